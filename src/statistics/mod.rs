//! Covariances, tests and intervals; no I/O, no randomness of its own.
//!
//! The entry point is [`infer`]: estimates, the Jacobian of the prediction, the residual and when
//! each row was taken -> three conventions side by side. The robust one is the one to believe.

mod autocorrelation;
mod autoregression;
mod bootstrap;
mod convergence;
mod design;
mod error;
mod goodness;
mod inference;
mod kernel;
mod long_run;
mod noise;
mod repeats;
mod tail;
mod toeplitz;
mod whitening;

pub use autocorrelation::{LjungBox, autocorrelation, effective_samples, ljung_box};
pub use autoregression::{Autoregression, contiguous};
pub use bootstrap::{block_bootstrap, block_length};
pub use convergence::Convergence;
pub use design::{Design, Direction};
pub use error::StatisticsError;
pub use goodness::Goodness;
pub use inference::{Inference, Inferences, infer};
pub use kernel::{Bandwidth, Kernel, long_run_covariance};
pub use long_run::{LongRun, cosine_covariance, model_covariance};
pub use noise::{noise_from_differences, noise_from_periodogram};
pub use repeats::{Cycle, design_effect, pairs};
pub use tail::{PValue, normal_quantile, normal_two_sided, student_quantile, student_two_sided};
pub use whitening::Whitening;

#[cfg(test)]
mod tests;
