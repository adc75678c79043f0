//! One aspect of a study of identification: what goes in and what comes out.

use super::seen::Seen;
use crate::figure::Panel;

/// One system's rows.
pub struct Part<'a> {
    pub rows: Vec<&'a Seen>,
    /// Rows that no sensor rounded, where the others are rounded.
    pub exact: Vec<&'a Seen>,
    /// Signal-to-noise ratios, rising, dB; infinite is no noise.
    pub snrs: Vec<f64>,
    pub methods: Vec<&'a str>,
}

impl<'a> Part<'a> {
    /// The method whose errors and tests stand in the tables.
    pub fn main(&self) -> &'a str {
        let nlse = self.methods.iter().find(|m| **m == "nlse");
        nlse.or(self.methods.first()).copied().unwrap_or_default()
    }

    pub fn of<'b>(&'b self, method: &'b str) -> impl Iterator<Item = &'a Seen> + 'b {
        self.rows.iter().copied().filter(move |r| r.method == method)
    }
}

/// What one aspect comes to.
pub struct Chapter {
    /// Name of the figure's file, before the system and the ending.
    pub name: &'static str,
    /// The conclusion, in words.
    pub says: String,
    /// Headline and tables.
    pub text: String,
    pub caption: String,
    /// Panels of the figure, and how many stand side by side.
    pub panels: Vec<Panel>,
    pub columns: usize,
}
