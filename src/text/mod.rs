//! Words, numbers and tables as text: what every room may print with.

mod markdown;
mod paragraph;
mod table;
mod titled;
mod width;

pub use crate::numbers::to_uncertainty;
pub use markdown::markdown_table;
pub use paragraph::paragraph;
pub use table::table;
pub use titled::titled;
pub use width::{broken, width};
