//! Where a fit of each of many changes of a twin begins: at the values that meet a recording best to first order, all of them
//! from one simulation with its tangent. The other recording then tells what is worth the fit.

use std::collections::BTreeMap;
use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::fit::weigh;
use super::parameters::{FINE, with_values};
use super::problem::Problem;
use super::refit::{Refits, parameters, taken_out};
use super::replay::lead;
use super::tangent::Tangent;
use super::{Free, Plant, ServoError, Settings, Track, loss};
use crate::diagnosis::{Change, changed};
use crate::regression::bounded;
use crate::regression::bounds::Bounds;
use crate::twin::Twin;

/// Where a fit begins.
pub struct Start {
    pub twin: Twin,
    /// Does its tangent tell? Else it was fitted.
    pub has_tangent: bool,
}

/// A change that is screened.
pub struct Other<'a> {
    pub change: &'a Change,
    /// A twin that it was fitted in before.
    pub fitted: Option<&'a Twin>,
}

/// A twin and values of it, varied from where they are.
struct Varied {
    twin: Twin,
    free: Vec<Free>,
}

/// Errors along a recording (rad, joint after joint), and how they change with each value.
struct Along {
    errors: DVector<f64>,
    columns: DMatrix<f64>,
}

/// Errors by the values of the twin first, then by those of each change.
struct Linear {
    shared: Varied,
    along: Along,
    /// Weights of rows, 1/rad, and of what is expected of a value.
    weights: Vec<f64>,
    prior_weight: f64,
}

/// Where fits begin of `others` beside `changes`, which `twin` has: at those values by which the recording of `refits` would be
/// met best if errors were linear in them; where no tangent tells, at those of a fit of the change's own.
///
/// # Errors
/// If a change has values that cannot be fitted.
pub fn starts(
    refits: &Refits<'_>,
    (twin, changes): (&Twin, &[Change]),
    others: &[Other<'_>],
) -> Result<Vec<Start>, ServoError> {
    let varied = |twin: &Twin| -> Result<Vec<Varied>, ServoError> {
        others.par_iter().map(|other| absent(refits, twin, changes, other.change)).collect()
    };
    let begun = varied(twin)?.iter().fold(twin.clone(), begun);
    let shared = Varied { twin: begun.clone(), free: refits.free(&begun, changes)? };
    let own = varied(&begun)?;
    let has_tangent: Vec<bool> = own.par_iter().map(Varied::has_tangent).collect();
    let with_tangent = own.iter().zip(&has_tangent).filter(|(_, has)| **has).map(|(v, _)| v);
    let with_tangent: Vec<&Varied> = with_tangent.collect();
    let linear = Linear::new(&refits.tracks, shared, &with_tangent);
    let solved = linear.map(|linear| linear.solved(&with_tangent));
    let mut solved = solved.unwrap_or_default().into_iter();
    let told = has_tangent.iter().map(|has| if *has { solved.next().flatten() } else { None });
    let told: Vec<Option<Twin>> = told.collect();
    let fitted = |other: &Other<'_>| match other.fitted {
        Some(fitted) => as_fitted(fitted, twin, other.change),
        None => refits.alone(&found(twin, other.change), changes, other.change),
    };
    let start = |(told, other): (Option<Twin>, &Other<'_>)| -> Result<Start, ServoError> {
        let has_tangent = told.is_some();
        Ok(Start { twin: told.map_or_else(|| fitted(other), Ok)?, has_tangent })
    };
    told.into_par_iter().zip(others).map(start).collect()
}

/// `twin` with a change as a search has it.
fn found(twin: &Twin, change: &Change) -> Twin {
    changed(twin, &BTreeMap::new(), std::slice::from_ref(change))
}

/// `twin` with a change as a twin has it that it was fitted in.
fn as_fitted(fitted: &Twin, twin: &Twin, change: &Change) -> Result<Twin, ServoError> {
    let own = parameters(fitted, change)?;
    let values: Vec<f64> = own.iter().map(|f| f.start).collect();
    Ok(with_values(&found(twin, change), &own, &values))
}

