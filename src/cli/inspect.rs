//! `armtwin inspect`: what a recording holds and what is wrong with it.

use std::path::PathBuf;

use super::outputs::Output;
use super::save;
use crate::recording;
use crate::recording::inspection::{Inspection, JointMotion, JointSignal, Signal, inspect};
use crate::report::table;

/// Show what a recording holds, how good it is, and what is wrong with it
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin inspect log.csv
  armtwin inspect Movement_No6 --json inspection.json
  armtwin inspect log.csv --columns scenarios/columns/ur10e_shamilmamedov.toml
  armtwin inspect rosbag2_folder")]
pub struct Args {
    /// File, bag, or folder with one log per signal
    recording: PathBuf,
    /// Column map (TOML) of a CSV without RTDE names, or of a bag
    #[arg(long, value_name = "MAP")]
    columns: Option<PathBuf>,
    /// Write the findings as JSON too
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

const WIDTH: usize = 96;

pub fn run(args: &Args) -> anyhow::Result<()> {
    let recording = recording::read(&args.recording, args.columns.as_deref())?;
    let inspection = inspect(&recording);
    print!("{}", page(&inspection));
    args.json.as_ref().map_or(Ok(()), |path| save::document(path, &inspection))
}

fn page(inspection: &Inspection) -> String {
    let mut text = heading(inspection);
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
    items.iter().for_each(|item| text += &wrapped(item));
    text
}

/// One item of a list, its lines broken at blanks.
fn wrapped(item: &str) -> String {
    let mut lines = vec![String::from("  -")];
    for word in item.split(' ') {
        let line = lines.last().map_or(0, |l| l.chars().count());
        if line + 1 + word.chars().count() > WIDTH {
            lines.push("   ".into());
        }
        if let Some(line) = lines.last_mut() {
            *line += &format!(" {word}");
        }
    }
    lines.join("\n") + "\n"
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
