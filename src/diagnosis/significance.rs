//! How sure a shrink of the gap is.

use super::columns::Blocks;
use crate::statistics::{block_bootstrap, block_length};

/// Resamples.
const REPLICATIONS: usize = 200;

/// Of the mean square over `joints`, each relative to its own before: the lower end of a 90 %
/// block-bootstrap interval, and the value.
pub fn shrink(before: &Blocks, after: &Blocks, joints: &[usize], seed: u64) -> [f64; 2] {
    let mut differences = Vec::new();
    let mut levels = Vec::new();
    for &j in joints.iter().filter(|j| before.touches(**j)) {
        let level = before.dot(before, j) / before.joint(j).len() as f64;
        for (b, a) in before.joint(j).iter().zip(after.joint(j)) {
            differences.push((b * b - a * a) / level);
            levels.push(b * b / level);
        }
    }
    let n = differences.len();
    if n == 0 {
        return [0.0; 2];
    }
    let value = differences.iter().sum::<f64>() / n as f64;
    let neighbours: f64 = differences.windows(2).map(|w| (w[0] - value) * (w[1] - value)).sum();
    let power: f64 = differences.iter().map(|d| (d - value).powi(2)).sum();
    let block = block_length(if power > 0.0 { neighbours / power } else { 0.0 }, n);
    let mean = |rows: &[usize]| {
        let top: f64 = rows.iter().map(|&k| differences[k]).sum();
        let below: f64 = rows.iter().map(|&k| levels[k]).sum();
        top / below.max(f64::MIN_POSITIVE)
    };
    let [low, _] = block_bootstrap(n, block, REPLICATIONS, 0.9, seed, mean);
    [low, value]
}
