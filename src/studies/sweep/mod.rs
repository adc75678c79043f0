//! Studies over a grid: signal-to-noise ratio, seeds, effects, strengths, motions, methods.
//!
//! A [`Study`] is a file. Its grids are numbered through, [`Cell`] after cell, and what a cell comes
//! to is a pure function of the file and the cell's number: alone, beside others, on any machine.
//! Cells that share a motion lie together in a block, which is simulated once and seen through the
//! sensors once per cell. Every finished cell is a Parquet file of its own in a [`Store`]; when all
//! are there they are joined to one table, drawn and summed up in words. What depends on the
//! machine (seconds, bytes) stands in a table of its own.

mod alone;
mod arm;
mod cost;
mod diagnosis;
mod grid;
mod identification;
mod motor;
mod parquet_file;
mod run;
mod stopwatch;
mod store;
mod study;
mod summary;
mod table;

pub use alone::{Part, Spent, cell};
pub use grid::{Cell, Method, Snr, System};
pub use run::{Alone, Ran, run};
pub use store::{Shard, Store, merge, tables};
pub use study::{Question, Study};
pub use summary::{Page, summarise};
pub use table::{Row, Table, Value};
