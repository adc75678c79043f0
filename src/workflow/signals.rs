//! How a recording is conditioned, where its owner says.

use crate::signals::{Conditioning, Derivatives};

/// What is `None` stays as the job usually has it: [`Conditioning::default`], or what suits the
/// recordings of a diagnosis ([`conditioning`](crate::diagnosis::conditioning)). Units as there.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SignalOptions {
    pub rate_hz: Option<f64>,
    pub derivatives: Option<Derivatives>,
    pub motion_cutoff_hz: Option<f64>,
    pub torque_cutoff_hz: Option<f64>,
    pub filter_order: Option<usize>,
    pub standstill_rad_s: Option<f64>,
    pub guard_s: Option<f64>,
    pub margin_s: Option<f64>,
    pub decimation: Option<usize>,
}

impl SignalOptions {
    /// `usual` with what was given written over it.
    pub fn over(&self, usual: Conditioning) -> Conditioning {
        Conditioning {
            rate_hz: self.rate_hz.or(usual.rate_hz),
            derivatives: self.derivatives.unwrap_or(usual.derivatives),
            motion_cutoff_hz: self.motion_cutoff_hz.unwrap_or(usual.motion_cutoff_hz),
            torque_cutoff_hz: self.torque_cutoff_hz.unwrap_or(usual.torque_cutoff_hz),
            filter_order: self.filter_order.unwrap_or(usual.filter_order),
            standstill_rad_s: self.standstill_rad_s.unwrap_or(usual.standstill_rad_s),
            guard_s: self.guard_s.unwrap_or(usual.guard_s),
            margin_s: self.margin_s.unwrap_or(usual.margin_s),
            decimation: self.decimation.or(usual.decimation),
            ..usual
        }
    }

    /// The least rate of a recording that what was given can do with, Hz.
    pub fn floor_hz(&self) -> f64 {
        // A low-pass wants its cutoff well below half the rate; who decimates counts recorded rows.
        let cutoffs =
            [self.motion_cutoff_hz, self.torque_cutoff_hz].map(|c| 2.5 * c.unwrap_or(0.0));
        let rates = [self.rate_hz.unwrap_or(0.0), self.decimation.map_or(0.0, |_| f64::INFINITY)];
        cutoffs.into_iter().chain(rates).fold(0.0, f64::max)
    }
}
