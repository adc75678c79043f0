//! A twin as the simulation takes it.

use crate::effects::{Effect, Scope};
use crate::signals::Samples;
use crate::simulation::{Injection, Thermal};
use crate::twin::Twin;

/// Temperature at which friction holds as it stands, where none is recorded, deg C.
const USUAL_C: f64 = 25.0;

/// The twin's known effects at the joints where they act. What begins at a time counts from
/// `start_s`, when the recording begins.
pub fn injections(twin: &Twin, start_s: f64) -> Vec<Injection> {
    let all: Vec<usize> = (0..twin.robot.dof()).collect();
    let others = twin.known().filter(|e| e.stands_for().is_none());
    let injection = |effect: &'static dyn Effect| {
        let whole_arm = effect.about().scope == Scope::Arm;
        let rows = if whole_arm { &all[..1] } else { &all[..] };
        let given = rows.iter().filter_map(|&j| Some((j, twin.values_at(effect, j)?)));
        let (joints, mut values): (Vec<usize>, Vec<Vec<f64>>) =
            given.filter(|(_, values)| acts(effect, values)).unzip();
        values.iter_mut().for_each(|values| count_from(effect, start_s, values));
        let joints = if whole_arm && !values.is_empty() { all.clone() } else { joints };
        Injection { effect, joints, values }
    };
    others.map(injection).filter(|i| !i.values.is_empty()).collect()
}

/// Is any parameter away from where the effect vanishes?
fn acts(effect: &dyn Effect, values: &[f64]) -> bool {
    let vanishing = effect.about().parameters.iter().zip(values).filter(|(p, _)| !p.null.is_nan());
    let mut vanishing = vanishing.peekable();
    vanishing.peek().is_none() || vanishing.any(|(p, v)| p.null != *v)
}

/// Moves an effect's times from the recording's clock to the simulation's, which starts at 0.
fn count_from(effect: &dyn Effect, start_s: f64, values: &mut [f64]) {
    for (p, value) in effect.about().parameters.iter().zip(values) {
        if p.name == "contact_start" {
            *value -= start_s;
        }
    }
}

/// Joints as warm as they were on average, all the time.
pub fn thermal(samples: &Samples) -> Thermal {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len().max(1) as f64;
    let of_joints = samples.temperature.as_ref().map(|t| {
        let joints: Vec<f64> = (0..t.joints()).map(|j| mean(t.joint(j))).collect();
        mean(&joints)
    });
    let warm = of_joints.filter(|t| t.is_finite()).unwrap_or(USUAL_C);
    Thermal { ambient_c: warm, start_c: warm, rise_k_per_w: 0.0, ..Thermal::default() }
}
