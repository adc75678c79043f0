//! What can go wrong between samples and estimates.

use thiserror::Error;

use crate::follow::Interrupted;
use crate::regression::bounds::BoundsError;
use crate::signals::SignalError;
use crate::statistics::StatisticsError;

#[derive(Debug, Error)]
pub enum IdentificationError {
    #[error("the recording has {samples} joints but the twin's robot has {robot}")]
    Joints { samples: usize, robot: usize },
    #[error("no term `{name}`; there are {known}")]
    UnknownTerm { name: String, known: String },
    #[error(
        "`{effect}` needs its nonlinear parameter `{parameter}`: give all of its nonlinear parameters \
         in the twin's [values], or none of them and let `armtwin identify` search for them"
    )]
    Nonlinear { effect: String, parameter: String },
    #[error(
        "`{effect}` has no torque of its own that could be fitted; give its values in the twin's \
         [values] or leave the term out"
    )]
    Unseen { effect: String },
    #[error("there is nothing to fit: name terms with --terms")]
    NoTerms,
    #[error("no parameter `{name}` is fitted, so it has no bounds to set; there are {known}")]
    UnknownBound { name: String, known: String },
    #[error(
        "no joint slides: no usable sample is faster than {threshold} rad/s; record a motion, or \
         lower --standstill"
    )]
    NothingSlides { threshold: f64 },
    #[error(
        "mcmc takes one joint at a time and cannot fit {names}, which all joints share: leave them \
         out, give their values in the twin, or take --method nlse"
    )]
    SharedPosterior { names: String },
    #[error("a link of the twin's robot has no mass: correct it in the URDF")]
    NoMass,
    #[error(transparent)]
    Bounds(#[from] BoundsError),
    #[error(transparent)]
    Signals(#[from] SignalError),
    #[error(transparent)]
    Statistics(#[from] StatisticsError),
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}
