//! Parameters that all joints share, such as a payload's mass and first moments.
//!
//! They enter linearly, each joint's own parameters b_j only its own rows: with P_j the shared
//! columns at joint j, projected onto what the joint's own columns leave, the shared parameters
//! phi solve min sum_j |y_j - P_j phi|^2 / sigma_j^2 (Frisch and Waugh's theorem; the arrow-shaped
//! normal equations by blocks). Stribeck velocities and noise levels sigma_j follow from fitting
//! each joint to what phi leaves; a few rounds converge.

use nalgebra::DVector;
use rayon::prelude::*;

use super::arm_problem::ArmProblem;
use super::error::IdentificationError;
use super::judge::{self, WithExcess};
use super::prepared::Prepared;
use super::problem::{JointProblem, Parameter};
use super::{Found, ParameterEstimate, separable};
use crate::effects::Ratio;
use crate::kernels::axpy;
use crate::regression::bounded;
use crate::regression::bounds::Bounds;
use crate::regression::qr::{Qr, unexplained};
use crate::statistics::Cycle;

/// Rounds of fitting joints and shared parameters in turn.
const MOST_ROUNDS: usize = 30;
/// Relative change at which the rounds end.
const SETTLED: f64 = 1e-9;

/// The shared parameters; empty if there are none.
///
/// # Errors
/// If bounds are the wrong way round.
pub fn solve(
    arm: &ArmProblem,
    settings: &separable::Settings,
) -> Result<Vec<f64>, IdentificationError> {
    let mut phi = vec![0.0; arm.shared.len()];
    if phi.is_empty() {
        return Ok(phi);
    }
    let bounds = Bounds::new(
        arm.shared.iter().map(|p| p.lower).collect(),
        arm.shared.iter().map(|p| p.upper).collect(),
    )?;
    for _ in 0..MOST_ROUNDS {
        let new = round(arm, &phi, &bounds, settings)?;
        let change = new.iter().zip(&phi).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let size = new.iter().map(|a| a.abs()).fold(0.0, f64::max);
        phi = new;
        if change <= SETTLED * size {
            break;
        }
    }
    Ok(phi)
}

/// Every joint fitted to what `phi` leaves, then phi to what the joints leave.
fn round(
    arm: &ArmProblem,
    phi: &[f64],
    bounds: &Bounds,
    settings: &separable::Settings,
) -> Result<Vec<f64>, IdentificationError> {
    let mut columns = vec![Vec::new(); phi.len()];
    let mut y = Vec::new();
    for (j, left) in take_off(arm, phi).into_iter().enumerate() {
        if left.samples() == 0 {
            continue;
        }
        let prepared = Prepared::new(left)?;
        let x = prepared.separable(settings).x;
        let weight = 1.0 / prepared.problem.direct_cost(&x).max(1e-12);
        let own = Qr::new(prepared.problem.sensitivity(&x));
        let append = |all: &mut Vec<f64>, values: &[f64]| {
            all.extend(unexplained(&own.q, values.to_vec()).iter().map(|v| weight * v));
        };
        for (all, column) in columns.iter_mut().zip(&arm.shared_columns[j]) {
            append(all, column);
        }
        append(&mut y, &arm.joints[j].y);
    }
    let qr = Qr::new(columns);
    let c: DVector<f64> = qr.transpose_times(&y);
    Ok(bounded::solve(&qr.r, &c, bounds).as_slice().to_vec())
}

/// The joints' problems with the shared torque subtracted.
pub fn take_off(arm: &ArmProblem, phi: &[f64]) -> Vec<JointProblem> {
    let mut joints = arm.joints.clone();
    for (joint, columns) in joints.iter_mut().zip(&arm.shared_columns) {
        for (value, column) in phi.iter().zip(columns) {
            axpy(-value, column, &mut joint.y);
        }
    }
    joints
}

impl Found {
    /// Values by least squares: what is shared, and every joint's own values beside it.
    ///
    /// # Errors
    /// If bounds are the wrong way round.
    pub fn of(arm: &ArmProblem) -> Result<Self, IdentificationError> {
        let settings = separable::Settings::default();
        let shared = solve(arm, &settings)?;
        let own = |p: JointProblem| Ok(Prepared::new(p)?.separable(&settings).x);
        let joints: Result<_, IdentificationError> =
            take_off(arm, &shared).into_par_iter().map(own).collect();
        Ok(Self { joints: joints?, shared })
    }
}

/// All joints in one system: rows weighted by 1/sigma_j, own columns of every joint, shared last.
struct Stack {
    parameters: Vec<Parameter>,
    x: Vec<f64>,
    columns: Vec<Vec<f64>>,
    residual: Vec<f64>,
    slots: Vec<usize>,
    cycle: Option<Cycle>,
}

