//! An effect of a scenario made weaker or stronger.

use super::StudyError;
use crate::effects::{Effect, Role, Seen};
use crate::simulation::Scenario;
use crate::twin::PerJoint;

/// The scenario with everything that is linear in `effect`, or the whole of a delay or lag, times
/// `strength`; references follow, and values may leave the catalogue's range.
pub(super) fn scaled(
    effect: &dyn Effect,
    scenario: &Scenario,
    strength: f64,
) -> Result<Scenario, StudyError> {
    let name = effect.about().name;
    let mut scenario = scenario.clone();
    let table = scenario.effects.get_mut(name);
    let table = table.ok_or_else(|| StudyError::Absent(name.into()))?;
    for p in effect.about().parameters {
        if p.is_reference() {
            table.remove(p.name);
        } else if p.role == Role::Linear || effect.seen() == Seen::Channels {
            table.entry(p.name.into()).and_modify(|value| *value = times(value, strength));
        }
    }
    if !scenario.beyond_range.iter().any(|b| b == name) {
        scenario.beyond_range.push(name.into());
    }
    Ok(scenario)
}

fn times(value: &PerJoint, factor: f64) -> PerJoint {
    match value {
        PerJoint::All(x) => PerJoint::All(factor * x),
        PerJoint::Each(all) => PerJoint::Each(all.iter().map(|x| factor * x).collect()),
    }
}
