//! Effects no catalogue entry describes, injected in trials only: the right answer is "unknown".

use std::f64::consts::TAU;

use nalgebra::Vector3;

use crate::effects::{About, Effect, JointLoad, JointState, Parameter, Role, Scope};
use crate::robot::{flange_placement, point_jacobian};

pub static FOREIGN: &[&dyn Effect] =
    &[&SwingingLoad, &Hum, &Seizing, &Rubbing, &WanderingGain, &TwistedHose];

/// The effect by the name in its `about`.
pub fn find(name: &str) -> Option<&'static dyn Effect> {
    FOREIGN.iter().copied().find(|e| e.about().name == name)
}

pub(super) const fn parameter(
    name: &'static str,
    unit: &'static str,
    max: f64,
    typical: f64,
) -> Parameter {
    let role = Role::Nonlinear;
    Parameter { name, symbol: name, unit, min: -max, max, typical, null: 0.0, role }
}

pub(super) const fn about(
    name: &'static str,
    law: &'static str,
    scope: Scope,
    parameters: &'static [Parameter],
) -> About {
    About {
        name,
        law,
        scope,
        parameters,
        memory: 0,
        dissipates: false,
        cause: "not in the catalogue",
        remedy: "none: drawn in blind trials only",
        source: "armtwin, blind trials",
    }
}

/// A damped pendulum hung at the flange, swinging in all directions (small swings: a mass held by
/// a spring of its frequency), with its weight.
pub struct SwingingLoad;

static SWINGING_LOAD: About = About {
    memory: 7,
    ..about(
        "swinging_load",
        "tau = -J^T F,  F = -m (x'' - g),  x'' = w^2 (p - x) + 2 D w (p' - x')",
        Scope::Arm,
        &[
            parameter("swinging_mass", "kg", 3.0, 0.5),
            parameter("swinging_frequency", "Hz", 10.0, 1.3),
            parameter("swinging_damping", "-", 1.0, 0.03),
        ],
    )
};

impl Effect for SwingingLoad {
    fn about(&self) -> &'static About {
        &SWINGING_LOAD
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, m: &mut [f64], load: &mut JointLoad) {
        let (mass, w, damping) = (values[0], TAU * values[1], values[2]);
        let robot = state.arm.robot;
        let Some(last) = robot.dof().checked_sub(1) else { return };
        let p = flange_placement(robot, state.arm.q).translation;
        let jacobian = point_jacobian(robot, state.arm.q, last, &robot.flange.translation);
        let linear = jacobian.fixed_rows::<3>(0);
        let p_rate = linear * nalgebra::DVector::from_column_slice(state.arm.qd);
        if m[0] == 0.0 {
            m[0] = 1.0;
            m[1..4].copy_from_slice(p.as_slice());
        }
        let x = Vector3::from_column_slice(&m[1..4]);
        let x_rate = Vector3::from_column_slice(&m[4..7]);
        let pull = (p - x) * w * w + (p_rate - x_rate) * 2.0 * damping * w;
        let x_rate = x_rate + pull * state.dt;
        let x = x + x_rate * state.dt;
        m[1..4].copy_from_slice(x.as_slice());
        m[4..7].copy_from_slice(x_rate.as_slice());
        let force = (robot.gravity - pull) * mass;
        load.torque -= linear.column(state.joint).dot(&force);
    }
}

/// A torque that comes and goes with time, whatever the arm does.
pub struct Hum;

static HUM: About = about(
    "hum",
    "tau = a sin(2 pi f t + p)",
    Scope::Joint,
    &[
        parameter("hum_amplitude", "N.m", 20.0, 1.0),
        parameter("hum_frequency", "Hz", 20.0, 2.0),
        parameter("hum_phase", "rad", TAU, 0.0),
    ],
);

impl Effect for Hum {
    fn about(&self) -> &'static About {
        &HUM
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, _: &mut [f64], load: &mut JointLoad) {
        load.torque += values[0] * (TAU * values[1] * state.time + values[2]).sin();
    }
}

/// A bearing that seizes for some time.
pub struct Seizing;

static SEIZING: About = about(
    "seizing",
    "tau = F sign(qd),  start <= t < start + D",
    Scope::Joint,
    &[
        parameter("seizing_friction", "N.m", 40.0, 2.0),
        parameter("seizing_start", "s", 1e4, 15.0),
        parameter("seizing_duration", "s", 1e4, 15.0),
    ],
);

