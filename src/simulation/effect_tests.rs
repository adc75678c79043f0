//! Effects in rapier against Runge-Kutta twins that share nothing with it, and their energy books.

mod books;
mod driven;
mod runge_kutta;
mod sensors;
mod transmissions;

use super::*;
use crate::effects::{ArmState, CATALOGUE, Effect, JointLoad, Mechanism, Parameter, Role, Scope};
use crate::robot::builtin;

const ROTORS: [f64; 6] = [1.1, 1.1, 1.1, 0.14, 0.14, 0.14];
const VISCOUS: [f64; 6] = [8.0, 10.0, 7.0, 1.5, 1.2, 1.0];
/// Below this nothing that lowers dry friction may fall.
const COULOMB: [f64; 6] = [3.0, 3.0, 2.0, 0.6, 0.5, 0.4];
const TORQUE: [f64; 6] = [40.0, 40.0, 25.0, 8.0, 7.0, 5.0];
const HANGING: [f64; 6] = [0.0, 1.57, 0.0, 0.0, 0.0, 0.0];
const STILL: [f64; 6] = [0.0; 6];
/// Warm to begin with, and quick to follow what friction heats.
const THERMAL: Thermal =
    Thermal { ambient_c: 25.0, start_c: 45.0, rise_k_per_w: 0.5, time_constant_s: 1.0 };

/// N.m, a different swing at every joint.
fn push(t: f64) -> [f64; 6] {
    std::array::from_fn(|j| TORQUE[j] * ((2.0 + 0.7 * j as f64) * t).sin())
}

fn arm() -> Mechanism {
    Mechanism::with_armature(builtin("ur5").unwrap(), ROTORS.to_vec())
}

/// At its typical values at every joint, weaker at the wrist.
fn typical(effect: &'static dyn Effect) -> Injection {
    let values = |joint: usize| {
        let share = if effect.about().scope == Scope::Joint && joint > 2 { 0.2 } else { 1.0 };
        let value = |p: &Parameter| match p.role {
            Role::Linear => share * p.typical,
            Role::Nonlinear => p.typical,
        };
        effect.about().parameters.iter().map(value).collect()
    };
    Injection { effect, joints: (0..6).collect(), values: (0..6).map(values).collect() }
}

/// The arm with the effect, or with nothing.
fn injected(effect: Option<&'static dyn Effect>) -> (Mechanism, Injections) {
    let injections = Injections::new(&effect.map(typical).into_iter().collect::<Vec<_>>());
    let mut mechanism = arm();
    injections.build(&mut mechanism);
    (mechanism, injections)
}

/// Coulomb and viscous friction on top of what the effect does.
fn add_friction(loads: &mut [JointLoad]) {
    for (j, load) in loads.iter_mut().enumerate() {
        load.dry += COULOMB[j];
        load.damping += VISCOUS[j];
    }
}

/// Does the effect load the joints, of which the gears carry `transmitted` (N.m)?
fn loads_joints(effect: &'static dyn Effect, transmitted: f64) -> bool {
    let (mechanism, mut injections) = injected(Some(effect));
    let state = ArmState {
        robot: &mechanism.robot,
        time: 0.5,
        dt: 1e-3,
        q: &HANGING,
        qd: &[0.3; 6],
        transmitted: &[transmitted; 6],
        temperature: &[45.0; 6],
    };
    let mut loads = [JointLoad::default(); 6];
    injections.loads(&state, &mut loads);
    loads.iter().any(|load| *load != JointLoad::default())
}

/// Does the effect change masses, rotors or gravity?
fn changes_masses(effect: &'static dyn Effect) -> bool {
    let (mechanism, nominal) = (injected(Some(effect)).0, arm());
    mechanism.robot != nominal.robot || mechanism.armature != nominal.armature
}

fn gives_way(effect: &'static dyn Effect) -> bool {
    injected(Some(effect)).0.transmission.iter().any(Option::is_some)
}

/// Does the effect act in the mechanism while it moves? Others show in what is recorded, limited or
/// asked for.
fn acts(effect: &'static dyn Effect) -> bool {
    loads_joints(effect, 20.0) || changes_masses(effect) || gives_way(effect)
}

/// The largest difference.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
