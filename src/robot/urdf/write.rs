//! A [`Robot`] as URDF text: joints, inertias, a `tool0` frame, and cylinders to look at.

use std::f64::consts::PI;
use std::fmt::Write;

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::visual::{self, Cylinder, Shape};
use crate::robot::{Body, Inertia, Joint, Limits, Placement, Robot};

/// What a URDF may say besides the arm itself.
#[derive(Debug, Clone, Default)]
pub struct Additions {
    /// Lines of a comment at the top.
    pub head: Vec<String>,
    /// Elements inside each joint.
    pub joints: Vec<String>,
    /// How the base stands in a link `world`.
    pub base: Option<Placement>,
    /// Elements after the flange, which they call [`Additions::TOOL`].
    pub tool: String,
}

impl Additions {
    pub const TOOL: &str = "{tool}";
}

/// URDF of any robot; numbers are printed so that reading them back gives the same bits. The root
/// link `base` is the arm's base frame, `tool0` its flange.
pub fn write(robot: &Robot) -> String {
    let head = "Made by `armtwin urdf`; inertial frames have the axes of their links.";
    let base = stand(robot);
    write_with(robot, &Additions { head: vec![head.into()], base, ..Additions::default() })
}

/// How the base stands in a world whose gravity is along -z, if it does not stand upright. How it is
/// turned about the vertical cannot be told, nor does it matter.
pub fn stand(robot: &Robot) -> Option<Placement> {
    let (seen, level) = (robot.gravity, -Vector3::z());
    if seen.x == 0.0 && seen.y == 0.0 && seen.z <= 0.0 {
        return None;
    }
    let upside_down = || Rotation3::from_axis_angle(&Vector3::x_axis(), PI);
    let rotation = Rotation3::rotation_between(&seen, &level).unwrap_or_else(upside_down);
    Some(Placement { rotation: *rotation.matrix(), ..Placement::identity() })
}

/// URDF of any robot with `more` in it.
pub fn write_with(robot: &Robot, more: &Additions) -> String {
    let (base, tool) = (&free_name(robot, "base"), &free_name(robot, "tool0"));
    let mut text = String::from("<?xml version=\"1.0\"?>\n");
    let _ = writeln!(text, "<!-- {} -->", more.head.join("\n     "));
    let _ = writeln!(text, "<robot name=\"{}\">", escape(&robot.name));
    if let Some(stands) = &more.base {
        text += "  <link name=\"world\"/>\n";
        text += &fixed("base_fixed_joint", stands, "world", base);
    }
    text += &link(base, None, visual::base(robot));
    for (i, body) in robot.bodies.iter().enumerate() {
        let Shape { hub, tubes } = visual::body(robot, i);
        text += &link(&body.name, Some(&body.inertia), hub.into_iter().chain(tubes));
        let parent = body.parent.map_or(base, |p| &robot.bodies[p].name);
        let inside = more.joints.get(i).map_or("", String::as_str);
        text += &joint(&body.joint, parent, body, inside);
    }
    let _ = writeln!(text, "  <link name=\"{tool}\"/>");
    let carrier = robot.carrier().map_or(base, |i| &robot.bodies[i].name);
    text += &fixed(&format!("{tool}_fixed_joint"), &robot.flange, carrier, tool);
    text += &more.tool.replace(Additions::TOOL, tool);
    text + "</robot>\n"
}

/// Moving links of other people's arms may be called `base`.
fn free_name(robot: &Robot, wanted: &str) -> String {
    let mut name = wanted.to_string();
    while robot.bodies.iter().any(|b| b.name == name) {
        name.push('_');
    }
    name
}

fn link(
    name: &str,
    inertia: Option<&Inertia>,
    cylinders: impl IntoIterator<Item = Cylinder>,
) -> String {
    let mut text = format!("  <link name=\"{}\">\n", escape(name));
    if let Some(inertia) = inertia {
        text += &inertial(inertia);
    }
    for c in cylinders {
        let _ = write!(
            text,
            "    <visual>\n      {}\n      <geometry><cylinder radius=\"{}\" length=\"{}\"/>\
             </geometry>\n    </visual>\n",
            origin(&c.placement),
            c.radius,
            c.length
        );
    }
    text + "  </link>\n"
}

/// The `<inertial>` element of a link.
pub fn inertial(inertia: &Inertia) -> String {
    let i = &inertia.about_com;
    format!(
        "    <inertial>\n      <origin xyz=\"{}\" rpy=\"0 0 0\"/>\n      <mass value=\"{}\"/>\n      \
         <inertia ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" iyz=\"{}\" izz=\"{}\"/>\n    \
         </inertial>\n",
        triple(&inertia.com),
        inertia.mass,
        i.m11 + 0.0,
        i.m12 + 0.0,
        i.m13 + 0.0,
        i.m22 + 0.0,
        i.m23 + 0.0,
        i.m33 + 0.0
    )
}

fn joint(joint: &Joint, parent: &str, body: &Body, inside: &str) -> String {
    let continuous = joint.limits.upper.is_infinite();
    format!(
        "  <joint name=\"{}\" type=\"{}\">\n    {}\n    <parent link=\"{}\"/>\n    \
         <child link=\"{}\"/>\n    <axis xyz=\"{}\"/>\n{}{inside}  </joint>\n",
        escape(&joint.name),
        if continuous { "continuous" } else { "revolute" },
        origin(&joint.placement),
        escape(parent),
        escape(&body.name),
        triple(&joint.axis),
        limit(&joint.limits)
    )
}

/// Nothing for a joint without limits; an unlimited velocity or effort is 0, as in most URDFs.
fn limit(l: &Limits) -> String {
    if [l.velocity, l.effort, l.upper].into_iter().all(f64::is_infinite) {
        return String::new();
    }
    let range = if l.upper.is_infinite() {
        String::new()
    } else {
        format!("lower=\"{}\" upper=\"{}\" ", l.lower, l.upper)
    };
    let [velocity, effort] = [l.velocity, l.effort].map(|x| if x.is_finite() { x } else { 0.0 });
    format!("    <limit {range}velocity=\"{velocity}\" effort=\"{effort}\"/>\n")
}

fn fixed(name: &str, placement: &Placement, parent: &str, child: &str) -> String {
    format!(
        "  <joint name=\"{name}\" type=\"fixed\">\n    {}\n    \
         <parent link=\"{}\"/>\n    <child link=\"{child}\"/>\n  </joint>\n",
        origin(placement),
        escape(parent)
    )
}

fn origin(placement: &Placement) -> String {
    let rpy = roll_pitch_yaw(&placement.rotation);
    format!("<origin xyz=\"{}\" rpy=\"{}\"/>", triple(&placement.translation), triple(&rpy))
}

/// Adding zero turns -0 into 0.
fn triple(v: &Vector3<f64>) -> String {
    format!("{} {} {}", v.x + 0.0, v.y + 0.0, v.z + 0.0)
}

/// Angles with R = Rot_z(yaw) Rot_y(pitch) Rot_x(roll). Roll is read after undoing yaw, which
/// keeps full accuracy where pitch is +-pi/2 and only roll - yaw is determined.
fn roll_pitch_yaw(r: &Matrix3<f64>) -> Vector3<f64> {
    let yaw = if r.m11.hypot(r.m21) < 1e-9 { 0.0 } else { r.m21.atan2(r.m11) };
    let (s, c) = yaw.sin_cos();
    let pitch = (-r.m31).atan2(c * r.m11 + s * r.m21);
    let roll = (s * r.m13 - c * r.m23).atan2(c * r.m22 - s * r.m12);
    Vector3::new(roll, pitch, yaw)
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
