//! Columns over the rows of all joints, and as a model with random effects sees them.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock};

use rustc_hash::FxHashMap;

use super::Blocks;
use super::random_effects::{Features, JointMetric, Metric};

/// A column, its products with the random effects' features (D'x, joint by joint) and with older
/// columns, each worked out when first asked for.
#[derive(Debug, Clone)]
pub struct Raw {
    pub rows: Arc<Blocks>,
    features: Arc<Vec<Features>>,
    products: Arc<Vec<OnceLock<Vec<f64>>>>,
    /// What the random effects of a metric take up of it, for the metrics seen last: joint, sizes and values.
    taken: Arc<Mutex<VecDeque<Taken>>>,
    /// The larger, the younger.
    age: u64,
    dots: Arc<Mutex<FxHashMap<u64, Arc<[f64]>>>>,
}

/// What a joint's random effects take up of a column.
#[derive(Debug)]
struct Taken {
    joint: usize,
    metric: Arc<JointMetric>,
    values: Arc<Vec<f64>>,
}

/// Metrics of each joint for which this is kept: a search goes back and forth between a few.
const METRICS: usize = 4;

impl Raw {
    pub fn new(rows: Blocks, features: Arc<Vec<Features>>) -> Self {
        static BORN: AtomicU64 = AtomicU64::new(0);
        let products = Arc::new((0..features.len()).map(|_| OnceLock::new()).collect());
        let age = BORN.fetch_add(1, Ordering::Relaxed);
        let (taken, dots) = (Arc::default(), Arc::default());
        Self { rows: Arc::new(rows), features, products, taken, age, dots }
    }

    /// x'y at every joint.
    pub fn dots(&self, other: &Self) -> Arc<[f64]> {
        if other.age > self.age {
            return other.dots(self);
        }
        if let Some(dots) = self.dots.lock().ok().and_then(|d| d.get(&other.age).cloned()) {
            return dots;
        }
        let joints = 0..self.rows.0.len();
        let dots: Arc<[f64]> = joints.map(|j| self.rows.dot(&other.rows, j)).collect();
        if let Ok(mut known) = self.dots.lock() {
            known.insert(other.age, dots.clone());
        }
        dots
    }

    /// D'x at a joint; empty where the column has no rows there.
    pub fn products(&self, j: usize) -> &[f64] {
        self.products[j].get_or_init(|| match self.rows.touches(j) {
            true => self.features[j].products(&[self.rows.joint(j)]).swap_remove(0),
            false => Vec::new(),
        })
    }

    /// Works out D'x of several columns together, at the joints that are `asked` for.
    pub fn meet(columns: &[&Self], asked: impl Fn(usize) -> bool) {
        let joints = columns.first().map_or(0, |c| c.features.len());
        for j in (0..joints).filter(|j| asked(*j)) {
            let is_open = |c: &&Self| c.rows.touches(j) && c.products[j].get().is_none();
            let open: Vec<&Self> = columns.iter().copied().filter(is_open).collect();
            let Some(first) = open.first() else { continue };
            let rows: Vec<&[f64]> = open.iter().map(|c| c.rows.joint(j)).collect();
            for (column, products) in open.iter().zip(first.features[j].products(&rows)) {
                // Another thread may have been faster, with the same.
                let _ = column.products[j].set(products);
            }
        }
    }

    /// What the random effects of a joint's metric take up of it.
    fn taken(&self, j: usize, metric: &Arc<JointMetric>) -> Arc<Vec<f64>> {
        if metric.is_plain() || !self.rows.touches(j) {
            return Arc::default();
        }
        let work_out = || Arc::new(metric.taken(self.products(j)));
        let Ok(mut all) = self.taken.lock() else { return work_out() };
        let same = |t: &&Taken| t.joint == j && Arc::ptr_eq(&t.metric, metric);
        if let Some(known) = all.iter().find(same) {
            return known.values.clone();
        }
        let values = work_out();
        all.truncate(METRICS * self.features.len() - 1);
        all.push_front(Taken { joint: j, metric: metric.clone(), values: values.clone() });
        values
    }

    /// self less `x` of each column, where self has rows.
    pub fn less_sum(&self, x: &[f64], columns: &[Self]) -> Self {
        let mut rows = (*self.rows).clone();
        x.iter().zip(columns).for_each(|(x, column)| rows.add_scaled(-x, &column.rows));
        Self::new(rows, self.features.clone())
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
    taken: Vec<Arc<Vec<f64>>>,
    /// Where it is still what it was made of.
    raw: Option<Raw>,
}

impl Column {
    pub fn new(raw: &Raw, metric: &Metric) -> Self {
        let of = |(j, metric): (usize, &Arc<JointMetric>)| raw.taken(j, metric);
        let taken = metric.joints.iter().enumerate().map(of).collect();
        Self { rows: raw.rows.clone(), taken, raw: Some(raw.clone()) }
    }

    /// Several in one metric.
    pub fn all(raw: &[Raw], metric: &Metric) -> Vec<Self> {
        let columns: Vec<&Raw> = raw.iter().collect();
        Raw::meet(&columns, |j| !metric.joints[j].is_plain());
        raw.iter().map(|raw| Self::new(raw, metric)).collect()
    }

    /// Nothing at any of the joints.
    pub fn zeros(joints: usize) -> Self {
        let none = Blocks(vec![Vec::new(); joints]);
        Self { rows: Arc::new(none), taken: vec![Arc::default(); joints], raw: None }
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
        self.raw = None;
        Arc::make_mut(&mut self.rows).gather(factor, &other.rows);
        self.taken.resize(other.taken.len(), Arc::default());
        for (mine, theirs) in self.taken.iter_mut().zip(&other.taken).filter(|(_, t)| !t.is_empty())
        {
            let mine = Arc::make_mut(mine);
            mine.resize(theirs.len(), 0.0);
            crate::kernels::axpy(factor, theirs, mine);
        }
    }

    /// self += factor x other, where self has rows.
    pub fn add_scaled(&mut self, factor: f64, other: &Self) {
        self.raw = None;
        Arc::make_mut(&mut self.rows).add_scaled(factor, &other.rows);
        for (mine, theirs) in self.taken.iter_mut().zip(&other.taken) {
            if mine.len() == theirs.len() {
                crate::kernels::axpy(factor, theirs, Arc::make_mut(mine).as_mut_slice());
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
    let each = weights.iter().enumerate();
    match (&a.raw, &b.raw) {
        (Some(x), Some(y)) => {
            let dots = x.dots(y);
            each.map(|(j, w)| w * (dots[j] - a.taken_dot(b, j))).sum()
        }
        _ => each.map(|(j, w)| w * a.dot(b, j)).sum(),
    }
}
