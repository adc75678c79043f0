//! What these data cannot tell, and why.

use rayon::prelude::*;

use super::candidate::{Candidate, Place};
use super::model::Fit;
use super::{Untestable, select};
use crate::effects::{Parameter, Role, Scope};

/// Share of a column that nothing else shows, below which an effect cannot be told from the rest.
const LEAST_OWN: f64 = 1e-3;
/// A typical effect this many standard errors large would be seen.
const LEAST_SEEN: f64 = 4.0;

/// The candidates that would not show if they were there at their typical size.
pub fn untestable(fit: &Fit<'_, '_>, candidates: &[Candidate]) -> Vec<Untestable> {
    let why = |c: &Candidate| {
        let why = reason(fit, *c)?;
        Some(Untestable { effect: c.name().into(), joints: c.place.joints(), why })
    };
    candidates.par_iter().filter_map(why).collect()
}

fn reason(fit: &Fit<'_, '_>, candidate: Candidate) -> Option<String> {
    let about = candidate.effect.about();
    if candidate.senses() {
        return match about.name {
            "velocity_lag" => {
                Some("the velocity used is made from positions, which do not lag".into())
            }
            _ => None,
        };
    }
    if let (Place::Joint(j), Scope::Joint) = (candidate.place, about.scope)
        && fit.evidence.rows[j].is_empty()
    {
        return Some("the joint hardly slides: move it".into());
    }
    let typical = typical(about.parameters, Role::Nonlinear);
    let columns = fit.columns(candidate, &typical);
    if columns.iter().all(|c| c.0.iter().all(Vec::is_empty)) {
        return Some(match about.name {
            "temperature_friction" => {
                "no joint temperatures are recorded, or they do not change".into()
            }
            _ => "it would give no torque in this motion".into(),
        });
    }
    let projected = fit.system.project(&columns);
    let own = projected.own_share();
    let linear = typical_linear(about.parameters);
    let size = |i: usize| linear[i].powi(2) * projected.information[(i, i)].max(0.0);
    let seen: f64 = (0..linear.len()).map(size).sum::<f64>().sqrt();
    if own.iter().all(|o| *o < LEAST_OWN) {
        return Some("in this motion its torque is that of effects the twin already has".into());
    }
    (seen < LEAST_SEEN).then(|| {
        format!(
            "at its typical size it would be {seen:.1} standard errors large, {LEAST_SEEN:.0} are \
             needed at {}",
            select::describe(candidate)
        )
    })
}

fn typical(parameters: &[Parameter], role: Role) -> Vec<f64> {
    parameters.iter().filter(|p| p.role == role).map(|p| p.typical).collect()
}

fn typical_linear(parameters: &[Parameter]) -> Vec<f64> {
    typical(parameters, Role::Linear)
}
