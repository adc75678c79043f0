//! The size at which a graft is as strong as it is to be.

use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;

use super::plan::Wanted;
use super::shape::{self, Shape, placed};
use super::{Ground, graft};
use crate::effects::{Effect, find};
use crate::simulation::Injection;
use crate::trials::{Kind, Strength, TrialError};

/// An effect at its size; times count from the start of a recording.
pub struct Graft {
    pub injection: Injection,
    pub strength: Strength,
}

impl Graft {
    pub fn effect(&self) -> &'static dyn Effect {
        self.injection.effect
    }

    pub fn kind(&self) -> Kind {
        match find(self.effect().about().name) {
            Some(_) => Kind::Grafted,
            None => Kind::GraftedForeign,
        }
    }
}

/// Times an effect is drawn anew where its range ends before its strength is reached.
const TRIES: usize = 6;
/// Effects tried in place of one that does not reach its strength.
const OTHERS: usize = 12;
/// Shares of the wanted strength: that counts as reached; that is enough to keep.
const REACHED: f64 = 0.95;
const ENOUGH: f64 = 0.5;

/// `wanted` brought to its strength on the first recording; where no joint and no proportions let it
/// come near, another effect.
///
/// # Errors
/// If none of them comes near.
pub fn sized(
    wanted: &Wanted,
    others: &[&'static str],
    pair: [&Ground; 2],
    mut rng: ChaCha8Rng,
) -> Result<Graft, TrialError> {
    let mut name = wanted.effect;
    for _ in 0..OTHERS {
        if let Some(graft) = best(name, wanted.strength, pair, &mut rng) {
            return Ok(graft);
        }
        name = others.choose(&mut rng).copied().unwrap_or(name);
    }
    let source = &pair[0].recording.provenance.source;
    Err(TrialError::Usage(format!(
        "{source}: neither {} nor another effect reaches a strength of {} within the catalogue's \
         ranges; ask for lower --strengths or other effects (--only)",
        wanted.effect, wanted.strength
    )))
}

fn best(name: &str, strength: f64, pair: [&Ground; 2], rng: &mut ChaCha8Rng) -> Option<Graft> {
    let mut best: Option<Graft> = None;
    for _ in 0..TRIES {
        let graft = brought_to(strength, &shape::draw(name, pair, rng)?, pair[0]);
        let reached = graft.strength.reached();
        if best.as_ref().is_none_or(|b| b.strength.reached() < reached) {
            best = Some(graft);
        }
        if reached >= REACHED * strength {
            break;
        }
    }
    best.filter(|b| b.strength.reached() >= ENOUGH * strength)
}

/// Scaled until it is as strong as wanted. What enters linearly is so after one step; references
/// and delays make it bend a little.
fn brought_to(wanted: f64, shape: &Shape, fit: &Ground) -> Graft {
    const STEPS: usize = 12;
    const CLOSE: f64 = 0.005;
    let mut size = 1.0_f64.min(shape.limit);
    let mut injection = shape.sized(size);
    let mut found = strength(&injection, fit);
    for _ in 0..STEPS {
        let reached = found.reached();
        let next = (size * (wanted / reached.max(1e-12)).clamp(1e-3, 1e3)).min(shape.limit);
        if (reached / wanted - 1.0).abs() < CLOSE || next == size || reached == 0.0 {
            break;
        }
        size = next;
        injection = shape.sized(size);
        found = strength(&injection, fit);
    }
    Graft { injection, strength: Strength { drawn: Some(wanted), ..found } }
}

/// The graft's torque over what the twin leaves of the untouched recording, joint by joint; of a
/// velocity that lags, its error over that of the recorded velocity.
pub fn strength(injection: &Injection, ground: &Ground) -> Strength {
    let here = placed(injection, ground);
    let over = |x: Vec<f64>, left: &[f64]| -> Vec<f64> {
        x.iter().zip(left).map(|(x, left)| x / left.max(f64::MIN_POSITIVE)).collect()
    };
    if injection.effect.about().name == "velocity_lag" {
        let error = ground.sliding(&graft::velocity_error(&here, ground));
        let ratio = over(error, &ground.velocity_left);
        return Strength { drawn: None, own: ratio.clone(), gap: ratio };
    }
    let torque = graft::torque(&here, ground);
    Strength {
        drawn: None,
        own: over(ground.own(&torque), &ground.left_nm),
        gap: over(ground.beyond_twin(&torque), &ground.left_nm),
    }
}
