//! Pages a person reads, and what they have in common with the terminal.

pub mod diagnosis;
pub mod html;

pub use crate::text::{broken, markdown_table, paragraph, table, to_uncertainty, width};
