//! A finished study in words, tables and plots.

mod chapter;
mod cost;
mod coverage;
mod detection;
mod diagnosis;
mod errors;
mod identification;
mod rounding;
mod seen;

use super::study::{Question, Study};
use super::table::Table;
use crate::figure::{Figure, Panel};
use crate::text::markdown_table;

/// What a study comes to.
pub struct Page {
    /// What the study found, in one or two sentences for somebody who knows nothing of it.
    pub headline: String,
    /// Markdown: a title, findings as a list, chapters with tables and figures by their files.
    pub text: String,
    /// The first finding at a glance; `None` where there is none.
    pub picture: Option<Panel>,
    pub figures: Vec<Figure>,
}

/// Page of a finished study, from the joined tables of its cells.
pub fn summarise(study: &Study, cells: &Table, timings: &Table) -> Page {
    let head = head(study, cells);
    let page = match study.question {
        Question::Identification => identification::page(cells),
        Question::Diagnosis => diagnosis::page(cells),
        Question::Cost => cost::page(study, cells, timings),
    };
    Page { text: format!("{head}{}", page.text), ..page }
}

fn head(study: &Study, cells: &Table) -> String {
    let seeds: std::collections::BTreeSet<u64> =
        study.grid.iter().flat_map(|g| g.seed.iter().copied()).collect();
    let seeds = match (seeds.first(), seeds.last()) {
        (Some(first), Some(last)) if first != last => format!("seeds {first} to {last}"),
        _ => "seed 1".into(),
    };
    let failures: Vec<&String> = cells.texts("failed").iter().filter(|f| !f.is_empty()).collect();
    let failed = match failures.first() {
        None => String::new(),
        Some(why) => {
            format!("\n{} cells failed and are left out; the first: {why}\n", failures.len())
        }
    };
    format!(
        "# {}\n\narmtwin {}, {} cells, {seeds}; study {}.\n{failed}\n",
        study.title,
        env!("CARGO_PKG_VERSION"),
        study.cells(),
        &study.digest()[..16],
    )
}

/// A signal-to-noise ratio in words; `none` for no noise.
fn decibel(db: f64) -> String {
    if db.is_infinite() { "none".into() } else { format!("{db} dB") }
}

fn percent(share: f64) -> String {
    match share.is_finite() {
        true if share.abs() >= 9.995 => format!("{:.0} %", 100.0 * share),
        true => format!("{:.1} %", 100.0 * share),
        false => "-".into(),
    }
}

/// Markdown table of rows with one column per signal-to-noise ratio.
fn over_snr(first: &str, snrs: &[f64], rows: &[Vec<String>]) -> String {
    let names: Vec<String> = snrs.iter().map(|db| decibel(*db)).collect();
    let header: Vec<&str> =
        std::iter::once(first).chain(names.iter().map(String::as_str)).collect();
    markdown_table(&header, 1, rows)
}

/// The different values, rising, without NaN.
fn distinct(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = values.filter(|v| !v.is_nan()).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Quantile `p`, linear between order statistics; NaN of none.
fn quantile(values: &[f64], p: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let at = p * last as f64;
    let (below, share) = (at as usize, at.fract());
    let above = sorted[(below + 1).min(last)];
    sorted[below] + if share > 0.0 { share * (above - sorted[below]) } else { 0.0 }
}

/// The lowest of rising `snrs` from which on `holds`; `None` if not even at the highest.
fn down_to(snrs: &[f64], holds: impl Fn(f64) -> bool) -> Option<f64> {
    snrs.iter().rev().copied().take_while(|db| holds(*db)).last()
}

/// Words as a list: "a, b and c".
fn listed(words: &[String]) -> String {
    match words {
        [] => "nothing".into(),
        [one] => one.clone(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_and_limits() {
        assert_eq!(quantile(&[3.0, 1.0, 2.0], 0.5), 2.0);
        assert!(quantile(&[], 0.5).is_nan());
        let snrs = [10.0, 20.0, 30.0, f64::INFINITY];
        assert_eq!(down_to(&snrs, |db| db >= 20.0), Some(20.0));
        assert_eq!(down_to(&snrs, |db| db == 10.0), None);
        assert_eq!(listed(&["a".into(), "b".into(), "c".into()]), "a, b and c");
    }
}