/// `twin` with a change that does nothing yet, and those of its values by which it would.
fn absent(
    refits: &Refits<'_>,
    twin: &Twin,
    changes: &[Change],
    change: &Change,
) -> Result<Varied, ServoError> {
    let found = found(twin, change);
    let absent = taken_out(&found, twin, change);
    let acts = |f: &Free| f.parameter.null.is_finite();
    let own = refits.own(&found, changes, change)?.into_iter().filter(acts);
    let free = own.map(|f| Free { start: f.value_in(&absent).clamp(f.min, f.max), ..f }).collect();
    Ok(Varied { twin: absent, free })
}

/// `twin` with next to nothing of what has to be something to be varied: a load without mass has no centre.
fn begun(twin: Twin, own: &Varied) -> Twin {
    let is_begun = own.free.iter().all(|f| f.start == f.value_in(&own.twin));
    match is_begun || own.moved(0.0).is_none() {
        true => twin,
        false => with_values(&twin, &own.free, &own.starts()),
    }
}

impl Varied {
    /// Does a tangent tell what its values do?
    fn has_tangent(&self) -> bool {
        !self.free.is_empty() && self.moved(0.0).is_some()
    }

    fn starts(&self) -> Vec<f64> {
        self.free.iter().map(|f| f.start).collect()
    }

    /// The arm with each value a step further, and the step; `None` where one of them has no tangent.
    fn moved(&self, start_s: f64) -> Option<Vec<(Plant, f64)>> {
        let of = |(i, f): (usize, &Free)| {
            let (mut x, step) = (self.starts(), f.step(f.start, f.max, FINE));
            x[i] += step;
            let plant = Plant::new(&with_values(&self.twin, &self.free, &x), start_s).ok()?;
            plant.is_plain().then_some((plant, step))
        };
        self.free.iter().enumerate().map(of).collect()
    }
}

impl Along {
    /// `None` where the arm has no tangent or runs away.
    fn new(tracks: &[&Track], horizon_s: f64, all: &[&Varied]) -> Option<Self> {
        let each = tracks.iter().map(|track| Self::rows(track, horizon_s, all));
        let rows = each.collect::<Option<Vec<_>>>()?.concat();
        let dof = tracks.first()?.joints();
        let samples = rows.len() / dof;
        let at = |row: usize| &rows[row % samples * dof + row / samples];
        let errors = DVector::from_fn(rows.len(), |row, _| at(row)[0]);
        let values = rows.first()?.len() - 1;
        let columns = DMatrix::from_fn(rows.len(), values, |row, i| at(row)[1 + i]);
        columns.iter().all(|c| c.is_finite()).then_some(Self { errors, columns })
    }

    /// Sample by sample and joint by joint: the error, and how it changes with each value.
    fn rows(track: &Track, horizon_s: f64, all: &[&Varied]) -> Option<Vec<Vec<f64>>> {
        let plant = Plant::new(&all.first()?.twin, track.start).ok()?;
        let moved = all.iter().map(|v| v.moved(track.start)).collect::<Option<Vec<_>>>()?.concat();
        let tangent = Tangent::new(plant, &moved)?;
        let stretches = track.stretches(horizon_s);
        let of = |stretch: &Range<usize>| {
            let mut rows: Vec<Vec<f64>> = Vec::with_capacity(stretch.len() * track.joints());
            let mut k = stretch.start;
            lead(&mut tangent.clone(), track, stretch, |tangent| {
                for j in 0..track.joints() {
                    let error = tangent.plant.shown(j) - track.q.joint(j)[k];
                    let columns = (0..moved.len()).map(|i| tangent.shown(j, i));
                    rows.push([error].into_iter().chain(columns).collect());
                }
                k += 1;
            })
            .ok()?;
            Some(rows)
        };
        Some(stretches.par_iter().map(of).collect::<Option<Vec<_>>>()?.concat())
    }
}

