//! An encoder that shows q + d where the joint is at q: tau = -d tau/dq d.
//!
//! The columns are linear in small offsets; felt by all joints.

use super::{About, Effect, Mechanism, Motion, Parameter, Role, Scope};
use crate::series::JointSeries;

pub struct EncoderOffset;

static ABOUT: About = About {
    name: "encoder_offset",
    law: "tau = ID(q - d) - ID(q)",
    scope: Scope::Link,
    parameters: &[Parameter {
        name: "encoder_offset",
        symbol: "d",
        unit: "rad",
        min: -0.2,
        max: 0.2,
        typical: 0.01,
        null: 0.0,
        role: Role::Linear,
    }],
    memory: 0,
    dissipates: false,
    cause: "joint zero lost or never calibrated: after a collision, a repair, or an assembly by eye",
    remedy: "calibrate the joint zeros, or subtract the offset from the recorded positions",
    source: "Hollerbach, Khalil, Gautier, Model identification, Handbook of Robotics, 2nd ed., 2016, section 6.2: joint offsets",
};

impl Effect for EncoderOffset {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn reach(&self, motion: &Motion<'_>, from: usize, _: &[f64]) -> Vec<JointSeries> {
        // The joint stands behind what its encoder shows.
        vec![motion.slopes(from).0[0].map_joints(|_, slope| slope.iter().map(|s| -s).collect())]
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        mechanism.encoder_zero[joint] += values[0];
    }
}
