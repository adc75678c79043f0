//! The arm that an effect is shown on.

use crate::effects::{About, Scope};
use crate::twin::Twin;

/// A UR5 that has this effect alone, at typical values.
pub fn typical(about: &About) -> Twin {
    let mut twin = Twin { effects: vec![about.name.into()], ..Twin::default() };
    let count = if about.scope == Scope::Arm { 1 } else { twin.robot.dof() };
    for p in about.parameters.iter().filter(|p| !p.is_reference()) {
        twin.values.insert(p.name.into(), vec![p.typical; count]);
    }
    twin
}
