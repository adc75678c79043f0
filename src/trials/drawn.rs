//! What all simulated cases have in common, whatever the arm: attempts, effects put in, the truth.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::asked::Draw;
use super::plan::Plan;
use super::truth::{SCHEMA, place};
use super::{Hidden, Kind, Strength, TrialError, TrueValue, Truth};
use crate::diagnosis::Settings;
use crate::effects::Scope;
use crate::simulation::{Injection, Setup};

/// Times a case is drawn anew because the arm ran away or the effect hardly showed.
const ATTEMPTS: u64 = 6;

/// What is drawn and then simulated, with the number of the attempt (from 0): drawn anew where the arm runs away
/// or what is hidden hardly shows, the last time however that is.
///
/// # Errors
/// If the last arm runs away too; all others at once.
pub fn attempts<H, T>(
    how: &Draw,
    number: usize,
    draw: impl Fn(&mut ChaCha8Rng) -> Result<H, TrialError>,
    shows: impl Fn(&H) -> bool,
    simulate: impl Fn(H) -> Result<T, TrialError>,
) -> Result<(u64, T), TrialError> {
    let mut attempt = 0;
    loop {
        let is_last = attempt + 1 == ATTEMPTS;
        let simulated = |hiding| match is_last || shows(&hiding) {
            true => simulate(hiding).map(Some),
            false => Ok(None),
        };
        match draw(&mut stream(how.seed, number, attempt)).and_then(simulated) {
            Ok(Some(done)) => return Ok((attempt, done)),
            Err(e) if is_last || !matches!(e, TrialError::Simulation { .. }) => return Err(e),
            _ => attempt += 1,
        }
    }
}

/// Random numbers of an attempt at a case, whatever is drawn for the others.
fn stream(seed: u64, number: usize, attempt: u64) -> ChaCha8Rng {
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

/// Puts an effect into the arm, in place of what it replaces.
pub fn inject(setup: &mut Setup, injection: &Injection, replaces_coulomb: bool) {
    if replaces_coulomb {
        let is_coulomb = |i: &&mut Injection| i.effect.about().name == "coulomb";
        if let Some(coulomb) = setup.effects.iter_mut().find(is_coulomb) {
            injection.joints.iter().for_each(|&j| coulomb.values[j][0] = 0.0);
        }
    }
    setup.effects.push(injection.clone());
}

/// The truth of a case that hides these in an arm of `dof` joints, without noise on a torque and without a third
/// recording; `made` is what else made it.
pub fn truth<'a>(
    how: &Draw,
    plan: &Plan,
    case: &str,
    effects: impl Iterator<Item = (&'a Injection, &'a Strength)>,
    dof: usize,
    made: serde_json::Value,
) -> Truth {
    Truth {
        schema: SCHEMA.into(),
        armtwin: env!("CARGO_PKG_VERSION").into(),
        case: case.into(),
        kind: plan.kind,
        effects: effects.map(|(injection, strength)| hidden(injection, strength, dof)).collect(),
        family: how.family.name().into(),
        noise_nm: Vec::new(),
        third: false,
        recordings: Vec::new(),
        base: None,
        made,
    }
}

/// What a case hides, as its truth has it.
fn hidden(injection: &Injection, strength: &Strength, dof: usize) -> Hidden {
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
