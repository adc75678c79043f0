//! Tables and pages a person reads.

pub mod diagnosis;
pub mod html;
mod markdown;
mod paragraph;
mod table;
mod width;

pub use markdown::markdown_table;
pub use paragraph::paragraph;
pub use table::table;
pub use width::{broken, width};

pub use crate::numbers::to_uncertainty;
