//! What simpler rules say about the same case: the paper's z-test, BIC, best R2 on the check.
//!
//! Every candidate is one effect of the catalogue at one joint (or on the whole arm), added alone
//! to the twin, its nonlinear parameters tried at the catalogue's `starts`, the rest by ordinary
//! least squares on sliding samples. Effects on recorded channels (delay, lag) have no columns and
//! cannot be named by these rules.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use crate::diagnosis::{Named, Settings};
use crate::effects::{CATALOGUE, Effect, Motion, Role, Scope, Seen};
use crate::regression::qr::{Qr, unexplained};
use crate::regression::{Equations, Solved};
use crate::signals::Samples;
use crate::twin::Twin;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Largest |z| with white residuals, named above 2.58 (1 %, two-sided).
    ZTest,
    /// Smallest BIC, named where it is below that of the twin alone.
    Bic,
    /// Largest gain on the check recording, named above 1 % of what the twin leaves there.
    BestR2,
}

impl Method {
    pub const ALL: [Self; 3] = [Self::ZTest, Self::Bic, Self::BestR2];

    pub fn name(self) -> &'static str {
        match self {
            Self::ZTest => "the paper's z-test",
            Self::Bic => "BIC",
            Self::BestR2 => "best R2 on the check",
        }
    }

    /// What a candidate's score must exceed.
    fn threshold(self) -> f64 {
        match self {
            Self::ZTest => 2.58,
            Self::Bic => 0.0,
            Self::BestR2 => 0.01,
        }
    }
}

/// What one rule names, if anything.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BaselineAnswer {
    pub method: Method,
    pub named: Option<Named>,
}

/// Every n-th sample is enough for rules that take samples for independent.
const STRIDE: usize = 4;

/// What all rules say, in the order of [`Method::ALL`].
pub fn baselines(
    twin: &Twin,
    fit: &Samples,
    check: &Samples,
    settings: &Settings,
) -> Vec<BaselineAnswer> {
    let [fit, check] = [fit, check].map(|samples| Residual::new(twin, samples));
    let mut best: [(f64, Option<Named>); 3] = Method::ALL.map(|m| (m.threshold(), None));
    for effect in candidates(twin, settings) {
        let whole_arm = effect.about().scope == Scope::Arm;
        for joint in 0..if whole_arm { 1 } else { twin.robot.dof() } {
            for start in effect.starts(&fit.motion, joint) {
                let [on_fit, on_check] =
                    [&fit, &check].map(|residual| residual.normal(effect, joint, &start));
                let Some(scores) = scores(&fit, &check, &on_fit, &on_check) else { continue };
                for (best, score) in best.iter_mut().zip(scores) {
                    if score > best.0 {
                        let joints = if whole_arm { vec![] } else { vec![joint + 1] };
                        *best = (score, Some(Named { effect: effect.about().name.into(), joints }));
                    }
                }
            }
        }
    }
    let answer = |(method, (_, named))| BaselineAnswer { method, named };
    Method::ALL.into_iter().zip(best).map(answer).collect()
}

fn candidates(twin: &Twin, settings: &Settings) -> impl Iterator<Item = &'static dyn Effect> {
    let absent = |name: &str| !twin.effects.iter().chain(&settings.without).any(|n| n == name);
    let open = move |e: &&dyn Effect| {
        e.seen() == Seen::Columns && absent(e.about().name) && twin.can_have(*e)
    };
    CATALOGUE.iter().copied().filter(open)
}

/// What the twin leaves of a recording, its open parameters fitted, over its own scatter per joint.
struct Residual<'a> {
    motion: Motion<'a>,
    rows: Vec<Vec<usize>>,
    /// Orthonormal columns of the twin's open parameters, per joint.
    open: Vec<Vec<Vec<f64>>>,
    left: Vec<DVector<f64>>,
    scatter: Vec<f64>,
}

/// A candidate's columns against what is left at one joint.
struct AtJoint {
    joint: usize,
    equations: Equations,
}

