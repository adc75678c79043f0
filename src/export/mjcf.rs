//! MuJoCo's MJCF: bodies with exact inertias, joints with friction and armature, motors whose control
//! is the recorded current.

use std::fmt::Write;

use nalgebra::{Matrix3, Rotation3, SymmetricEigen, UnitQuaternion};

use super::plan::{JointPlan, Left, Plan};
use super::{escape, number, numbers};
use crate::robot::urdf::visual::{self, Cylinder, Shape};
use crate::robot::{Inertia, Placement, Robot, Servo};

/// s; a fifth of the time constants of the stiffest controllers of such arms.
const STEP_S: f64 = 0.001;

/// Everything in a [`Plan`] has its place here.
pub fn left(plan: &Plan) -> Vec<Left> {
    let dry: Vec<usize> =
        (0..plan.joints.len()).filter(|j| plan.joints[*j].coulomb > 0.0).collect();
    let soft = Left {
        effect: "coulomb".into(),
        joints: dry,
        values: String::new(),
        why:
            "frictionloss is a soft constraint, under load a standing joint creeps (solreffriction \
              and a smaller timestep make it stiffer)"
                .into(),
    };
    let mut all = if soft.joints.is_empty() { Vec::new() } else { vec![soft] };
    all.extend(plan.servo.iter().flat_map(of_servos));
    all
}

/// What a position actuator does not do.
fn of_servos(servo: &Servo) -> Vec<Left> {
    let why = [
        (
            "servo_dead_band",
            &servo.dead_band,
            "an actuator answers every error: take the band off the control",
        ),
        (
            "servo_friction",
            &servo.friction,
            "no joint's friction grows with its actuator: take a level of frictionloss that suits the load",
        ),
        ("servo_delay", &servo.delay, "hold the control back by so long"),
    ];
    let left = |(effect, values, why): (&str, &Vec<f64>, &str)| {
        let joints: Vec<usize> = (0..servo.dof()).filter(|j| values[*j] > 0.0).collect();
        let given: Vec<String> = joints.iter().map(|j| number(values[*j])).collect();
        Left { effect: effect.into(), joints, values: given.join(", "), why: why.into() }
    };
    why.into_iter().map(left).filter(|l| !l.joints.is_empty()).collect()
}

pub fn write(plan: &Plan, head: &[String]) -> String {
    let robot = &plan.robot;
    let mut out = String::from("<?xml version=\"1.0\"?>\n<!--\n");
    head.iter().for_each(|line| out += &format!("  {line}\n"));
    out += "-->\n";
    let _ = writeln!(out, "<mujoco model=\"{}\">", escape(&robot.name));
    out += "  <compiler angle=\"radian\" autolimits=\"true\"/>\n";
    let gravity = numbers(&robot.gravity);
    let _ = writeln!(
        out,
        "  <option timestep=\"{STEP_S}\" integrator=\"implicitfast\" gravity=\"{gravity}\"/>"
    );
    if robot.gravity != plan.level_gravity {
        out += "  <!-- gravity is that of a tilted base -->\n";
    }
    out += "  <default>\n    <geom type=\"cylinder\" contype=\"0\" conaffinity=\"0\" mass=\"0\" \
            rgba=\"0.6 0.65 0.7 1\"/>\n  </default>\n  <worldbody>\n    \
            <light pos=\"0 -2 3\" dir=\"0 0.5 -1\"/>\n";
    visual::base(robot).iter().for_each(|c| out += &geom(c, 2));
    let roots = (0..robot.dof()).filter(|i| robot.bodies[*i].parent.is_none());
    roots.for_each(|i| body(plan, i, 2, &mut out));
    out += "  </worldbody>\n";
    out += &plan.servo.as_ref().map_or_else(|| actuators(plan), |servo| positions(plan, servo));
    out + "</mujoco>\n"
}

fn body(plan: &Plan, i: usize, depth: usize, out: &mut String) {
    let robot = &plan.robot;
    let body = &robot.bodies[i];
    let pad = "  ".repeat(depth);
    let place = placement(&body.joint.placement);
    let _ = writeln!(out, "{pad}<body name=\"{}\" {place}>", escape(&body.name));
    *out += &inertial(&body.inertia, &pad);
    *out += &joint(robot, i, &plan.joints[i], &pad);
    let Shape { hub, tubes } = visual::body(robot, i);
    hub.iter().chain(&tubes).for_each(|c| *out += &geom(c, depth + 1));
    if robot.carrier() == Some(i) {
        *out += &flange(&robot.flange, plan.payload.as_ref(), &pad);
    }
    let children = (0..robot.dof()).filter(|c| robot.bodies[*c].parent == Some(i));
    children.for_each(|c| self::body(plan, c, depth + 1, out));
    let _ = writeln!(out, "{pad}</body>");
}

fn placement(p: &Placement) -> String {
    format!("pos=\"{}\" quat=\"{}\"", numbers(&p.translation), quaternion(p))
}

fn quaternion(p: &Placement) -> String {
    let rotation = Rotation3::from_matrix_unchecked(p.rotation);
    let q = UnitQuaternion::from_rotation_matrix(&rotation);
    numbers(&[q.w, q.i, q.j, q.k])
}

