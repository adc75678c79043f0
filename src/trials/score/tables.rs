//! The tables of the report.

use std::collections::BTreeMap;

use super::rows::{LEVELS, brier, level, mean, mean_set_size, median, of, of_oracle};
use super::{Judged, Kind, Share};
use crate::diagnosis::Named;
use crate::text::markdown_table;
use crate::trials::Method;

fn share(cases: &[&Judged], hit: impl Fn(&Judged) -> bool) -> String {
    Share::count(cases.iter().copied(), hit).to_string()
}

fn number(value: Option<f64>) -> String {
    value.map_or("-".into(), |v| format!("{v:.2}"))
}

/// Table by strength of cases with a single effect of the catalogue.
pub fn by_strength(all: &[Judged]) -> String {
    let row = |label: String, cases: &[&Judged]| {
        vec![
            label,
            cases.len().to_string(),
            share(cases, |j| j.top1),
            share(cases, |j| j.top1_set),
            share(cases, |j| j.top2),
            share(cases, |j| j.top2_set),
            number(mean_set_size(cases.iter().copied())),
            share(cases, |j| j.joint),
            share(cases, |j| j.wrong),
            share(cases, |j| j.abstained),
            share(cases, |j| j.silent),
        ]
    };
    let single = of(all, Kind::Single);
    let mut rows = Vec::new();
    for (i, strength) in LEVELS.iter().enumerate() {
        let cases: Vec<_> = single.iter().copied().filter(|j| level(j.strength) == i).collect();
        rows.push(row(strength.to_string(), &cases));
    }
    let strong: Vec<_> = single.iter().copied().filter(|j| level(j.strength) > 0).collect();
    rows.push(row("1 and above".into(), &strong));
    let header = [
        "strength",
        "cases",
        "top-1",
        "top-1, set",
        "top-2",
        "top-2, set",
        "set size",
        "joint",
        "wrong name",
        "abstained",
        "no gap",
    ];
    markdown_table(&header, 1, &rows)
}

/// Single effects at strength 1 and above.
pub fn by_effect(all: &[Judged]) -> String {
    let mut groups: BTreeMap<&str, Vec<&Judged>> = BTreeMap::new();
    for judged in super::rows::plain(all) {
        let Some(truth) = judged.truth.first() else { continue };
        groups.entry(&truth.effect).or_default().push(judged);
    }
    let row = |(effect, cases): (&&str, &Vec<&Judged>)| {
        vec![
            effect.to_string(),
            share(cases, |j| j.top1),
            share(cases, |j| j.top1_set),
            share(cases, |j| j.joint),
            share(cases, |j| j.wrong),
            share(cases, |j| j.abstained || j.silent),
            taken_for(cases),
        ]
    };
    let rows: Vec<_> = groups.iter().map(row).collect();
    let header = ["effect", "top-1", "top-1, set", "joint", "wrong name", "no name", "taken for"];
    markdown_table(&header, 1, &rows)
}

fn taken_for(cases: &[&Judged]) -> String {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for named in cases.iter().filter(|j| j.wrong).filter_map(|j| j.first.as_ref()) {
        *counts.entry(named.effect.clone()).or_default() += 1;
    }
    counts.iter().map(|(name, n)| format!("{name} {n}")).collect::<Vec<_>>().join(", ")
}

/// Cases whose right answer is no name.
pub fn without_a_name(all: &[Judged]) -> String {
    let mut rows = Vec::new();
    for kind in [Kind::Clean, Kind::Unseen, Kind::Withheld, Kind::Foreign] {
        let cases = of(all, kind);
        let graded = matches!(kind, Kind::Withheld | Kind::Foreign);
        rows.push(row_without_a_name(kind.name().into(), &cases));
        for (i, strength) in LEVELS.iter().enumerate().filter(|_| graded) {
            let here: Vec<_> = cases.iter().copied().filter(|j| level(j.strength) == i).collect();
            rows.push(row_without_a_name(format!("{} at {strength}", kind.name()), &here));
        }
    }
    let header =
        ["kind", "cases", "no gap", "abstained", "a cause named", "of these a stand-in", "right"];
    markdown_table(&header, 1, &rows)
}

fn row_without_a_name(label: String, cases: &[&Judged]) -> Vec<String> {
    let named: Vec<_> =
        cases.iter().copied().filter(|j| !j.causes.is_empty() && !j.abstained).collect();
    vec![
        label,
        cases.len().to_string(),
        share(cases, |j| j.silent),
        share(cases, |j| j.abstained),
        named.len().to_string(),
        share(&named, Judged::stands_in),
        share(cases, |j| j.right),
    ]
}

pub fn pairs(all: &[Judged]) -> String {
    let cases = of(all, Kind::Pair);
    let rows: Vec<_> = (0..LEVELS.len())
        .map(|i| {
            let here: Vec<_> = cases.iter().copied().filter(|j| level(j.strength) == i).collect();
            vec![
                LEVELS[i].to_string(),
                here.len().to_string(),
                share(&here, |j| j.all),
                share(&here, |j| j.all_set),
                share(&here, |j| j.top1_set),
                share(&here, |j| j.wrong),
                number(mean(here.iter().map(|j| j.causes.len() as f64))),
            ]
        })
        .collect();
    let header =
        ["weaker strength", "cases", "both", "both, sets", "top-1, set", "wrong name", "causes"];
    markdown_table(&header, 1, &rows)
}

