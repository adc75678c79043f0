//! How far links and scales of torque are off, and which scales are further than they are said to be known to.
//!
//! Beside its causes a fit leaves room for what the twin states within limits, one standard deviation each. A torque constant
//! that is wrong is expected to be no more than twice what it is said to be known to, so that evidence hardly tells one from the
//! other: what the twin says is taken for true. But where the recordings by themselves place a scale beyond its expanded
//! uncertainty (JCGM 100:2008, GUM, section 6.2), what the twin says does not hold, and that is a cause. Of links, whose centres
//! may be off by several times what is said, evidence tells.

use statrs::distribution::{ContinuousCDF, Normal};

use super::candidate::{Candidate, Place};
use super::fit::Fit;
use super::sizes::Sizes;
use super::tolerances::{PER_LINK, of_links, of_scales};
use crate::effects::find;
use crate::regression::bounds::Bounds;
use crate::regression::{Column, Raw};

/// What the scale of a joint's torque is where it is off.
const GAIN: &str = "torque_constant";

/// Standard deviations within which a value is said to be: the usual factor, of about 95 %.
const COVERAGE: f64 = 2.0;

/// How far a value is off that the twin states within a limit.
pub struct Off {
    pub value: f64,
    /// Standard deviation given all others.
    pub sd: f64,
    pub limit: f64,
}

/// Every link's mass and first moments, and the scale of every joint's torque, beside the causes of a fit.
pub struct Stated<'a> {
    pub fit: Fit<'a>,
    /// What the rows show of them, links first.
    pub raw: Vec<Raw>,
    columns: Vec<Column>,
    limits: Vec<f64>,
}

impl<'a> Stated<'a> {
    /// `None` where the twin is exact, or the data say that it is.
    pub fn new(fit: &Fit<'a>) -> Option<Self> {
        let limits = fit.data.tolerances.limits();
        if fit.sizes.tolerances == 0 || limits.is_empty() {
            return None;
        }
        // They stand for themselves here.
        let fit = fit.clone().beside(Sizes { tolerances: 0, ..fit.sizes.clone() });
        let data = fit.data;
        let mut raw = data.fresh(|p| of_links(data.parts[p]).to_vec());
        raw.extend(data.fresh(|p| of_scales(&fit.carried(p))));
        let columns = Column::all(&raw, &fit.metric);
        Some(Self { fit, raw, columns, limits })
    }

    /// All of them, where each is expected to be as large as this share of its limit: four values of every link, then the
    /// scales.
    pub fn off(&self, share: f64) -> Vec<Off> {
        let expected: Vec<f64> = self.limits.iter().map(|limit| share * limit).collect();
        let projected = self.fit.system.project(&self.columns, &expected);
        let (x, _) = projected.solve(&Bounds::unbounded(self.columns.len()));
        let each = x.iter().zip(projected.variances()).zip(&self.limits);
        each.map(|((x, v), limit)| Off { value: *x, sd: v.sqrt(), limit: *limit }).collect()
    }

    /// The cause that each scale is, with the odds that it is beyond what it is known to, nats. The other values are as unsure as
    /// the twin is said to be.
    pub fn beyond(&self) -> Option<Vec<(Candidate, f64)>> {
        let gain = find(GAIN)?;
        let off = self.off(1.0);
        let (_, scales) = off.split_at(PER_LINK * off.len() / (PER_LINK + 1));
        let at =
            |(j, off): (usize, &Off)| (Candidate::new(gain, Place::Joint(j)), ln_odds_beyond(off));
        Some(scales.iter().enumerate().map(at).collect())
    }
}

/// Logarithm of the odds that the recordings place a value beyond what it is known to, given all others within theirs. What is
/// said of the value itself, which is in question, is taken out: a product of normal densities, divided by one of them.
fn ln_odds_beyond(off: &Off) -> f64 {
    let Off { value, sd, limit } = off;
    let told = sd.powi(-2) - limit.powi(-2);
    if told.is_nan() || told <= 0.0 {
        return 0.0;
    }
    let alone = value.abs() * sd.powi(-2) / told;
    let further = (alone - COVERAGE * limit) * told.sqrt();
    let [beyond, within] = [-further, further].map(|z| Normal::standard().sf(z));
    (beyond / within.max(f64::MIN_POSITIVE)).ln()
}

/// Odds that `cause` is beyond what the twin says beside these causes, nats; `None` where the twin says nothing of it within
/// limits.
pub fn odds_beyond(without: &Fit<'_>, cause: Candidate) -> Option<f64> {
    let all = cause.scaled().and_then(|_| Stated::new(without))?.beyond()?;
    all.into_iter().find(|(c, _)| *c == cause).map(|(_, odds)| odds)
}
