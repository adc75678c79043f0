//! Flags that set how a recording is conditioned, for every command that takes one.

use crate::signals::Derivatives;
use crate::workflow::SignalOptions;

/// What is not given stays as [`Conditioning::default`](crate::signals::Conditioning) has it.
#[derive(clap::Args, Default)]
#[command(next_help_heading = "Signals")]
pub struct ConditioningArgs {
    /// Resample to this rate [default: the recording's own]
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// Where velocity and acceleration come from [default: position; for `diagnose` tracking-error where a
    /// command is recorded]
    #[arg(long, value_enum)]
    derivatives: Option<Source>,
    /// Zero-phase low-pass of the motion, 0 for none [default: 20]
    #[arg(long, value_name = "HZ")]
    motion_cutoff: Option<f64>,
    /// Zero-phase low-pass of torque and of what is fitted to it, 0 for none [default: 8]
    #[arg(long, value_name = "HZ")]
    torque_cutoff: Option<f64>,
    /// Butterworth order of both filters [default: 4]
    #[arg(long, value_name = "N")]
    filter_order: Option<usize>,
    /// Leave out samples at or below this speed, 0 keeps all [default: 0.02]
    #[arg(long, value_name = "RAD_S")]
    standstill: Option<f64>,
    /// Leave out samples nearer than this to a standstill [default: 0.1]
    #[arg(long, value_name = "S")]
    guard: Option<f64>,
    /// Leave out this much at both ends of the recording [default: 0.5]
    #[arg(long, value_name = "S")]
    margin: Option<f64>,
    /// Keep every N-th sample [default: follows from the torque cutoff]
    #[arg(long, value_name = "N")]
    decimate: Option<usize>,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Source {
    /// Central differences of the low-passed measured position (default)
    Position,
    /// Commanded motion plus the smoothed tracking error
    TrackingError,
    /// Recorded velocity, low-passed
    Recorded,
    /// As in the paper: recorded velocity, forward and backward differences, no filter
    Paper,
}

impl ConditioningArgs {
    /// The least rate of a recording that what was given can do with, Hz.
    pub fn floor_hz(&self) -> f64 {
        self.options().floor_hz()
    }

    pub fn options(&self) -> SignalOptions {
        SignalOptions {
            rate_hz: self.rate,
            derivatives: self.derivatives.map(Source::derivatives),
            motion_cutoff_hz: self.motion_cutoff,
            torque_cutoff_hz: self.torque_cutoff,
            filter_order: self.filter_order,
            standstill_rad_s: self.standstill,
            guard_s: self.guard,
            margin_s: self.margin,
            decimation: self.decimate,
        }
    }
}

impl Source {
    fn derivatives(self) -> Derivatives {
        match self {
            Self::Position => Derivatives::Position,
            Self::TrackingError => Derivatives::TrackingError,
            Self::Recorded => Derivatives::Recorded,
            Self::Paper => Derivatives::Paper,
        }
    }
}
