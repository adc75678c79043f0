//! The fit: bounded Levenberg-Marquardt on position errors, and what the data say of its values.

use nalgebra::DMatrix;

use super::gap::PositionGap;
use super::parameters::{Free, with_values};
use super::problem::Problem;
use super::{ServoError, Track, loss, replay};
use crate::effects::of_drive;
use crate::follow::{Watch, go_on, stoppable};
use crate::identification::levenberg_marquardt::{self as minimiser, Residuals, Stop};
use crate::regression::bounds::Bounds;
use crate::statistics::{effective_samples, infer};
use crate::twin::Twin;

/// Choices of a fit; echoed in every output.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Settings {
    /// Longest stretch that is simulated from one measured state, s.
    pub horizon_s: f64,
    /// Probability that an interval holds the value.
    pub level: f64,
    /// Simulations of everything, at most.
    pub max_evaluations: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self { horizon_s: 5.0, level: 0.99, max_evaluations: 2000 }
    }
}

/// A fitted value.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Estimate {
    pub effect: &'static str,
    pub name: &'static str,
    pub unit: &'static str,
    /// From 1; none for one of the whole arm.
    pub joint: Option<usize>,
    /// In that unit, as all that follow.
    pub value: f64,
    #[serde(skip)]
    pub standard_error: f64,
    /// Its interval.
    pub low: f64,
    pub high: f64,
    /// Probability of such data if the effect is not there, where there is such a value.
    pub p: f64,
    pub at_bound: bool,
    /// Do these recordings tell it?
    pub identifiable: bool,
    /// Least and most that was searched.
    #[serde(skip)]
    pub range: [f64; 2],
}

/// What came of it.
#[derive(Debug, Clone)]
pub struct Fitted {
    pub estimates: Vec<Estimate>,
    /// The twin with the values in it.
    pub twin: Twin,
    /// Position errors of each recording before and after.
    pub before: Vec<PositionGap>,
    pub after: Vec<PositionGap>,
    pub samples: usize,
    pub cost: f64,
    pub evaluations: usize,
    pub stop: Stop,
}

/// Rounds over stretches of these shares of the longest: where a joint sticks a little earlier or later the error of
/// long ones jumps, that of short ones hardly. The second long round has weights by what the first left.
const STRETCHES: [f64; 3] = [0.1, 1.0, 1.0];
/// Relative change of what errors count below which a search ends: less than one recording tells from the next, and
/// where values are compared that differ by more.
const CLOSE: f64 = 1e-4;
pub(super) const ABOUT: f64 = 1e-3;
/// Evaluations of a search for values that are compared: with exact columns what fits is found in half of them.
pub(super) const FEW: usize = 40;
/// Sums of neighbouring rows whose correlation is looked at: every pair of them is.
const MOST_BINS: usize = 2000;
/// Shortest recording, s.
const SHORTEST_S: f64 = 1.0;

/// Fits `free` to all `tracks` at once.
///
/// # Errors
/// If the twin cannot be simulated as given, the tracks are too short for so many values, or `watch` ends it.
pub fn identify(
    twin: &Twin,
    tracks: &[&Track],
    free: &[Free],
    settings: &Settings,
    watch: &dyn Watch,
) -> Result<Fitted, ServoError> {
    let mut problem = posed(twin, tracks, free, settings)?;
    let before = gaps(&with_values(twin, free, &starts(free)), tracks, settings)?;
    let Search { x, evaluations, stop } =
        stoppable(watch, || searched(&mut problem, (&STRETCHES, CLOSE), settings, watch))?;
    let estimates = estimates(&mut problem, &x, settings)?;
    let fitted = with_values(twin, free, &x);
    let after = gaps(&fitted, tracks, settings)?;
    let samples = problem.count();
    let mut r = vec![0.0; samples];
    problem.residuals(&x, &mut r);
    let cost = (r.iter().map(|r| r * r).sum::<f64>() / samples as f64).sqrt();
    Ok(Fitted { estimates, twin: settled(fitted), before, after, samples, cost, evaluations, stop })
}

/// How much work a fit of changes is. Errors count as they do where changes are compared, by their size. Each value is held near
/// where it is expected, as firmly as a recording of so many independent rows lets it, and what the recordings say of each is
/// left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fit {
    /// From any values that the twin can be led with: by short stretches.
    FromFar,
    /// From values that are about right, to compare them: by long stretches, whose errors are those of a whole motion.
    About,
    /// From values that are about right, to keep them: as far as it comes.
    Close,
}

