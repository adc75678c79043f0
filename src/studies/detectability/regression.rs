//! Weighted least squares over all joints, with and without an effect.

use nalgebra::{DMatrix, DVector};

use crate::effects::{Mechanism, Motion, Role, Scope, Seen};
use crate::regression::Equations;
use crate::series::JointSeries;
use crate::signals::{Samples, SignalError};
use crate::simulation::Injection;
use crate::twin::Twin;

/// Share of an effect that counts as none of it.
const FADED: f64 = 1e-4;

/// What is known of the arm, what is fitted anyway, what is sought.
pub(super) struct Known {
    pub twin: Twin,
    pub fitted: Vec<Injection>,
    pub sought: Vec<Injection>,
}

/// One recording as a regression: all joints below each other, in units of the noise.
pub(super) struct Side {
    y: DVector<f64>,
    /// Columns of what is fitted anyway, then of the effect.
    columns: DMatrix<f64>,
    fitted: usize,
    /// True values of the effect's columns.
    truth: Vec<f64>,
    /// What stays of the effect however weak it is: teeth without play still give way.
    limit: DVector<f64>,
    /// Row where each joint begins, and the end.
    starts: Vec<usize>,
    /// Variance that the filter leaves of white noise.
    passed: f64,
}

/// What one seed came to.
pub(super) struct Trial {
    /// Chi-square per sample on the second recording, with and without the effect.
    pub left: f64,
    pub left_without: f64,
    /// |estimate - truth| / |truth| where the truth is not zero.
    pub errors: Vec<f64>,
    pub rms_over_noise: f64,
}

/// A column over all joints, N.m per unit, and its true coefficient.
type Term = (JointSeries, f64);

impl Known {
    /// `noise`: standard deviation of each joint's torque, N.m.
    pub(super) fn side(&self, samples: &Samples, noise: &[f64]) -> Result<Side, SignalError> {
        let motion = self.twin.motion(samples);
        let modelled = self.twin.torque(&motion);
        let motion = Motion { known: Some(&modelled), ..motion };
        let fitted: Vec<Term> = self.fitted.iter().flat_map(|i| terms(i, &motion)).collect();
        let sought: Vec<Term> =
            self.sought.iter().flat_map(|i| self.sought(i, samples, &motion)).collect();
        let left = samples.torque.map_joints(|j, torque| {
            torque.iter().zip(modelled.joint(j)).map(|(t, m)| t - m).collect()
        });
        let filter = samples.torque_filter()?;
        let limit = self.limit(&motion);
        let (mut series, mut truth) = (vec![left, limit], Vec::new());
        let count = fitted.len();
        series.extend(fitted.into_iter().map(|(column, _)| column));
        for (column, value) in sought {
            series.push(column);
            truth.push(value);
        }
        let mut stacked = vec![Vec::new(); series.len()];
        let mut starts = vec![0];
        for (joint, noise) in noise.iter().enumerate() {
            let rows = samples.rows(joint);
            let mut raw: Vec<Vec<f64>> = series.iter().map(|s| s.joint(joint).to_vec()).collect();
            if let Some(filter) = &filter {
                filter.apply_many(&mut raw);
            }
            for (all, column) in stacked.iter_mut().zip(raw) {
                all.extend(rows.take(&column).iter().map(|x| x / noise));
            }
            starts.push(stacked[0].len());
        }
        let mut pulse = vec![vec![0.0; samples.len()]];
        pulse[0][samples.len() / 2] = 1.0;
        if let Some(filter) = &filter {
            filter.apply_many(&mut pulse);
        }
        let passed = pulse[0].iter().map(|h| h * h).sum();
        let mut columns = stacked.into_iter().map(DVector::from_vec);
        let mut next = || columns.next().unwrap_or_else(|| DVector::zeros(0));
        let (y, limit) = (next(), next());
        let columns: Vec<_> = columns.collect();
        let columns = DMatrix::from_columns(&columns);
        Ok(Side { y, columns, fitted: count, truth, limit, starts, passed })
    }

    /// The effect's torque at next to no strength, N.m.
    fn limit(&self, motion: &Motion<'_>) -> JointSeries {
        let mut sum = JointSeries::zeros(motion.q.joints(), motion.samples());
        let by_torque = |i: &&Injection| i.effect.seen() == Seen::Columns;
        for injection in self.sought.iter().filter(by_torque) {
            for (column, value) in terms(&faded(injection), motion) {
                add(&mut sum, value, &column);
            }
        }
        sum
    }

    fn sought(&self, injection: &Injection, samples: &Samples, motion: &Motion<'_>) -> Vec<Term> {
        match injection.effect.seen() {
            Seen::Columns => terms(injection, motion),
            Seen::Channels => injection
                .joints
                .iter()
                .enumerate()
                .map(|(i, &joint)| (self.shown(injection, i, joint, samples), 1.0))
                .collect(),
            Seen::Simulation => Vec::new(),
        }
    }

