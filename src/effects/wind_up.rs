//! How far the links of elastic or slack joints lag behind their motors, from the motors' motion.
//!
//! The wind-ups w = q_motor - q_link of the joints that give way follow
//!
//! ```text
//! M w'' = tau(t) - tau_qd w' - tau_q w - T(w, w'),     q_link = q - w
//! ```
//!
//! where tau is the rigid arm's torque along the motion, M, tau_qd and tau_q its slopes over
//! acceleration, velocity and angle at those joints, and T what the transmissions carry (Spong,
//! J. Dyn. Sys. Meas. Control 109(4), 1987, eqs. 2 and 3, for a given motor motion).

use std::borrow::Cow;

use nalgebra::DMatrix;

use super::spring_steps::Steps;
use super::{Motion, Rigid, Slopes, Transmission};
use crate::series::JointSeries;

/// Longest step of the integration, s.
const STEP_S: f64 = 2.5e-4;
/// Least inertia of a link, kg.m2: it divides.
const LIGHTEST: f64 = 1e-9;
/// Least damping of teeth that meet, of critical, about the steady wind-up. A motor answers a blow,
/// which ends the ringing; its conditioned motion has lost most of that answer, and links would ring
/// on against it. Without it the stiffness comes out low, by what rings in step by chance.
const RINGING: f64 = 0.4;

/// N.m at every joint, per unit of `reference`, when `joint` gives way by `law` on top of what
/// [`Motion::giving`] says of the arm.
pub(super) fn lagging(
    motion: &Motion<'_>,
    joint: usize,
    law: Transmission,
    reference: f64,
) -> JointSeries {
    let kept = Rigid::new(motion.q.joints());
    let motion = &Motion { rigid: Some(motion.rigid.unwrap_or(&kept)), ..*motion };
    let mut with = motion.giving.to_vec();
    with.resize(motion.q.joints(), None);
    with[joint] = Some(law);
    let (more, less) = (lag(motion, &with), lag(motion, motion.giving));
    let share = |(m, l): (&f64, &f64)| (m - l) / reference;
    more.map_joints(|j, more| more.iter().zip(less.joint(j)).map(share).collect())
}

/// N.m at every joint when the links lag behind their motors.
fn lag(motion: &Motion<'_>, laws: &[Option<Transmission>]) -> JointSeries {
    let mut lag = JointSeries::zeros(motion.q.joints(), motion.samples());
    for joint in wind_up(motion, laws) {
        for (slope, mean) in joint.slopes.0.iter().zip(&joint.means) {
            for j in 0..lag.joints() {
                let terms = slope.joint(j).iter().zip(mean);
                lag.joint_mut(j).iter_mut().zip(terms).for_each(|(lag, (s, w))| *lag -= s * w);
            }
        }
    }
    lag
}

/// A joint that gives way, on its way along the motion.
struct Giving<'a> {
    joint: usize,
    law: Transmission,
    slopes: Cow<'a, Slopes>,
    /// w, rad, its rate and the state of the hysteresis.
    w: f64,
    rate: f64,
    z: f64,
    /// w, w', w'' at the samples: means over the interval around each, as filters see them.
    means: [Vec<f64>; 3],
}

