//! What the sensors' rounding does where noise does not blur its steps: rounded and exact cells of
//! the same motions side by side.

use super::chapter::{Chapter, Part};
use super::seen::{Seen, in_order};
use super::{decibel, distinct, over_snr, percent, quantile};
use crate::figure::{Line, Panel, Scale};

/// Share of the estimates that keep to the errors shown.
const MOST: f64 = 0.9;
/// Rounding is said to matter where it makes errors so many times larger.
const WORSE: f64 = 2.0;

/// `None` where no cell was left unrounded.
pub fn chapter(part: &Part<'_>) -> Option<Chapter> {
    if part.exact.is_empty() {
        return None;
    }
    let main = part.main();
    let exact: Vec<&Seen> = part.exact.iter().copied().filter(|r| r.method == main).collect();
    let there = |r: &&Seen| exact.iter().any(|e| e.strength == r.strength && e.snr_db == r.snr_db);
    let rounded: Vec<&Seen> = part.of(main).filter(there).collect();
    let snrs = distinct(exact.iter().map(|r| r.snr_db));
    let labels = in_order(exact.iter().filter(|r| r.truth != 0.0).map(|r| r.label.as_str()));
    let row = |label: &&str| {
        let cell = |db: &f64| {
            let [rounded, exact] = [&rounded, &exact].map(|rows| most(rows, label, *db));
            format!("{} ({})", percent(rounded), percent(exact))
        };
        std::iter::once(label.to_string()).chain(snrs.iter().map(cell)).collect()
    };
    let mut rows: Vec<Vec<String>> = labels.iter().map(row).collect();
    let cell = |db: &f64| {
        let [rounded, exact] = [&rounded, &exact].map(|rows| held(rows, None, *db));
        format!("{} ({})", percent(rounded), percent(exact))
    };
    let first = "hold the truth".to_string();
    rows.push(std::iter::once(first).chain(snrs.iter().map(cell)).collect());
    let panels: Vec<Panel> = labels.iter().map(|l| panel(l, &snrs, &rounded, &exact)).collect();
    Some(Chapter {
        name: "rounding",
        says: says(&labels, &snrs, &rounded, &exact),
        text: format!(
            "### Rounding\n\nWhat {:.0} % of {main}'s estimates keep to where the sensors round, and \
             in brackets where they do not, on the same motions; last, how often its robust \
             intervals hold the truth.\n\n{}",
            100.0 * MOST,
            over_snr("parameter", &snrs, &rows)
        ),
        caption: "Relative error with and without the sensors' rounding: median, and the band \
                  between 10 % and 90 %"
            .into(),
        panels,
        columns: 3,
    })
}

fn errors(rows: &[&Seen], label: &str, db: f64) -> Vec<f64> {
    let here = rows.iter().filter(|r| r.label == label && r.snr_db == db);
    here.filter_map(|r| r.error()).filter(|e| e.is_finite()).collect()
}

fn most(rows: &[&Seen], label: &str, db: f64) -> f64 {
    quantile(&errors(rows, label, db), MOST)
}

/// Share of the robust intervals, of one parameter or of all, that hold the truth.
fn held(rows: &[&Seen], label: Option<&str>, db: f64) -> f64 {
    let ours = |r: &&&Seen| r.snr_db == db && r.given && label.is_none_or(|l| r.label == l);
    let here: Vec<_> = rows.iter().filter(ours).collect();
    here.iter().filter(|r| r.held(0)).count() as f64 / here.len() as f64
}

/// The parameter and noise at which rounding does most, and the joint that feels it.
fn says(labels: &[&str], snrs: &[f64], rounded: &[&Seen], exact: &[&Seen]) -> String {
    let ratio = |(label, db): &(&str, f64)| most(rounded, label, *db) / most(exact, label, *db);
    let places = labels.iter().flat_map(|label| snrs.iter().map(|db| (*label, *db)));
    let worst = places.max_by(|a, b| ratio(a).total_cmp(&ratio(b)));
    let Some((label, db)) = worst.filter(|place| ratio(place) >= WORSE) else {
        return "**The sensors' rounding** does little at any noise studied.".into();
    };
    let here = || rounded.iter().filter(|r| r.label == label && r.snr_db == db);
    let median = |joint: u64| {
        let at = here().filter(|r| r.joint == joint).filter_map(|r| r.error());
        quantile(&at.collect::<Vec<_>>(), 0.5)
    };
    let joints = distinct(here().map(|r| r.joint as f64)).into_iter().map(|j| j as u64);
    let joint = joints.max_by(|a, b| median(*a).total_cmp(&median(*b))).unwrap_or_default();
    let noise =
        if db.is_infinite() { "Without noise".into() } else { format!("At {}", decibel(db)) };
    format!(
        "**Less noise is not always better**: where it no longer blurs the steps to which sensors \
         round, these become errors that go with the motion. {noise}, nine of ten estimates of \
         {label} are within {} (median at joint {joint}, which feels it most: {}), without rounding \
         within {}; of its robust intervals {} hold the truth, without rounding {}.",
        percent(most(rounded, label, db)),
        percent(median(joint)),
        percent(most(exact, label, db)),
        percent(held(rounded, Some(label), db)),
        percent(held(exact, Some(label), db)),
    )
}

fn panel(label: &str, snrs: &[f64], rounded: &[&Seen], exact: &[&Seen]) -> Panel {
    let line = |(name, rows): (&str, &[&Seen])| {
        let at = |p: f64| snrs.iter().map(move |db| 100.0 * quantile(&errors(rows, label, *db), p));
        Line {
            label: name.into(),
            points: snrs.iter().copied().zip(at(0.5)).collect(),
            band: snrs.iter().zip(at(0.1)).zip(at(MOST)).map(|((db, a), b)| (*db, a, b)).collect(),
            ..Line::default()
        }
    };
    Panel {
        title: label.into(),
        across: ("SNR, dB", Scale::Decibel),
        up: ("error, %", Scale::Log),
        lines: [("rounded", rounded), ("exact", exact)].into_iter().map(line).collect(),
        ..Panel::default()
    }
}
