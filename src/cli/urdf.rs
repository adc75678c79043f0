//! `armtwin urdf`: the URDF made from the tables.

use std::path::PathBuf;

use serde::Serialize;

use super::save;
use crate::robot::{self, Robot, urdf};

/// Write the URDF of a built-in arm, made from its DH and mass tables
#[derive(clap::Args)]
#[command(after_help = "Example: armtwin urdf --robot ur5e -o ur5e.urdf\n\n\
    `armtwin robots` lists the built-in arms. Given a URDF file instead of a name, it is read, \
    checked, its fixed joints merged, and written in the same form.")]
pub struct Args {
    /// Built-in name, or a URDF file to check and normalise
    #[arg(long, default_value = "ur5", value_name = "NAME")]
    robot: String,
    /// Write here instead of standard output
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write the arm's joints, limits and masses as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Of `--json`.
#[derive(Serialize)]
struct Arm<'a> {
    robot: &'a str,
    mass_kg: f64,
    joints: Vec<Moved<'a>>,
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
    /// In the joint's frame, whose z is its axis.
    com_m: [f64; 3],
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let robot = robot::load(&args.robot)?;
    let text = urdf::write(&robot);
    if let Some(path) = &args.json {
        save::json(path, "armtwin.arm/1", &arm(&robot))?;
    }
    match &args.out {
        Some(out) => save::text(out, &text),
        None => {
            print!("{text}");
            Ok(())
        }
    }
}

fn arm(robot: &Robot) -> Arm<'_> {
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
    Arm { robot: &robot.name, mass_kg, joints: joints.collect() }
}
