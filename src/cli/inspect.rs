//! `armtwin inspect`: what a recording holds and what is wrong with it.

use std::path::PathBuf;

use super::outputs::Output;
use super::recordings::ReadArgs;
use super::save;
use super::twin::ArmArgs;
use crate::plausibility::{self, Judgement, Slope};
use crate::recording::Recording;
use crate::recording::inspection::{Inspection, JointMotion, JointSignal, Signal, inspect};
use crate::report::{paragraph, table};

/// Show what a recording holds, how good it is, and what is wrong with it
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin inspect log.csv
  armtwin inspect Movement_No6 --json inspection.json
  armtwin inspect log.csv --columns scenarios/columns/ur10e_shamilmamedov.toml
  armtwin inspect rosbag2_folder
  armtwin inspect log.csv --robot ur10e

With the arm, named by --robot or --twin, the weight that the recorded torque carries is held against the
arm's: that tells units, signs and the order of columns.")]
pub struct Args {
    /// File, bag, or folder with one log per signal
    recording: PathBuf,
    #[command(flatten)]
    read: ReadArgs,
    #[command(flatten)]
    arm: ArmArgs,
    /// Write the findings as JSON too
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let mut recording = args.read.read(&args.recording)?;
    let (arm, judged) = held_against(&args.arm, &mut recording)?;
    let mut inspection = inspect(&recording);
    let doubts = judged.doubts.iter().map(ToString::to_string);
    inspection.findings = doubts.chain(inspection.findings).collect();
    let inspected =
        Inspected { inspection: &inspection, arm: &arm, torque_over_predicted: &judged.slopes };
    print!("{}", page(&inspected));
    args.json.as_ref().map_or(Ok(()), |path| save::document(path, &inspected))
}

/// What `--json` writes.
#[derive(serde::Serialize)]
struct Inspected<'a> {
    #[serde(flatten)]
    inspection: &'a Inspection,
    /// Who it is, and who says so.
    arm: &'a str,
    /// Joint by joint, where the arm's weight tells.
    torque_over_predicted: &'a [Option<Slope>],
}

/// The line about the arm, and what it and the recording say of each other; where the recording is not of
/// this arm, what the recording says of itself, and why.
fn held_against(given: &ArmArgs, recording: &mut Recording) -> anyhow::Result<(String, Judgement)> {
    let arm = given.load()?;
    let Err(why) = arm.settle(recording) else {
        return Ok((arm.line(), arm.judge(recording)));
    };
    let mut doubts = plausibility::judge_alone(recording);
    let what = why.to_string();
    let what = what.strip_prefix(&format!("{}: ", recording.provenance.source)).unwrap_or(&what);
    doubts.push(plausibility::Doubt { what: what.into(), remedy: String::new() });
    let line = match arm.assumed() {
        true => "arm: not known (--robot NAME or --twin FILE says which)".into(),
        false => arm.line(),
    };
    Ok((line, Judgement { doubts, slopes: Vec::new() }))
}

/// How the recorded torque carries the arm.
fn carried(slopes: &[Option<Slope>]) -> Option<String> {
    let told = slopes.iter().enumerate().filter_map(|(j, s)| Some((j + 1, (*s)?)));
    let each: Vec<String> = told
        .map(|(joint, s)| {
            format!("joint {joint}: {:.2} ({:.0} % explained)", s.value, 1e2 * s.explained)
        })
        .collect();
    (!each.is_empty()).then(|| {
        format!("recorded torque over the arm's weight and inertia: {}\n", each.join(", "))
    })
}

fn page(inspected: &Inspected<'_>) -> String {
    let inspection = inspected.inspection;
    let mut text = format!("{}\n{}", inspected.arm, heading(inspection));
    text += &format!("\n{}\n", signals(&inspection.signals));
    text += "noise: white noise at rest, from second differences; ~ an upper bound, from motion\n\
             step: smallest difference between values. Both of the worst column.\n";
    if !inspection.motion.is_empty() {
        text += &format!("\n{}\n", motion(&inspection.motion));
        text += "moving: faster than 0.02 rad/s. qd against q: correlation and slope of the recorded \
                 velocity\nover the differentiated position, while moving\n";
    }
    if let Some(drive) = drive(inspection) {
        text += &format!("\n{drive}\n");
    }
    if let Some(carried) = carried(inspected.torque_over_predicted) {
        text += &format!("\n{carried}");
    }
    text += &list("While reading", &inspection.notes, "nothing was dropped or mended");
    text + &list("What is wrong with it", &inspection.findings, "nothing found")
}

