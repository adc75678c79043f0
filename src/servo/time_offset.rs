//! How much later commands of one recording are noted beside positions than those of another.
//!
//! A logger notes in a row what was sent and read somewhere within it, and programs differ in what they do first. Servos that delay
//! commands by as much in both recordings share that delay; what is between them is of the recordings, not of the arm,
//! and would be called friction, gain or load. It is fitted together with values by which a twin follows both (temporal
//! calibration: Furgale, Rehder and Siegwart, *Unified temporal and spatial calibration for multi-sensor systems*, IROS 2013).

use nalgebra::{DMatrix, DVector};

use super::fit::{ABOUT, FEW, starts, weigh};
use super::problem::Problem;
use super::{Free, ServoError, Settings, Track};
use crate::diagnosis::TimeOffset;
use crate::follow::{Watch, stoppable};
use crate::identification::levenberg_marquardt::{self as minimiser, Residuals};
use crate::kernels::dot;
use crate::regression::bounds::Bounds;
use crate::twin::Twin;

/// The effect that does the same in both recordings.
pub const DELAY: &str = "servo_delay";
/// No two recordings are further apart, s: the longest delay of a servo.
const LONGEST_S: f64 = 0.2;

/// By how much commands of the second of two tracks are sent later beside positions than those of the first: what is most likely where
/// it is expected to be about a row. `free` has the delay of every joint, and other values of `twin`, with which it follows both.
/// Joints that contradict each other make it small; `None` where one alone tells it, which may as well be otherwise along
/// the other motion.
///
/// # Errors
/// If `watch` ends it.
pub fn time_offset(
    twin: &Twin,
    tracks: [&Track; 2],
    free: &[Free],
    watch: &dyn Watch,
) -> Result<Option<TimeOffset>, ServoError> {
    stoppable(watch, || {
        let shifted = Shifted::new(twin, tracks, free);
        let bounds = shifted.bounds()?;
        let settings = minimiser::Settings {
            cost_tolerance: ABOUT,
            step_tolerance: ABOUT,
            max_evaluations: FEW,
            ..minimiser::Settings::default()
        };
        let from: Vec<f64> = starts(free).into_iter().chain([0.0]).collect();
        let x = minimiser::minimise(&shifted, &from, &bounds, &settings).x;
        let variance = shifted.variance(&x, &bounds)?;
        let precision = [variance, tracks[1].dt.powi(2)].map(f64::recip);
        let both = precision[0] + precision[1];
        let late_s = x[free.len()] * precision[0] / both;
        let told = TimeOffset { late_s, standard_error_s: both.recip().sqrt() };
        told.late_s.is_finite().then_some(told)
    })
    .map_err(ServoError::from)
}

/// Errors count as in every fit for a diagnosis ([`super::fit::Fit`]).
fn posed<'a>(twin: &'a Twin, tracks: &'a [&'a Track; 2], free: &'a [Free]) -> Problem<'a> {
    let mut problem = Problem::new(twin, tracks, free, Settings::default().horizon_s);
    (problem.counts_independent, problem.is_robust) = (true, true);
    problem
}

/// Errors of both tracks by values of the twin, and by how much later commands of the second one are sent.
struct Shifted<'a> {
    twin: &'a Twin,
    tracks: [&'a Track; 2],
    free: &'a [Free],
    weights: Vec<f64>,
    prior_weight: f64,
}

impl<'a> Shifted<'a> {
    /// Each joint weighed by what is left of it with commands as they are noted.
    fn new(twin: &'a Twin, tracks: [&'a Track; 2], free: &'a [Free]) -> Self {
        let mut problem = posed(twin, &tracks, free);
        let errors = problem.errors(&starts(free));
        weigh(&mut problem, &errors);
        let Problem { weights, prior_weight, .. } = problem;
        Self { twin, tracks, free, weights, prior_weight }
    }

    fn bounds(&self) -> Option<Bounds> {
        let ends =
            |end: fn(&Free) -> f64, late: f64| self.free.iter().map(end).chain([late]).collect();
        Bounds::new(ends(|f| f.min, -LONGEST_S), ends(|f| f.max, LONGEST_S)).ok()
    }

    /// The same with commands of the second track as much later as `x` has it.
    fn at<R>(&self, x: &[f64], of: impl FnOnce(&Problem<'_>, &[f64]) -> R) -> R {
        let (values, late) = x.split_at(self.free.len());
        let later = self.tracks[1].later(late[0]);
        let tracks = [self.tracks[0], &later];
        let mut problem = posed(self.twin, &tracks, self.free);
        problem.weights.clone_from(&self.weights);
        problem.prior_weight = self.prior_weight;
        of(&problem, values)
    }

    /// Rows of one joint, and those of them that are of the first track.
    fn rows(&self) -> [usize; 2] {
        let stretches = self.tracks.map(|track| track.stretches(Settings::default().horizon_s));
        let [first, second] = stretches.map(|all| all.iter().map(|s| s.len()).sum::<usize>());
        [first + second, first]
    }

    /// Variance of how much later it is, s2, by how far joints contradict each other: the jackknife over joints, whose errors have a
    /// common cause each (Bell and McCaffrey, *Bias reduction in standard errors for linear regression with multi-stage
    /// samples*, Survey Methodology 28, 2002). Infinite, or none at all, where one joint alone tells it.
    fn variance(&self, x: &[f64], bounds: &Bounds) -> Option<f64> {
        let mut r = vec![0.0; self.count()];
        self.residuals(x, &mut r);
        let mut columns = self.jacobian(x, &r, bounds);
        let late = DVector::from_vec(columns.pop()?);
        let others = DMatrix::from_fn(r.len(), columns.len(), |row, i| columns[i][row]);
        // What no other value does.
        let shared = others.tr_mul(&others).cholesky()?.solve(&others.tr_mul(&late));
        let own = &late - &others * shared;
        let [rows, _] = self.rows();
        let of_joint = |j: usize| j * rows..(j + 1) * rows;
        let all = 0..self.weights.len();
        let own = |j: usize| &own.as_slice()[of_joint(j)];
        let tells: Vec<f64> = all.clone().map(|j| dot(own(j), own(j))).collect();
        let moved_without = |j: usize| {
            let others: f64 = all.clone().filter(|i| *i != j).map(|i| tells[i]).sum();
            dot(own(j), &r[of_joint(j)]) / others
        };
        let joints = tells.iter().filter(|t| **t > 0.0).count() as f64;
        Some((joints - 1.0) / joints * all.clone().map(|j| moved_without(j).powi(2)).sum::<f64>())
    }
}

impl Residuals for Shifted<'_> {
    fn count(&self) -> usize {
        self.at(&vec![0.0; self.free.len() + 1], |problem, _| problem.count())
    }

    fn residuals(&self, x: &[f64], out: &mut [f64]) {
        self.at(x, |problem, values| problem.residuals(values, out));
    }

    /// To send later is what delays do that are as much longer at every joint.
    fn jacobian(&self, x: &[f64], r: &[f64], bounds: &Bounds) -> Vec<Vec<f64>> {
        let mut columns = self.at(x, |problem, values| problem.jacobian(values, r, bounds));
        let [rows, first] = self.rows();
        let errors = rows * self.weights.len();
        let mut late = vec![0.0; r.len()];
        let delays = self.free.iter().zip(&columns).filter(|(f, _)| f.effect.about().name == DELAY);
        for (_, column) in delays {
            let second = (0..errors).filter(|row| row % rows >= first);
            second.for_each(|row| late[row] += column[row]);
        }
        columns.push(late);
        columns
    }
}
