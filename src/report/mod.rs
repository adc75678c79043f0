//! Tables and pages a person reads.

pub mod diagnosis;
#[cfg(feature = "report")]
pub mod html;
mod markdown;
mod paragraph;
mod rounded;
mod table;

pub use markdown::markdown_table;
pub use paragraph::paragraph;
pub use rounded::to_uncertainty;
pub use table::table;

/// What is being said, and what is said of it.
pub type Fact = (String, String);
