//! How far position servos give way under torque: what torque that a twin lacks makes of its simulated
//! position.
//!
//! Beside a simulated motion an arm that also has to supply tau(t) is d(t) further, to first order
//!
//! ```text
//! M d'' + D d' + K d = -tau,   d' = 0 while the joint sticks,   d = d' = 0 where a stretch begins
//! ```
//!
//! with the inertia M, the damping D and the servo's slope K along that motion: the sensitivity equation of
//! every parameter of which the column of torque is tau (Walter and Pronzato, *Identification of Parametric
//! Models from Experimental Data*, 1997, section 4.3). Joints of geared servos hardly move each other, and
//! each is taken alone; what is found is proved by simulation.

use std::ops::Range;

/// Longest step of servos' motion, s: a tenth of the time constants of small ones.
const LONGEST_STEP_S: f64 = 0.002;

/// A joint beside its simulated motion, sample by sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Giving {
    /// M, kg.m2
    pub inertia: Vec<f64>,
    /// D, N.m.s/rad
    pub damping: Vec<f64>,
    /// K, N.m/rad
    pub slope: Vec<f64>,
    pub slides: Vec<bool>,
    /// Recorded less simulated position, rad.
    pub error: Vec<f64>,
    /// N.m/rad by which positions are read as torque: the servo's gain.
    pub scale: f64,
}

/// All joints of an arm beside its simulated motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Samples that are simulated from one measured state.
    pub stretches: Vec<Range<usize>>,
    pub joints: Vec<Giving>,
    /// What moves each joint to every sample from the one before.
    moves: Vec<Vec<Move>>,
}

/// How far a joint is further (d, rad) and how much faster (v, rad/s) at a sample: each by d and v at the sample before,
/// torque there and torque here (N.m), which changes evenly in between. The state transition of the
/// steps in between.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Move {
    further: [f64; 4],
    faster: [f64; 4],
}

impl Move {
    /// To sample `k`, in steps that are short beside the servo's time constants.
    fn to(of: &Giving, k: usize, dt: f64) -> Self {
        let steps = (dt / LONGEST_STEP_S).ceil().max(1.0);
        let h = dt / steps;
        let (m, damping, slope) = (of.inertia[k], of.damping[k], of.slope[k]);
        let yields = 1.0 / (m + h * damping + h * h * slope);
        let by = |[mut d, mut v, before, now]: [f64; 4]| {
            for step in 1..=steps as usize {
                let tau = before + step as f64 / steps * (now - before);
                v = if of.slides[k] { (m * v + h * (tau - slope * d)) * yields } else { 0.0 };
                d += h * v;
            }
            [d, v]
        };
        // It is linear: what one of each does.
        let of_each: [[f64; 2]; 4] =
            std::array::from_fn(|i| by(std::array::from_fn(|k| f64::from(u8::from(i == k)))));
        Self { further: of_each.map(|[d, _]| d), faster: of_each.map(|[_, v]| v) }
    }
}

impl Response {
    /// Of joints whose samples are `dt` s apart, as many of each list; samples of a stretch are simulated from one
    /// measured state.
    pub fn new(dt: f64, stretches: Vec<Range<usize>>, joints: Vec<Giving>) -> Self {
        let of = |g: &Giving| (0..g.inertia.len()).map(|k| Move::to(g, k, dt)).collect();
        let moves = joints.iter().map(of).collect();
        Self { stretches, joints, moves }
    }

    /// What a torque that the twin lacks at `joint` shows of itself in position, times the servo's gain: N.m of
    /// a steady torque come out as they are.
    pub fn to(&self, joint: usize, torque: &[f64]) -> Vec<f64> {
        let (moves, scale) = (&self.moves[joint], self.joints[joint].scale);
        let mut shown = vec![0.0; torque.len()];
        let times = |share: &[f64; 4], by: [f64; 4]| -> f64 {
            (share[0] * by[0] + share[1] * by[1]) + (share[2] * by[2] + share[3] * by[3])
        };
        for stretch in &self.stretches {
            let [mut d, mut v] = [0.0; 2];
            for k in stretch.start + 1..stretch.end {
                let by = [d, v, torque[k - 1], torque[k]];
                [d, v] = [times(&moves[k].further, by), times(&moves[k].faster, by)];
                shown[k] = scale * d;
            }
        }
        shown
    }

    /// What the recording shows of all torque that the twin lacks, as [`Response::to`] has it, N.m.
    pub fn seen(&self, joint: usize) -> Vec<f64> {
        let of = &self.joints[joint];
        of.error.iter().map(|e| -of.scale * e).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn servo(n: usize) -> Response {
        let all = |x: f64| vec![x; n];
        let joint = Giving {
            inertia: all(0.02),
            damping: all(0.6),
            slope: all(20.0),
            slides: vec![true; n],
            error: all(0.0),
            scale: 20.0,
        };
        Response::new(0.01, std::iter::once(0..n).collect(), vec![joint])
    }

    /// Steady torque comes out as it is; a sine as the transfer function K / (K - M w^2 + i D w) has it.
    #[test]
    fn a_servo_gives_way_as_its_transfer_function_says() {
        let w: f64 = 6.0;
        let torque: Vec<f64> = (0..1000).map(|k| 0.5 + (w * 0.01 * k as f64).sin()).collect();
        let shown = servo(1000).to(0, &torque);
        let (real, imaginary) = (20.0 - 0.02 * w * w, 0.6 * w);
        let size = 20.0 / real.hypot(imaginary);
        let late = imaginary.atan2(real);
        for (k, shown) in shown.iter().enumerate().skip(800) {
            let expected = 0.5 + size * (w * 0.01 * k as f64 - late).sin();
            assert!((shown - expected).abs() < 5e-3, "{k}: {shown} {expected}");
        }
    }

    #[test]
    fn a_joint_that_sticks_stays_where_it_was() {
        let mut joint = servo(400).joints.remove(0);
        joint.slides[200..].fill(false);
        let servo = Response::new(0.01, std::iter::once(0..400).collect(), vec![joint]);
        let torque: Vec<f64> = (0..400).map(|k| if k < 200 { 1.0 } else { -3.0 }).collect();
        let shown = servo.to(0, &torque);
        assert!((shown[199] - 1.0).abs() < 1e-3 && shown[399] == shown[200], "{shown:?}");
    }
}
