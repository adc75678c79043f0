//! Reports as one HTML file each: no network, readable on a phone, on paper and without JavaScript.

mod diagnosis;
mod frame;
mod gap_chart;
mod plot;
mod table;

pub use diagnosis::{DiagnosisReport, diagnosis_report};
pub use frame::{Fact, Page, Section};