pub fn calibration(all: &[Judged]) -> String {
    let edges = [0.0, 0.5, 0.7, 0.8, 0.9, 0.95, 1.0 + f64::EPSILON];
    let rows: Vec<_> = edges
        .windows(2)
        .map(|e| {
            let inside = |j: &&Judged| j.verdict.is_some() && (e[0]..e[1]).contains(&j.probability);
            let here: Vec<_> = all.iter().filter(inside).collect();
            vec![
                format!("{} to {}", e[0], e[1].min(1.0)),
                here.len().to_string(),
                number(mean(here.iter().map(|j| j.probability))),
                share(&here, |j| j.right),
            ]
        })
        .collect();
    let score = brier(all).map_or("-".into(), |b| format!("{b:.3}"));
    let table = markdown_table(&["printed", "cases", "mean", "right"], 1, &rows);
    format!("{table}\nBrier score over all cases: {score}.\n")
}

pub fn parameters<'a>(all: impl IntoIterator<Item = &'a Judged>) -> String {
    let mut groups: BTreeMap<(&str, &str), Vec<_>> = BTreeMap::new();
    for p in all.into_iter().flat_map(|j| &j.parameters) {
        groups.entry((&p.effect, &p.name)).or_default().push(p);
    }
    let row = |((effect, name), all): (&(&str, &str), &Vec<&super::JudgedParameter>)| {
        let errors = || all.iter().filter_map(|p| p.error());
        vec![
            effect.to_string(),
            name.to_string(),
            median(errors()).map_or("-".into(), |e| format!("{:.1} %", 100.0 * e)),
            Share::count(all.iter().copied(), |p: &super::JudgedParameter| p.covers()).to_string(),
        ]
    };
    let rows: Vec<_> = groups.iter().map(row).collect();
    markdown_table(&["effect", "parameter", "median error", "90 % interval covers"], 2, &rows)
}

pub fn shrink(all: &[Judged]) -> String {
    let named = |kind| -> Vec<&Judged> {
        of(all, kind).into_iter().filter(|j| !j.causes.is_empty()).collect()
    };
    let rows: Vec<_> = [Kind::Single, Kind::Pair, Kind::Withheld, Kind::Foreign]
        .into_iter()
        .map(|kind| {
            let cases = named(kind);
            let middle =
                |f: fn(&Judged) -> Option<f64>| number(median(cases.iter().filter_map(|j| f(j))));
            vec![
                kind.name().to_string(),
                cases.len().to_string(),
                middle(|j| j.predicted),
                middle(|j| j.reducible),
                middle(|j| j.realised),
                middle(|j| j.oracle),
                number(median(of_oracle(cases.iter().copied()).into_iter())),
            ]
        })
        .collect();
    let header = [
        "kind",
        "with a cause",
        "printed",
        "printed, above noise",
        "realised",
        "oracle",
        "realised / oracle",
    ];
    markdown_table(&header, 1, &rows)
}

/// The simpler rules beside the diagnosis.
pub fn baselines(all: &[Judged]) -> String {
    let strong = super::rows::plain(all);
    let outside: Vec<&Judged> =
        all.iter().filter(|j| matches!(j.kind, Kind::Withheld | Kind::Foreign)).collect();
    let clean = of(all, Kind::Clean);
    let mut rows = vec![vec![
        "the diagnosis".to_string(),
        share(&strong, |j| j.top1),
        share(&strong, |j| j.joint),
        share(&strong, |j| j.wrong),
        share(&clean, |j| !j.causes.is_empty()),
        share(&outside, |j| !j.causes.is_empty() && !j.abstained),
    ]];
    for method in Method::ALL {
        let says = move |j: &Judged| j.baselines.iter().find(|b| b.method == method).cloned();
        let names = move |j: &Judged| says(j).is_some_and(|b| b.named.is_some());
        rows.push(vec![
            method.name().to_string(),
            share(&strong, |j| says(j).is_some_and(|b| b.top1)),
            share(&strong, |j| says(j).is_some_and(|b| b.joint)),
            share(&strong, |j| says(j).is_some_and(|b| b.named.is_some() && !b.top1)),
            share(&clean, names),
            share(&outside, names),
        ]);
    }
    let header = [
        "rule",
        "top-1",
        "joint",
        "wrong name",
        "false alarm, clean",
        "a name, withheld and foreign",
    ];
    markdown_table(&header, 1, &rows)
}

/// Every case whose answer was not right.
pub fn missed(all: &[Judged]) -> String {
    let rows: Vec<_> = all
        .iter()
        .filter(|j| !j.right)
        .map(|j| {
            vec![
                j.case.clone(),
                j.kind.name().into(),
                list(&j.truth),
                number(Some(j.strength)),
                j.verdict.map_or("failed".into(), |v| format!("{v:?}")),
                list(&j.causes),
                j.likeliest.as_ref().map_or(String::new(), said),
                number(Some(j.probability)),
            ]
        })
        .collect();
    let header =
        ["case", "kind", "hidden", "strength", "verdict", "causes", "likeliest", "probability"];
    markdown_table(&header, 3, &rows)
}

fn list(names: &[Named]) -> String {
    names.iter().map(said).collect::<Vec<_>>().join(", ")
}

/// `payload`, `stribeck 2`
pub fn said(named: &Named) -> String {
    let joints: Vec<String> = named.joints.iter().map(ToString::to_string).collect();
    format!("{} {}", named.effect, joints.join("+")).trim_end().to_string()
}
