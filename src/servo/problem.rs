//! Output error: positions of the twin, led along stretches of recordings that begin in measured states,
//! less those recorded.
//!
//! Stretches make the error local: it forgets its begin within a servo's time constant, and no error of one
//! stretch reaches the next (multiple shooting with the measured states for its nodes: Bock, *Recent advances
//! in parameter identification techniques for O.D.E.*, 1983). Columns of the Jacobian are tangents of the
//! simulation ([`super::tangent`]), or differences between simulations where the arm has none, all stretches at once
//! over the machine's cores. All joints are in them: links of small arms move each other, and a search
//! by sensitivity equations of single joints ends where nothing is.

use std::ops::Range;

use rayon::prelude::*;

use super::parameters::{COARSE, FINE, Free, with_values};
use super::replay::lead;
use super::tangent::Tangent;
use super::{Plant, Track, loss};
use crate::identification::levenberg_marquardt::Residuals;
use crate::regression::bounds::Bounds;
use crate::twin::Twin;

/// What is minimised.
pub struct Problem<'a> {
    pub twin: &'a Twin,
    pub tracks: &'a [&'a Track],
    pub free: &'a [Free],
    /// Track and samples of each stretch.
    pub stretches: Vec<(usize, Range<usize>)>,
    /// Weight of a joint's error, 1/rad.
    pub weights: Vec<f64>,
    /// A row for each parameter, how far it is from where it is expected (most likely values a posteriori).
    pub with_priors: bool,
    /// Is what is expected held against as many rows as are independent, or against all? Values that are chosen among
    /// many are best where they are expected unless much speaks for more, those that are told are what is recorded.
    pub counts_independent: bool,
    /// Weight of such a row, the square root of how many rows of errors, which go along with each other, say as much as
    /// one would say alone.
    pub prior_weight: f64,
    /// Do large errors count by their size ([`loss`]), or all of them by their square?
    pub is_robust: bool,
}