    /// Error of the model's torque where one joint's channels are not corrected, N.m.
    fn shown(
        &self,
        injection: &Injection,
        i: usize,
        joint: usize,
        samples: &Samples,
    ) -> JointSeries {
        let about = injection.effect.about();
        let dof = self.twin.robot.dof();
        let mut twin = self.twin.clone();
        twin.effects = vec![about.name.into()];
        for (p, value) in about.parameters.iter().zip(&injection.values[i]) {
            let mut each = vec![if p.null.is_finite() { p.null } else { p.typical }; dof];
            each[joint] = *value;
            twin.values.insert(p.name.into(), each);
        }
        let (wrong, right) = (self.modelled(samples), self.modelled(&twin.correct(samples)));
        right.map_joints(|j, right| right.iter().zip(wrong.joint(j)).map(|(r, w)| r - w).collect())
    }

    /// The torque of the twin and of the true values of what is fitted anyway, N.m.
    fn modelled(&self, samples: &Samples) -> JointSeries {
        let motion = self.twin.motion(samples);
        let mut torque = self.twin.torque(&motion);
        for (column, value) in self.fitted.iter().flat_map(|i| terms(i, &motion)) {
            add(&mut torque, value, &column);
        }
        torque
    }
}

fn add(sum: &mut JointSeries, value: f64, column: &JointSeries) {
    for joint in 0..sum.joints() {
        let both = sum.joint_mut(joint).iter_mut().zip(column.joint(joint));
        both.for_each(|(sum, c)| *sum += value * c);
    }
}

/// The effect with its linear values faded to next to nothing.
fn faded(injection: &Injection) -> Injection {
    let effect = injection.effect;
    let linear = effect.about().parameters.iter().filter(|p| p.role == Role::Linear).count();
    let faded = |row: &Vec<f64>| {
        let mut row = row.clone();
        let (linear, nonlinear) = row.split_at_mut(linear);
        linear.iter_mut().for_each(|value| *value *= FADED);
        effect.settle(linear, nonlinear);
        row
    };
    Injection { values: injection.values.iter().map(faded).collect(), ..injection.clone() }
}

/// The columns of an effect at its joints, with its true values.
fn terms(injection: &Injection, motion: &Motion<'_>) -> Vec<Term> {
    let effect = injection.effect;
    let about = effect.about();
    let linear = about.parameters.iter().filter(|p| p.role == Role::Linear).count();
    if about.scope == Scope::Arm {
        let (linear, nonlinear) = injection.values[0].split_at(linear);
        let joints: Vec<_> =
            (0..motion.robot.dof()).map(|j| effect.columns(motion, j, nonlinear)).collect();
        let column = |i: usize| {
            let rows: Vec<Vec<f64>> = joints.iter().map(|c| c[i].clone()).collect();
            JointSeries::from_joints(&rows)
        };
        return linear.iter().enumerate().map(|(i, &value)| (column(i), value)).collect();
    }
    let mut arm = Mechanism::new(motion.robot.clone());
    let at = |(&joint, values): (&usize, &Vec<f64>)| {
        let (linear, nonlinear) = values.split_at(linear);
        let motion = &Motion { giving: &arm.transmission, ..*motion };
        let reach = effect.reach(motion, joint, nonlinear);
        effect.build(values, joint, &mut arm);
        reach.into_iter().zip(linear.to_vec()).collect::<Vec<_>>()
    };
    injection.joints.iter().zip(&injection.values).flat_map(at).collect()
}

/// Fits `fit` with and without the effect and holds both against `check`.
pub(super) fn compare(fit: &Side, check: &Side) -> Trial {
    let with = fit.solve(fit.columns.ncols(), &fit.y);
    let without = fit.solve(fit.fitted, &(&fit.y - &fit.limit));
    let found = with.iter().skip(fit.fitted).zip(&fit.truth);
    let errors = found.filter(|(_, t)| **t != 0.0).map(|(x, t)| ((x - t) / t).abs()).collect();
    Trial {
        left: check.left(&with, &check.y),
        left_without: check.left(&without, &(&check.y - &check.limit)),
        errors,
        rms_over_noise: fit.rms(),
    }
}

impl Side {
    /// Least squares over the first `count` columns; undetermined directions stay at zero.
    fn solve(&self, count: usize, y: &DVector<f64>) -> DVector<f64> {
        Equations::new(self.columns.columns(0, count), y).solve_determined()
    }

    /// Chi-square per sample that `x` leaves of `y`.
    fn left(&self, x: &DVector<f64>, y: &DVector<f64>) -> f64 {
        let residual = y - self.columns.columns(0, x.len()) * x;
        residual.norm_squared() / (self.passed * residual.len().max(1) as f64)
    }

    /// The effect's own torque over the noise, at the joint where it is largest.
    fn rms(&self) -> f64 {
        let own = self.columns.columns(self.fitted, self.truth.len())
            * DVector::from_column_slice(&self.truth)
            - &self.limit;
        let of = |w: &[usize]| {
            let rows = (w[1] - w[0]).max(1) as f64;
            (own.rows(w[0], w[1] - w[0]).norm_squared() / rows).sqrt()
        };
        self.starts.windows(2).map(of).fold(0.0, f64::max)
    }
}
