//! A trial as the page and its tenths see it.

use super::Judged;

/// One trial of the page.
#[derive(Debug, Clone)]
pub struct Chapter {
    pub title: String,
    /// How the cases were made.
    pub made: String,
    pub cases: Vec<Judged>,
}
