//! Columns over the rows of all joints, and as a model with random effects sees them.

use std::sync::{Arc, OnceLock};

use super::Blocks;
use super::random_effects::{Features, JointMetric, Metric};

/// A column, and its products with the random effects' features: D'x, joint by joint, worked out
/// where a metric asks for them.
#[derive(Debug, Clone)]
pub struct Raw {
    pub rows: Arc<Blocks>,
    features: Arc<Vec<Features>>,
    products: Arc<Vec<OnceLock<Vec<f64>>>>,
}

impl Raw {
    pub fn new(rows: Blocks, features: Arc<Vec<Features>>) -> Self {
        let products = Arc::new((0..features.len()).map(|_| OnceLock::new()).collect());
        Self { rows: Arc::new(rows), features, products }
    }

    /// D'x at a joint; empty where the column has no rows there.
    pub fn products(&self, j: usize) -> &[f64] {
        self.products[j].get_or_init(|| match self.rows.touches(j) {
            true => self.features[j].products(self.rows.joint(j)),
            false => Vec::new(),
        })
    }

    /// scale x (self - other), where self has rows.
    pub fn less(&self, other: &Self, scale: f64) -> Self {
        let joint = |(a, b): (&Vec<f64>, &Vec<f64>)| {
            a.iter().zip(b).map(|(a, b)| scale * (a - b)).collect()
        };
        let rows = self.rows.0.iter().zip(&other.rows.0).map(joint).collect();
        Self::new(Blocks(rows), self.features.clone())
    }
}

/// A column in a metric: inner products are x'y less those of what the random effects take up,
/// x'(1 + D R D')^-1 y.
#[derive(Debug, Clone, Default)]
pub struct Column {
    pub rows: Arc<Blocks>,
    taken: Vec<Vec<f64>>,
}

impl Column {
    pub fn new(raw: &Raw, metric: &Metric) -> Self {
        let of = |(j, metric): (usize, &Arc<JointMetric>)| match metric.is_plain() {
            true => Vec::new(),
            false => metric.taken(raw.products(j)),
        };
        Self { rows: raw.rows.clone(), taken: metric.joints.iter().enumerate().map(of).collect() }
    }

    /// Nothing at any of the joints.
    pub fn zeros(joints: usize) -> Self {
        let none = vec![Vec::new(); joints];
        Self { rows: Arc::new(Blocks(none.clone())), taken: none }
    }

    pub fn touches(&self, j: usize) -> bool {
        self.rows.touches(j)
    }

    /// Product at one joint.
    pub fn dot(&self, other: &Self, j: usize) -> f64 {
        match self.touches(j) && other.touches(j) {
            true => self.rows.dot(&other.rows, j) - self.taken_dot(other, j),
            false => 0.0,
        }
    }

    /// What the random effects take up of it at a joint.
    pub fn taken(&self, j: usize) -> &[f64] {
        &self.taken[j]
    }

    /// What the random effects take of the product at a joint.
    pub(super) fn taken_dot(&self, other: &Self, j: usize) -> f64 {
        crate::kernels::dot(&self.taken[j], &other.taken[j])
    }

    /// self += factor x other, where other has rows.
    pub fn gather(&mut self, factor: f64, other: &Self) {
        Arc::make_mut(&mut self.rows).gather(factor, &other.rows);
        self.taken.resize(other.taken.len(), Vec::new());
        for (mine, theirs) in self.taken.iter_mut().zip(&other.taken).filter(|(_, t)| !t.is_empty())
        {
            mine.resize(theirs.len(), 0.0);
            crate::kernels::axpy(factor, theirs, mine);
        }
    }

    /// self += factor x other, where self has rows.
    pub fn add_scaled(&mut self, factor: f64, other: &Self) {
        Arc::make_mut(&mut self.rows).add_scaled(factor, &other.rows);
        for (mine, theirs) in self.taken.iter_mut().zip(&other.taken) {
            if mine.len() == theirs.len() {
                crate::kernels::axpy(factor, theirs, mine);
            }
        }
    }

    /// Sum of squares in the metric, joint by joint.
    pub fn squares(&self) -> Vec<f64> {
        (0..self.rows.0.len()).map(|j| self.dot(self, j)).collect()
    }
}

/// Products weighted joint by joint.
pub fn weighted_dot(a: &Column, b: &Column, weights: &[f64]) -> f64 {
    weights.iter().enumerate().map(|(j, w)| w * a.dot(b, j)).sum()
}