impl<'a> Residual<'a> {
    fn new(twin: &'a Twin, samples: &'a Samples) -> Self {
        let motion = twin.motion(samples);
        let known = twin.torque(&motion);
        let mut this = Self { motion, rows: vec![], open: vec![], left: vec![], scatter: vec![] };
        for joint in 0..twin.robot.dof() {
            let rows: Vec<usize> =
                samples.rows(joint).samples.into_iter().step_by(STRIDE).collect();
            let take = |x: &[f64]| rows.iter().map(|&k| x[k]).collect::<Vec<f64>>();
            let alone = twin.open().filter(|e| e.about().scope == Scope::Joint);
            let columns = alone.flat_map(|e| e.columns(&motion, joint, &typical(e)));
            let open = Qr::new(columns.map(|column| take(&column)).collect()).q;
            let difference = samples.torque.joint(joint).iter().zip(known.joint(joint));
            let difference: Vec<f64> = difference.map(|(a, b)| a - b).collect();
            let left = DVector::from_vec(unexplained(&open, take(&difference)));
            let scatter = (left.norm_squared() / left.len().max(1) as f64).sqrt().max(1e-12);
            this.left.push(left / scatter);
            this.rows.push(rows);
            this.open.push(open);
            this.scatter.push(scatter);
        }
        this
    }

    /// Where the candidate acts.
    fn normal(&self, effect: &dyn Effect, joint: usize, nonlinear: &[f64]) -> Vec<AtJoint> {
        match effect.about().scope {
            Scope::Joint => vec![self.at(joint, &effect.columns(&self.motion, joint, nonlinear))],
            Scope::Arm => {
                let columns = |j| effect.columns(&self.motion, j, nonlinear);
                (0..self.left.len()).map(|j| self.at(j, &columns(j))).collect()
            }
            Scope::Link => {
                let reach = effect.reach(&self.motion, joint, nonlinear);
                let columns = |j| reach.iter().map(|s| s.joint(j).to_vec()).collect::<Vec<_>>();
                (0..self.left.len()).map(|j| self.at(j, &columns(j))).collect()
            }
        }
    }

    fn at(&self, joint: usize, columns: &[Vec<f64>]) -> AtJoint {
        let scaled = |column: &Vec<f64>| {
            let taken = self.rows[joint].iter().map(|&k| column[k] / self.scatter[joint]);
            unexplained(&self.open[joint], taken.collect())
        };
        let (rows, all) = (self.rows[joint].len(), columns.iter().flat_map(scaled));
        let columns = DMatrix::from_iterator(rows, columns.len(), all);
        AtJoint { joint, equations: Equations::new(columns.as_view(), &self.left[joint]) }
    }

    fn squares(&self, joint: usize) -> f64 {
        self.left[joint].norm_squared()
    }
}

/// Scores by the rules of [`Method::ALL`]; `None` where the columns say nothing.
fn scores(
    fit: &Residual<'_>,
    check: &Residual<'_>,
    on_fit: &[AtJoint],
    on_check: &[AtJoint],
) -> Option<[f64; 3]> {
    let Solved { x: theta, inverse } =
        Equations::sum(on_fit.iter().map(|a| &a.equations))?.solve()?;
    let (mut rows, mut after, mut bic) = (0.0, 0.0, 0.0);
    for a in on_fit {
        let n = fit.rows[a.joint].len() as f64;
        let before = fit.squares(a.joint);
        let now = before - a.equations.taken(&theta);
        rows += n;
        after += now;
        bic -= n * (now / before).max(1e-12).ln();
    }
    bic -= theta.len() as f64 * rows.max(1.0).ln();
    let variance = after / (rows - theta.len() as f64).max(1.0);
    let z = (0..theta.len())
        .map(|k| theta[k].abs() / (variance * inverse[(k, k)]).sqrt())
        .fold(0.0, f64::max);
    let all: f64 = (0..check.left.len()).map(|j| check.squares(j)).sum();
    let gain: f64 = on_check.iter().map(|a| a.equations.taken(&theta)).sum();
    let finite = [z, bic, gain / all.max(1e-12)];
    finite.iter().all(|s| s.is_finite()).then_some(finite)
}

fn typical(effect: &dyn Effect) -> Vec<f64> {
    let parameters = effect.about().parameters.iter();
    parameters.filter(|p| p.role == Role::Nonlinear).map(|p| p.typical).collect()
}