impl<'a> Problem<'a> {
    /// Stretches of `horizon_s` at most; all joints weigh alike.
    pub fn new(twin: &'a Twin, tracks: &'a [&'a Track], free: &'a [Free], horizon_s: f64) -> Self {
        let of = |(i, t): (usize, &&Track)| -> Vec<(usize, Range<usize>)> {
            t.stretches(horizon_s).into_iter().map(|s| (i, s)).collect()
        };
        let stretches = tracks.iter().enumerate().flat_map(of).collect();
        let weights = vec![1.0; twin.robot.dof()];
        Self {
            twin,
            tracks,
            free,
            stretches,
            weights,
            with_priors: true,
            counts_independent: false,
            prior_weight: 1.0,
            is_robust: false,
        }
    }

    /// The same over stretches of another length, all joints weighing alike.
    pub fn over(&self, horizon_s: f64) -> Self {
        Self {
            with_priors: self.with_priors,
            counts_independent: self.counts_independent,
            is_robust: self.is_robust,
            ..Self::new(self.twin, self.tracks, self.free, horizon_s)
        }
    }

    /// Samples of a joint.
    pub fn samples(&self) -> usize {
        self.stretches.iter().map(|(_, s)| s.len()).sum()
    }

    /// Time of each row in samples of all tracks one after the other, joint after joint: increasing.
    pub fn slots(&self) -> Vec<usize> {
        let mut begins = vec![0];
        self.tracks.iter().for_each(|t| begins.push(begins[begins.len() - 1] + 2 * t.len()));
        let all = begins[self.tracks.len()];
        let of_joint = |j: usize| {
            let begins = &begins;
            self.stretches
                .iter()
                .flat_map(move |(i, s)| s.clone().map(move |k| j * all + begins[*i] + k))
        };
        (0..self.weights.len()).flat_map(of_joint).collect()
    }

    /// Position errors, simulated less recorded, rad, joint after joint; infinite where it cannot be
    /// simulated.
    pub fn errors(&self, x: &[f64]) -> Vec<f64> {
        self.joined(&self.simulated(&[x.to_vec()])[0])
    }

    /// For each set of values the errors of each stretch, sample by sample and joint by joint.
    fn simulated(&self, sets: &[Vec<f64>]) -> Vec<Vec<Vec<f64>>> {
        let twins: Vec<Twin> = sets.iter().map(|x| with_values(self.twin, self.free, x)).collect();
        let pairs: Vec<(usize, usize)> =
            (0..sets.len()).flat_map(|x| (0..self.stretches.len()).map(move |s| (x, s))).collect();
        let mut each: Vec<Vec<f64>> =
            pairs.par_iter().map(|&(x, s)| self.stretch(&twins[x], s)).collect();
        let mut grouped = Vec::with_capacity(sets.len());
        while !each.is_empty() {
            let rest = each.split_off(self.stretches.len().min(each.len()));
            grouped.push(std::mem::replace(&mut each, rest));
        }
        grouped
    }

    fn stretch(&self, twin: &Twin, s: usize) -> Vec<f64> {
        let (i, range) = &self.stretches[s];
        let (track, dof) = (self.tracks[*i], self.weights.len());
        let mut errors = Vec::with_capacity(range.len() * dof);
        let mut k = range.start;
        let done = Plant::new(twin, track.start).and_then(|mut plant| {
            lead(&mut plant, track, range, |plant| {
                errors.extend((0..dof).map(|j| plant.shown(j) - track.q.joint(j)[k]));
                k += 1;
            })
        });
        if done.is_err() {
            errors = vec![f64::INFINITY; range.len() * dof];
        }
        errors
    }

    /// Errors of all stretches, joint after joint.
    fn joined<S: AsRef<[f64]>>(&self, stretches: &[S]) -> Vec<f64> {
        let dof = self.weights.len();
        let of = |j: usize| {
            stretches.iter().flat_map(move |s| s.as_ref().iter().skip(j).step_by(dof).copied())
        };
        (0..dof).flat_map(of).collect()
    }

    /// Rows for what is expected of the parameters.
    fn priors(&self) -> usize {
        if self.with_priors { self.free.len() } else { 0 }
    }

    fn weighted(&self, mut errors: Vec<f64>) -> Vec<f64> {
        let rows = self.samples();
        for (j, weight) in self.weights.iter().enumerate() {
            errors[j * rows..(j + 1) * rows].iter_mut().for_each(|e| *e *= weight);
        }
        errors
    }

    /// Residuals of errors, without rows for what is expected.
    fn counted(&self, errors: Vec<f64>) -> Vec<f64> {
        let mut counted = self.weighted(errors);
        if self.is_robust {
            counted.iter_mut().for_each(|u| *u = loss::residual(*u));
        }
        counted
    }
}

impl Residuals for Problem<'_> {
    fn count(&self) -> usize {
        self.samples() * self.weights.len() + self.priors()
    }

    fn residuals(&self, x: &[f64], out: &mut [f64]) {
        let (errors, expected) = out.split_at_mut(self.samples() * self.weights.len());
        errors.copy_from_slice(&self.counted(self.errors(x)));
        let off = |(f, x): (&Free, &f64)| self.prior_weight * (x - f.expected) / f.spread;
        let off = self.free.iter().zip(x).map(off);
        expected.iter_mut().zip(off).for_each(|(row, off)| *row = off);
    }

    fn jacobian(&self, x: &[f64], r: &[f64], bounds: &Bounds) -> Vec<Vec<f64>> {
        match self.tangents(x, &self.steps(x, bounds, FINE)) {
            Some(columns) => self.counted_columns(columns, r),
            None => self.expecting(self.differences(x, r, &self.steps(x, bounds, COARSE))),
        }
    }
}

