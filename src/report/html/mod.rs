//! Reports as one HTML file each: no network, readable on a phone, on paper and without JavaScript.

mod bars;
mod diagnosis;
mod frame;
mod history;
mod identification;
mod motor;
mod plot;
mod scale;
mod study;
mod table;
#[cfg(test)]
mod tests;

pub use diagnosis::{DiagnosisReport, diagnosis_report};
pub use frame::{Fact, Page, Section};
pub use history::{HistoryReport, history_report};
pub use identification::{IdentificationReport, JointCurves, identification_report};
pub use motor::motor_report;
pub use study::study_report;
