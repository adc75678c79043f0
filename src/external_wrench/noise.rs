//! What a twin leaves of the torque where nothing touches, learned from recordings most of whose time
//! is free of contacts.
//!
//! At every joint, apart for each state of its friction: an Ornstein-Uhlenbeck process and white noise on it,
//! by maximum likelihood over a grid. A stretch that does not fit (a contact) has little say: Huber's
//! loss (Annals of Mathematical Statistics 35, 1964) in place of the squares.

use super::left::{Friction, Left};

/// Standard deviations tried, of the typical residual.
const SCALES: [f64; 6] = [0.7, 1.0, 1.4, 2.0, 2.8, 4.0];
/// Times tried, s.
const LASTING_S: [f64; 7] = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0];
/// White noise tried, of the process.
const WHITE: [f64; 4] = [0.03, 0.1, 0.3, 1.0];
/// Standard deviations beyond which a step counts by its size, not by its square.
const HUBER: f64 = 1.0;
/// Steps below which a state of a joint says nothing.
const FEWEST: usize = 40;
/// Standard deviation of a torque that is anywhere between plus and minus 1 with equal chances.
const UNIFORM: f64 = 0.577;
/// How long what friction holds stays as it is where no recording tells, s.
const HELD_S: f64 = 5.0;
/// Median of |x| of a normal x with standard deviation 1.
const MEDIAN_SIZE: f64 = 0.6745;

/// What one joint's residual is like in one state of its friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Process {
    /// Standard deviation, N.m.
    pub spread_nm: f64,
    /// After which it has forgotten itself, s.
    pub lasting_s: f64,
    /// Standard deviation of the white part, N.m.
    pub white_nm: f64,
}

/// Torque is measured no finer, N.m: that of a simulation without noise has a spread too.
const FINEST_NM: f64 = 1e-6;

impl Process {
    /// `white` is the white part over the spread.
    fn new(spread_nm: f64, lasting_s: f64, white: f64) -> Self {
        let spread_nm = spread_nm.max(FINEST_NM);
        Self { spread_nm, lasting_s, white_nm: white * spread_nm }
    }
}

/// Noise of all joints, base to wrist, by the state of their friction.
#[derive(Debug, Clone, PartialEq)]
pub struct Noise {
    pub sliding: Vec<Process>,
    pub holding: Vec<Process>,
    pub resting: Vec<Process>,
    pub changing: Vec<Process>,
}

/// A recording taken every `every`-th sample.
#[derive(Debug, Clone, Copy)]
pub struct Heard<'a> {
    pub left: &'a Left,
    pub every: usize,
    /// Time between the samples that are kept, s.
    pub dt: f64,
}

impl Noise {
    /// Learns it from a recording and others of the same arm that are `free` of contacts: at every joint the
    /// worst of them. At rest, where what a push looks like is most of what happens, from those that
    /// are free alone if one of them rests. Where friction holds or changes it may be anything between
    /// its limits, whatever the recordings happen to show; the same for a state that none is in long
    /// enough.
    pub fn learn(own: Heard<'_>, free: &[Heard<'_>]) -> Self {
        let joints = own.left.torque.joints();
        let worst = |of: &[Heard<'_>], j: usize, friction: Friction| {
            let each = of.iter().filter_map(|r| process(r, j, friction));
            each.max_by(|a, b| a.spread_nm.total_cmp(&b.spread_nm))
        };
        let all: Vec<Heard<'_>> = std::iter::once(own).chain(free.iter().copied()).collect();
        let seen = |j: usize, friction: Friction| match friction {
            Friction::Rests => worst(free, j, friction).or_else(|| worst(&[own], j, friction)),
            _ => worst(&all, j, friction),
        };
        let held = |j: usize| {
            let holds = all.iter().flat_map(|r| r.left.holds.joint(j));
            let holds_nm = holds.copied().fold(0.0, f64::max);
            Process::new(UNIFORM * holds_nm, HELD_S, 0.1 / UNIFORM)
        };
        let at_least_held = |friction: Friction| {
            let one = |j: usize| {
                let (seen, held) = (seen(j, friction).unwrap_or_else(|| held(j)), held(j));
                Process { spread_nm: seen.spread_nm.max(held.spread_nm), ..seen }
            };
            (0..joints).map(one).collect()
        };
        let slides = |j| seen(j, Friction::Slides).unwrap_or_else(|| held(j));
        Self {
            sliding: (0..joints).map(slides).collect(),
            holding: at_least_held(Friction::Holds),
            resting: at_least_held(Friction::Rests),
            changing: at_least_held(Friction::Changes),
        }
    }

    pub fn at(&self, joint: usize, friction: Friction) -> &Process {
        match friction {
            Friction::Slides => &self.sliding[joint],
            Friction::Holds => &self.holding[joint],
            Friction::Rests => &self.resting[joint],
            Friction::Changes => &self.changing[joint],
        }
    }
}