fn heading(inspection: &Inspection) -> String {
    let s = &inspection.sampling;
    let milliseconds =
        [s.step_min_s, s.step_median_s, s.step_max_s].map(|x| format!("{:.2}", 1e3 * x));
    format!(
        "{}\n{}\n{} joints, {} samples, {:.3} s from t = {:.3} s; moving {:.1} s, at rest {:.0} % of the time\n\
         {:.1} Hz on average, {} samples missing; time steps {} ms (least, median, largest)\n",
        inspection.source,
        inspection.format,
        inspection.joints,
        inspection.samples,
        s.duration_s,
        s.start_s,
        inspection.moving_s,
        1e2 * inspection.rest_share,
        s.mean_hz,
        s.missing,
        milliseconds.join(" / "),
    )
}

fn signals(signals: &[Signal]) -> String {
    let row = |s: &Signal| {
        let noise = s.columns.iter().map(|c| c.noise).fold(0.0, f64::max);
        let bound = if s.columns.iter().any(|c| c.noise_at_rest) { "" } else { "~" };
        let step = s.columns.iter().filter_map(|c| c.step).fold(f64::NAN, f64::max);
        vec![
            s.name.clone(),
            s.unit.into(),
            s.columns.len().to_string(),
            format!("{:.4}", s.low()),
            format!("{:.4}", s.high()),
            format!("{bound}{}", short(noise)),
            if step.is_nan() { "-".into() } else { short(step) },
        ]
    };
    let header = ["signal", "unit", "columns", "least", "largest", "noise", "step"];
    table(&header, 2, signals.iter().map(row))
}

fn motion(joints: &[JointMotion]) -> String {
    let row = |m: &JointMotion| {
        let agreement = match (m.velocity_correlation, m.velocity_slope) {
            (Some(r), Some(slope)) => format!("{r:.4}, {slope:.3}"),
            _ => "-".into(),
        };
        vec![
            m.joint.to_string(),
            format!("{:.3} .. {:.3}", m.low_rad, m.high_rad),
            format!("{:.2} .. {:.2}", m.speed_low, m.speed_high),
            format!("{:.2}", m.acceleration),
            format!("{:.0} %", 1e2 * m.moving_share),
            m.reversals.to_string(),
            agreement,
        ]
    };
    let header =
        ["joint", "q, rad", "qd, rad/s", "top |qdd|", "moving", "reversals", "qd against q"];
    table(&header, 1, joints.iter().map(row))
}

/// Joint by joint: the signal friction is identified from.
fn drive(inspection: &Inspection) -> Option<String> {
    let named = |name: &str| inspection.signals.iter().find(|s| s.name == name);
    let signal = named("joint_torque").or_else(|| named("actual_current"))?;
    let row = |(j, c): (usize, &JointSignal)| {
        let bound = if c.noise_at_rest { "" } else { "~" };
        let step = c.step.map_or("-".into(), short);
        let joint = (j + 1).to_string();
        vec![
            joint,
            short(c.low),
            short(c.high),
            short(c.rms),
            format!("{bound}{}", short(c.noise)),
            step,
        ]
    };
    let name = format!("{}, {}", signal.name, signal.unit);
    let header = ["joint", "least", "largest", "RMS", "noise", "step"];
    let rows = signal.columns.iter().enumerate().map(row);
    Some(format!("{name}\n{}", table(&header, 1, rows)))
}

fn list(title: &str, items: &[String], none: &str) -> String {
    let mut text = format!("\n{title}\n");
    if items.is_empty() {
        text += &format!("  {none}\n");
    }
    items.iter().for_each(|item| text += &paragraph("  - ", item));
    text
}

/// Three significant digits.
fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let digits = 2 - value.abs().log10().floor() as i32;
    if (0..=6).contains(&digits) {
        format!("{value:.*}", digits as usize)
    } else {
        format!("{value:.2e}")
    }
}
