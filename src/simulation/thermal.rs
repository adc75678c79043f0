//! Joint temperatures: each joint a single heat capacity warmed by its own friction,
//!
//! ```text
//! tau_w dT/dt = ambient - T + R P,     P = dry |qd| + damping qd^2
//! ```

use crate::effects::JointLoad;

/// The `[thermal]` table of a scenario.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Thermal {
    /// deg C
    pub ambient_c: f64,
    /// Temperature of every joint to begin with, deg C.
    pub start_c: f64,
    /// R, steady rise per W of friction heat, K/W.
    pub rise_k_per_w: f64,
    /// tau_w, s
    pub time_constant_s: f64,
}

impl Default for Thermal {
    fn default() -> Self {
        Self { ambient_c: 25.0, start_c: 25.0, rise_k_per_w: 1.0, time_constant_s: 1200.0 }
    }
}

impl Thermal {
    pub(super) fn check(&self) -> Result<(), String> {
        let must = |key, value: f64, low: f64, high: f64| match (low..=high).contains(&value) {
            true => Ok(()),
            false => Err(format!("thermal.{key} = {value}: give {low} to {high}")),
        };
        must("ambient_c", self.ambient_c, -50.0, 150.0)?;
        must("start_c", self.start_c, -50.0, 150.0)?;
        must("rise_k_per_w", self.rise_k_per_w, 0.0, 100.0)?;
        must("time_constant_s", self.time_constant_s, 1.0, 1e6)
    }

    /// Temperatures `step_s` later.
    pub(super) fn advance(&self, t: &mut [f64], loads: &[JointLoad], qd: &[f64], step_s: f64) {
        for ((t, load), qd) in t.iter_mut().zip(loads).zip(qd) {
            let power = load.dry.max(0.0) * qd.abs() + load.damping * qd * qd;
            let steady = self.ambient_c + self.rise_k_per_w * power;
            *t += step_s / self.time_constant_s * (steady - *t);
        }
    }
}
