//! The arm that an effect is shown on.

use crate::effects::{About, DriveKind, Scope, find};
use crate::robot::Servo;
use crate::twin::Twin;

/// N.m/rad and N.m of position servos, where an effect is about such; any will do.
const GAIN: f64 = 1000.0;
const MAX_TORQUE: f64 = 100.0;

/// A UR5 without effects, its motors position servos where the effect is about such.
pub fn bare(about: &About) -> Twin {
    let mut twin = Twin { effects: Vec::new(), ..Twin::default() };
    let of_servos = find(about.name).is_some_and(|e| e.of_drive() == DriveKind::Servo);
    let [gain, max_torque] = [GAIN, MAX_TORQUE].map(|all| vec![all; twin.robot.dof()]);
    twin.drive.servo = of_servos.then(|| Servo { max_torque, ..Servo::new(gain) });
    twin
}

/// A UR5 that has this effect alone, at typical values.
pub fn typical(about: &About) -> Twin {
    let mut twin = Twin { effects: vec![about.name.into()], ..bare(about) };
    let count = if about.scope == Scope::Arm { 1 } else { twin.robot.dof() };
    for p in about.parameters.iter().filter(|p| !p.is_reference()) {
        twin.values.insert(p.name.into(), vec![p.typical; count]);
    }
    twin
}
