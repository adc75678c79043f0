//! Which grafts were found, at which strength.

use std::collections::BTreeMap;

use super::super::{Judged, Share};
use crate::diagnosis::Verdict;
use crate::text::markdown_table;
use crate::trials::Kind;

/// Strengths that were asked for, in order.
pub fn levels(all: &[Judged]) -> Vec<f64> {
    let mut levels: Vec<f64> = all.iter().filter_map(|j| j.drawn).collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup();
    levels
}

/// The level next to the strength that a case reached, by ratio.
pub fn level(judged: &Judged, levels: &[f64]) -> Option<f64> {
    let distance = |l: &f64| (judged.strength.max(1e-9) / l).ln().abs();
    levels.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// Grafts of the catalogue whose finding proves something: what the untouched pair is said to lack
/// already is left out.
pub fn asked(all: &[Judged]) -> Vec<&Judged> {
    all.iter().filter(|j| j.kind == Kind::Grafted && !j.in_base).collect()
}

/// Named at the right place, or called equivalent to something named.
pub fn named(judged: &Judged) -> bool {
    judged.all_set
}

pub fn at_level<'a>(cases: &[&'a Judged], wanted: f64, levels: &[f64]) -> Vec<&'a Judged> {
    let here = |j: &&Judged| level(j, levels) == Some(wanted);
    cases.iter().copied().filter(here).collect()
}

pub fn by_strength(all: &[Judged]) -> String {
    let (levels, cases) = (levels(all), asked(all));
    let row = |label: String, here: &[&Judged]| {
        let share = |hit: fn(&Judged) -> bool| Share::count(here.iter().copied(), hit).to_string();
        vec![
            label,
            here.len().to_string(),
            share(named),
            share(|j| j.all),
            share(|j| j.top1_set),
            share(|j| j.wrong),
            share(|j| j.causes.is_empty()),
        ]
    };
    let mut rows: Vec<_> =
        levels.iter().map(|l| row(l.to_string(), &at_level(&cases, *l, &levels))).collect();
    rows.push(row("all".into(), &cases));
    let header = [
        "strength",
        "cases",
        "named, set",
        "named exactly",
        "first cause, set",
        "strays",
        "no name",
    ];
    let known = all.iter().filter(|j| j.kind == Kind::Grafted && j.in_base).count();
    let left_out = match known {
        0 => String::new(),
        n => format!(
            "\nLeft out: {n} grafts of what the untouched pair is said to lack already, at that \
             place.\n"
        ),
    };
    markdown_table(&header, 1, &rows) + &left_out
}

/// Effect by strength: found of asked.
pub fn by_effect(all: &[Judged]) -> String {
    let (levels, cases) = (levels(all), asked(all));
    let mut groups: BTreeMap<&str, Vec<&Judged>> = BTreeMap::new();
    for judged in cases {
        let Some(truth) = judged.truth.first() else { continue };
        groups.entry(&truth.effect).or_default().push(judged);
    }
    let cell = |cases: &[&Judged]| match cases.len() {
        0 => "-".to_string(),
        n => format!("{} / {n}", cases.iter().filter(|j| named(j)).count()),
    };
    let row = |(effect, cases): (&&str, &Vec<&Judged>)| {
        let each = levels.iter().map(|l| cell(&at_level(cases, *l, &levels)));
        std::iter::once(effect.to_string()).chain(each).chain([cell(cases)]).collect()
    };
    let rows: Vec<Vec<String>> = groups.iter().map(row).collect();
    let labels: Vec<String> = levels.iter().map(|l| format!("strength {l}")).collect();
    let header: Vec<&str> =
        std::iter::once("effect").chain(labels.iter().map(String::as_str)).chain(["all"]).collect();
    markdown_table(&header, 1, &rows)
}

/// Effects that no entry of the catalogue describes.
pub fn foreign(all: &[Judged]) -> String {
    let cases = all.iter().filter(|j| j.kind == Kind::GraftedForeign);
    let mut groups: BTreeMap<&str, Vec<&Judged>> = BTreeMap::new();
    for judged in cases {
        let Some(truth) = judged.truth.first() else { continue };
        groups.entry(&truth.effect).or_default().push(judged);
    }
    let row = |(effect, cases): (&&str, &Vec<&Judged>)| {
        let share = |hit: fn(&Judged) -> bool| Share::count(cases.iter().copied(), hit).to_string();
        let mut names: Vec<&str> =
            cases.iter().flat_map(|j| &j.strays).map(|n| n.effect.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        vec![
            effect.to_string(),
            cases.len().to_string(),
            share(explained),
            share(|j| j.wrong),
            names.join(", "),
        ]
    };
    let rows: Vec<_> = groups.iter().map(row).collect();
    let header =
        ["effect", "cases", "\"explained\"", "a cause beyond the untouched pair's", "named"];
    markdown_table(&header, 1, &rows)
}

pub fn explained(judged: &Judged) -> bool {
    judged.verdict == Some(Verdict::Explained)
}
