//! Forces from outside: when something touched the arm, where, and how strongly, from the torque
//! that the twin does not account for.
//!
//! A force F (N, base axes) on the arm at a point of a link adds tau = -J^T F to what the drives
//! must supply (J the linear Jacobian of the point; Haddadin, De Luca, Albu-Schaffer, *Robot
//! Collisions: A Survey*, IEEE Trans. Robotics 33(6), 2017, eq. 1 and section V): a contact loads
//! only the joints between the base and the link that is touched. The force is a random process of
//! no given shape, beside what the twin leaves without a contact, which is one too (`noise`). When
//! something touches is the most probable course of a model that switches between the two (`model`,
//! `search`): a contact must gain more in log-evidence than a force of any shape does by chance. What
//! the force is over time, a smoother says (`smooth`); which link, the evidences of forces at points
//! along all links, held against each other (`contact`).
//!
//! A joint that stands shows a force only as far as it exceeds what friction holds, and friction
//! holds more or less of it as it comes and goes. That is in the uncertainty.

mod contact;
mod kalman;
mod left;
mod model;
mod noise;
mod places;
mod search;
mod smooth;
#[cfg(test)]
mod tests;

pub use contact::{Contact, Instant};
pub use left::{Friction, Left, left};
pub use noise::{Heard, Noise, Process};

use std::ops::Range;

use contact::Stretch;
use model::{Mode, Steps, Switching};
use places::{along, places};

use crate::follow::Watch;
use crate::robot::Robot;
use crate::series::JointSeries;

/// What is taken for a contact.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Criteria {
    /// One contact per this time is expected, s: nothing touches most of the time.
    pub apart_s: f64,
    /// A contact is expected to last this long, s: a push.
    pub lasts_s: f64,
    /// A force is another after this time, s: as quickly as a hand changes it. Contacts nearer to
    /// each other are one.
    pub force_s: f64,
    /// While something touches, friction that holds a joint has given way to it after this time, s.
    pub yields_s: f64,
    /// Size of a force that is expected, of the arm's weight.
    pub of_weight: f64,
    /// Log-odds from which a contact is told, nats: 20 to 1, with how rare contacts are counted in.
    pub log_odds: f64,
    /// Share of the stretch's squared residual that the force must take off: where it takes off
    /// less, something happened to friction.
    pub explained: f64,
    /// Standard deviations that its peak must be large.
    pub certain: f64,
    /// What is over sooner is not told from a jump of the friction, s: a period and a half of the
    /// torque's usual low-pass.
    pub shortest_s: f64,
    /// Only the flange is touched: a tool, a sensor there.
    pub at_flange: bool,
}

impl Default for Criteria {
    fn default() -> Self {
        Self {
            apart_s: 60.0,
            lasts_s: 2.0,
            force_s: 0.5,
            yields_s: 1.0,
            of_weight: 0.1,
            log_odds: 3.0,
            explained: 0.25,
            certain: 2.0,
            shortest_s: 0.19,
            at_flange: false,
        }
    }
}

/// What is left of a recording, and what is known of the arm in it.
#[derive(Debug, Clone, Copy)]
pub struct Residual<'a> {
    /// As a contact names it.
    pub recording: &'a str,
    pub robot: &'a Robot,
    /// Time of the first sample in the recording, and between samples, s.
    pub start: f64,
    pub dt: f64,
    /// rad
    pub q: &'a JointSeries,
    pub left: &'a Left,
    /// Samples that may be used: no gaps, no margins.
    pub usable: &'a [bool],
    /// One step of the filter in so many samples.
    pub every: usize,
    pub noise: &'a Noise,
}

/// Standard gravity, m/s^2.
const G: f64 = 9.81;