/// Most likely noise of a joint in one state of its friction; `None` if it is hardly ever in it.
fn process(heard: &Heard<'_>, joint: usize, friction: Friction) -> Option<Process> {
    let level = level(heard.left, joint);
    let values = heard.left.torque.joint(joint);
    let picked: Vec<Option<f64>> = (0..values.len())
        .step_by(heard.every)
        .map(|k| (heard.left.friction[joint][k] == friction).then_some(values[k] - level))
        .collect();
    let sizes: Vec<f64> = picked.iter().flatten().map(|r| r.abs()).collect();
    if sizes.len() < FEWEST {
        return None;
    }
    let typical = median(sizes) / MEDIAN_SIZE;
    let all = SCALES.iter().flat_map(|scale| {
        LASTING_S.iter().flat_map(move |&lasting_s| {
            WHITE.iter().map(move |white| Process::new(scale * typical, lasting_s, *white))
        })
    });
    let likelihood = |p: &Process| likelihood(&picked, p, heard.dt);
    all.map(|p| (likelihood(&p), p)).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, p)| p)
}

/// The joint's usual residual, N.m: what a wrong mass or a load at the tool adds in a pose that is
/// held, and the middle of its friction.
pub fn level(left: &Left, joint: usize) -> f64 {
    median(left.torque.joint(joint).to_vec())
}

/// Log-likelihood of a process and white noise on it; where it is interrupted it begins anew.
fn likelihood(values: &[Option<f64>], process: &Process, dt: f64) -> f64 {
    let kept = (-dt / process.lasting_s).exp();
    let stationary = process.spread_nm.powi(2);
    let (mut x, mut p, mut sum) = (0.0, stationary, 0.0);
    for value in values {
        let Some(r) = value else {
            (x, p) = (0.0, stationary);
            continue;
        };
        let s = p + process.white_nm.powi(2);
        let e = (r - x) / s.sqrt();
        sum -= 0.5 * s.ln() + huber(e);
        // What does not fit moves the process no further than what just fits would.
        let heard = e.clamp(-HUBER, HUBER) * s.sqrt();
        (x, p) = (x + p / s * heard, p * process.white_nm.powi(2) / s);
        (x, p) = (kept * x, kept * kept * p + (1.0 - kept * kept) * stationary);
    }
    sum
}

fn huber(e: f64) -> f64 {
    let size = e.abs();
    if size <= HUBER { 0.5 * e * e } else { HUBER * (size - 0.5 * HUBER) }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn a_process_comes_back_whatever_touches_a_tenth_of_the_time() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut normal = || (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0;
        let (dt, lasting_s) = (0.05, 1.0f64);
        let kept = (-dt / lasting_s).exp();
        let mut x = 0.0;
        let mut one = |k: usize| {
            x = kept * x + (1.0 - kept * kept).sqrt() * normal();
            let touched = if (500..700).contains(&k) { 10.0 } else { 0.0 };
            2.0 * x + 0.2 * normal() + touched
        };
        let values: Vec<f64> = (0..2000).map(&mut one).collect();
        let left = Left {
            torque: crate::series::JointSeries::from_joints(&[values]),
            holds: crate::series::JointSeries::zeros(1, 2000),
            friction: vec![vec![Friction::Slides; 2000]],
        };
        let noise = Noise::learn(Heard { left: &left, every: 1, dt }, &[]);
        let found = noise.at(0, Friction::Slides);
        assert!((1.4..3.5).contains(&found.spread_nm), "{found:?}");
        assert!((0.5..=2.0).contains(&found.lasting_s), "{found:?}");
    }

    /// Nothing is left of a simulation without noise: variances stay above zero all the same.
    #[test]
    fn exact_torque_has_a_spread_too() {
        let nothing = || crate::series::JointSeries::zeros(1, 500);
        let friction = vec![vec![Friction::Slides; 500]];
        let left = Left { torque: nothing(), holds: nothing(), friction };
        let noise = Noise::learn(Heard { left: &left, every: 1, dt: 0.05 }, &[]);
        for friction in [Friction::Slides, Friction::Holds, Friction::Rests, Friction::Changes] {
            let Process { spread_nm, white_nm, .. } = *noise.at(0, friction);
            assert!(spread_nm.powi(2) > 0.0 && white_nm.powi(2) > 0.0, "{friction:?}");
        }
    }
}
