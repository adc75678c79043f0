//! One answer held against what its case hides.

use serde::Serialize;

use super::super::truth::place;
use super::{Answer, Kind, Printed, Truth};
use crate::diagnosis::{Cause, Diagnosis, Named, Ranked, Verdict};
use crate::effects;
use crate::trials::Method;

const NONE: &str = "none";
const UNKNOWN: &str = "unknown";

/// One case, answered and opened. What is not defined for its kind is false or absent.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Judged {
    pub case: String,
    pub kind: Kind,
    pub truth: Vec<Named>,
    /// Strength of the weakest hidden effect: gap over noise, and its own torque over noise.
    pub strength: f64,
    pub own: f64,
    pub verdict: Option<Verdict>,
    pub causes: Vec<Named>,
    /// The first cause, or the best of the ranking where there is none.
    pub first: Option<Named>,
    /// The first name is a hidden effect; with what the answer calls equivalent.
    pub top1: bool,
    pub top1_set: bool,
    /// One of the first two names is a hidden effect; with what the answer calls equivalent.
    pub top2: bool,
    pub top2_set: bool,
    /// The first name's place is a hidden effect's.
    pub joint: bool,
    /// Number of names: the first cause and its equivalents; 0 without a cause.
    pub set_size: usize,
    /// All hidden effects are among the causes, or their equivalents.
    pub all: bool,
    pub all_set: bool,
    /// There is said to be a gap, and no cause is named or "unknown" is more likely than any.
    pub abstained: bool,
    /// No gap is said to be.
    pub silent: bool,
    /// A cause is named for more likely than unknown, and the first is neither a hidden effect nor
    /// called equivalent to one.
    pub wrong: bool,
    /// The first cause, or the likeliest of the ranking, "none" and "unknown" among them.
    pub likeliest: Option<Named>,
    /// The probability printed beside that, and whether the answer was right.
    pub probability: f64,
    pub right: bool,
    pub parameters: Vec<JudgedParameter>,
    /// Shrink of the mean square as printed: on the check recording, and above its noise floor.
    pub predicted: Option<f64>,
    pub reducible: Option<f64>,
    /// Shrink on a third recording without noise, with what the answer names, and with the truth.
    pub realised: Option<f64>,
    pub oracle: Option<f64>,
    pub baselines: Vec<JudgedBaseline>,
    /// Every cause, in the order of the answer.
    pub printed: Vec<Printed>,
    /// Strength that was asked for.
    pub drawn: Option<f64>,
    /// Somebody's own recordings the case is made of, and the case with the same pair untouched.
    pub recordings: Vec<String>,
    pub base: Option<String>,
    /// Causes that are neither hidden nor named for the untouched pair, and whether what is hidden is
    /// named there.
    pub strays: Vec<Named>,
    pub in_base: bool,
}

/// Share of what the truth closes of a gap that a stand-in for it closes.
const STANDS_IN: f64 = 0.95;

impl Judged {
    /// What is named closes nearly as much of the true gap on a recording it has not seen as what is hidden does: all
    /// of it where the catalogue cannot state that.
    pub fn stands_in(&self) -> bool {
        let enough = STANDS_IN * self.oracle.unwrap_or(1.0);
        !self.causes.is_empty() && self.realised.is_some_and(|r| r >= enough)
    }
}

/// A parameter of a cause that is a hidden effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JudgedParameter {
    pub effect: String,
    pub name: String,
    pub truth: f64,
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

impl JudgedParameter {
    pub fn covers(&self) -> bool {
        (self.low..=self.high).contains(&self.truth)
    }

    /// |value - truth| / |truth|; `None` where the truth is zero.
    pub fn error(&self) -> Option<f64> {
        (self.truth != 0.0).then(|| ((self.value - self.truth) / self.truth).abs())
    }
}

/// What a simpler rule named.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JudgedBaseline {
    pub method: Method,
    pub named: Option<Named>,
    pub top1: bool,
    pub joint: bool,
}

