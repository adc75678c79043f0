//! Which parameters make the twin's torque match the recorded one, and how sure that is.

pub mod adaptive_metropolis;
mod arm;
mod arm_problem;
mod assemble;
pub mod chebyshev;
mod coordinates;
mod error;
mod fitted;
mod inertia;
mod judge;
pub mod levenberg_marquardt;
mod links;
mod located;
mod payload;
mod posterior;
mod prepared;
pub mod problem;
pub mod pso;
pub mod quadratic;
mod reduce;
mod regressors;
pub mod separable;
mod settings;
mod settle;
mod shared;
mod tables;
mod terms;
#[doc(hidden)]
pub mod testing;
mod torque_scale;
mod verdict;

use serde::Serialize;

pub use arm::{identify, identify_watched};
pub use arm_problem::{ArmProblem, BoundsByName};
pub use assemble::{assemble, assemble_around};
pub use error::IdentificationError;
pub use fitted::fitted_twin;
pub use inertia::Inertial;
pub use judge::LEVEL;
pub use links::{LinkFit, RigidBody};
pub use located::Located;
pub use payload::payload_beside_links;
pub use posterior::Posterior;
pub use reduce::{Dropped, reduce};
pub use settings::{Method, Search, Settings};
pub use settle::settle;
pub use terms::{BESIDE, PAPER_LAW, Terms};
pub use torque_scale::{Gain, Load, TorqueScale, torque_scale};
pub use verdict::{Standing, standing, verdict};

/// What one method found, all joints.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodResult {
    /// `pso`, `nlse`, `mcmc`
    pub method: String,
    pub joints: Vec<JointEstimate>,
    /// Parameters of the whole arm (payload).
    pub arm: Vec<ParameterEstimate>,
    /// What was searched for, as found: what a twin is written from.
    #[serde(skip)]
    pub found: Found,
}

/// Parameter values in the order of the problems.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Found {
    pub joints: Vec<Vec<f64>>,
    pub shared: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointEstimate {
    /// From 1 at the base.
    pub joint: usize,
    /// Used for the fit, after masking and decimation.
    pub samples: usize,
    /// Root mean square residual, N.m (the paper's Eq. 5).
    pub cost: f64,
    pub evaluations: usize,
    pub seconds: f64,
    /// `converged`, `iterations`, ...
    pub stopped: String,
    pub fit: Goodness,
    pub check: Option<Goodness>,
    pub parameters: Vec<ParameterEstimate>,
}

/// How well predicted torque matches measured torque on the samples used.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Goodness {
    /// 1 - SSE/SST
    pub r2: f64,
    /// The paper's Eq. 20, sum (yhat - ybar)^2 / sum (y - ybar)^2: can exceed 1.
    pub r2_printed: f64,
    pub mse_nm2: f64,
}

/// `low`, `high`, `statistic` and `p` are the autocorrelation-robust ones; the other conventions
/// stand beside them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterEstimate {
    pub name: String,
    pub unit: String,
    pub value: f64,
    pub low: f64,
    pub high: f64,
    pub statistic: f64,
    pub p: f64,
    pub asymptotic: Interval,
    pub paper: Interval,
    pub bounds: [f64; 2],
    pub at_bound: bool,
    /// False where these data do not determine the parameter; then `why_not` says what is missing.
    pub identifiable: bool,
    pub why_not: Option<String>,
    /// Posterior by `mcmc`: then `value` is its mean, `low` and `high` its 99 % interval.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub posterior: Option<Posterior>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    pub low: f64,
    pub high: f64,
    pub statistic: f64,
    pub p: f64,
}
