//! An encoder that shows q + d where the joint is at q: tau = -d tau/dq d.
//!
//! Gravity is not linear in an offset: the columns are worked out at a reference offset and exact there
//! (fit again with that of the fit). A tangent would be off by half the offset in radians: 5 % at
//! 0.1 rad, which other causes are then named for. Felt by all joints; of several offsets each is on
//! its own.

use super::rigid;
use super::{About, Effect, Mechanism, Motion, Parameter, Role, RoundTrip, Scope, Worked};
use crate::series::JointSeries;

pub struct EncoderOffset;

/// A joint put together one hole of twelve off stands 0.52 rad off.
const MOST_RAD: f64 = 0.6;
/// A smaller offset than this is as good as none, rad.
const TANGENT_RAD: f64 = 1e-5;

static ABOUT: About = About {
    name: "encoder_offset",
    law: "tau = ID(q - d) - ID(q)",
    scope: Scope::Link,
    parameters: &[
        Parameter {
            name: "encoder_offset",
            symbol: "d",
            unit: "rad",
            min: -MOST_RAD,
            max: MOST_RAD,
            typical: 0.01,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "offset_reference",
            symbol: "d0",
            unit: "rad",
            min: -MOST_RAD,
            max: MOST_RAD,
            typical: 0.0,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
    ],
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

    fn reach(&self, motion: &Motion<'_>, from: usize, nonlinear: &[f64]) -> Vec<JointSeries> {
        let [reference] = *nonlinear else { return vec![] };
        let offset = if reference.abs() < TANGENT_RAD { TANGENT_RAD } else { reference };
        // The joint stands behind what its encoder shows.
        let mut q = motion.q.clone();
        q.joint_mut(from).iter_mut().for_each(|q| *q -= offset);
        let there = rigid::torque(motion.robot, [&q, motion.qd, motion.qdd]);
        let here = motion.rigid_torque();
        let each = |(there, here): (&f64, &f64)| (there - here) / offset;
        vec![there.map_joints(|j, there| there.iter().zip(here.joint(j)).map(each).collect())]
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        mechanism.encoder_zero[joint] += values[0];
    }

    fn worked(&self) -> Option<Worked> {
        let text = "3 kg x 9.81 m/s2 x 0.4 m sin(0.1), shown upright";
        let at = [std::f64::consts::FRAC_PI_2, 0.0, 0.0];
        Some(Worked::torque(text, 11.772 * f64::sin(0.1), &[("encoder_offset", 0.1)], at))
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted(&["encoder_offset"]))
    }
}
