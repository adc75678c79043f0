//! How far estimates are off, and which parameter goes first.

use super::chapter::{Chapter, Part};
use super::seen::{Seen, in_order};
use super::{decibel, listed, over_snr, percent, quantile};
use crate::figure::{Line, Panel, Scale};

/// Relative error within which an estimate is of use.
const USEFUL: f64 = 0.2;
/// Share of the estimates that must be within it.
const MOST: f64 = 0.9;

pub fn chapter(part: &Part<'_>) -> Chapter {
    let labels = labels(part);
    let main = part.main();
    let row = |label: &&str| {
        let cell = |db: &f64| {
            let errors = errors(part.of(main), label, *db);
            format!("{} ({})", percent(quantile(&errors, 0.5)), percent(quantile(&errors, MOST)))
        };
        std::iter::once(label.to_string()).chain(part.snrs.iter().map(cell)).collect()
    };
    let rows: Vec<Vec<String>> = labels.iter().map(row).collect();
    let panels: Vec<Panel> = labels.iter().map(|label| panel(part, label)).collect();
    Chapter {
        name: "error",
        says: order(part, &labels),
        text: format!(
            "### Errors\n\n|estimate - truth| / |truth| by {main}: median over seeds and joints, and \
             in brackets what {:.0} % of the estimates keep to.\n\n{}",
            100.0 * MOST,
            over_snr("parameter", &part.snrs, &rows)
        ),
        caption: "Relative error over SNR: median, and the band between 10 % and 90 %".into(),
        panels,
        columns: 3,
    }
}

/// Labels of the parameters that exist.
fn labels<'a>(part: &Part<'a>) -> Vec<&'a str> {
    let exists = part.rows.iter().filter(|r| r.truth != 0.0 && !r.absent);
    in_order(exists.map(|r| r.label.as_str()))
}

fn errors<'a>(rows: impl Iterator<Item = &'a Seen>, label: &str, db: f64) -> Vec<f64> {
    let here = rows.filter(|r| r.label == label && r.snr_db == db);
    here.filter_map(Seen::error).filter(|e| e.is_finite()).collect()
}

/// The noises at which a parameter is of use: from the SNR at which it is best, down and up.
struct Range<'a> {
    label: &'a str,
    /// Lowest and highest SNR; `None` if it is of use at none.
    snrs: Option<(f64, f64)>,
}

fn range<'a>(part: &Part<'_>, label: &'a str) -> Range<'a> {
    let most = |db: f64| quantile(&errors(part.of(part.main()), label, db), MOST);
    let best = part.snrs.iter().copied().min_by(|a, b| most(*a).total_cmp(&most(*b)));
    let useful = |db: &f64| most(*db) <= USEFUL;
    let snrs = best.filter(useful).map(|best| {
        let below = part.snrs.iter().rev().copied().filter(|db| *db <= best);
        let above = part.snrs.iter().copied().filter(|db| *db >= best);
        let lowest = below.take_while(useful).last().unwrap_or(best);
        (lowest, above.take_while(useful).last().unwrap_or(best))
    });
    Range { label, snrs }
}

impl Range<'_> {
    fn in_words(&self, quietest: f64) -> String {
        let noises = match self.snrs {
            None => "at no SNR".into(),
            Some((low, _)) if low.is_infinite() => "only without noise".into(),
            Some((low, high)) if high < quietest => format!("{low} to {}", decibel(high)),
            Some((low, _)) => format!("down to {}", decibel(low)),
        };
        format!("{} ({noises})", self.label)
    }
}

