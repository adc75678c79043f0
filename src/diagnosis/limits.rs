//! How far links and scales of torque are off, and which scales are further than they are said to be known to.
//!
//! Beside its causes a fit leaves room for what the twin states within limits, one standard deviation each. A torque constant
//! that is wrong is expected to be no more than twice what it is said to be known to, so that evidence hardly tells one from the
//! other: what the twin says is taken for true. But where the recordings by themselves place a scale beyond its expanded
//! uncertainty (JCGM 100:2008, GUM, section 6.2), what the twin says does not hold, and that is a cause. Of links, whose centres
//! may be off by several times what is said, evidence tells.

use statrs::distribution::{ContinuousCDF, Normal};

use super::candidate::{Candidate, Place, SCALE};
use super::fit::Fit;
use super::sizes::Sizes;
use super::tolerances::{PER_LINK, of_links, of_scales};
use crate::effects::find;
use crate::regression::bounds::Bounds;
use crate::regression::{Column, Raw};

/// How far a value is off that the twin states within a limit, one standard deviation: kg and kg.m of links, relative of
/// scales.
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

    /// Four values of every link, and the scales, where each is expected to be as large as this share of its limit.
    pub fn off(&self, share: f64) -> [Vec<Off>; 2] {
        let expected: Vec<f64> = self.limits.iter().map(|limit| share * limit).collect();
        let projected = self.fit.system.project(&self.columns, &expected);
        let (x, _) = projected.solve(&Bounds::unbounded(self.columns.len()));
        let each = x.iter().zip(projected.variances()).zip(&self.limits);
        let off = each.map(|((x, v), limit)| Off { value: *x, sd: v.sqrt(), limit: *limit });
        let mut links: Vec<Off> = off.collect();
        let scales = links.split_off(PER_LINK * links.len() / (PER_LINK + 1));
        [links, scales]
    }

    /// The cause that each scale is, with the odds that it is beyond what it is known to, nats. The other values are as unsure as
    /// the twin is said to be.
    pub fn beyond(&self, coverage: f64) -> Option<Vec<(Candidate, f64)>> {
        let effect = find(SCALE)?;
        let [_, scales] = self.off(1.0);
        let at = |(j, off): (usize, &Off)| {
            (Candidate::new(effect, Place::Joint(j)), ln_odds_beyond(off, coverage))
        };
        Some(scales.iter().enumerate().map(at).collect())
    }
}

/// Logarithm of the odds that the recordings place a value beyond what it is known to, given all others within theirs. What is
/// said of the value itself, which is in question, is taken out: a product of normal densities, divided by one of them.
fn ln_odds_beyond(off: &Off, coverage: f64) -> f64 {
    let Off { value, sd, limit } = off;
    let told = sd.powi(-2) - limit.powi(-2);
    if told.is_nan() || told <= 0.0 {
        return 0.0;
    }
    let alone = value.abs() * sd.powi(-2) / told;
    let further = (alone - coverage * limit) * told.sqrt();
    let [beyond, within] = [-further, further].map(|z| Normal::standard().sf(z));
    (beyond / within.max(f64::MIN_POSITIVE)).ln()
}

/// Odds that `cause` is beyond what the twin says beside these causes, nats; `None` where the twin says nothing of it within
/// limits.
pub fn odds_beyond(without: &Fit<'_>, cause: Candidate, coverage: f64) -> Option<f64> {
    let all = cause.scaled().and_then(|_| Stated::new(without))?.beyond(coverage)?;
    all.into_iter().find(|(c, _)| *c == cause).map(|(_, odds)| odds)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: f64 = 0.05;

    /// Odds by a measurement of a value, combined with what is said of it.
    fn odds(measured: f64, sd: f64) -> f64 {
        let all = sd.powi(-2) + LIMIT.powi(-2);
        let off = Off { value: measured * sd.powi(-2) / all, sd: all.powf(-0.5), limit: LIMIT };
        ln_odds_beyond(&off, 2.0)
    }

    /// They are those of the measurement alone: even at the bound, 0.97725 to 0.02275 two deviations further.
    #[test]
    fn what_is_said_of_a_value_is_taken_out() {
        for sd in [0.01, 0.03, 0.2] {
            assert!(odds(2.0 * LIMIT, sd).abs() < 1e-6);
            for sign in [-1.0, 1.0] {
                let further = odds(sign * (2.0 * LIMIT + 2.0 * sd), sd);
                assert!((further - 3.7601).abs() < 1e-3, "{further}");
            }
        }
        assert_eq!(ln_odds_beyond(&Off { value: 0.0, sd: LIMIT, limit: LIMIT }, 2.0), 0.0);
    }
}
