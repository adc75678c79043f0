//! What comes back of an effect that is simulated and then explained.

/// What is expected when `scenarios/effects/NAME.toml` is simulated in rapier and the recording explained.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RoundTrip {
    /// Fitted values lie in their intervals.
    Fitted {
        /// Times the scenario's linear values.
        strengths: [f64; 2],
        /// Low-pass of the motion, Hz: what moves a spring is fast.
        motion_cutoff_hz: f64,
        /// Parameters whose interval leaves out zero at a joint that has the effect.
        shows: &'static [&'static str],
    },
    /// What it leaves of the torque is gone once its values are known.
    Corrected {
        /// Is it in the recorded velocity, not between position and torque?
        of_velocity: bool,
    },
    /// Nothing in the torque along the motion; the joint is further off its command by this factor.
    Strays { joint: usize, times: f64 },
    /// Simulated along the command, a joint goes where it was recorded with values this close to the truth,
    /// relative.
    Followed { within: f64 },
    /// The channel of this joint lies on steps of this parameter.
    Steps { channel: &'static str, joint: usize, parameter: &'static str },
}

impl RoundTrip {
    /// At the scenario's strength and half of it these parameters show, and all lie in their intervals.
    pub const fn fitted(shows: &'static [&'static str]) -> Self {
        Self::Fitted { strengths: [1.0, 0.5], motion_cutoff_hz: 8.0, shows }
    }

    /// What is fitted of an elastic or slack joint: half of a usual elasticity hides in the noise.
    pub const fn fitted_wind_up(shows: &'static [&'static str]) -> Self {
        Self::Fitted { strengths: [1.0, 2.0], motion_cutoff_hz: 20.0, shows }
    }
}
