//! An elastic joint: the link winds up against the motor by c tau_load, c = 1/K.
//!
//! Positions are the motor's. The wind-up follows the load through the joint's resonance, which
//! is not linear in c: the columns are worked out at the compliance c0 and hold where the fitted c
//! comes near it (fit again with c0 = c). Felt by all joints. Of several elastic joints each column
//! comes on top of those before it ([`Motion::giving`]). Injecting takes c alone.
//!
//! What recordings show: below the resonance little more than c times the load's rate of change. At
//! c = 6e-5 that is a quarter of the noise at 30 dB: 60 s give a UR5's shoulder within 10 % (one standard
//! deviation), its elbow within 30 %, its base, which nothing loads, not at all. Nearer the resonance
//! there is more, of motion and torque alike: low-pass the motion well above the torque, or a joint that
//! swings between both comes out half as soft again; and torque faster than the controller follows
//! makes it look stiff.

use super::wind_up::lagging;
use super::{
    About, Effect, Mechanism, Motion, Parameter, Role, RoundTrip, Scope, Transmission, Worked,
    starts,
};
use crate::series::JointSeries;

pub struct JointFlexibility;

static ABOUT: About = About {
    name: "joint_flexibility",
    law: "tau = ID(q - c tau_load) - ID(q),  c = 1/K",
    scope: Scope::Link,
    parameters: &[
        Parameter {
            name: "joint_compliance",
            symbol: "c",
            unit: "rad/(N.m)",
            min: 0.0,
            max: 0.005,
            typical: 1e-4,
            null: 0.0,
            role: Role::Linear,
        },
        Parameter {
            name: "joint_hardening",
            symbol: "K3",
            unit: "N.m/rad3",
            min: 0.0,
            max: 1e9,
            typical: 0.0,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "joint_damping",
            symbol: "D",
            unit: "N.m.s/rad",
            min: 0.0,
            max: 500.0,
            typical: 20.0,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "joint_hysteresis",
            symbol: "h",
            unit: "N.m",
            min: 0.0,
            max: 50.0,
            typical: 0.0,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "hysteresis_width",
            symbol: "w",
            unit: "rad",
            min: 1e-5,
            max: 0.05,
            typical: 0.001,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
        Parameter {
            name: "compliance_reference",
            symbol: "c0",
            unit: "rad/(N.m)",
            min: 1e-7,
            max: 0.005,
            typical: 1e-4,
            null: f64::NAN,
            role: Role::Nonlinear,
        },
    ],
    memory: 0,
    dissipates: false,
    cause: "harmonic drives, belts and torque sensors twist under load",
    remedy: "put a spring between motor and link: two coaxial joints with stiffness and armature",
    source: "Spong, Modeling and control of elastic joint robots, J. Dyn. Sys. Meas. Control 109(4), 1987, eqs. 2 and 3",
};

impl Effect for JointFlexibility {
    /// Too little to search anew for it: the stiffness that is found is refined with the load.
    fn depends_on_load(&self) -> bool {
        false
    }

    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn outruns_motion(&self) -> bool {
        true
    }

    fn gives_way(&self) -> bool {
        true
    }

    fn kept(&self) -> &'static [&'static str] {
        &["joint_hardening", "joint_hysteresis", "hysteresis_width"]
    }

    fn starts(&self, motion: &Motion<'_>, _: usize) -> Vec<Vec<f64>> {
        let axes = [
            ("joint_damping", vec![10.0, 60.0]),
            ("compliance_reference", starts::between(1e-5, 2e-3, 7)),
        ];
        starts::grid_on(motion, ABOUT.parameters, &axes)
    }

    fn reach(&self, motion: &Motion<'_>, from: usize, nonlinear: &[f64]) -> Vec<JointSeries> {
        let Some((&reference, law)) = nonlinear.split_last() else { return vec![] };
        vec![lagging(motion, from, spring(reference, law), reference)]
    }

    fn build(&self, values: &[f64], joint: usize, mechanism: &mut Mechanism) {
        mechanism.give_way(joint, values[0], spring(values[0], &values[1..]));
    }

    fn worked(&self) -> Option<Worked> {
        let (load, slope) = (11.772 * f64::cos(1.0), 11.772 * f64::sin(1.0));
        let text = "held at 1 rad: 11.772 sin(1) x 11.772 cos(1) / (1e4 - 11.772 sin(1))";
        let values = [
            ("joint_compliance", 1e-4),
            ("joint_damping", 20.0),
            ("joint_hardening", 0.0),
            ("joint_hysteresis", 0.0),
            ("hysteresis_width", 1e-3),
        ];
        let torque = slope * load / (1e4 - slope);
        let held = Worked::along(text, torque, &values, vec![[1.0, 0.0, 0.0]; 90]);
        // Gravity is taken as a line over the wind-up.
        Some(Worked { within: 1e-3, ..held })
    }

    fn round_trip(&self) -> Option<RoundTrip> {
        Some(RoundTrip::fitted_wind_up(&["joint_compliance"]))
    }
}

/// The spring of a compliance, and of hardening, damping, hysteresis and its width.
fn spring(compliance: f64, law: &[f64]) -> Transmission {
    Transmission {
        stiffness: 1.0 / compliance,
        hardening: law[0],
        damping: law[1],
        gap: 0.0,
        hysteresis: law[2],
        hysteresis_width: law[3],
    }
}
