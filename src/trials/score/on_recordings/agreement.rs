//! Do answers to recordings of one arm, untouched, agree?

use super::super::tables::said;
use super::super::{Judged, Share};
use crate::diagnosis::{Named, Verdict};
use crate::text::markdown_table;
use crate::trials::Kind;

/// Share of the check recording's mean square: a candidate that takes more off than this is no unknown.
const TAKES_MUCH: f64 = 0.3;

/// Agreement of the answers to all untouched pairs.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    /// Pairs with the commonest leading cause, or an equal of it, of all pairs.
    pub same: Share,
    pub leading: Option<Named>,
    /// "Unexplained" although the best candidate takes much off.
    pub unexplained: Share,
}

/// Where no gap is found, that is the leading answer.
fn leading(judged: &Judged) -> Vec<Named> {
    match judged.printed.first() {
        Some(cause) => cause.set().cloned().collect(),
        None if judged.silent => vec![Named { effect: "no gap".into(), joints: Vec::new() }],
        None => Vec::new(),
    }
}

pub fn agreement(all: &[Judged]) -> Agreement {
    let pairs: Vec<&Judged> = all.iter().filter(|j| j.kind == Kind::Untouched).collect();
    let sets: Vec<Vec<Named>> = pairs.iter().map(|j| leading(j)).collect();
    let votes = |name: &Named| sets.iter().filter(|s| s.contains(name)).count();
    let commonest = sets.iter().flatten().max_by_key(|name| votes(name)).cloned();
    let much = |j: &Judged| {
        j.verdict == Some(Verdict::Unexplained) && j.predicted.is_some_and(|f| f > TAKES_MUCH)
    };
    Agreement {
        same: Share { hits: commonest.as_ref().map_or(0, votes), of: pairs.len() },
        leading: commonest,
        unexplained: Share::count(pairs.iter().copied(), much),
    }
}

pub fn table(all: &[Judged]) -> String {
    let row = |j: &Judged| {
        let [fit, check] = [0, 1].map(|i| j.recordings.get(i).map_or("", |r| short(r)).to_string());
        let first = j.printed.first();
        vec![
            j.case.clone(),
            fit,
            check,
            j.verdict.map_or("failed".into(), |v| format!("{v:?}")),
            first.map_or("-".into(), |c| said(&c.named)),
            first.map_or("-".into(), |c| format!("{:.2}", c.probability)),
            j.printed.iter().skip(1).map(|c| said(&c.named)).collect::<Vec<_>>().join(", "),
            j.predicted.map_or("-".into(), |f| format!("{f:.2}")),
        ]
    };
    let rows: Vec<_> = all.iter().filter(|j| j.kind == Kind::Untouched).map(row).collect();
    let header = [
        "case",
        "fit",
        "check",
        "verdict",
        "leading cause",
        "probability",
        "other causes",
        "shrink on check",
    ];
    let leading = agreement(all).leading;
    let commonest = leading.map_or("none".into(), |n| said(&n));
    format!("{}\nCommonest leading cause: {commonest}.\n", markdown_table(&header, 5, &rows))
}

/// A file's name without folder and ending.
fn short(source: &str) -> &str {
    let name = source.rsplit('/').next().unwrap_or(source);
    ["csv.gz", "csv", "parquet", "mcap", "db3"]
        .iter()
        .find_map(|end| name.strip_suffix(end)?.strip_suffix('.'))
        .unwrap_or(name)
}
