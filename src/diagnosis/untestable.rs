//! What these data cannot tell, and why.

use rayon::prelude::*;

use super::Untestable;
use super::candidate::{Candidate, Place};
use super::fit::Fit;
use crate::effects::{Needed, Parameter, Role, Scope};

/// Share of a column that nothing else shows, below which an effect cannot be told from the rest.
const LEAST_OWN: f64 = 1e-3;
/// A typical effect this many standard errors large would be seen.
const LEAST_SEEN: f64 = 4.0;

/// The candidates that would not show if they were there at their typical size, against what
/// `fit` leaves; joints of an effect with the same reason together.
pub fn untestable(fit: &Fit<'_>, candidates: &[Candidate]) -> Vec<Untestable> {
    let reasons: Vec<Option<&str>> = candidates.par_iter().map(|c| reason(fit, *c)).collect();
    let mut found: Vec<Untestable> = Vec::new();
    for (candidate, why) in candidates.iter().zip(reasons) {
        let Some(why) = why else { continue };
        let same = |u: &&mut Untestable| {
            u.effect == candidate.name() && u.why == why && candidate.place != Place::Arm
        };
        match found.iter_mut().find(same) {
            Some(known) => known.joints.extend(candidate.place.joints()),
            None => found.push(Untestable {
                effect: candidate.name().into(),
                joints: candidate.place.joints(),
                why: why.into(),
            }),
        }
    }
    found
}

fn reason(fit: &Fit<'_>, candidate: Candidate) -> Option<&'static str> {
    let about = candidate.effect.about();
    if candidate.senses() {
        // Asked of the channels themselves where both are recorded (`kinematics`).
        let asked = fit.data.parts[0].samples.sensed.is_some() || candidate.place != Place::Arm;
        let missing = !asked && candidate.effect.needs() == Some(Needed::Velocity);
        return missing.then_some("no velocities are recorded beside the positions");
    }
    if let (Place::Joint(j), Scope::Joint) = (candidate.place, about.scope)
        && fit.data.rows(j) == 0
    {
        return Some("the joint hardly slides: move it");
    }
    let typical = typical(about.parameters, Role::Nonlinear);
    let columns = fit.columns(candidate, &typical);
    if columns.iter().all(|c| c.rows.0.iter().all(Vec::is_empty)) {
        return Some(match candidate.effect.needs() {
            Some(Needed::Temperature) => {
                "no joint temperatures are recorded, or they do not change"
            }
            _ => "it would give no torque in this motion",
        });
    }
    let projected = fit.system.project(&columns, &vec![f64::INFINITY; columns.len()]);
    let own = projected.own_share();
    let linear = typical_linear(about.parameters);
    let size = |i: usize| linear[i].powi(2) * projected.information[(i, i)].max(0.0);
    let seen: f64 = (0..linear.len()).map(size).sum::<f64>().sqrt();
    if own.iter().all(|o| *o < LEAST_OWN) {
        return Some("in this motion its torque is that of effects the twin already has");
    }
    (seen < LEAST_SEEN).then_some("at its typical size it would hide in what is left")
}

fn typical(parameters: &[Parameter], role: Role) -> Vec<f64> {
    parameters.iter().filter(|p| p.role == role).map(|p| p.typical).collect()
}

fn typical_linear(parameters: &[Parameter]) -> Vec<f64> {
    typical(parameters, Role::Linear)
}
