//! Reports as one HTML file each: no network, readable on a phone, on paper and without JavaScript.

mod bars;
mod diagnosis;
mod frame;
mod history;
mod identification;
#[cfg(feature = "studies")]
mod motor;
mod plot;
mod scale;
#[cfg(feature = "studies")]
mod study;
mod table;
#[cfg(all(test, feature = "studies"))]
mod tests;

pub use diagnosis::{DiagnosisReport, diagnosis_report};
pub use frame::{Fact, Page, Section};
pub use history::{HistoryReport, history_report};
pub use identification::{IdentificationReport, JointCurves, identification_report};
#[cfg(feature = "studies")]
pub use motor::motor_report;
#[cfg(feature = "studies")]
pub use study::study_report;