/// Contacts in a recording, in the order of time. `watch` is told how far the search is.
pub fn contacts(input: &Residual<'_>, criteria: &Criteria, watch: &dyn Watch) -> Vec<Contact> {
    let mut all = places(input.robot);
    if criteria.at_flange {
        all.retain(|place| Some(place.link) == input.robot.carrier());
    }
    let pieces: Vec<Vec<usize>> = crate::signals::runs(input.usable)
        .into_iter()
        .map(|whole| whole.step_by(input.every.max(1)).collect())
        .collect();
    let of: usize = pieces.iter().map(Vec::len).sum();
    let (mut found, mut before) = (Vec::new(), 0);
    for samples in &pieces {
        let tell = |k| watch.tell("searching for contacts, step", (before + k) as u64, of as u64);
        found.extend(in_one_piece(input, criteria, &all, samples, &tell));
        before += samples.len();
    }
    let told = |c: &Contact| {
        c.log_odds >= criteria.log_odds
            && c.explained >= criteria.explained
            && c.peak_n >= criteria.certain * c.peak_sd_n
            && c.end_s - c.start_s >= criteria.shortest_s
    };
    found.retain(told);
    found
}

/// Contacts in samples without a gap between them; `tell` hears how many are searched.
fn in_one_piece(
    input: &Residual<'_>,
    criteria: &Criteria,
    places: &[places::Place],
    samples: &[usize],
    tell: &dyn Fn(usize),
) -> Vec<Contact> {
    let times: Vec<f64> = samples.iter().map(|k| input.start + *k as f64 * input.dt).collect();
    let steps = steps(input, criteria, places, samples);
    let switching = Switching::new(criteria, steps.dt, places.len());
    let modes = search::course(&steps, &switching, tell);
    let near = (criteria.force_s / steps.dt) as usize;
    let stretches = touched(&modes, near);
    let modes = whole_contacts(&modes, &stretches);
    let stretch = |inside: &Range<usize>| Stretch {
        recording: input.recording,
        steps: &steps,
        places,
        times: &times,
        criteria,
        modes: &modes,
        from: inside.start,
        until: inside.end,
        beforehand: switching.contact(inside.len()),
    };
    stretches.iter().map(|inside| stretch(inside).contact()).collect()
}

/// Stretches in which anything touches, those at most `near` steps apart taken together.
fn touched(modes: &[Mode], near: usize) -> Vec<Range<usize>> {
    let mut all: Vec<Range<usize>> = Vec::new();
    let touched: Vec<bool> = modes.iter().map(Option::is_some).collect();
    for run in crate::signals::runs(&touched) {
        match all.last_mut() {
            Some(last) if run.start - last.end <= near => last.end = run.end,
            _ => all.push(run),
        }
    }
    all
}

/// One place per stretch: where most of it is touched.
fn whole_contacts(modes: &[Mode], stretches: &[Range<usize>]) -> Vec<Mode> {
    let mut whole = vec![None; modes.len()];
    for inside in stretches {
        let held = |place: &Mode| modes[inside.clone()].iter().filter(|m| *m == place).count();
        let most = modes[inside.clone()].iter().filter(|m| m.is_some()).max_by_key(|m| held(m));
        whole[inside.clone()].fill(most.copied().flatten());
    }
    whole
}

fn steps(
    input: &Residual<'_>,
    criteria: &Criteria,
    places: &[places::Place],
    samples: &[usize],
) -> Steps {
    let joints = input.q.joints();
    let dt = input.dt * input.every.max(1) as f64;
    let levels: Vec<f64> = (0..joints).map(|j| noise::level(input.left, j)).collect();
    let row = |value: &dyn Fn(usize, usize) -> f64| -> Vec<Vec<f64>> {
        samples.iter().map(|&k| (0..joints).map(|j| value(j, k)).collect()).collect()
    };
    let noise = |j: usize, k: usize| input.noise.at(j, input.left.friction[j][k]);
    let weight: f64 = input.robot.bodies.iter().map(|b| b.inertia.mass * G).sum();
    Steps {
        dt,
        joints,
        residual: row(&|j, k| input.left.torque.joint(j)[k] - levels[j]),
        spread: row(&|j, k| noise(j, k).spread_nm),
        white: row(&|j, k| noise(j, k).white_nm.powi(2)),
        kept: row(&|j, k| (-dt / noise(j, k).lasting_s).exp()),
        friction: samples
            .iter()
            .map(|&k| input.left.friction.iter().map(|f| f[k]).collect())
            .collect(),
        levers: places.iter().map(|p| along(input.robot, input.q, samples, p)).collect(),
        force_n: criteria.of_weight * weight,
        force_kept: (-dt / criteria.force_s).exp(),
        yielding: (-dt / criteria.yields_s).exp(),
    }
}