impl Linear {
    /// `None` where the arm has no tangent or runs away.
    fn new(tracks: &[&Track], shared: Varied, own: &[&Varied]) -> Option<Self> {
        let all: Vec<&Varied> = [&shared].into_iter().chain(own.iter().copied()).collect();
        let horizon_s = Settings::default().horizon_s;
        let along = Along::new(tracks, horizon_s, &all)?;
        let mut problem = Problem::new(&shared.twin, tracks, &shared.free, horizon_s);
        problem.counts_independent = true;
        problem.is_robust = true;
        weigh(&mut problem, along.errors.as_slice());
        let rows = problem.samples();
        let Problem { weights, prior_weight, .. } = problem;
        let weight = |(row, error): (usize, &f64)| {
            let weight = weights[row / rows];
            weight * loss::root_weight(weight * error)
        };
        let weights = along.errors.iter().enumerate().map(weight).collect();
        Some(Self { weights, prior_weight, along, shared })
    }

    /// Twins with values of their own beside those of all, which are where they were but for what those change: a further
    /// fit of what stands is no merit of a change. `None` where a value does nothing yet: a limit that nothing comes near.
    fn solved(&self, own: &[&Varied]) -> Vec<Option<Twin>> {
        let mut columns = self.along.columns.clone();
        columns.row_iter_mut().zip(&self.weights).for_each(|(mut row, weight)| row *= *weight);
        let errors =
            DVector::from_fn(columns.nrows(), |i, _| self.weights[i] * self.along.errors[i]);
        let (gram, pull) = (columns.tr_mul(&columns), -columns.tr_mul(&errors));
        let shared = &self.shared.free;
        let nearest = |at: &[usize], free: &[Free]| {
            let gram = DMatrix::from_fn(at.len(), at.len(), |i, k| gram[(at[i], at[k])]);
            let pull = DVector::from_fn(at.len(), |i, _| pull[at[i]]);
            self.nearest(free, gram, pull)
        };
        let all: Vec<usize> = (0..shared.len()).collect();
        let without = nearest(&all, shared);
        let mut end = shared.len();
        let of = |varied: &&Varied| {
            let begin = end;
            end += varied.free.len();
            if (begin..end).any(|i| gram[(i, i)] == 0.0) {
                return None;
            }
            let at: Vec<usize> = all.iter().copied().chain(begin..end).collect();
            let begun = |own: Vec<Free>| {
                let free: Vec<Free> = shared.iter().copied().chain(own).collect();
                let mut x = nearest(&at, &free);
                let further = x.iter_mut().zip(&without).zip(shared);
                further.for_each(|((x, w), f)| *x = (f.start + *x - w).clamp(f.min, f.max));
                with_values(&varied.twin, &free, &x)
            };
            let first = begun(varied.free.clone());
            // What is expected of a load's moments follows from its mass.
            Some(begun(varied.free.iter().map(|f| f.near_start(&first)).collect()))
        };
        own.iter().map(of).collect()
    }

    /// Values that meet the recording best, in their range and near where they are expected.
    fn nearest(&self, free: &[Free], mut gram: DMatrix<f64>, mut pull: DVector<f64>) -> Vec<f64> {
        for (i, f) in free.iter().enumerate() {
            let weight = (self.prior_weight / f.spread).powi(2);
            gram[(i, i)] += weight;
            pull[i] -= weight * (f.start - f.expected);
        }
        let range = |end: fn(&Free) -> f64| free.iter().map(|f| end(f) - f.start).collect();
        let bounds = Bounds::new(range(|f| f.min), range(|f| f.max));
        let by = bounds.ok().zip(gram.cholesky()).and_then(|(bounds, root)| {
            let root = root.l();
            let measured = root.solve_lower_triangular(&pull)?;
            Some(bounded::solve(&root.transpose(), &measured, &bounds))
        });
        let by = by.unwrap_or_else(|| DVector::zeros(free.len()));
        free.iter().zip(&by).map(|(f, by)| f.start + by).collect()
    }
}