impl Problem<'_> {
    /// How residuals change, which are `r`, from how errors do.
    fn counted_columns(&self, columns: Vec<Vec<f64>>, r: &[f64]) -> Vec<Vec<f64>> {
        let counted = |column: Vec<f64>| {
            let mut column = self.weighted(column);
            if self.is_robust {
                column.iter_mut().zip(r).for_each(|(c, r)| *c *= loss::slope(*r));
            }
            column
        };
        self.expecting(columns.into_iter().map(counted).collect())
    }

    /// Columns of errors with the rows of what is expected below them.
    fn expecting(&self, mut columns: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        for (i, column) in columns.iter_mut().enumerate() {
            let expected =
                |k: usize| if k == i { self.prior_weight / self.free[k].spread } else { 0.0 };
            column.extend((0..self.priors()).map(expected));
        }
        columns
    }

    /// Steps of differences by the values, as shares of them.
    pub(super) fn steps(&self, x: &[f64], bounds: &Bounds, share: f64) -> Vec<f64> {
        (0..x.len()).map(|i| self.free[i].step(x[i], bounds.upper(i), share)).collect()
    }

    /// How errors change with each value, by the tangent of the simulation, where it has one; columns of what cannot be
    /// simulated are not finite.
    pub(super) fn tangents(&self, x: &[f64], steps: &[f64]) -> Option<Vec<Vec<f64>>> {
        let of = |track: &&Track| self.tangent(track, x, steps);
        let of_tracks: Vec<Tangent> = self.tracks.iter().map(of).collect::<Option<_>>()?;
        let of = |(i, stretch): &(usize, Range<usize>)| {
            self.tangent_errors(of_tracks[*i].clone(), self.tracks[*i], stretch)
        };
        let stretches: Vec<Vec<Vec<f64>>> = self.stretches.par_iter().map(of).collect();
        let column = |i: usize| {
            let parts: Vec<&[f64]> = stretches.iter().map(|s| &s[i][..]).collect();
            self.joined(&parts)
        };
        Some((0..x.len()).map(column).collect())
    }

    fn tangent(&self, track: &Track, x: &[f64], steps: &[f64]) -> Option<Tangent> {
        let plant = |x: &[f64]| Plant::new(&with_values(self.twin, self.free, x), track.start).ok();
        let moved = |(x, step): (Vec<f64>, &f64)| Some((plant(&x)?, *step));
        let moved = self.moved(x, steps).into_iter().zip(steps).map(moved);
        Tangent::new(plant(x)?, &moved.collect::<Option<Vec<_>>>()?)
    }

    /// How the errors of a stretch change with each value.
    fn tangent_errors(
        &self,
        mut tangent: Tangent,
        track: &Track,
        stretch: &Range<usize>,
    ) -> Vec<Vec<f64>> {
        let (dof, count) = (self.weights.len(), stretch.len() * self.weights.len());
        let mut columns = vec![Vec::with_capacity(count); self.free.len()];
        let done = lead(&mut tangent, track, stretch, |tangent| {
            for (i, column) in columns.iter_mut().enumerate() {
                column.extend((0..dof).map(|j| tangent.shown(j, i)));
            }
        });
        if done.is_err() {
            columns.iter_mut().for_each(|c| *c = vec![f64::INFINITY; count]);
        }
        columns
    }

    /// `x` with one value a step further, each of them.
    fn moved(&self, x: &[f64], steps: &[f64]) -> Vec<Vec<f64>> {
        let moved = |(i, step): (usize, &f64)| {
            let mut x = x.to_vec();
            x[i] += step;
            x
        };
        steps.iter().enumerate().map(moved).collect()
    }

    /// How residuals change with each value, by differences between simulations.
    pub(super) fn differences(&self, x: &[f64], r: &[f64], steps: &[f64]) -> Vec<Vec<f64>> {
        let column = |(stretches, step): (Vec<Vec<f64>>, &f64)| {
            let mut column = self.counted(self.joined(&stretches));
            column.iter_mut().zip(r).for_each(|(c, r)| *c = (*c - r) / step);
            column
        };
        self.simulated(&self.moved(x, steps)).into_iter().zip(steps).map(column).collect()
    }
}
