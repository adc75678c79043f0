//! Tables and files a person or a program reads.

mod table;

pub use table::table;
