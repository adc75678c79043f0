//! Which columns are which, by what the numbers say of each other.

use super::Block;
use super::source::Columns;

/// s, over which changes are held against sums.
const STRETCH_S: f64 = 0.25;
const MOST_STRETCHES: usize = 1000;
/// Correlation from which on a column is what another changes by; friction's follows velocity by .97.
const DERIVATIVE: f64 = 0.99;
/// Correlation of two columns of one motion.
const ALIKE: f64 = 0.99;
/// Share of a column that friction (direction and size of velocity) explains, where it is torque or current.
const DRIVEN: f64 = 0.2;
/// deg C, as motors have them.
const WARM: std::ops::Range<f64> = 10.0..110.0;
const MOST_JOINTS: usize = 12;

/// Changes and sums of all columns over the same stretches.
struct Stretches {
    changes: Vec<Vec<f64>>,
    sums: Vec<Vec<f64>>,
}

/// Blocks of as many columns as there are joints, in the order of the file.
pub fn blocks(columns: &Columns, time: usize, time_scale: f64) -> Vec<Block> {
    let stretches = Stretches::of(columns, time, time_scale);
    let all = columns.values.len();
    let rate = |i: usize, j: usize| i != j && stretches.derivative(i, j);
    let apart = |n: usize| (0..all.saturating_sub(n)).filter(|i| rate(*i, i + n)).count();
    let Some(joints) = (2..=MOST_JOINTS).find(|n| apart(*n) >= 2) else { return Vec::new() };
    let first = if time == 0 { 1 } else { 0 };
    let starts: Vec<usize> = (first..all).step_by(joints).filter(|s| s + joints <= all).collect();
    let derives = |a: usize, b: usize| {
        let moving = (0..joints).filter(|k| stretches.moves(a + k)).count();
        let fits = (0..joints).filter(|k| rate(a + k, b + k)).count();
        fits >= 2 && 2 * fits > moving
    };
    let positions: Vec<usize> =
        starts.iter().copied().filter(|a| starts.iter().any(|b| derives(*a, *b))).collect();
    let is_rate = |b: &usize| positions.iter().any(|a| derives(*a, *b));
    // Velocities have derivatives too where accelerations are there.
    let positions: Vec<usize> = positions.iter().copied().filter(|a| !is_rate(a)).collect();
    let Some(actual) = measured(columns, &positions, joints) else { return Vec::new() };
    let column = |s: usize| (s..s + joints).collect::<Vec<usize>>();
    let mut found = Vec::new();
    let mut take = |stem, at: usize, why: &str| {
        found.push(Block { stem, columns: column(at), scale: 1.0, why: why.into() });
    };
    take("actual_q", actual, "positions: other columns are what they change by");
    let mut used = vec![actual];
    let target = positions.iter().copied().find(|p| *p != actual);
    if let Some(target) = target {
        take("target_q", target, "a smoother copy of actual_q");
        used.push(target);
    }
    let mut rates: Vec<usize> =
        starts.iter().copied().filter(|b| !used.contains(b) && derives(actual, *b)).collect();
    rates.sort_by(|a, b| noise(columns, *b, joints).total_cmp(&noise(columns, *a, joints)));
    let speeds = ["actual_qd", "target_qd"];
    for (stem, at) in speeds.into_iter().zip(rates.iter().copied()) {
        take(stem, at, "what the positions change by");
        used.push(at);
    }
    let accelerations = starts
        .iter()
        .copied()
        .filter(|s| !used.contains(s))
        .find(|s| rates.iter().any(|r| derives(*r, *s)));
    if let Some(at) = accelerations {
        let stem = if target.is_some() { "target_qdd" } else { "actual_qdd" };
        take(stem, at, "what the velocities change by");
        used.push(at);
    }
    let rest: Vec<usize> = starts.iter().copied().filter(|s| !used.contains(s)).collect();
    if let Some(at) = rest.iter().copied().find(|s| driven(&stretches, actual, *s, joints)) {
        take(
            "actual_current",
            at,
            "it follows the direction of motion: current, A, or torque, N.m?",
        );
    }
    if let Some(at) = rest.iter().copied().find(|s| warm(columns, *s, joints)) {
        take("joint_temperatures", at, "slow, and as warm as motors are");
    }
    found
}