fn inertial(inertia: &Inertia, pad: &str) -> String {
    let i = &inertia.about_com;
    format!(
        "{pad}  <inertial pos=\"{}\" mass=\"{}\" fullinertia=\"{}\"/>\n",
        numbers(&inertia.com),
        number(inertia.mass),
        numbers(&[i.m11, i.m22, i.m33, i.m12, i.m13, i.m23])
    )
}

fn joint(robot: &Robot, i: usize, plan: &JointPlan, pad: &str) -> String {
    let joint = &robot.bodies[i].joint;
    let mut text = format!(
        "{pad}  <joint name=\"{}\" type=\"hinge\" axis=\"{}\"",
        escape(&joint.name),
        numbers(&joint.axis.into_inner())
    );
    let limits = &joint.limits;
    if limits.lower.is_finite() && limits.upper.is_finite() {
        text += &format!(" range=\"{}\"", numbers(&[limits.lower, limits.upper]));
    }
    let mut add = |name: &str, value: f64| {
        if value != 0.0 {
            text += &format!(" {name}=\"{}\"", number(value));
        }
    };
    add("damping", plan.viscous);
    add("frictionloss", plan.coulomb);
    add("armature", plan.armature);
    add("ref", plan.encoder_zero);
    if plan.spring != 0.0 {
        add("stiffness", plan.spring);
        add("springref", plan.rest);
    }
    text + "/>\n"
}

fn geom(c: &Cylinder, depth: usize) -> String {
    let pad = "  ".repeat(depth);
    let size = numbers(&[c.radius, 0.5 * c.length]);
    format!("{pad}<geom size=\"{size}\" {}/>\n", placement(&c.placement))
}

/// Principal axes at the centre of mass, and the moments about them: MuJoCo takes no `fullinertia` that is
/// only just possible (a point, a rod).
fn principal_axes(inertia: &Inertia) -> (Placement, [f64; 3]) {
    let eigen = SymmetricEigen::new(inertia.about_com);
    let mut rotation: Matrix3<f64> = eigen.eigenvectors;
    if rotation.determinant() < 0.0 {
        rotation.column_mut(2).neg_mut();
    }
    let moments = eigen.eigenvalues.map(|i| i.max(0.0));
    (Placement { rotation, translation: inertia.com }, moments.into())
}

/// Where tools are bolted on; a load there is a body of its own.
fn flange(flange: &Placement, load: Option<&Inertia>, pad: &str) -> String {
    let place = placement(flange);
    let mut text = format!("{pad}  <site name=\"tool0\" {place} size=\"0.01\"/>\n");
    if let Some(load) = load {
        let (principal, moments) = principal_axes(load);
        let _ = write!(
            text,
            "{pad}  <body name=\"payload\" {place}>\n\
             {pad}    <inertial {} mass=\"{}\" diaginertia=\"{}\"/>\n\
             {pad}  </body>\n",
            placement(&principal),
            number(load.mass),
            numbers(&moments)
        );
    }
    text
}

/// Torque of the joint = kp (control + offset - angle) - kv velocity. A motor's own voltage is in kv, which
/// forcerange clips with the rest: with all of the supply a real servo brakes more.
fn positions(plan: &Plan, servo: &Servo) -> String {
    let mut text = String::from(
        "  <!-- ctrl is the commanded angle in rad, as the servos are told it -->\n  <actuator>\n",
    );
    for (j, body) in plan.robot.bodies.iter().enumerate() {
        let name = escape(&body.joint.name);
        let [kp, kv] = [servo.gain[j], servo.damping[j]];
        let _ = match servo.offset[j] {
            0.0 => write!(
                text,
                "    <position name=\"{name}_servo\" joint=\"{name}\" kp=\"{}\" kv=\"{}\"",
                number(kp),
                number(kv)
            ),
            offset => write!(
                text,
                "    <general name=\"{name}_servo\" joint=\"{name}\" gainprm=\"{}\" biastype=\"affine\" \
                 biasprm=\"{}\"",
                number(kp),
                numbers(&[kp * offset, -kp, -kv])
            ),
        };
        if servo.max_torque[j].is_finite() {
            let limit = servo.max_torque[j];
            let _ = write!(text, " forcerange=\"{}\"", numbers(&[-limit, limit]));
        }
        text += "/>\n";
    }
    text + "  </actuator>\n"
}

/// Torque of the joint = gain x current - offset.
fn actuators(plan: &Plan) -> String {
    let mut text = String::from(
        "  <!-- ctrl is the motor current in A as the arm's controller reports it; the gain is N.m per A -->\n  \
         <actuator>\n",
    );
    for (body, plan) in plan.robot.bodies.iter().zip(&plan.joints) {
        let name = escape(&body.joint.name);
        let _ = write!(
            text,
            "    <general name=\"{name}_motor\" joint=\"{name}\" gainprm=\"{}\"",
            number(plan.gain)
        );
        if plan.offset != 0.0 {
            let offset = number(-plan.offset);
            let _ = write!(text, " biastype=\"affine\" biasprm=\"{offset} 0 0\"");
        }
        for (range, limit) in [("ctrlrange", plan.current_limit), ("forcerange", plan.torque_limit)]
        {
            if limit.is_finite() {
                let _ = write!(text, " {range}=\"{}\"", numbers(&[-limit, limit]));
            }
        }
        text += "/>\n";
    }
    text + "  </actuator>\n"
}