pub fn judge(truth: &Truth, answer: &Answer) -> Judged {
    let dof = dof(truth, answer);
    let hidden: Vec<Named> = truth.effects.iter().map(|e| at(&e.named(), dof)).collect();
    let own = |s: &super::super::Strength| s.own.iter().fold(0.0, |most: f64, g| most.max(*g));
    let least = |x: f64| if x.is_finite() { x } else { 0.0 };
    let owns = truth.effects.iter().map(|e| own(&e.strength));
    let mut judged = Judged {
        case: truth.case.clone(),
        kind: truth.kind,
        strength: least(truth.strength()),
        own: least(owns.fold(f64::INFINITY, f64::min)),
        verdict: None,
        causes: Vec::new(),
        first: None,
        top1: false,
        top1_set: false,
        top2: false,
        top2_set: false,
        joint: false,
        set_size: 0,
        all: false,
        all_set: false,
        abstained: false,
        silent: false,
        wrong: false,
        likeliest: None,
        probability: 0.0,
        right: false,
        parameters: Vec::new(),
        predicted: None,
        reducible: None,
        realised: None,
        oracle: None,
        baselines: baselines(answer, &hidden, dof),
        printed: Vec::new(),
        drawn: truth.effects.first().and_then(|e| e.strength.drawn),
        recordings: truth.recordings.clone(),
        base: truth.base.clone(),
        strays: Vec::new(),
        in_base: false,
        truth: hidden,
    };
    if let Some(diagnosis) = &answer.diagnosis {
        hold(&mut judged, truth, diagnosis, dof);
    }
    judged
}

fn dof(truth: &Truth, answer: &Answer) -> usize {
    let gap = answer.diagnosis.as_ref().map_or(0, |d| d.gap.joints.len());
    let strength = truth.effects.first().map_or(0, |e| e.strength.gap.len());
    [gap, strength, 6].into_iter().find(|n| *n > 0).unwrap_or(6)
}

fn at(named: &Named, dof: usize) -> Named {
    let whole_arm = |e: &dyn effects::Effect| e.about().scope == effects::Scope::Arm;
    let joints = match effects::find(&named.effect) {
        Some(effect) if whole_arm(effect) => Vec::new(),
        _ => place(&named.joints, dof),
    };
    Named { effect: named.effect.clone(), joints }
}

fn hold(judged: &mut Judged, truth: &Truth, diagnosis: &Diagnosis, dof: usize) {
    let cause = |c: &Cause| at(&Named { effect: c.effect.clone(), joints: c.joints.clone() }, dof);
    let set = |c: &Cause| {
        let others = c.equivalent.iter().map(|e| at(e, dof));
        std::iter::once(cause(c)).chain(others).collect::<Vec<_>>()
    };
    let hidden = judged.truth.clone();
    let is_hidden = |n: &Named| hidden.contains(n);
    let sets: Vec<Vec<Named>> = diagnosis.causes.iter().map(set).collect();
    judged.verdict = Some(diagnosis.verdict);
    judged.causes = diagnosis.causes.iter().map(cause).collect();
    let names = first_names(diagnosis, &judged.causes, dof);
    judged.first = names.first().cloned();
    judged.top1 = names.first().is_some_and(is_hidden);
    judged.top2 = names.iter().take(2).any(is_hidden);
    judged.top1_set = judged.top1 || sets.first().is_some_and(|s| s.iter().any(is_hidden));
    judged.top2_set = judged.top2 || sets.iter().take(2).flatten().any(is_hidden);
    judged.joint = names.first().is_some_and(|n| hidden.iter().any(|h| h.joints == n.joints));
    judged.set_size = sets.first().map_or(0, Vec::len);
    judged.all = !hidden.is_empty() && hidden.iter().all(|h| judged.causes.contains(h));
    judged.all_set =
        !hidden.is_empty() && hidden.iter().all(|h| sets.iter().flatten().any(|n| n == h));
    let nothing = diagnosis.causes.is_empty();
    let top = diagnosis.ranking.iter().max_by(|a, b| a.probability.total_cmp(&b.probability));
    judged.silent = nothing && diagnosis.verdict == Verdict::NoGap;
    judged.abstained = !judged.silent && (nothing || top.is_some_and(|t| t.effect == UNKNOWN));
    judged.wrong = !nothing && !judged.top1_set && !judged.abstained;
    judged.right = match truth.kind {
        Kind::Clean | Kind::Unseen => judged.silent,
        Kind::Withheld | Kind::Foreign => judged.abstained,
        Kind::Single | Kind::Pair => !nothing && judged.top1_set,
        Kind::Grafted => judged.all_set,
        // Nobody knows; and what holds for foreign ones follows from the pair untouched.
        Kind::Untouched | Kind::GraftedForeign => false,
    };
    (judged.likeliest, judged.probability) = match (diagnosis.causes.first(), top) {
        (Some(first), _) => (Some(cause(first)), first.probability),
        (None, Some(Ranked { effect, joints, probability, .. })) => {
            (Some(Named { effect: effect.clone(), joints: joints.clone() }), *probability)
        }
        (None, None) => (None, 0.0),
    };
    judged.printed = printed(diagnosis, &sets, &judged.truth, truth.kind);
    judged.predicted = Some(diagnosis.shrink.torque.fraction);
    judged.reducible = Some(diagnosis.shrink.torque.reducible);
    judged.parameters = parameters(truth, diagnosis, dof);
}