/// Tests and intervals of every joint's and the shared parameters together. Joints are taken for
/// independent of each other, given the parameters.
///
/// # Errors
/// If something is not finite.
pub fn judge(
    problems: &[&JointProblem],
    arm: &ArmProblem,
    found: &Found,
) -> Result<(Vec<Vec<ParameterEstimate>>, Vec<ParameterEstimate>), IdentificationError> {
    let (plain, places) = stack(problems, arm, found, false);
    let mut rows = judge::estimate(
        &plain.parameters,
        &plain.x,
        &plain.columns,
        &plain.residual,
        &plain.slots,
        plain.cycle,
    )?;
    let curved = problems.iter().any(|p| p.curve.is_some());
    let bent = if curved {
        let (s, _) = stack(problems, arm, found, true);
        judge::estimate(&s.parameters, &s.x, &s.columns, &s.residual, &s.slots, s.cycle)?
    } else {
        Vec::new()
    };
    let shared = rows.split_off(plain.parameters.len() - arm.shared.len());
    let mut tables = Vec::new();
    for (j, problem) in problems.iter().enumerate() {
        let x = &found.joints[j];
        tables.push(match places[j] {
            Some(start) => {
                let own = rows[start..start + x.len()].to_vec();
                let excess = problem.curve.as_ref().map(|_| bent[start + 1].clone());
                judge::finish(problem, x, own, excess)
            }
            None => {
                let all: Vec<_> = problem.parameters().into_iter().cloned().collect();
                judge::unknown(&all, x, &judge::too_short(problem))
            }
        });
    }
    Ok((tables, shared))
}

/// The stack, and where each joint's parameters begin (`None`: too few samples to be in it).
/// With `excess`, T_s - T_c stands for T_s.
fn stack(
    problems: &[&JointProblem],
    arm: &ArmProblem,
    found: &Found,
    excess: bool,
) -> (Stack, Vec<Option<usize>>) {
    let rows: usize = problems.iter().map(|p| p.samples()).sum();
    let mut s = Stack {
        parameters: vec![],
        x: vec![],
        columns: vec![],
        residual: vec![],
        slots: vec![],
        // One recording has one.
        cycle: problems.iter().find_map(|p| p.cycle),
    };
    let (shared, shared_x) = readable(arm, &found.shared);
    let mut shared_columns = vec![Vec::with_capacity(rows); shared.len()];
    let mut places = Vec::new();
    for (j, problem) in problems.iter().enumerate() {
        if judge::too_few(problem) {
            places.push(None);
            continue;
        }
        places.push(Some(s.x.len()));
        let x = &found.joints[j];
        let weight = 1.0 / problem.direct_cost(x).max(1e-12);
        let columns = problem.sensitivity(x);
        let own = excess.then(|| WithExcess::of(problem, x, &columns)).flatten();
        let own = own.unwrap_or_else(|| WithExcess {
            parameters: problem.parameters().into_iter().cloned().collect(),
            x: x.clone(),
            columns,
        });
        s.add_joint(own, weight, &problem.residual(x), &problem.slots);
        let at_joint = readable_columns(arm, j, &found.shared);
        for (all, column) in shared_columns.iter_mut().zip(at_joint) {
            all.extend(column.iter().map(|v| weight * v));
        }
    }
    s.columns.iter_mut().for_each(|c| c.resize(s.residual.len(), 0.0));
    s.parameters.extend(shared);
    s.x.extend(shared_x);
    s.columns.extend(shared_columns);
    (s, places)
}

impl Stack {
    fn add_joint(&mut self, own: WithExcess, weight: f64, residual: &[f64], slots: &[usize]) {
        let above = self.residual.len();
        self.parameters.extend(own.parameters);
        self.x.extend(own.x);
        for column in own.columns {
            let mut all = vec![0.0; above];
            all.extend(column.iter().map(|v| weight * v));
            self.columns.push(all);
        }
        self.columns.iter_mut().for_each(|c| c.resize(above + residual.len(), 0.0));
        self.residual.extend(residual.iter().map(|r| weight * r));
        // Far enough from the joint before that no correlation is seen between the two.
        let apart = 1000 + self.cycle.map_or(0, |cycle| cycle.slots);
        let from = self.slots.last().map_or(0, |last| last + apart);
        self.slots.extend(slots.iter().map(|s| from + s));
    }
}

/// The shared parameters as people read them: ratios in place of some (a payload's centre of mass in place of
/// its first moments).
fn readable(arm: &ArmProblem, phi: &[f64]) -> (Vec<Parameter>, Vec<f64>) {
    let (mut parameters, mut x) = (arm.shared.clone(), phi.to_vec());
    for (i, over, ratio) in ratios(arm) {
        let (name, unit) = (ratio.name.into(), ratio.unit.into());
        parameters[i] = Parameter { name, unit, lower: -1.0, upper: 1.0 };
        x[i] = if phi[over] > 0.0 { phi[i] / phi[over] } else { 0.0 };
    }
    (parameters, x)
}

/// Those of the shared parameters that are read as ratios: its place, and that of what it is divided by.
pub(super) fn ratios(arm: &ArmProblem) -> Vec<(usize, usize, Ratio)> {
    let place = |name: &str| arm.shared.iter().position(|p| p.name == name);
    let ratio = |(i, p): (usize, &Parameter)| {
        let ratio = Ratio::replacing(&p.name)?;
        Some((i, place(ratio.over)?, ratio))
    };
    arm.shared.iter().enumerate().filter_map(ratio).collect()
}

/// d torque / d readable parameters at joint `j`. With moments h = m c, d/dm = P_m + c . P_h and
/// d/dc = m P_h.
fn readable_columns(arm: &ArmProblem, j: usize, phi: &[f64]) -> Vec<Vec<f64>> {
    let mut columns = arm.shared_columns[j].clone();
    let (_, x) = readable(arm, phi);
    for (i, over, _) in ratios(arm) {
        let own = std::mem::take(&mut columns[i]);
        axpy(x[i], &own, &mut columns[over]);
        columns[i] = own.into_iter().map(|v| phi[over] * v).collect();
    }
    columns
}