/// How much noise the estimates bear, in plain words.
pub fn headline(part: &Part<'_>) -> String {
    let labels = labels(part);
    let ranges: Vec<Range> = labels.iter().map(|label| range(part, label)).collect();
    let useful: Vec<(&str, f64)> =
        ranges.iter().filter_map(|r| Some((r.label, r.snrs?.0))).collect();
    let most_in_need = useful.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    let Some((label, least)) = most_in_need else {
        return format!(
            "At no noise are nine of ten values within {:.0} % of the truth.",
            100.0 * USEFUL
        );
    };
    let within = format!("within {:.0} % of the truth in nine of ten cases", 100.0 * USEFUL);
    let noises = match least.is_infinite() {
        true => "without noise".into(),
        false => format!("where the signal is at least {} above the noise", decibel(*least)),
    };
    match ranges.len() - useful.len() {
        0 => format!("All parameters come back {within} {noises}; {label} needs that most."),
        _ => format!(
            "Of {} parameters {} come back {within} {noises}; the others do at no noise that was tried.",
            ranges.len(),
            useful.len()
        ),
    }
}

/// Which parameter is of no more use first as noise grows.
fn order(part: &Part<'_>, labels: &[&str]) -> String {
    let ends = (part.snrs.first().copied(), part.snrs.last().copied());
    let (Some(loudest), Some(quietest)) = ends else { return "Nothing was estimated.".into() };
    let mut ranges: Vec<Range> = labels.iter().map(|label| range(part, label)).collect();
    // What is never of use goes first.
    let lowest = |r: &Range| r.snrs.map_or(f64::INFINITY, |s| s.0);
    ranges.sort_by(|a, b| {
        a.snrs.is_some().cmp(&b.snrs.is_some()).then(lowest(b).total_cmp(&lowest(a)))
    });
    let (hold, go): (Vec<_>, Vec<_>) =
        ranges.into_iter().partition(|r| r.snrs == Some((loudest, quietest)));
    let held: Vec<String> = hold.iter().map(|r| r.label.to_string()).collect();
    let lost: Vec<String> = go.iter().map(|r| r.in_words(quietest)).collect();
    let floor = decibel(loudest);
    let within = format!(
        "nine of ten estimates are within {:.0} % of the truth by {}",
        100.0 * USEFUL,
        part.main()
    );
    let Some(first) = go.first() else {
        return format!("**No parameter is lost down to {floor}**: {within}.");
    };
    let rest = match held.is_empty() {
        true => String::new(),
        false => format!("; down to {floor} hold {}", listed(&held)),
    };
    format!(
        "**{} goes first** as noise grows; where {within}, in this order: {}{rest}.",
        first.label,
        lost.join(", ")
    )
}

/// What most estimates of every parameter keep to, in one panel: the answer at a glance.
pub fn overview(part: &Part<'_>) -> Panel {
    let main = part.main();
    let line = |label: &str| {
        let at = |db: &f64| (*db, 100.0 * quantile(&errors(part.of(main), label, *db), MOST));
        let points = part.snrs.iter().map(at).filter(|p| p.1.is_finite()).collect();
        Line { label: label.into(), points, ..Line::default() }
    };
    Panel {
        title: format!("What {:.0} % of the estimates by {main} keep to", 100.0 * MOST),
        across: ("SNR, dB", Scale::Decibel),
        up: ("error, %", Scale::Log),
        lines: labels(part).into_iter().map(line).collect(),
        nominal: part.snrs.iter().map(|db| (*db, 100.0 * USEFUL)).collect(),
        ..Panel::default()
    }
}

fn panel(part: &Part<'_>, label: &str) -> Panel {
    let line = |method: &&str| {
        let at = |db: &f64| (*db, errors(part.of(method), label, *db));
        let all: Vec<(f64, Vec<f64>)> =
            part.snrs.iter().map(at).filter(|(_, e)| !e.is_empty()).collect();
        Line {
            label: method.to_string(),
            points: all.iter().map(|(db, e)| (*db, 100.0 * quantile(e, 0.5))).collect(),
            band: all
                .iter()
                .map(|(db, e)| (*db, 100.0 * quantile(e, 0.1), 100.0 * quantile(e, 0.9)))
                .collect(),
            ..Line::default()
        }
    };
    Panel {
        title: label.into(),
        across: ("SNR, dB", Scale::Decibel),
        up: ("error, %", Scale::Log),
        lines: part.methods.iter().map(line).collect(),
        ..Panel::default()
    }
}
