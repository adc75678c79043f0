//! Do the intervals hold the truth as often as they say?

use super::chapter::{Chapter, Part};
use super::seen::{CONVENTIONS, Seen, in_order};
use super::{decibel, listed, over_snr, percent, quantile};
use crate::figure::{Line, Panel, Scale};
use crate::identification::LEVEL;
use crate::statistics::{normal_quantile, normal_two_sided};
use crate::text::markdown_table;

/// Intervals that hold the truth less often than this, of 99 % ones, lie.
const LIE: f64 = 0.95;
/// Standard errors of the share that chance is granted.
const CHANCE: f64 = 3.0;

/// Share of intervals that hold the truth, with its standard error.
struct Share {
    held: f64,
    error: f64,
    intervals: usize,
}

/// Parameters of one cell go together: the error is that of a mean over cells.
fn share(rows: &[&Seen], convention: usize) -> Share {
    let mut cells: Vec<(u64, f64, f64)> = Vec::new();
    for r in rows {
        let held = f64::from(u8::from(r.held(convention)));
        match cells.iter_mut().find(|c| c.0 == r.cell) {
            Some(cell) => (cell.1, cell.2) = (cell.1 + held, cell.2 + 1.0),
            None => cells.push((r.cell, held, 1.0)),
        }
    }
    let all = rows.len() as f64;
    let held = cells.iter().map(|c| c.1).sum::<f64>() / all;
    let n = cells.len() as f64;
    let squares: f64 = cells.iter().map(|c| (c.1 - held * c.2).powi(2)).sum();
    let error = (squares * n / (n - 1.0).max(1.0)).sqrt() / all;
    Share { held, error, intervals: rows.len() }
}

/// Conventions of a method with a name; chains have the posterior in the robust one's place.
fn conventions(method: &str) -> Vec<(usize, String)> {
    match method {
        "mcmc" => vec![(0, "posterior".into())],
        _ => CONVENTIONS.iter().enumerate().map(|(i, c)| (i, c.to_string())).collect(),
    }
}

fn given<'a>(part: &Part<'a>, method: &str) -> Vec<&'a Seen> {
    part.of(method).filter(|r| r.given).collect()
}

/// Rows from which shares over all noises are made.
fn counted<'a>(part: &Part<'a>, method: &str) -> Vec<&'a Seen> {
    given(part, method).into_iter().filter(|r| !r.noiseless()).collect()
}

pub fn chapter(part: &Part<'_>) -> Chapter {
    let mut rows = Vec::new();
    let mut verdicts: [Vec<String>; 4] = Default::default();
    let mut refused = Vec::new();
    for &method in &part.methods {
        let all = part.of(method).filter(|r| !r.noiseless()).count();
        let given = counted(part, method);
        if given.is_empty() {
            refused.push(method.to_string());
        }
        for (convention, name) in conventions(method) {
            let s = share(&given, convention);
            rows.push(vec![
                format!("{method}, {name}"),
                s.intervals.to_string(),
                (all - s.intervals).to_string(),
                percent(s.held),
                percent(s.error),
            ]);
            if s.intervals > 0 {
                let chance = s.held + CHANCE * s.error >= LEVEL;
                let kind = match (chance, s.held >= LIE) {
                    (true, true) => 0,
                    (false, true) => 1,
                    (false, false) => 2,
                    (true, false) => 3,
                };
                verdicts[kind].push(format!("{method}'s {name} ({})", percent(s.held)));
            }
        }
    }
    let header = ["intervals", "given", "refused", "hold the truth", "standard error"];
    let by_snr: Vec<Vec<String>> = part.methods.iter().flat_map(|m| over(part, m)).collect();
    let mut panels: Vec<Panel> = part.methods.iter().map(|m| panel(part, m)).collect();
    panels.extend(part.methods.iter().map(|m| against_nominal(part, m)));
    Chapter {
        name: "coverage",
        says: format!("{}{}{}", says(&verdicts), none_given(&refused), weakest(part)),
        text: format!(
            "### Coverage\n\nOf the {:.0} % intervals, over all parameters, seeds and noises (a motor \
             without any noise does not count: there is nothing for an interval to hold); refused \
             are those the tool does not stand by. Standard errors are of a mean over cells, as \
             the parameters of one recording go together.\n\n{}\n{}",
            100.0 * LEVEL,
            markdown_table(&header, 1, &rows),
            over_snr("hold the truth", &part.snrs, &by_snr)
        ),
        caption: "Coverage over SNR (top) and against the nominal level (bottom)".into(),
        panels,
        columns: part.methods.len(),
    }
}

fn says([keep, narrow, lie, open]: &[Vec<String>; 4]) -> String {
    let mut parts = Vec::new();
    if !lie.is_empty() {
        parts.push(format!("**Intervals that lie**: {}", listed(lie)));
    }
    if !narrow.is_empty() {
        parts.push(format!("somewhat too narrow: {}", listed(narrow)));
    }
    if !keep.is_empty() {
        parts.push(format!(
            "as good as they say (nominal {:.0} %): {}",
            100.0 * LEVEL,
            listed(keep)
        ));
    }
    if !open.is_empty() {
        parts.push(format!("too few cells to say: {}", listed(open)));
    }
    match parts.is_empty() {
        true => "**No interval was given.**".into(),
        false => format!("{}.", parts.join("; ")),
    }
}

