//! Pages a person reads, and what they have in common with the terminal.

pub mod diagnosis;
#[cfg(feature = "report")]
pub mod html;

pub use crate::text::{broken, markdown_table, paragraph, table, to_uncertainty, width};

/// What is being said, and what is said of it.
pub type Fact = (String, String);
