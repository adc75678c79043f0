//! Words, numbers and tables as text: what every room may print with.

mod markdown;
mod paragraph;
mod rounded;
mod table;
mod titled;

pub use markdown::markdown_table;
pub use paragraph::paragraph;
pub use rounded::to_uncertainty;
pub use table::table;
pub use titled::titled;