fn none_given(methods: &[String]) -> String {
    match methods {
        [] => String::new(),
        _ => format!(" The tool stands by no interval of {}.", listed(methods)),
    }
}

/// The parameter at which the main method's robust intervals fail most, if they do.
fn weakest(part: &Part<'_>) -> String {
    let given = counted(part, part.main());
    let only = |label: &str, of: bool| -> Vec<&Seen> {
        given.iter().copied().filter(|r| (r.label == label) == of).collect()
    };
    let held = |label: &&str| share(&only(label, true), 0).held;
    let labels = in_order(given.iter().map(|r| r.label.as_str()));
    let Some(label) = labels.into_iter().min_by(|a, b| held(a).total_cmp(&held(b))) else {
        return String::new();
    };
    let (here, others) = (only(label, true), share(&only(label, false), 0).held);
    let at = |db: f64| here.iter().copied().filter(move |r| r.snr_db == db);
    let worst =
        part.snrs.iter().copied().map(|db| (db, share(&at(db).collect::<Vec<_>>(), 0).held));
    let worst = worst.filter(|w| w.1.is_finite()).min_by(|a, b| a.1.total_cmp(&b.1));
    let Some((db, least)) = worst.filter(|_| held(&label) < LIE) else { return String::new() };
    let errors: Vec<f64> = at(db).filter_map(Seen::error).collect();
    let off = match errors.is_empty() {
        true => String::new(),
        false => format!(" where the median error is {}", percent(quantile(&errors, 0.5))),
    };
    format!(
        " {}'s robust ones fail most for {label}: {} of them hold the truth, {} at {}{off}; of all \
         others {} do.",
        part.main(),
        percent(held(&label)),
        percent(least),
        if db.is_infinite() { "no noise".into() } else { decibel(db) },
        percent(others)
    )
}

fn over(part: &Part<'_>, method: &str) -> Vec<Vec<String>> {
    let given = given(part, method);
    let row = |(convention, name): (usize, String)| {
        let cell = |db: &f64| {
            let here: Vec<&Seen> = given.iter().copied().filter(|r| r.snr_db == *db).collect();
            percent(share(&here, convention).held)
        };
        let first = std::iter::once(format!("{method}, {name}"));
        first.chain(part.snrs.iter().map(cell)).collect()
    };
    conventions(method).into_iter().map(row).collect()
}

fn panel(part: &Part<'_>, method: &str) -> Panel {
    let given = given(part, method);
    let line = |(convention, label): (usize, String)| {
        let mut line = Line { label, ..Line::default() };
        for &db in &part.snrs {
            let here: Vec<&Seen> = given.iter().copied().filter(|r| r.snr_db == db).collect();
            if here.is_empty() {
                continue;
            }
            let s = share(&here, convention);
            line.points.push((db, s.held));
            let [low, high] = [s.held - 2.0 * s.error, s.held + 2.0 * s.error];
            line.band.push((db, low.max(0.0), high.min(1.0)));
        }
        line
    };
    Panel {
        title: format!("{method}: {:.0} % intervals", 100.0 * LEVEL),
        across: ("SNR, dB", Scale::Decibel),
        up: ("hold the truth, %", Scale::Share),
        lines: conventions(method).into_iter().map(line).collect(),
        nominal: part.snrs.iter().map(|db| (*db, LEVEL)).collect(),
        ..Panel::default()
    }
}

/// Intervals of other levels follow from the 99 % one as if the estimate were Gaussian.
fn against_nominal(part: &Part<'_>, method: &str) -> Panel {
    let given = given(part, method);
    let levels: Vec<f64> =
        (0..=25).map(|k| 0.5 + 0.02 * f64::from(k)).map(|l| l.min(LEVEL)).collect();
    let line = |(convention, label): (usize, String)| {
        let needed: Vec<f64> = given.iter().map(|r| level_needed(r, convention)).collect();
        let held = |level: f64| {
            needed.iter().filter(|n| **n <= level).count() as f64 / needed.len().max(1) as f64
        };
        let points = levels.iter().map(|l| (*l, held(*l))).collect();
        Line { label, points, ..Line::default() }
    };
    Panel {
        title: format!("{method}: all levels"),
        across: ("nominal level", Scale::Linear),
        up: ("hold the truth, %", Scale::Share),
        lines: conventions(method).into_iter().map(line).collect(),
        nominal: vec![(0.5, 0.5), (LEVEL, LEVEL)],
        ..Panel::default()
    }
}

/// The least level whose interval holds the truth.
fn level_needed(r: &Seen, convention: usize) -> f64 {
    let [low, high, _] = r.intervals[convention];
    let half = if r.truth < r.value { r.value - low } else { high - r.value };
    let z = normal_quantile(1.0 - LEVEL) * (r.truth - r.value).abs() / half;
    if z.is_finite() { 1.0 - normal_two_sided(z).p } else { 1.0 }
}
