//! A motion through recorded samples: a natural cubic spline per joint.

use crate::series::JointSeries;

/// Position, velocity and acceleration as functions of time, through given positions at given
/// times; the acceleration is continuous and vanishes at both ends (Press et al., *Numerical
/// Recipes*, 3rd ed., 2007, section 3.3). At rest before the first and after the last sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Spline {
    /// s, increasing, at least two.
    time: Vec<f64>,
    q: JointSeries,
    /// Second derivative at the samples, rad/s^2.
    qdd: JointSeries,
}

impl Spline {
    /// Through `q` (rad) at `time` (s); `None` unless there are two samples or more, one per
    /// entry of `time`, which increases strictly, and all numbers are finite.
    pub fn through(time: &[f64], q: &JointSeries) -> Option<Self> {
        let increasing = time.windows(2).all(|w| w[0] < w[1]);
        let finite = time.iter().all(|t| t.is_finite())
            && (0..q.joints()).all(|j| q.joint(j).iter().all(|x| x.is_finite()));
        if time.len() < 2 || q.samples() != time.len() || !increasing || !finite {
            return None;
        }
        let qdd = q.map_joints(|_, x| moments(time, x));
        Some(Self { time: time.to_vec(), q: q.clone(), qdd })
    }

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.q.joints()
    }

    /// Time of the first sample, s.
    pub fn start(&self) -> f64 {
        self.time[0]
    }

    /// Time of the last sample, s.
    pub fn end(&self) -> f64 {
        self.time[self.time.len() - 1]
    }

    /// Position (rad), velocity (rad/s) and acceleration (rad/s^2) of all joints at time `t` (s).
    pub fn at(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        let inside = (self.start()..=self.end()).contains(&t);
        let t = t.clamp(self.start(), self.end());
        let i = self.time.partition_point(|&s| s <= t).clamp(1, self.time.len() - 1) - 1;
        for j in 0..self.dof() {
            let [x, v, a] = self.in_interval(i, j, t);
            [q[j], qd[j], qdd[j]] = if inside { [x, v, a] } else { [x, 0.0, 0.0] };
        }
    }

    /// Numerical Recipes, Eqs. 3.3.3 to 3.3.6, with A = 1 - B.
    fn in_interval(&self, i: usize, j: usize, t: f64) -> [f64; 3] {
        let h = self.time[i + 1] - self.time[i];
        let (x, m) = (self.q.joint(j), self.qdd.joint(j));
        let b = (t - self.time[i]) / h;
        let a = 1.0 - b;
        let bend = (a.powi(3) - a) * m[i] + (b.powi(3) - b) * m[i + 1];
        let tilt = (1.0 - 3.0 * a * a) * m[i] + (3.0 * b * b - 1.0) * m[i + 1];
        [
            a * x[i] + b * x[i + 1] + bend * h * h / 6.0,
            (x[i + 1] - x[i]) / h + tilt * h / 6.0,
            a * m[i] + b * m[i + 1],
        ]
    }
}

/// Second derivatives that make the first continuous: a tridiagonal system (Eq. 3.3.7),
/// solved by elimination from the front and substitution from the back.
fn moments(time: &[f64], x: &[f64]) -> Vec<f64> {
    let n = time.len();
    let mut m = vec![0.0; n];
    let mut above = vec![0.0; n];
    for i in 1..n - 1 {
        let (h0, h1) = (time[i] - time[i - 1], time[i + 1] - time[i]);
        let bend = (x[i + 1] - x[i]) / h1 - (x[i] - x[i - 1]) / h0;
        let pivot = 2.0 * (h0 + h1) - h0 * above[i - 1];
        above[i] = h1 / pivot;
        m[i] = (6.0 * bend - h0 * m[i - 1]) / pivot;
    }
    for i in (1..n - 1).rev() {
        m[i] -= above[i] * m[i + 1];
    }
    m
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(spline: &Spline, t: f64) -> [f64; 3] {
        let [mut q, mut qd, mut qdd] = [[0.0]; 3];
        spline.at(t, &mut q, &mut qd, &mut qdd);
        [q[0], qd[0], qdd[0]]
    }

    /// A sine has no acceleration at its zeros, so the natural ends are the true ones.
    #[test]
    fn a_sine_comes_back_to_fourth_order() {
        let error = |n: usize| {
            let time: Vec<f64> =
                (0..=n).map(|k| k as f64 * std::f64::consts::TAU / n as f64).collect();
            let q = JointSeries::from_joints(&[time.iter().map(|t| t.sin()).collect()]);
            let spline = Spline::through(&time, &q).unwrap();
            let worst = |i: usize, f: fn(f64) -> f64| {
                let e = |k: usize| (at(&spline, k as f64 * 1e-3)[i] - f(k as f64 * 1e-3)).abs();
                (0..6283).map(e).fold(0.0, f64::max)
            };
            [worst(0, f64::sin), worst(1, f64::cos), worst(2, |t| -t.sin())]
        };
        let (coarse, fine) = (error(50), error(100));
        for (i, order) in [4, 3, 2].into_iter().enumerate() {
            let ratio = coarse[i] / fine[i];
            let expected = 2f64.powi(order);
            assert!((0.7..1.4).contains(&(ratio / expected)), "derivative {i}: ratio {ratio}");
        }
        assert!(fine[0] < 1e-6);
    }

    #[test]
    fn samples_are_hit_and_the_ends_rest() {
        let time = [1.0, 1.5, 1.7, 3.0];
        let spline =
            Spline::through(&time, &JointSeries::from_joints(&[vec![0.2, 0.4, -0.1, 0.5]]));
        let spline = spline.unwrap();
        assert!((at(&spline, 1.7)[0] + 0.1).abs() < 1e-15);
        assert_eq!(at(&spline, 0.0), [0.2, 0.0, 0.0]);
        assert_eq!(at(&spline, 9.0), [0.5, 0.0, 0.0]);
        assert!((at(&spline, 1.5 - 1e-9)[1] - at(&spline, 1.5 + 1e-9)[1]).abs() < 1e-6);
    }

    #[test]
    fn unusable_samples_are_refused() {
        let q = JointSeries::zeros(1, 2);
        assert!(Spline::through(&[0.0, 0.0], &q).is_none());
        assert!(Spline::through(&[0.0, f64::NAN], &q).is_none());
        assert!(Spline::through(&[0.0, 1.0, 2.0], &q).is_none());
        assert!(Spline::through(&[0.0], &JointSeries::zeros(1, 1)).is_none());
    }
}
