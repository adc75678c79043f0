//! `armtwin excite`: a motion within limits that tells what is asked for.

use anyhow::{Context, anyhow, bail};
use indicatif::{ProgressBar, ProgressStyle};

use super::outputs::Output;
use super::twin::ArmArgs;
use super::{out, save};
use crate::excitation::write::{self, Format};
use crate::excitation::{Ask, Cuboid, Request, Surroundings, design, page};
use crate::studies::excitation as study;
use crate::twin::Twin;

/// Design a motion within limits that tells what is asked for as sharply as can be
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin excite --twin scenarios/twins/ur5.toml --seconds 30 --for friction -o next.csv
  armtwin excite --twin scenarios/twins/ur5.toml --for inertia --table-z -0.05 -o next.toml -o next.yaml
  armtwin excite --twin scenarios/twins/ur5.toml --apart payload,base_tilt -o next.script
  armtwin excite --twin scenarios/twins/ur5.toml --for inertia,friction --study 5 -o docs/excitation.md

--for takes inertia (all inertial parameters of all links), friction (coulomb, viscous, stribeck) and
effects of the catalogue, EFFECT at every joint or EFFECT@JOINT, parted by commas. --apart takes two
rivals, as `diagnose` names them: the motion then shows as much as it can of what one of them does and
the other cannot.

Every file's extension says what it is: .csv (RTDE names, 125 Hz), .yaml (ROS 2 JointTrajectory),
.script (URScript: movej to the start, then servoj) or .toml (a scenario of `armtwin simulate`).

The motion is simulated with all that the twin knows before anything is written; if the simulated arm
breaks a limit, nothing is. Boxes and heights are in metres in the axes of the base, x0,y0,z0 one
corner and x1,y1,z1 the opposite one. The links are capsules: look whether their radius covers your
arm, its cables and its tool. The same seed gives the same files.")]
pub struct Args {
    #[command(flatten)]
    arm: ArmArgs,
    /// Length of the motion, with a second of rest at both ends
    #[arg(long, value_name = "S", default_value_t = 30.0, allow_negative_numbers = true)]
    seconds: f64,
    /// What it shall tell: inertia, friction, EFFECT, EFFECT@JOINT, parted by commas
    #[arg(long = "for", value_name = "WHAT", default_value = "inertia")]
    what: String,
    /// Two effects that the motion shall tell apart: EFFECT[@JOINT],EFFECT[@JOINT] [default: --for decides]
    #[arg(long, value_name = "A,B", conflicts_with = "what")]
    apart: Option<String>,
    /// File for the motion, .csv, .yaml, .script or .toml; may be repeated
    #[arg(short, long, value_name = "FILE", required = true)]
    out: Vec<Output>,
    /// Largest distance of a joint from the middle pose, rad
    #[arg(long, value_name = "RAD", default_value_t = 1.0, allow_negative_numbers = true)]
    range: f64,
    /// Largest speed of any joint, rad/s, if its own limit is not lower
    #[arg(long, value_name = "RAD/S", default_value_t = 1.5, allow_negative_numbers = true)]
    speed: f64,
    /// Largest acceleration of any joint, rad/s2
    #[arg(long, value_name = "RAD/S2", default_value_t = 5.0, allow_negative_numbers = true)]
    acceleration: f64,
    /// Middle pose, one angle per joint, rad [default: above the table for UR arms, the middle of the joint
    /// limits for others]
    #[arg(long, value_name = "RAD,...", value_delimiter = ',', allow_hyphen_values = true)]
    home: Option<Vec<f64>>,
    /// Height of a table that no part of the arm may reach below, m [default: no table]
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    table_z: Option<f64>,
    /// A box that no part of the arm may touch, m; may be repeated [default: none]
    #[arg(long, value_name = "X0,Y0,Z0,X1,Y1,Z1", allow_hyphen_values = true)]
    keep_out: Vec<String>,
    /// Radius of the capsules around the links, m [default: 5 % of the arm's length]
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    radius: Option<f64>,
    /// Length of a tool beyond the flange, along its z axis, m
    #[arg(long, value_name = "M", default_value_t = 0.0, allow_negative_numbers = true)]
    tool: f64,
    /// Kept between surfaces, m
    #[arg(long, value_name = "M", default_value_t = 0.02, allow_negative_numbers = true)]
    clearance: f64,
    /// Noise of each joint's torque, standard deviation, N.m [default: 1 % of its largest torque]
    #[arg(long, value_name = "N.M,...", value_delimiter = ',', allow_hyphen_values = true)]
    noise: Option<Vec<f64>>,
    /// Rate of the recording the motion is made for, Hz
    #[arg(long, value_name = "HZ", default_value_t = 125.0, allow_negative_numbers = true)]
    rate: f64,
    /// Random seed for the search
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Motions the search tries: more take longer and tell more
    #[arg(long, value_name = "N", default_value_t = 10_000)]
    evaluations: usize,
    /// Write no motion: design one for every word of --for with each of N seeds, and write to FILE.md what
    /// they tell, beside random sines [default: one motion is written]
    #[arg(long, value_name = "N", conflicts_with = "apart", value_parser = clap::value_parser!(u64).range(1..=1000))]
    study: Option<u64>,
    /// Write what the motion tells, the limits it holds and all settings as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    if let Some(seeds) = args.study {
        return measure(args, seeds);
    }
    for path in &args.out {
        Format::of(path)?;
    }
    let twin = args.arm.load()?.twin;
    let request = request(args, &twin)?;
    let bar = progress(args.evaluations as u64);
    let designed = design(&twin, &request, |tried| bar.set_position(tried as u64))?;
    bar.finish_and_clear();
    out::page(&page(&designed.report));
    write::files(&designed, &args.out)?;
    if let Some(path) = &args.json {
        save::json(path, "armtwin.excitation/1", &json(args, &designed))?;
    }
    let names: Vec<String> = args.out.iter().map(|p| p.display().to_string()).collect();
    println!("\nThe motion: {}", names.join(", "));
    Ok(())
}

