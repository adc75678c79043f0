//! The recordings of an arm that are searched together: columns over the rows of all of them, and
//! the discrepancy beside them.

use std::sync::Arc;

use rayon::prelude::*;

use super::Settings;
use super::discrepancy::{Discrepancy, GROUPS, KNOWN};
use super::kept::Kept;
use super::observed::Observed;
use super::sizes::Sizes;
use super::tolerances::Tolerances;
use crate::follow::Watch;
use crate::regression::random_effects::{Features, JointMetric, Metric, STEPS, ln_likelihood};
use crate::regression::{Blocks, Raw};
use crate::twin::Twin;

/// Share of the sensors' noise floor that no model is believed to fall short of: the floor is an
/// estimate.
const BELOW_FLOOR: f64 = 0.7;

pub struct Data<'a> {
    pub twin: &'a Twin,
    pub parts: Vec<&'a Observed<'a>>,
    /// Features of the discrepancy, joint by joint.
    pub features: Arc<Vec<Features>>,
    /// Torque that is large for a joint, N.m: rated, or else the largest recorded.
    pub rated: Vec<f64>,
    /// Share of the rows that is independent of the others, recording by recording and joint by joint: every row is scaled
    /// by its square root.
    pub shares: Vec<Vec<f64>>,
    /// What the twin states within limits.
    pub tolerances: Tolerances,
    /// Who may end the work on them.
    pub watch: &'a dyn Watch,
    /// Columns that a search comes back to.
    kept: Kept<Vec<Raw>>,
}

impl<'a> Data<'a> {
    /// The recordings with a discrepancy.
    pub fn new(parts: Vec<&'a Observed<'a>>, settings: &Settings) -> Self {
        let mut data = Self::plain(parts);
        let discrepancy = Discrepancy::new(&data.parts, settings);
        let rows = |j: usize| {
            let parts = &data.parts;
            let noise = data.least(j).sqrt() / BELOW_FLOOR;
            discrepancy.features(j, noise, move |p, series| parts[p].block(j, series))
        };
        data.features = Arc::new((0..data.joints()).into_par_iter().map(rows).collect());
        let noise: Vec<f64> = (0..data.joints()).map(|j| data.least(j)).collect();
        data.tolerances = Tolerances::new(&data.parts, &noise, settings);
        data
    }

    /// The recordings without a discrepancy.
    pub fn plain(parts: Vec<&'a Observed<'a>>) -> Self {
        let twin = parts[0].twin;
        let none = || Features::new(Vec::new(), Vec::new(), GROUPS.len());
        let features = Arc::new((0..parts[0].joints()).map(|_| none()).collect());
        let rated = (0..parts[0].joints()).map(|j| rated(&parts, j)).collect();
        let shares = vec![vec![1.0; parts[0].joints()]; parts.len()];
        let (tolerances, kept) = (Tolerances::none(), Kept::default());
        let watch = &();
        Self { twin, parts, features, rated, shares, tolerances, watch, kept }
    }

    /// These recordings, in work that `watch` may end.
    pub fn watched(self, watch: &'a dyn Watch) -> Self {
        Self { watch, ..self }
    }

    pub fn joints(&self) -> usize {
        self.features.len()
    }

    /// Rows of a joint, over all recordings.
    pub fn rows(&self, j: usize) -> usize {
        self.parts.iter().map(|p| p.rows[j].len()).sum()
    }

    /// Number of independent rows of a joint, over all recordings.
    pub fn count(&self, j: usize) -> f64 {
        let parts = self.parts.iter().zip(&self.shares);
        parts.map(|(p, shares)| shares[j] * p.rows[j].len() as f64).sum()
    }

    /// Rows of a joint, over all recordings, each scaled by what its recording's share makes of it.
    fn by_shares(&self, j: usize, rows: &mut [f64], factor: impl Fn(f64) -> f64) {
        let mut rest = rows;
        for (part, shares) in self.parts.iter().zip(&self.shares) {
            let (own, others) = rest.split_at_mut(part.rows[j].len());
            let by = factor(shares[j]);
            if by != 1.0 {
                own.iter_mut().for_each(|r| *r *= by);
            }
            rest = others;
        }
    }

    /// Rows of a joint as they count -> in full.
    pub fn in_full(&self, j: usize, mut rows: Vec<f64>) -> Vec<f64> {
        self.by_shares(j, &mut rows, |share| 1.0 / share.sqrt());
        rows
    }

    /// Smallest variance of what a model leaves of a joint, (N.m)^2.
    pub fn least(&self, j: usize) -> f64 {
        let noise = self.parts.iter().map(|p| p.sigma[j]).fold(f64::INFINITY, f64::min);
        (BELOW_FLOOR * noise).powi(2)
    }

    /// Blocks of every recording, one after the other -> one column.
    pub fn raw(&self, parts: Vec<Blocks>) -> Raw {
        let joint = |j: usize| -> Vec<f64> {
            if parts.iter().all(|p| !p.touches(j)) {
                return Vec::new();
            }
            let mut rows = Vec::with_capacity(self.rows(j));
            for (block, part) in parts.iter().zip(&self.parts) {
                match block.touches(j) {
                    true => rows.extend_from_slice(block.joint(j)),
                    false => rows.resize(rows.len() + part.rows[j].len(), 0.0),
                }
            }
            self.by_shares(j, &mut rows, f64::sqrt);
            rows
        };
        let rows = Blocks((0..self.joints()).map(joint).collect());
        Raw::new(rows, self.features.clone())
    }

