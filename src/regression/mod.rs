//! Least squares over the rows of recordings: columns, bounds, solvers. Knows no effect's name.

mod blocks;
pub mod bounded;
pub mod bounds;
pub mod brent;
mod column;
mod equations;
pub mod qr;
pub mod random_effects;
mod system;

pub use blocks::Blocks;
pub use column::{Column, Raw, weighted_dot};
pub use equations::{Equations, Solved};
pub use system::{Normal, Projected, System};
