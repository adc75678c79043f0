//! What a motion of the same length and limits tells that nobody designed: random sines.

use rayon::prelude::*;

use super::limits::{Limits, torque_along};
use super::question::{Answer, Question};
use crate::motion::{Kind, Sampled, Settings};
use crate::twin::Twin;

/// The random motions that hold all limits.
pub struct RandomSines {
    pub answers: Vec<Option<Answer>>,
    /// How many were drawn.
    pub drawn: usize,
    /// Largest distance from the middle pose at which enough of them hold the limits, rad.
    pub range_rad: f64,
}

const KINDS: [Kind; 2] = [Kind::RandomFrequency, Kind::Fourier];
/// Motions drawn per kind and range.
const SEEDS: u64 = 12;
/// Fewer have no median worth the name.
const ENOUGH: usize = 5;
const HALVINGS: i32 = 4;
/// Step of the grid on which they are judged, s.
pub const DT: f64 = 0.02;

/// Random sines with the range of `like`, or half of it and so on where too few of them keep clear.
pub fn random_sines(
    question: &Question<'_>,
    limits: &Limits<'_>,
    filled: &Twin,
    like: &Settings,
) -> RandomSines {
    let drawn = KINDS.len() * SEEDS as usize;
    for halving in 0..=HALVINGS {
        let range_rad = like.range_rad * 0.5_f64.powi(halving);
        let all: Vec<Settings> = (1..=SEEDS)
            .flat_map(|seed| KINDS.map(|kind| Settings { kind, seed, range_rad, ..like.clone() }))
            .collect();
        let held = |s: Settings| {
            let motion = s.trajectory(limits.robot).ok()?.sampled(DT);
            holds(&motion, limits, filled).then_some(motion)
        };
        let motions: Vec<Sampled> = all.into_par_iter().filter_map(held).collect();
        if motions.len() >= ENOUGH || (halving == HALVINGS && !motions.is_empty()) {
            let answers = motions.par_iter().map(|m| question.answer(m, DT)).collect();
            return RandomSines { answers, drawn, range_rad };
        }
    }
    RandomSines { answers: Vec::new(), drawn, range_rad: 0.0 }
}

fn holds(motion: &Sampled, limits: &Limits<'_>, filled: &Twin) -> bool {
    let tau = torque_along(filled, motion, DT);
    limits.held(motion, &tau).passed(limits.clearance_m).is_none()
}