    /// These recordings, with columns of their own.
    pub fn again(&self) -> Self {
        Self {
            parts: self.parts.clone(),
            features: self.features.clone(),
            rated: self.rated.clone(),
            shares: self.shares.clone(),
            tolerances: self.tolerances.clone(),
            kept: Kept::default(),
            ..*self
        }
    }

    /// These recordings, each row of a joint counted by the share of them that is independent: what a model
    /// leaves is correlated in time, and so many rows say no more than fewer.
    pub fn counted(self, shares: Vec<Vec<f64>>) -> Self {
        let scaled = |(j, features): (usize, &Features)| {
            let parts = self.shares.iter().zip(&shares);
            let by: Vec<f64> = parts.map(|(was, now)| (now[j] / was[j]).sqrt()).collect();
            features.scaled(&by)
        };
        let features = self.features.iter().enumerate().map(scaled).collect();
        Self { features: Arc::new(features), shares, kept: Kept::default(), ..self }
    }

    /// Columns that `work_out` makes of every recording.
    pub fn fresh(&self, work_out: impl Fn(usize) -> Vec<Blocks>) -> Vec<Raw> {
        let parts: Vec<Vec<Blocks>> = (0..self.parts.len()).map(work_out).collect();
        let count = parts.first().map_or(0, Vec::len);
        let column = |i: usize| self.raw(parts.iter().map(|p| p[i].clone()).collect());
        (0..count).map(column).collect()
    }

    /// Columns by all that they depend on; `work_out` makes those of a recording.
    pub fn kept(&self, key: &str, work_out: impl Fn(usize) -> Vec<Blocks>) -> Arc<Vec<Raw>> {
        self.kept.get(key, || self.fresh(work_out))
    }

    /// Columns of what the twin states within limits, where the rigid arm needs `carried` in each recording; those of
    /// torque are kept where a `key` says what they depend on.
    pub fn within_tolerances(
        &self,
        key: Option<String>,
        carried: impl Fn(usize) -> Blocks,
    ) -> Vec<Raw> {
        if self.tolerances.count() == 0 {
            return Vec::new();
        }
        let links = self.kept("tolerances", |p| self.tolerances.of_links(self.parts[p]));
        let of_scales = |p: usize| self.tolerances.of_scales(&carried(p));
        let scales = match key {
            Some(key) => self.kept(&key, of_scales),
            None => Arc::new(self.fresh(of_scales)),
        };
        links.iter().chain(&*scales).cloned().collect()
    }

    /// No discrepancy anywhere, and a twin that is exact.
    pub fn nothing(&self) -> Sizes {
        Sizes::nothing(self.joints())
    }

    /// These sizes with all that is known to be no larger than so much as large as that.
    pub fn at_limits(&self, sizes: &Sizes) -> Sizes {
        let group = |f: &Features, (g, step): (usize, &u8)| match KNOWN.contains(&GROUPS[g]) {
            true => f.largest(g),
            false => *step,
        };
        let joint = |(f, steps): (&Features, &Vec<u8>)| {
            steps.iter().enumerate().map(|step| group(f, step)).collect()
        };
        let joints = self.features.iter().zip(&sizes.joints).map(joint).collect();
        Sizes { joints, tolerances: STEPS }
    }

    pub fn metric(&self, sizes: &Sizes) -> Metric {
        let joint = |(f, s): (&Features, &Vec<u8>)| f.metric(s);
        Metric { joints: self.features.iter().zip(&sizes.joints).map(joint).collect() }
    }

    /// Log-likelihood of a joint's rows that leave `squares` in a metric, the discrepancy integrated
    /// out, nats.
    pub fn ln_likelihood(&self, j: usize, squares: f64, metric: &Metric) -> f64 {
        match self.count(j) {
            0.0 => 0.0,
            count => {
                let JointMetric { ln_det, .. } = &*metric.joints[j];
                let price = metric.joints[j].price();
                ln_likelihood(squares, count, self.least(j)) - 0.5 * ln_det - price
            }
        }
    }

    /// 1/s^2 of what a residual shows, joint by joint, within what the noise is known to be.
    pub fn weights(&self, squares: &[f64]) -> Vec<f64> {
        let level = |(j, s): (usize, &f64)| {
            let mean_square = s / self.count(j).max(f64::MIN_POSITIVE);
            1.0 / mean_square.max(self.least(j)).max(f64::MIN_POSITIVE)
        };
        squares.iter().enumerate().map(level).collect()
    }
}

fn rated(parts: &[&Observed], j: usize) -> f64 {
    let twin = parts[0].twin;
    let effort = twin.robot.bodies[j].joint.limits.effort;
    let limit = twin.drive.torque_limit.as_ref().map_or(f64::INFINITY, |l| l[j]);
    let rated = effort.min(limit);
    if rated.is_finite() && rated > 0.0 {
        return rated;
    }
    let recorded = parts.iter().flat_map(|p| p.samples.torque.joint(j));
    recorded.fold(0.0f64, |most, t| most.max(t.abs())).max(f64::MIN_POSITIVE)
}