impl Effect for Seizing {
    fn about(&self) -> &'static About {
        &SEIZING
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, _: &mut [f64], load: &mut JointLoad) {
        if (values[1]..values[1] + values[2]).contains(&state.time) {
            load.dry += values[0];
        }
    }
}

/// Something that rubs over a part of the joint's travel.
pub struct Rubbing;

static RUBBING: About = about(
    "rubbing",
    "tau = F sign(qd),  |q - q0| <= width / 2",
    Scope::Joint,
    &[
        parameter("rubbing_friction", "N.m", 40.0, 2.0),
        parameter("rubbing_angle", "rad", TAU, 0.0),
        parameter("rubbing_width", "rad", TAU, 0.3),
    ],
);

impl Effect for Rubbing {
    fn about(&self) -> &'static About {
        &RUBBING
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, _: &mut [f64], load: &mut JointLoad) {
        if (state.q - values[1]).abs() <= 0.5 * values[2] {
            load.dry += values[0];
        }
    }
}

/// A torque sensor or drive whose gain wanders with time.
pub struct WanderingGain;

static WANDERING_GAIN: About = about(
    "wandering_gain",
    "tau = g sin(2 pi t / T + p) tau_load",
    Scope::Joint,
    &[
        parameter("wandering_gain", "-", 0.4, 0.05),
        parameter("wandering_period", "s", 1e3, 12.0),
        parameter("wandering_phase", "rad", TAU, 0.0),
    ],
);

impl Effect for WanderingGain {
    fn about(&self) -> &'static About {
        &WANDERING_GAIN
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, _: &mut [f64], load: &mut JointLoad) {
        let swing = (TAU * state.time / values[1] + values[2]).sin();
        load.torque += values[0] * swing * state.transmitted;
    }
}

/// A hose that damps a joint more or less as the neighbour turns.
pub struct TwistedHose;

static TWISTED_HOSE: About = about(
    "twisted_hose",
    "tau = d (1 + sin(3 q_neighbour)) qd",
    Scope::Joint,
    &[parameter("hose_damping", "N.m.s/rad", 60.0, 3.0)],
);

impl Effect for TwistedHose {
    fn about(&self) -> &'static About {
        &TWISTED_HOSE
    }

    fn act(&self, values: &[f64], state: &JointState<'_>, _: &mut [f64], load: &mut JointLoad) {
        let neighbour = if state.joint == 0 { 1 } else { state.joint - 1 };
        let angle = state.arm.q.get(neighbour).copied().unwrap_or(0.0);
        load.damping += values[0] * (1.0 + (3.0 * angle).sin());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::ArmState;
    use crate::simulation::{Injection, Injections};

    /// What acts on the whole arm, with a memory at every joint or worked out at once, is what acts joint by joint.
    #[test]
    fn an_effect_of_the_whole_arm_acts_at_every_joint() {
        let contact = crate::effects::find("external_contact").unwrap();
        let cases: [(&'static dyn Effect, &[f64]); 2] =
            [(&SwingingLoad, &[1.0, 1.3, 0.03]), (contact, &[1.0, -2.0, 3.0, 0.0, 10.0, 10.0])];
        let robot = crate::twin::Twin::default().robot;
        let (q, qd, none) =
            (vec![0.3; robot.dof()], vec![0.5; robot.dof()], vec![0.0; robot.dof()]);
        for (effect, values) in cases {
            let joints = (0..robot.dof()).collect();
            let mut all =
                Injections::new(&[Injection { effect, joints, values: vec![values.into()] }]);
            let mut memory = vec![vec![0.0; effect.about().memory]; robot.dof()];
            let mut loads = vec![JointLoad::default(); robot.dof()];
            for time in [0.0, 0.01, 0.02] {
                let (robot, q, qd, none) = (&robot, &q[..], &qd[..], &none[..]);
                let arm =
                    ArmState { robot, time, dt: 0.01, q, qd, transmitted: none, temperature: none };
                all.loads(&arm, &mut loads);
                for (j, load) in loads.iter().enumerate() {
                    let mut own = JointLoad::default();
                    effect.act(values, &arm.joint(j), &mut memory[j], &mut own);
                    assert!((load.torque - own.torque).abs() < 1e-12, "{}", effect.about().name);
                }
                assert!(loads.iter().any(|load| load.torque.abs() > 0.1));
            }
        }
    }
}
