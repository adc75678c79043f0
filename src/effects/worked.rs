//! One number of an effect worked out by hand: a law that both injects and explains would pass every
//! round trip even when it is wrong.

use super::{Channels, Effect, Mechanism, complete};

/// The number, how it was worked out, and what of the effect it is held against.
#[derive(Debug, Clone)]
pub struct Worked {
    /// The arithmetic, for people; it ends where `= 5 N.m` follows.
    pub by_hand: &'static str,
    pub result: f64,
    pub unit: &'static str,
    /// By name; what is left out is absent, or follows.
    pub values: Vec<(&'static str, f64)>,
    pub of: Shown,
    /// Relative error of the arithmetic, where it is not exact.
    pub within: f64,
}

/// What a number worked out by hand is held against.
#[derive(Debug, Clone)]
pub enum Shown {
    /// Torque of a pendulum at the end of a motion: q, qd, qdd in a row every 20 ms. It weighs 3 kg at 0.4 m,
    /// lies level at q = 0, has its flange at 0.5 m, and its joint is at 45 deg C.
    Pendulum(Vec<[f64; 3]>),
    /// Torque of a joint whose inner and outer neighbours turn at these speeds, rad/s.
    Between([f64; 2]),
    /// A channel half a second into the ramp qd = 3 t, torque = 2 t.
    Ramp(fn(&Channels) -> &[f64]),
    /// What of a mechanism of one joint it changes.
    Mechanism(fn(&Mechanism) -> f64),
}

impl Worked {
    /// Torque of the pendulum at one instant.
    pub fn torque(
        by_hand: &'static str,
        result: f64,
        values: &[(&'static str, f64)],
        at: [f64; 3],
    ) -> Self {
        Self::along(by_hand, result, values, vec![at])
    }

    /// Torque of the pendulum at the end of a motion.
    pub fn along(
        by_hand: &'static str,
        result: f64,
        values: &[(&'static str, f64)],
        rows: Vec<[f64; 3]>,
    ) -> Self {
        Self::of(by_hand, (result, "N.m"), values, Shown::Pendulum(rows))
    }

    pub fn of(
        by_hand: &'static str,
        (result, unit): (f64, &'static str),
        values: &[(&'static str, f64)],
        of: Shown,
    ) -> Self {
        Self { by_hand, result, unit, values: values.to_vec(), of, within: 1e-6 }
    }

    /// In the order of the effect's parameters.
    pub fn values_of(&self, effect: &dyn Effect) -> Vec<f64> {
        let absent = |name: &str| {
            let p = effect.about().parameters.iter().find(|p| p.name == name)?;
            (!p.is_reference() && !p.null.is_nan()).then_some(p.null)
        };
        let given = |name: &str| self.values.iter().find(|(n, _)| *n == name).map(|(_, v)| *v);
        complete(effect, |name| given(name).or_else(|| absent(name))).unwrap_or_default()
    }
}
