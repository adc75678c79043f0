//! `armtwin urdf`: the URDF of an arm alone.

use serde::Serialize;

use super::outputs::Output;
use super::{out, save};
use crate::robot::{self, Chain, Loaded, urdf};

/// Write the URDF of a built-in arm, or of the arm in another URDF
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin urdf --robot ur5e -o ur5e.urdf
  armtwin urdf --robot two_arms.urdf --base left_base --tip left_hand -o left.urdf

`armtwin robots` lists the built-in arms. Given a URDF file instead of a name, its arm is read, checked
and written in the same form: the revolute and continuous joints from base to tip. What hangs on
them otherwise (tools, grippers, cameras) is joined to its link, with its joints held at zero. Gravity is
along -z of the root link. What was assumed, because the file does not say or says it wrongly, is said
on standard error and in --json. A twin, a scenario and the [bag] table of a column map have the keys
robot, base and tip for the same, twins and scenarios flange as well.")]
pub struct Args {
    /// Built-in name, or a URDF file to check and normalise
    #[arg(long, default_value = "ur5", value_name = "NAME")]
    robot: String,
    /// The link the arm stands on, if its URDF has more than the arm [default: the root]
    #[arg(long, value_name = "LINK")]
    base: Option<String>,
    /// The link at which the arm ends [default: the end of the longest chain]
    #[arg(long, value_name = "LINK")]
    tip: Option<String>,
    /// The link that loads are bolted to, if more of the arm moves beyond it, as a gripper's jaw does [default: the tip]
    #[arg(long, value_name = "LINK")]
    flange: Option<String>,
    /// File to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    out: Option<Output>,
    /// Write the arm's joints, limits and masses as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

/// What `--json` writes.
#[derive(Serialize)]
struct Arm<'a> {
    robot: &'a str,
    /// The link it stands on, and the one at its flange.
    base: &'a str,
    tip: &'a str,
    /// Gravity in the base's frame, m/s^2.
    gravity_m_s2: [f64; 3],
    mass_kg: f64,
    joints: Vec<Moved<'a>>,
    /// What was assumed where the URDF does not say.
    notes: &'a [String],
}

/// A joint and the link it moves. Limits are absent where there are none.
#[derive(Serialize)]
struct Moved<'a> {
    /// From 1 at the base.
    joint: usize,
    name: &'a str,
    lower_rad: Option<f64>,
    upper_rad: Option<f64>,
    velocity_rad_s: Option<f64>,
    effort_nm: Option<f64>,
    link: &'a str,
    mass_kg: f64,
    /// Centre of mass in the joint's frame, whose z is its axis, m.
    com_m: [f64; 3],
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let (base, tip, flange) = (args.base.clone(), args.tip.clone(), args.flange.clone());
    let chain = Chain { base, tip, flange };
    let loaded = robot::load(&args.robot, &chain)?;
    out::notes(&args.robot, &loaded.notes);
    save::page(args.out.as_deref(), &urdf::write(&loaded.robot))?;
    if let Some(path) = &args.json {
        save::json(path, "armtwin.arm/1", &arm(&loaded))?;
    }
    Ok(())
}

fn arm(loaded: &Loaded) -> Arm<'_> {
    let robot = &loaded.robot;
    let finite = |x: f64| x.is_finite().then_some(x);
    let joints = robot.bodies.iter().enumerate().map(|(j, body)| Moved {
        joint: j + 1,
        name: &body.joint.name,
        lower_rad: finite(body.joint.limits.lower),
        upper_rad: finite(body.joint.limits.upper),
        velocity_rad_s: finite(body.joint.limits.velocity),
        effort_nm: finite(body.joint.limits.effort),
        link: &body.name,
        mass_kg: body.inertia.mass,
        com_m: body.inertia.com.into(),
    });
    let mass_kg = robot.bodies.iter().map(|b| b.inertia.mass).sum();
    Arm {
        robot: &robot.name,
        base: &loaded.base,
        tip: &loaded.tip,
        gravity_m_s2: robot.gravity.into(),
        mass_kg,
        joints: joints.collect(),
        notes: &loaded.notes,
    }
}
