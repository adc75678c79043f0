//! Which terms are found down to which noise, and which are found that are not there.

use super::chapter::{Chapter, Part};
use super::seen::{ALPHA, CONVENTIONS, Seen, in_order};
use super::{decibel, down_to, listed, over_snr, percent};
use crate::figure::{Line, Panel, Scale};

/// A term counts as found where it is in so many of the cases.
const FOUND: f64 = 0.95;

/// Tests by convention, and the tool's own choice of terms.
const RULES: [&str; 4] = [CONVENTIONS[0], CONVENTIONS[1], CONVENTIONS[2], "kept"];

fn told(r: &Seen, rule: usize) -> bool {
    if rule < CONVENTIONS.len() { r.told(rule) } else { r.kept }
}

fn share(rows: &[&Seen], rule: usize) -> f64 {
    rows.iter().filter(|r| told(r, rule)).count() as f64 / rows.len() as f64
}

pub fn chapter(part: &Part<'_>) -> Chapter {
    let main = part.main();
    let terms: Vec<&Seen> = part.of(main).filter(|r| r.is_term()).collect();
    let (present, absent): (Vec<&Seen>, Vec<&Seen>) = terms.iter().partition(|r| r.truth != 0.0);
    let labels = in_order(present.iter().map(|r| r.label.as_str()));
    let here = |rows: &[&'_ Seen], label: Option<&str>, db: f64| -> Vec<Seen> {
        let fits = |r: &&&Seen| r.snr_db == db && label.is_none_or(|l| r.label == l);
        rows.iter().filter(fits).map(|r| (*r).clone()).collect()
    };
    let found = |label: &str, db: f64, rule: usize| {
        let rows = here(&present, Some(label), db);
        share(&rows.iter().collect::<Vec<_>>(), rule)
    };
    let false_positives = |db: f64, rule: usize| {
        let rows = here(&absent, None, db);
        share(&rows.iter().collect::<Vec<_>>(), rule)
    };
    let row = |name: &str, of: &dyn Fn(f64) -> f64| -> Vec<String> {
        let shares = part.snrs.iter().map(|db| percent(of(*db)));
        std::iter::once(name.to_string()).chain(shares).collect()
    };
    let found_rows: Vec<_> = labels.iter().map(|l| row(l, &|db| found(l, db, 0))).collect();
    let false_rows: Vec<_> =
        (0..RULES.len()).map(|r| row(RULES[r], &|db| false_positives(db, r))).collect();
    let line = |label: &str, of: &dyn Fn(f64) -> f64| Line {
        label: label.into(),
        points: part.snrs.iter().map(|db| (*db, of(*db))).filter(|p| p.1.is_finite()).collect(),
        ..Line::default()
    };
    let panel = |title: String, lines, nominal: f64| Panel {
        title,
        across: ("SNR, dB", Scale::Decibel),
        up: ("of the cases, %", Scale::Share),
        lines,
        nominal: part.snrs.iter().map(|db| (*db, nominal)).collect(),
        ..Panel::default()
    };
    let panels = vec![
        panel(
            format!("found by {main}, robust test"),
            labels.iter().map(|l| line(l, &|db| found(l, db, 0))).collect(),
            1.0,
        ),
        panel(
            "found and not there".into(),
            (0..RULES.len()).map(|r| line(RULES[r], &|db| false_positives(db, r))).collect(),
            ALPHA,
        ),
    ];
    let limits: Vec<(String, Option<f64>)> = labels
        .iter()
        .map(|l| (l.to_string(), down_to(&part.snrs, |db| found(l, db, 0) >= FOUND)))
        .collect();
    let counted: Vec<&Seen> = absent.iter().copied().filter(|r| !r.noiseless()).collect();
    let rates: Vec<f64> = (0..RULES.len()).map(|rule| share(&counted, rule)).collect();
    Chapter {
        name: "detection",
        says: format!("{} {}", limits_in_words(part, &limits), rates_in_words(&rates)),
        text: format!(
            "### Detection\n\nShare of the cases (seeds and joints) in which {main}'s robust test \
             (p <= {ALPHA}) finds a term that exists:\n\n{}\nShare in which a term is found that \
             does not exist, by each convention's test (nominal {}) and after backward \
             elimination (kept):\n\n{}",
            over_snr("term", &part.snrs, &found_rows),
            percent(ALPHA),
            over_snr("rule", &part.snrs, &false_rows)
        ),
        caption: "Terms found over SNR, and terms found that are not there".into(),
        panels,
        columns: 2,
    }
}

fn limits_in_words(part: &Part<'_>, limits: &[(String, Option<f64>)]) -> String {
    let lowest = part.snrs.first().copied();
    let (always, others): (Vec<_>, Vec<_>) = limits.iter().partition(|l| l.1 == lowest);
    let name = |l: &&(String, Option<f64>)| l.0.clone();
    let mut parts = Vec::new();
    if let (false, Some(lowest)) = (always.is_empty(), lowest) {
        let names: Vec<String> = always.iter().map(name).collect();
        parts.push(format!("{} down to {}", listed(&names), decibel(lowest)));
    }
    for (label, limit) in others {
        parts.push(match limit {
            Some(db) if db.is_infinite() => format!("{label} only without noise"),
            Some(db) => format!("{label} down to {}", decibel(*db)),
            None => format!("{label} at no SNR"),
        });
    }
    let least = format!("{:.0} % of the cases", 100.0 * FOUND);
    format!("**Terms are found** in at least {least}: {}.", parts.join("; "))
}

fn rates_in_words(rates: &[f64]) -> String {
    if rates.iter().any(|r| r.is_nan()) {
        return "No absent term was searched for.".into();
    }
    let named: Vec<String> =
        RULES.iter().zip(rates).map(|(r, rate)| format!("{} ({r})", percent(*rate))).collect();
    format!(
        "Of terms that do not exist, found nonetheless: {} (nominal {}).",
        listed(&named),
        percent(ALPHA)
    )
}
