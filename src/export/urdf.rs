//! URDF: corrected links, payload and tilt as links, `<dynamics>` for friction; no drive.

use super::number;
use super::plan::{JointPlan, Left, Plan};
use crate::robot::Inertia;
use crate::robot::urdf::{self, Additions};

/// What of a [`Plan`] URDF has no element for.
pub fn left(plan: &Plan) -> Vec<Left> {
    type Value = fn(&JointPlan) -> f64;
    let rows: [(&str, &str, &str, Value); 5] = [
        ("rotor_inertia", "kg.m2", "URDF has no armature; give it to the simulator", |j| {
            j.armature
        }),
        ("cable_spring", "N.m/rad", "URDF has no joint springs", |j| j.spring),
        ("encoder_offset", "rad", "URDF has no joint zeros; add it to the angles shown", |j| {
            j.encoder_zero
        }),
        (
            "current_offset",
            "N.m",
            "URDF has no drive; subtract it from the torque commanded",
            |j| j.offset,
        ),
        ("torque_constant", "N.m/A", "URDF has no drive; efforts are joint torques", |j| j.gain),
    ];
    let mut all = Vec::new();
    for (effect, unit, why, value) in rows {
        let joints: Vec<usize> =
            (0..plan.joints.len()).filter(|j| value(&plan.joints[*j]) != 0.0).collect();
        if joints.is_empty() {
            continue;
        }
        let values: Vec<String> =
            joints.iter().map(|j| format!("{:.4}", value(&plan.joints[*j]))).collect();
        let values = format!("{} {unit}", values.join(", "));
        all.push(Left { effect: effect.into(), joints, values, why: why.into() });
    }
    if let Some(servo) = &plan.servo {
        let gains: Vec<String> = servo.gain.iter().map(|k| format!("{k:.4}")).collect();
        all.push(Left {
            effect: "servo".into(),
            joints: (0..servo.dof()).collect(),
            values: format!("{} N.m/rad", gains.join(", ")),
            why: "URDF has no position servos; MJCF has".into(),
        });
    }
    all
}

pub fn write(plan: &Plan, head: &[String]) -> String {
    let mut robot = plan.robot.clone();
    for (body, joint) in robot.bodies.iter_mut().zip(&plan.joints) {
        if joint.torque_limit.is_finite() {
            body.joint.limits.effort = joint.torque_limit;
        }
    }
    urdf::write_with(
        &robot,
        &Additions {
            head: head.to_vec(),
            joints: plan.joints.iter().map(dynamics).collect(),
            base: urdf::stand(&plan.robot),
            tool: plan.payload.as_ref().map(payload).unwrap_or_default(),
        },
    )
}

fn dynamics(joint: &JointPlan) -> String {
    if joint.viscous == 0.0 && joint.coulomb == 0.0 {
        return String::new();
    }
    let (damping, friction) = (number(joint.viscous), number(joint.coulomb));
    format!("    <dynamics damping=\"{damping}\" friction=\"{friction}\"/>\n")
}

/// Bolted to the flange.
fn payload(load: &Inertia) -> String {
    format!(
        "  <link name=\"payload\">\n{}  </link>\n  <joint name=\"payload_fixed_joint\" \
             type=\"fixed\">\n    <parent link=\"{}\"/>\n    <child link=\"payload\"/>\n  </joint>\n",
        urdf::inertial(load),
        Additions::TOOL,
    )
}
