//! The paper's first case study: a DC motor whose ten parameters are identified with its
//! simulation in the loop (section 3.1 and 4.1, Tables III and IV).

pub mod dormand_prince;
pub mod model;
pub mod sensitivity;
pub mod simulate;

pub use model::Motor;

#[cfg(test)]
mod tests;