/// Causes, and whether what they say is hidden.
fn printed(
    diagnosis: &Diagnosis,
    sets: &[Vec<Named>],
    hidden: &[Named],
    kind: Kind,
) -> Vec<Printed> {
    let one = |(cause, set): (&Cause, &Vec<Named>)| {
        let (named, equivalent) = (set[0].clone(), set[1..].to_vec());
        let mut printed = Printed::new(named, equivalent, cause.probability, kind);
        if printed.is_one_of(hidden) {
            printed.holds = Some(true);
        }
        printed
    };
    diagnosis.causes.iter().zip(sets).map(one).collect()
}

/// Causes in their order, then the ranking.
fn first_names(diagnosis: &Diagnosis, causes: &[Named], dof: usize) -> Vec<Named> {
    let mut ranking: Vec<_> = diagnosis.ranking.iter().collect();
    ranking.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let mut names = causes.to_vec();
    for r in ranking.iter().filter(|r| r.effect != NONE && r.effect != UNKNOWN) {
        let name = at(&Named { effect: r.effect.clone(), joints: r.joints.clone() }, dof);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// Values of causes that are hidden effects, beside the truth.
fn parameters(truth: &Truth, diagnosis: &Diagnosis, dof: usize) -> Vec<JudgedParameter> {
    let mut rows = Vec::new();
    for hidden in &truth.effects {
        let name = at(&hidden.named(), dof);
        let same = |c: &&Cause| {
            at(&Named { effect: c.effect.clone(), joints: c.joints.clone() }, dof) == name
        };
        let Some(cause) = diagnosis.causes.iter().find(same) else { continue };
        for p in hidden.parameters.iter().filter(|p| !p.name.ends_with("_reference")) {
            let Some(value) = cause.parameters.iter().find(|v| v.name == p.name) else { continue };
            let Some(truth) = p.values.first() else { continue };
            rows.push(JudgedParameter {
                effect: hidden.effect.clone(),
                name: p.name.clone(),
                truth: *truth,
                value: value.value,
                low: value.low,
                high: value.high,
            });
        }
    }
    rows
}

fn baselines(answer: &Answer, hidden: &[Named], dof: usize) -> Vec<JudgedBaseline> {
    let judged = |b: &crate::trials::BaselineAnswer| {
        let named = b.named.as_ref().map(|n| at(n, dof));
        JudgedBaseline {
            method: b.method,
            top1: named.as_ref().is_some_and(|n| hidden.contains(n)),
            joint: named.as_ref().is_some_and(|n| hidden.iter().any(|h| h.joints == n.joints)),
            named,
        }
    };
    answer.baselines.iter().map(judged).collect()
}