impl Fit {
    /// The twin with its values fitted.
    ///
    /// # Errors
    /// As [`identify`].
    pub fn of(
        self,
        twin: &Twin,
        tracks: &[&Track],
        free: &[Free],
        watch: &dyn Watch,
    ) -> Result<Twin, ServoError> {
        let (stretches, tolerance, max_evaluations) = match self {
            Self::FromFar => (&STRETCHES[..1], ABOUT, FEW),
            Self::About => (&STRETCHES[1..2], ABOUT, FEW),
            Self::Close => (&STRETCHES[1..], CLOSE, FEW),
        };
        let settings = &Settings { max_evaluations, ..Settings::default() };
        let mut problem = posed(twin, tracks, free, settings)?;
        gaps(&with_values(twin, free, &starts(free)), tracks, settings)?;
        (problem.counts_independent, problem.is_robust) = (true, true);
        let found =
            stoppable(watch, || searched(&mut problem, (stretches, tolerance), settings, watch))?;
        Ok(settled(with_values(twin, free, &found.x)))
    }
}

/// What the recordings say of values as fits for a diagnosis have them ([`Fit`]), whatever was expected.
///
/// # Errors
/// As [`identify`].
pub fn told(
    twin: &Twin,
    tracks: &[&Track],
    free: &[Free],
    settings: &Settings,
) -> Result<Vec<Estimate>, ServoError> {
    let mut problem = posed(twin, tracks, free, settings)?;
    problem.is_robust = true;
    let x = starts(free);
    problem.weights = weights(&problem, &problem.errors(&x));
    estimates(&mut problem, &x, settings)
}

fn posed<'a>(
    twin: &'a Twin,
    tracks: &'a [&'a Track],
    free: &'a [Free],
    settings: &Settings,
) -> Result<Problem<'a>, ServoError> {
    if free.is_empty() {
        return Err(ServoError::NothingToFit);
    }
    let problem = Problem::new(twin, tracks, free, settings.horizon_s);
    let seconds = problem.samples() as f64 * tracks.first().map_or(0.0, |t| t.dt);
    if seconds < SHORTEST_S {
        return Err(ServoError::TooShort { seconds, needed: SHORTEST_S });
    }
    Ok(problem)
}

pub(super) fn starts(free: &[Free]) -> Vec<f64> {
    free.iter().map(|f| f.start).collect()
}

/// Where a search is.
pub(super) struct Search {
    pub x: Vec<f64>,
    evaluations: usize,
    stop: Stop,
}

impl Search {
    /// At the values that a fit starts from.
    pub(super) fn new(free: &[Free]) -> Self {
        Self { x: starts(free), evaluations: 0, stop: Stop::Evaluations }
    }
}

/// A round over stretches of each of these shares, each joint weighed by what the last round left of it.
fn searched(
    problem: &mut Problem<'_>,
    (stretches, tolerance): (&[f64], f64),
    settings: &Settings,
    watch: &dyn Watch,
) -> Search {
    let mut found = Search::new(problem.free);
    for share in stretches {
        *problem = problem.over(share * settings.horizon_s);
        go_on(watch);
        let errors = problem.errors(&found.x);
        weigh(problem, &errors);
        let most = settings.max_evaluations / stretches.len();
        found = minimised(problem, problem.free, found, (tolerance, most));
    }
    found
}

/// The values `free` of a problem, from where a search is, in their ranges.
pub(super) fn minimised(
    problem: &impl Residuals,
    free: &[Free],
    from: Search,
    (tolerance, max_evaluations): (f64, usize),
) -> Search {
    let bounds =
        Bounds::new(free.iter().map(|f| f.min).collect(), free.iter().map(|f| f.max).collect())
            .unwrap_or_else(|_| Bounds::unbounded(free.len()));
    let settings = minimiser::Settings {
        cost_tolerance: tolerance,
        step_tolerance: tolerance,
        gradient_tolerance: 1e-8,
        max_evaluations,
    };
    let found = minimiser::minimise(problem, &from.x, &bounds, &settings);
    let evaluations = from.evaluations + found.evaluations;
    Search { x: found.x, evaluations, stop: found.stop }
}

