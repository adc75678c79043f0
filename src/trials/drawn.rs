//! What all simulated cases have in common, whatever the arm.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::asked::Draw;
use super::plan::Plan;
use super::truth::place;
use super::{Hidden, Kind, Strength, TrueValue};
use crate::diagnosis::Settings;
use crate::effects::Scope;
use crate::simulation::Injection;

/// Times a case is drawn anew because the arm ran away or the effect hardly showed.
pub const ATTEMPTS: u64 = 6;

/// Random numbers of an attempt at a case, whatever is drawn for the others.
pub fn stream(seed: u64, number: usize, attempt: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(1 + number as u64 + (attempt << 32));
    rng
}

/// What the answerer is told.
pub fn told(how: &Draw, plan: &Plan) -> Settings {
    let withheld = plan.effects.iter().filter(|_| plan.kind == Kind::Withheld);
    let without = withheld.map(|(name, _)| name.to_string()).collect();
    Settings { without, ..how.settings.clone() }
}

/// What a case hides, as its truth has it.
pub fn hidden(injection: &Injection, strength: &Strength, dof: usize) -> Hidden {
    let about = injection.effect.about();
    let joints: Vec<usize> = injection.joints.iter().map(|j| j + 1).collect();
    let value = |(i, p): (usize, &crate::effects::Parameter)| TrueValue {
        name: p.name.into(),
        values: injection.values.iter().map(|row| row[i]).collect(),
    };
    Hidden {
        effect: about.name.into(),
        joints: if about.scope == Scope::Arm { Vec::new() } else { place(&joints, dof) },
        parameters: about.parameters.iter().enumerate().map(value).collect(),
        strength: strength.clone(),
    }
}
