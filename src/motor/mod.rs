//! The paper's first case study: a DC motor whose ten parameters are identified with its
//! simulation in the loop (section 3.1 and 4.1, Tables III and IV).

mod consumer;
pub mod dependence;
pub mod dormand_prince;
pub mod error;
pub mod experiment;
pub mod fit;
pub mod inference;
pub mod input;
pub mod model;
pub mod output_error;
pub mod paper;
pub mod posterior;
pub mod render;
pub mod report;
pub mod scenario;
pub mod sensitivity;
pub mod series;
pub mod simulate;
pub mod sliding;
mod squares;
pub mod study;
pub mod study_text;

pub use error::MotorError;
pub use model::Motor;

#[cfg(test)]
mod identification_tests;
#[cfg(test)]
mod tests;
