//! What figures over many cases are made of.

use serde::Serialize;

use super::{Judged, JudgedParameter, Kind, Share};

/// Strengths cases are drawn at; others count to the nearest by ratio.
pub const LEVELS: [f64; 4] = [0.3, 1.0, 3.0, 10.0];

/// Index into [`LEVELS`].
pub fn level(strength: f64) -> usize {
    let distance = |l: f64| (strength.max(1e-9) / l).ln().abs();
    let nearest = |a: &usize, b: &usize| distance(LEVELS[*a]).total_cmp(&distance(LEVELS[*b]));
    (0..LEVELS.len()).min_by(nearest).unwrap_or(0)
}

/// A figure beside its goal.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Goal {
    pub figure: &'static str,
    pub found: String,
    pub goal: &'static str,
    /// `None` where there was nothing to measure.
    pub met: Option<bool>,
}

/// A figure as a number, to compare answers to the same cases by.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure {
    pub name: &'static str,
    /// `None` where there was nothing to measure.
    pub value: Option<f64>,
    /// Cases it is of.
    pub cases: usize,
}

impl Figure {
    pub fn share(name: &'static str, share: Share) -> Self {
        Self { name, value: share.value(), cases: share.of }
    }
}

/// Cases of one kind.
pub fn of(all: &[Judged], kind: Kind) -> Vec<&Judged> {
    all.iter().filter(|j| j.kind == kind).collect()
}

/// Cases with a single effect at a strength of 1 and above.
pub fn plain(all: &[Judged]) -> Vec<&Judged> {
    of(all, Kind::Single).into_iter().filter(|j| strong(j)).collect()
}

/// Cases with one or two effects of the catalogue.
pub fn catalogue(all: &[Judged]) -> Vec<&Judged> {
    all.iter().filter(|j| matches!(j.kind, Kind::Single | Kind::Pair)).collect()
}

/// Cases with an effect that the answerer has no name for, at a strength of 1 and above.
pub fn outside(all: &[Judged]) -> Vec<&Judged> {
    let outside = |j: &&Judged| matches!(j.kind, Kind::Withheld | Kind::Foreign);
    all.iter().filter(outside).filter(|j| strong(j)).collect()
}

pub fn count(cases: &[&Judged], hit: fn(&Judged) -> bool) -> Share {
    Share::count(cases.iter().copied(), hit)
}

pub fn strong(judged: &Judged) -> bool {
    level(judged.strength) >= 1
}

pub fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, n) = values.fold((0.0, 0), |(sum, n), x| (sum + x, n + 1));
    (n > 0).then(|| sum / f64::from(n))
}

pub fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.filter(|v| v.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Mean number of names in the set of the first cause, over cases with a cause.
pub fn mean_set_size<'a>(cases: impl IntoIterator<Item = &'a Judged>) -> Option<f64> {
    mean(cases.into_iter().filter(|j| j.set_size > 0).map(|j| j.set_size as f64))
}

/// Mean of (printed probability - right)^2.
pub fn brier<'a>(cases: impl IntoIterator<Item = &'a Judged>) -> Option<f64> {
    let square = |j: &Judged| (j.probability - f64::from(u8::from(j.right))).powi(2);
    mean(cases.into_iter().filter(|j| j.verdict.is_some()).map(square))
}

/// Share of the intervals that hold the truth, of parameters of effects named exactly.
pub fn coverage(all: &[Judged]) -> Share {
    Share::count(all.iter().flat_map(|j| &j.parameters), JudgedParameter::covers)
}

/// Realised shrink over the oracle's, where the answer is a named effect.
pub fn of_oracle<'a>(cases: impl IntoIterator<Item = &'a Judged>) -> Vec<f64> {
    let ratio = |j: &Judged| Some(j.realised? / j.oracle.filter(|o| *o > 0.05)?);
    cases.into_iter().filter(|j| !j.causes.is_empty()).filter_map(ratio).collect()
}
