//! Columns over the rows of all joints.

use crate::kernels;

/// One value per row used, joint by joint; a joint without any is zero throughout.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Blocks(pub Vec<Vec<f64>>);

impl Blocks {
    pub fn joint(&self, j: usize) -> &[f64] {
        &self.0[j]
    }

    pub fn touches(&self, j: usize) -> bool {
        !self.0[j].is_empty()
    }

    /// Product over the rows of one joint.
    pub fn dot(&self, other: &Self, j: usize) -> f64 {
        match self.touches(j) && other.touches(j) {
            true => kernels::dot(&self.0[j], &other.0[j]),
            false => 0.0,
        }
    }

    /// self += factor x other, where self has rows.
    pub fn add_scaled(&mut self, factor: f64, other: &Self) {
        for (mine, theirs) in self.0.iter_mut().zip(&other.0).filter(|(_, t)| !t.is_empty()) {
            kernels::axpy(factor, theirs, mine);
        }
    }

    /// self += factor x other, where other has rows.
    pub fn gather(&mut self, factor: f64, other: &Self) {
        for (mine, theirs) in self.0.iter_mut().zip(&other.0).filter(|(_, t)| !t.is_empty()) {
            mine.resize(theirs.len(), 0.0);
            kernels::axpy(factor, theirs, mine);
        }
    }

    /// Sum of squares, joint by joint.
    pub fn squares(&self) -> Vec<f64> {
        self.0.iter().map(|rows| kernels::dot(rows, rows)).collect()
    }
}