/// Each joint by what is left of it, and what is expected of values by what independent rows would say.
pub(super) fn weigh(problem: &mut Problem<'_>, errors: &[f64]) {
    problem.weights = weights(problem, errors);
    if problem.counts_independent {
        problem.prior_weight = rows_per_independent(problem, errors).sqrt();
    }
}

/// 1 / what is usual of each joint's errors, their mean size where they count by it, else their rms, at least that of rounding.
fn weights(problem: &Problem<'_>, errors: &[f64]) -> Vec<f64> {
    let rows = problem.samples();
    let resolution = |j: usize| problem.tracks.iter().map(|t| t.resolution[j]).fold(0.0, f64::max);
    let of = |j: usize| {
        let of_joint = &errors[j * rows..(j + 1) * rows];
        let least = (resolution(j).powi(2) / 12.0).max(1e-12).sqrt();
        let mean = |of: fn(&f64) -> f64| of_joint.iter().map(of).sum::<f64>() / rows as f64;
        let usual = if problem.is_robust { mean(|e| e.abs()) } else { mean(|e| e * e).sqrt() };
        let usual = usual.max(least);
        if usual.is_finite() { 1.0 / usual } else { 1.0 }
    };
    (0..problem.weights.len()).map(of).collect()
}

/// Rows of errors that say as much together as one that is independent of the others would.
fn rows_per_independent(problem: &Problem<'_>, errors: &[f64]) -> f64 {
    let rows = problem.samples();
    let of_joint = |errors: &[f64]| {
        let bins: Vec<f64> =
            errors.chunks(rows.div_ceil(MOST_BINS)).map(|c| c.iter().sum()).collect();
        effective_samples(&bins)
    };
    let independent: f64 = errors.chunks(rows).map(of_joint).sum();
    if independent > 0.0 { errors.len() as f64 / independent } else { 1.0 }
}

/// What the recordings say, whatever was expected.
fn estimates(
    problem: &mut Problem<'_>,
    x: &[f64],
    settings: &Settings,
) -> Result<Vec<Estimate>, ServoError> {
    problem.with_priors = false;
    let is_robust = std::mem::replace(&mut problem.is_robust, false);
    let free = problem.free;
    let bounds = Bounds::unbounded(x.len());
    let mut r = vec![0.0; problem.count()];
    problem.residuals(x, &mut r);
    let columns = problem.jacobian(x, &r, &bounds);
    let jacobian = DMatrix::from_fn(r.len(), x.len(), |i, j| columns[j][i]);
    if is_robust {
        r = r.chunks(problem.samples()).flat_map(loss::as_squares).collect();
    }
    let measured: Vec<f64> = r.iter().map(|r| -r).collect();
    let null: Vec<f64> = free
        .iter()
        .map(|f| if f.parameter.null.is_finite() { f.parameter.null } else { 0.0 })
        .collect();
    let found = infer(x, &null, &jacobian, &measured, &problem.slots(), None, settings.level)?;
    let one = |(i, f): (usize, &Free)| {
        let robust = &found.robust[i];
        Estimate {
            effect: f.effect.about().name,
            name: f.parameter.name,
            unit: f.parameter.unit,
            joint: f.joint.map(|j| j + 1),
            value: x[i],
            standard_error: robust.standard_error,
            low: robust.low,
            high: robust.high,
            p: robust.p,
            at_bound: f.is_bound(x[i]),
            // As by torque: what may be anything in the range it was searched in is not told.
            identifiable: found.design.is_determined(i) && robust.high - robust.low < f.max - f.min,
            range: [f.min, f.max],
        }
    };
    Ok(free.iter().enumerate().map(one).collect())
}

fn gaps(
    twin: &Twin,
    tracks: &[&Track],
    settings: &Settings,
) -> Result<Vec<PositionGap>, ServoError> {
    let of = |track: &&Track| {
        let simulated = replay(twin, track, &track.stretches(settings.horizon_s))?;
        Ok(PositionGap::new(track, &simulated))
    };
    tracks.iter().map(of).collect()
}

/// What the drive has a place for goes there, as in every twin that is written.
fn settled(mut twin: Twin) -> Twin {
    if of_drive().any(|(.., parameter)| twin.values.contains_key(parameter)) {
        twin.settle_drive();
    }
    twin
}