/// Wind-ups along the motion, from rest under the load. Links too light for the step are taken
/// heavier: they follow their load within it all the same.
fn wind_up<'a>(motion: &Motion<'a>, laws: &[Option<Transmission>]) -> Vec<Giving<'a>> {
    if laws.iter().all(Option::is_none) {
        return Vec::new();
    }
    let load = motion.rigid_torque();
    let laws = laws.iter().enumerate().filter_map(|(joint, law)| Some((joint, (*law)?)));
    let mut joints: Vec<_> = laws.map(|(j, law)| Giving::new(motion, j, law, &load)).collect();
    let parts = (motion.dt / STEP_S).ceil().max(1.0);
    if let [one] = &mut joints[..] {
        one.follow(load.joint(one.joint), motion.dt, parts as u32);
        return joints;
    }
    let h = motion.dt / parts;
    let mut torque = vec![0.0; joints.len()];
    for k in 0..load.samples() {
        let inverse = inverse_inertia(&joints, k, h);
        let damping = damping_of_blows(&joints, k);
        let mut sums = vec![[0.0; 3]; joints.len()];
        for part in 0..parts as usize {
            let along = (part as f64 + 0.5) / parts - 0.5;
            for (i, torque) in torque.iter_mut().enumerate() {
                let (tau, tau_rate) = between(load.joint(joints[i].joint), k, along, motion.dt);
                let steady = tau_rate / joints[i].law.stiffness;
                let carried = joints[i].carried(damping[i], steady);
                *torque = tau - carried - turned(&joints, i, k);
            }
            for (i, (joint, sums)) in joints.iter_mut().zip(&mut sums).enumerate() {
                let terms = torque.iter().enumerate().map(|(j, torque)| inverse[(i, j)] * torque);
                joint.advance(terms.sum(), h, sums);
            }
        }
        for (joint, sums) in joints.iter_mut().zip(sums) {
            joint.means.iter_mut().zip(sums).for_each(|(mean, sum)| mean.push(sum / parts));
        }
    }
    joints
}