impl Stretches {
    fn of(columns: &Columns, time: usize, time_scale: f64) -> Self {
        let t = &columns.values[time];
        let step = crate::recording::inspection::step(t) * time_scale;
        let length = ((STRETCH_S / step).round() as usize).clamp(1, t.len() / 2);
        let all = (t.len() - 1) / length;
        let starts: Vec<usize> =
            (0..all).step_by(all.div_ceil(MOST_STRETCHES)).map(|k| k * length).collect();
        let over = |f: &dyn Fn(&[f64], usize) -> f64| -> Vec<Vec<f64>> {
            let each = |v: &Vec<f64>| match v.len() == t.len() {
                true => starts.iter().map(|k| f(v, *k)).collect(),
                false => Vec::new(),
            };
            columns.values.iter().map(each).collect()
        };
        Self {
            changes: over(&|v, k| v[k + length] - v[k]),
            sums: over(&|v, k| {
                let trapezoid = |k: usize| 0.5 * (v[k] + v[k + 1]) * (t[k + 1] - t[k]) * time_scale;
                (k..k + length).map(trapezoid).sum()
            }),
        }
    }

    /// Whether column `j` is what column `i` changes by, but for a unit. The other way round a swing
    /// correlates as well, with the opposite sign.
    fn derivative(&self, i: usize, j: usize) -> bool {
        correlation(&self.changes[i], &self.sums[j]).is_some_and(|r| r > DERIVATIVE)
    }

    fn moves(&self, i: usize) -> bool {
        self.changes[i].iter().any(|c| *c != 0.0)
    }
}

fn correlation(x: &[f64], y: &[f64]) -> Option<f64> {
    let n = x.len().min(y.len()) as f64;
    if n < 10.0 {
        return None;
    }
    let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let sum = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
        x.iter().zip(y).map(|(x, y)| f(x - mx, y - my)).sum()
    };
    let (xx, yy, xy) = (sum(&|x, _| x * x), sum(&|_, y| y * y), sum(&|x, y| x * y));
    (xx > 0.0 && yy > 0.0).then(|| xy / (xx * yy).sqrt())
}

/// The block with noise on it, of those that are positions of the same joints.
fn measured(columns: &Columns, positions: &[usize], joints: usize) -> Option<usize> {
    let first = *positions.first()?;
    let same = |p: &&usize| {
        let alike = |k: usize| {
            correlation(&columns.values[first + k], &columns.values[**p + k])
                .is_none_or(|r| r > ALIKE)
        };
        (0..joints).all(alike)
    };
    let copies = positions.iter().filter(same).copied();
    copies.max_by(|a, b| noise(columns, *a, joints).total_cmp(&noise(columns, *b, joints)))
}

/// Mean square of second differences of a block.
fn noise(columns: &Columns, start: usize, joints: usize) -> f64 {
    let of = |v: &[f64]| -> f64 {
        v.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).powi(2)).sum::<f64>()
    };
    (start..start + joints).map(|c| of(&columns.values[c])).sum()
}

/// Whether the direction of the joints' motion shows in a block.
fn driven(stretches: &Stretches, actual: usize, block: usize, joints: usize) -> bool {
    let shows = |k: &usize| {
        let direction: Vec<f64> =
            stretches.changes[actual + k].iter().map(|c| c.signum()).collect();
        correlation(&direction, &stretches.sums[block + k]).is_some_and(|r| r * r > DRIVEN)
    };
    2 * (0..joints).filter(shows).count() >= joints
}

fn warm(columns: &Columns, block: usize, joints: usize) -> bool {
    (block..block + joints).all(|c| {
        let v = &columns.values[c];
        !v.is_empty() && v.iter().all(|t| WARM.contains(t))
    })
}
