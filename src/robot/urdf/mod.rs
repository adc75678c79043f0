//! URDF text <-> [`Robot`](super::Robot).

mod check;
mod locate;
mod read;
#[cfg(test)]
mod tests;
pub mod visual;
mod write;

pub use read::{read, read_file};
pub use write::{Additions, write, write_with};
