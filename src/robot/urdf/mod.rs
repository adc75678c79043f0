//! URDF text <-> [`Robot`](super::Robot).

mod carried;
mod chain;
mod elements;
mod file;
mod inertia;
mod limits;
mod markup;
mod notes;
mod read;
#[cfg(test)]
mod tests;
mod tip;
mod tree;
pub mod visual;
mod write;
mod xml;

pub use chain::Chain;
pub use read::{Loaded, read, read_file};
pub use write::{Additions, inertial, stand, write, write_with};
