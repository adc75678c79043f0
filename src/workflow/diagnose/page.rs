//! A diagnosis as a report with pictures.

use super::Diagnosed;
use crate::report::html::{DiagnosisReport, diagnosis_report};

impl Diagnosed {
    /// One HTML file for any browser.
    pub fn html(&self) -> String {
        // Plain tables of numbers, strings and lists: nothing TOML cannot hold.
        let settings = toml::to_string(&self.settings).unwrap_or_default();
        let conditioning = toml::to_string(&self.fit.samples.conditioning).unwrap_or_default();
        let mut facts = self.facts();
        facts.push(("seed".into(), self.settings.seed.to_string()));
        facts
            .push(("armtwin".into(), format!("{}, {:.1} s", self.diagnosis.armtwin, self.seconds)));
        diagnosis_report(&DiagnosisReport {
            diagnosis: &self.diagnosis,
            traces: &self.traces,
            facts: &facts,
            files: &[
                ("The mended twin (twin.toml)", self.mended.to_toml()),
                ("The twin as given", self.twin.to_toml()),
                ("Settings of the search", settings),
                ("Conditioning of the recordings", conditioning),
            ],
        })
    }
}
