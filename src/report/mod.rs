//! Tables and files a person or a program reads.

mod markdown;
mod paragraph;
mod table;

pub use markdown::markdown_table;
pub use paragraph::paragraph;
pub use table::table;
