//! Tables and files a person or a program reads.

mod paragraph;
mod table;

pub use paragraph::paragraph;
pub use table::table;
