//! How far one joint's weight and friction explain a column of torque.

use nalgebra::{DMatrix, DVector};

/// rad/s: slower is no sliding.
const SLIDING: f64 = 0.02;
/// Fewer sliding instants are no motion: all of them are taken.
const FEWEST_SLIDING: usize = 100;
/// Columns: direction of motion, velocity, what the rigid body needs; then the torque.
const DIRECTION: usize = 0;
const SPEED: usize = 1;
const RIGID: usize = 2;
const TORQUE: usize = 3;

/// torque = slope rigid + friction(velocity) + constant, by least squares.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// Torque over what the rigid body needs.
    pub slope: f64,
    /// Share of what friction leaves that the rigid body explains.
    pub by_weight: f64,
    /// Share of what the rigid body leaves that friction explains.
    pub by_friction: f64,
    /// Mean power that friction takes, W; negative where it would give.
    pub power: f64,
    /// Share that both explain.
    pub total: f64,
    /// The same with friction that takes power, and an arm that is carried and does not carry.
    pub physical: f64,
}

/// Sums of products of centred columns.
struct Sums([[f64; 4]; 4]);

/// `heavy`: the rigid body's part is so sure that its slope cannot be negative.
pub fn fit(qd: &[f64], rigid: &[f64], torque: &[f64], heavy: bool) -> Fit {
    let slides = |k: &usize| qd[*k].abs() > SLIDING;
    let sliding: Vec<usize> = (0..qd.len()).filter(slides).collect();
    let rows = if sliding.len() < FEWEST_SLIDING { (0..qd.len()).collect() } else { sliding };
    let direction = |k: usize| if slides(&k) { qd[k].signum() } else { 0.0 };
    let column = |of: &dyn Fn(usize) -> f64| rows.iter().map(|k| of(*k)).collect::<Vec<f64>>();
    let columns =
        [column(&direction), column(&|k| qd[k]), column(&|k| rigid[k]), column(&|k| torque[k])];
    let mean = |f: &dyn Fn(usize) -> f64| rows.iter().map(|k| f(*k)).sum::<f64>() / rows.len() as f64;
    let sums = Sums::new(&columns);
    let left = |which: &[usize]| sums.left(which).1;
    let (found, both) = sums.left(&[DIRECTION, SPEED, RIGID]);
    let (friction, weight) = (left(&[DIRECTION, SPEED]), left(&[RIGID]));
    let power =
        found[0] * mean(&|k| direction(k) * qd[k]) + found[1] * mean(&|k| qd[k] * qd[k]);
    let all = sums.0[TORQUE][TORQUE].max(f64::MIN_POSITIVE);
    let share = |left: f64, of: f64| 1.0 - left / of.max(f64::MIN_POSITIVE);
    let physical = match (heavy && found[2] < 0.0, power < 0.0) {
        (false, false) => both,
        (true, false) => friction,
        (false, true) => weight,
        (true, true) => all,
    };
    Fit {
        slope: found[2],
        by_weight: share(both, friction),
        by_friction: share(both, weight),
        power,
        total: share(both, all),
        physical: share(physical, all),
    }
}

impl Sums {
    fn new(columns: &[Vec<f64>; 4]) -> Self {
        let n = columns[0].len().max(1) as f64;
        let means = columns.each_ref().map(|c| c.iter().sum::<f64>() / n);
        let product = |a: usize, b: usize| {
            let pairs = columns[a].iter().zip(&columns[b]);
            pairs.map(|(x, y)| (x - means[a]) * (y - means[b])).sum()
        };
        Self(std::array::from_fn(|a| std::array::from_fn(|b| product(a, b))))
    }

    /// Coefficients of the columns `which`, and the sum of squares that they leave of the torque.
    fn left(&self, which: &[usize]) -> (Vec<f64>, f64) {
        let size = |c: usize| self.0[c][c].sqrt().max(f64::MIN_POSITIVE);
        let n = which.len();
        let a = DMatrix::from_fn(n, n, |i, k| {
            let (i, k) = (which[i], which[k]);
            self.0[i][k] / (size(i) * size(k))
        });
        let b = DVector::from_fn(n, |i, _| self.0[which[i]][TORQUE] / size(which[i]));
        let solved = a.svd(true, true).solve(&b, 1e-9).unwrap_or_else(|_| DVector::zeros(n));
        let left = self.0[TORQUE][TORQUE] - solved.dot(&b);
        (which.iter().zip(solved.iter()).map(|(c, x)| x / size(*c)).collect(), left.max(0.0))
    }
}