/// Studies every goal by itself, for `--study`.
fn measure(args: &Args, seeds: u64) -> anyhow::Result<()> {
    let markdown = |p: &Output| p.extension().is_some_and(|e| e.eq_ignore_ascii_case("md"));
    if let Some(other) = args.out.iter().find(|p| !markdown(p)) {
        bail!("{}: --study writes Markdown; name the file .md", other.display());
    }
    let twin = args.arm.load()?.twin;
    let goals: Vec<&str> = args.what.split(',').map(str::trim).filter(|g| !g.is_empty()).collect();
    let each = seeds * args.evaluations as u64;
    let bar = progress(each * goals.len() as u64);
    let mut all = Vec::new();
    for (i, goal) in goals.iter().enumerate() {
        let ask = Ask::learn(goal, twin.robot.dof()).context("--for")?;
        let request = Request { ask, ..request(args, &twin)? };
        let before = i as u64 * each;
        let done = |tried: usize| bar.set_position(before + tried as u64);
        all.push(study::measure(&twin, goal, &request, seeds, done)?);
    }
    bar.finish_and_clear();
    let source = args.arm.as_given();
    let mut text = format!(
        "# What designed motions tell\n\nMade by `armtwin excite{source} --for {} --seconds {} \
         --study {seeds}`, armtwin {}.\n\nExpected 99 % intervals of every parameter under white \
         noise, beside the median of random sines of the same length and limits. Percentages: half-width \
         over what the parameter, or an error of it, may well be, geometric mean over a group; beyond 100 % \
         such noise hides it.\n",
        args.what,
        args.seconds,
        env!("CARGO_PKG_VERSION"),
    );
    all.iter().for_each(|m| text += &format!("\n{}", study::page(m)));
    print!("{text}");
    args.out.iter().try_for_each(|path| save::text(path, &text))?;
    if let Some(path) = &args.json {
        save::json(path, "armtwin.excitation_study/1", &serde_json::json!({ "goals": all }))?;
    }
    Ok(())
}

fn json(args: &Args, designed: &crate::excitation::Design) -> serde_json::Value {
    serde_json::json!({
        "files": args.out,
        "robot": designed.twin.source,
        "for": args.apart.is_none().then_some(&args.what),
        "motion": designed.motion,
        "report": designed.report,
    })
}

fn request(args: &Args, twin: &Twin) -> anyhow::Result<Request> {
    let dof = twin.robot.dof();
    let ask = match &args.apart {
        Some(pair) => Ask::apart(pair, dof).context("--apart")?,
        None => Ask::learn(&args.what, dof).context("--for")?,
    };
    let keep_out = args.keep_out.iter().map(|b| cuboid(b)).collect::<anyhow::Result<_>>()?;
    Ok(Request {
        ask,
        seconds: args.seconds,
        range_rad: args.range,
        speed_rad_s: args.speed,
        acceleration_rad_s2: args.acceleration,
        home_rad: args.home.clone(),
        around: Surroundings { table_z: args.table_z, keep_out },
        radius_m: args.radius,
        tool_m: args.tool,
        clearance_m: args.clearance,
        noise_nm: args.noise.clone(),
        rate_hz: args.rate,
        seed: args.seed,
        evaluations: args.evaluations,
    })
}

/// Two opposite corners, in any order.
fn cuboid(text: &str) -> anyhow::Result<Cuboid> {
    let wrong =
        || anyhow!("--keep-out {text}: give six finite numbers: x0,y0,z0,x1,y1,z1, in metres");
    let numbers: Vec<f64> =
        text.split(',').map(|w| w.trim().parse().map_err(|_| wrong())).collect::<Result<_, _>>()?;
    let [x0, y0, z0, x1, y1, z1] = numbers[..] else { return Err(wrong()) };
    if numbers.iter().any(|x| !x.is_finite()) {
        return Err(wrong());
    }
    Ok(Cuboid {
        lower: [x0.min(x1), y0.min(y1), z0.min(z1)],
        upper: [x0.max(x1), y0.max(y1), z0.max(z1)],
    })
}

fn progress(evaluations: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("designing {wide_bar} {percent} %, {eta} left");
    ProgressBar::new(evaluations).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
