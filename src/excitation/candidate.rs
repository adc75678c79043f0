//! From the numbers that a search varies to a motion that holds its limits of angle, speed and
//! acceleration.

use std::f64::consts::TAU;

use super::limits::Limits;
use crate::kernels::axpy;
use crate::motion::{Sampled, Series};
use crate::series::JointSeries;

/// What all motions of one search have in common.
pub struct Family {
    dof: usize,
    pub period_s: f64,
    pub fade_s: f64,
    pub harmonics: usize,
    /// Step of the grid on which candidates are judged, s.
    pub dt: f64,
    /// What every harmonic's sine and every one's cosine does, one "joint" each, of amplitude 1.
    basis: Sampled,
}

/// One motion of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    pub centre: Vec<f64>,
    /// Coefficients of each joint: sines, then cosines, rad.
    pub coefficients: Vec<Vec<f64>>,
}

/// About the period wanted, s: the motion is a whole number of them. Longer ones have more
/// coefficients than a search of seconds makes use of.
const PERIOD_S: f64 = 9.0;
const HARMONICS: [f64; 2] = [4.0, 12.0];
/// Highest frequency over the one from which acceleration and no longer speed is the limit.
const BEYOND_CORNER: f64 = 1.25;
const FADE_S: f64 = 2.0;
/// Grid points in a period of the highest harmonic.
const POINTS_PER_PERIOD: f64 = 20.0;
/// Share of the limits of angle, speed and acceleration that is used: the rest is for what lies between
/// grid points and for a controller that follows.
const SHARE: f64 = 0.96;
/// Share of the range by which the centre may move.
const CENTRE_SHARE: f64 = 0.8;

impl Family {
    pub fn new(limits: &Limits<'_>, duration_s: f64, rest_s: f64) -> Self {
        let e = &limits.envelope;
        let moving_s = duration_s - 2.0 * rest_s;
        let period_s = moving_s / (moving_s / PERIOD_S).round().max(1.0);
        let corners = e.acceleration.iter().zip(&e.velocity).map(|(a, v)| a / (TAU * v));
        let highest_hz = BEYOND_CORNER * corners.fold(0.0, f64::max);
        let harmonics = (highest_hz * period_s).round().clamp(HARMONICS[0], HARMONICS[1]);
        let dt = period_s / (harmonics * POINTS_PER_PERIOD);
        let harmonics = harmonics as usize;
        let fade_s = FADE_S.min(moving_s / 4.0);
        let one = |i: usize| (0..harmonics).map(move |k| f64::from(u8::from(k == i)));
        let (mut sine_rad, mut cosine_rad) = (Vec::new(), Vec::new());
        for i in 0..2 * harmonics {
            sine_rad.push(one(i).collect());
            cosine_rad.push(one(i.wrapping_sub(harmonics)).collect());
        }
        let basis = Series { period_s, fade_s, sine_rad, cosine_rad };
        let basis = basis.around_centre(rest_s, duration_s, dt);
        let dof = limits.robot.dof();
        Self { dof, period_s, fade_s, harmonics, dt, basis }
    }

    /// How many numbers make a motion: per joint its coefficients, where its centre lies, and which
    /// share of its limits it uses.
    pub fn dimensions(&self) -> usize {
        self.dof * (2 * self.harmonics + 2)
    }

    /// The motion of these numbers, scaled joint by joint to the first of its limits.
    pub fn candidate(&self, x: &[f64], limits: &Limits<'_>) -> (Candidate, Sampled) {
        let each = x.chunks_exact(2 * self.harmonics + 2).enumerate();
        let (mut centre, mut coefficients) = (Vec::new(), Vec::new());
        for (j, numbers) in each {
            let (shape, &[offset, modesty]) = numbers.split_at(2 * self.harmonics) else {
                continue;
            };
            let e = &limits.envelope;
            let at = e.centre[j] + CENTRE_SHARE * e.range[j] * offset.tanh();
            // Every harmonic with the same share of the speed.
            let over_order = |(i, z): (usize, &f64)| z / (i % self.harmonics + 1) as f64;
            let shape: Vec<f64> = shape.iter().enumerate().map(over_order).collect();
            let scale = self.largest(&shape, j, at, limits) * (-modesty.abs()).exp();
            coefficients.push(shape.iter().map(|a| a * scale).collect());
            centre.push(at);
        }
        let candidate = Candidate { centre, coefficients };
        let motion = self.motion(&candidate);
        (candidate, motion)
    }

    /// The largest factor that keeps joint `j` within its limits.
    fn largest(&self, shape: &[f64], j: usize, at: f64, limits: &Limits<'_>) -> f64 {
        let e = &limits.envelope;
        let of = |basis: &JointSeries| self.combined(basis, shape);
        let peak = |x: Vec<f64>| x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let q = of(&self.basis.q);
        let (low, high) = q.iter().fold((0.0_f64, 0.0_f64), |(l, h), x| (l.min(*x), h.max(*x)));
        let up = (e.centre[j] + e.range[j] - at) / high;
        let down = (e.centre[j] - e.range[j] - at) / low;
        let speed = e.velocity[j] / peak(of(&self.basis.qd));
        let acceleration = e.acceleration[j] / peak(of(&self.basis.qdd));
        let largest = SHARE * up.min(down).min(speed).min(acceleration);
        if largest.is_finite() { largest } else { 0.0 }
    }

    pub fn motion(&self, candidate: &Candidate) -> Sampled {
        let Candidate { centre, coefficients } = candidate;
        let series = |basis: &JointSeries| {
            let rows: Vec<_> = coefficients.iter().map(|a| self.combined(basis, a)).collect();
            JointSeries::from_joints(&rows)
        };
        let mut q = series(&self.basis.q);
        for (j, centre) in centre.iter().enumerate() {
            q.joint_mut(j).iter_mut().for_each(|x| *x += centre);
        }
        Sampled { q, qd: series(&self.basis.qd), qdd: series(&self.basis.qdd) }
    }

    fn combined(&self, basis: &JointSeries, coefficients: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; basis.samples()];
        for (i, a) in coefficients.iter().enumerate() {
            axpy(*a, basis.joint(i), &mut sum);
        }
        sum
    }

    /// A candidate's coefficients as a scenario holds them.
    pub fn series(&self, candidate: &Candidate) -> Series {
        let half = |from: usize| {
            let of = |a: &Vec<f64>| a[from..from + self.harmonics].to_vec();
            candidate.coefficients.iter().map(of).collect()
        };
        Series {
            period_s: self.period_s,
            fade_s: self.fade_s,
            sine_rad: half(0),
            cosine_rad: half(self.harmonics),
        }
    }
}