/// M at the joints that give way, from below as heavy as the step needs, inverted.
fn inverse_inertia(joints: &[Giving<'_>], k: usize, h: f64) -> DMatrix<f64> {
    let n = joints.len();
    let mut m = DMatrix::from_fn(n, n, |i, j| joints[j].slopes.0[2].joint(joints[i].joint)[k]);
    // 1 / (M^-1)_ii is what a joint moves where the others are free.
    let free = m.clone().try_inverse();
    for (i, joint) in joints.iter().enumerate() {
        let moved = free.as_ref().map_or(0.0, |free| 1.0 / free[(i, i)]);
        m[(i, i)] += (joint.lightest(k, h) - moved.max(0.0)).max(0.0);
    }
    m.try_inverse().unwrap_or_else(|| DMatrix::zeros(n, n))
}

/// N.m.s/rad that blows have on top of the law's, per joint.
fn damping_of_blows(joints: &[Giving<'_>], k: usize) -> Vec<f64> {
    joints.iter().map(|g| (g.ringing(k) - g.law.damping).max(0.0)).collect()
}

/// N.m by which the load of joint `i` is another where the links hang.
fn turned(joints: &[Giving<'_>], i: usize, k: usize) -> f64 {
    let own = joints[i].joint;
    let by = |g: &Giving<'_>| {
        let [over_q, over_qd, _] = &g.slopes.0;
        over_q.joint(own)[k] * g.w + over_qd.joint(own)[k] * g.rate
    };
    joints.iter().map(by).sum()
}

/// Linear between samples, `along` -0.5 to 0.5 sample away from sample `k`, and its rate.
fn between(x: &[f64], k: usize, along: f64, dt: f64) -> (f64, f64) {
    let (before, after) = (k.saturating_sub(1), (k + 1).min(x.len() - 1));
    let next = if along < 0.0 { before } else { after };
    let rate = (x[after] - x[before]) / (after - before).max(1) as f64 / dt;
    (x[k] + along.abs() * (x[next] - x[k]), rate)
}

impl<'a> Giving<'a> {
    fn new(motion: &Motion<'a>, joint: usize, law: Transmission, load: &JointSeries) -> Self {
        let start = load.joint(joint).first().copied().unwrap_or(0.0);
        Self {
            joint,
            law,
            slopes: motion.slopes(joint),
            w: law.wind_up(start),
            rate: 0.0,
            z: 0.0,
            means: [(); 3].map(|()| Vec::with_capacity(motion.samples())),
        }
    }

    /// The way of a joint that alone gives way, as above but without anything between joints.
    fn follow(&mut self, load: &[f64], dt: f64, parts: u32) {
        for k in 0..load.len() {
            let sums = match self.law.is_linear() {
                true => self.swing(load, k, dt, parts),
                false => self.step(load, k, dt, parts),
            };
            let parts = f64::from(parts);
            self.means.iter_mut().zip(sums).for_each(|(mean, sum)| mean.push(sum / parts));
        }
    }

    /// Sums of w, w' and w'' over the steps about sample `k`, on a linear spring: those under a load on its way from the
    /// sample before, then those on its way to the next.
    fn swing(&mut self, load: &[f64], k: usize, dt: f64, parts: u32) -> [f64; 3] {
        let h = dt / f64::from(parts);
        let [over_q, over_qd, mobility] = self.feels(k, h);
        let Transmission { stiffness, damping, .. } = self.law;
        let one = Steps::one(stiffness + over_q, damping + over_qd, mobility, h);
        let [before, after] = [-1.0, 1.0].map(|side| between(load, k, side, dt).0 - load[k]);
        let (half, start) = (parts / 2, [self.w, self.rate]);
        let coming = one.times(half);
        let going = if parts == 2 * half { coming } else { coming.then(&one) };
        let mut sum = 0.0;
        for (steps, first, towards) in [(coming, 0, -before), (going, half, after)] {
            let along = (f64::from(first) + 0.5) / f64::from(parts) - 0.5;
            let (tau, rise) = (load[k] + along * towards, towards / f64::from(parts));
            let state = steps.from([self.w, self.rate], tau, rise);
            ([self.w, self.rate], sum) = (state.0, sum + state.1);
        }
        [sum, (self.w - start[0]) / h, (self.rate - start[1]) / h]
    }

    /// The same one after the other, whatever the transmission carries.
    fn step(&mut self, load: &[f64], k: usize, dt: f64, parts: u32) -> [f64; 3] {
        let (parts, h) = (f64::from(parts), dt / f64::from(parts));
        let [over_q, over_qd, mobility] = self.feels(k, h);
        let damping = (self.ringing(k) - self.law.damping).max(0.0);
        let steady = between(load, k, 0.0, dt).1 / self.law.stiffness;
        let [before, after] = [-1.0, 1.0].map(|side| between(load, k, side, dt).0 - load[k]);
        let mut sums = [0.0; 3];
        for part in 0..parts as usize {
            let along = (part as f64 + 0.5) / parts - 0.5;
            let tau = load[k] + along.abs() * if along < 0.0 { before } else { after };
            let turned = over_q * self.w + over_qd * self.rate;
            let torque = tau - self.carried(damping, steady) - turned;
            self.advance(torque * mobility, h, &mut sums);
        }
        sums
    }

    /// Slopes of the own load over angle (N.m/rad) and rate (N.m.s/rad) about sample `k`, and 1 / M of a link that steps of
    /// `h` s can follow.
    fn feels(&self, k: usize, h: f64) -> [f64; 3] {
        let [over_q, over_qd, inertia] = &self.slopes.0;
        let of = |slope: &JointSeries| slope.joint(self.joint)[k];
        [of(over_q), of(over_qd), 1.0 / of(inertia).max(self.lightest(k, h))]
    }

    /// A link that the step can follow is no lighter, kg.m2.
    fn lightest(&self, k: usize, h: f64) -> f64 {
        let damping = self.law.damping.max(self.ringing(k));
        (h * (4.0 * h * self.law.stiffest()).max(2.0 * damping)).max(LIGHTEST)
    }

    /// Least damping of teeth that meet, N.m.s/rad.
    fn ringing(&self, k: usize) -> f64 {
        let inertia = self.slopes.0[2].joint(self.joint)[k].max(0.0);
        let slack = self.law.gap > 0.0;
        if slack { 2.0 * RINGING * (self.law.stiffness * inertia).sqrt() } else { 0.0 }
    }

    /// T, N.m, where a steady wind-up changes by `steady` (rad/s) and blows are damped by `damping`
    /// more.
    fn carried(&self, damping: f64, steady: f64) -> f64 {
        let touching = self.law.damping_at(self.w);
        let blow = match self.law.touches(self.w) {
            true => damping * (self.rate - steady),
            false => 0.0,
        };
        self.law.torque(self.w) + self.law.hysteresis * self.z + touching * self.rate + blow
    }

    fn advance(&mut self, acceleration: f64, h: f64, sums: &mut [f64; 3]) {
        self.rate += h * acceleration;
        self.w += h * self.rate;
        self.z = self.law.bent(self.z, h * self.rate);
        *sums = [sums[0] + self.w, sums[1] + self.rate, sums[2] + acceleration];
    }
}
