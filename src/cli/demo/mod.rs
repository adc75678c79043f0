//! `armtwin demo`: the main job in one go, on an arm whose parameters are known.

mod friction;

use std::path::PathBuf;

use friction::Found;

use super::outputs::{self, Output};
use super::progress::Progress;
use super::{diagnose, out, save, simulate, view};
use crate::diagnosis::{self, Diagnosis};
use crate::recording::Recording;
use crate::report::{table, to_uncertainty};
use crate::simulation::{Scenario, Truth};
use crate::twin::{PerJoint, Twin};
use crate::workflow::{Diagnose, Diagnosed};

/// Simulate a UR5 with hidden friction and a hidden effect, identify the one, diagnose the other
#[derive(clap::Args)]
#[command(after_help = "Example: armtwin demo --out demo

Writes DIR/fit.csv and check.csv (the recordings), truth.json (what was hidden in them),
diagnosis.json (what the identified twin lacks), report.html (the same with pictures), twin.toml
(the twin with all that was found) and twin.rrd (the arm beside both twins, for the viewer). The
scenario is scenarios/ur5_friction.toml with a torque ripple on joint 3, which identification does not look for.")]
pub struct Args {
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "demo")]
    out: PathBuf,
    /// Random seed for the sensors' noise and the swarm
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Length of both recordings, s
    #[arg(long, value_name = "S", default_value_t = 60.0)]
    duration: f64,
    /// Write what was identified, and where the rest is, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
    /// Print every value of both methods with its interval
    #[arg(long)]
    full: bool,
    /// Open twin.rrd in the viewer
    #[arg(long)]
    view: bool,
}

const SCENARIO: &str = "scenarios/ur5_friction.toml";
/// The effect nobody tells the twin of: cogging, once in every 10 degrees.
const HIDDEN: &str = "torque_ripple";
const HIDDEN_JOINT: usize = 3;
const HIDDEN_VALUES: [(&str, f64); 3] =
    [("ripple_sine", 1.2), ("ripple_cosine", 0.6), ("ripple_order", 36.0)];

pub fn run(args: &Args) -> anyhow::Result<()> {
    outputs::ask_in(&args.out, &[&simulate::FILES[..], &diagnose::FILES].concat())?;
    let mut scenario =
        Scenario::parse(include_str!("../../../scenarios/ur5_friction.toml"), SCENARIO)?;
    scenario.seed = args.seed;
    scenario.shorten(args.duration);
    hide(&mut scenario);
    let made = scenario.work_out(SCENARIO)?;
    println!("armtwin {}  demo  seed {}", env!("CARGO_PKG_VERSION"), args.seed);
    println!(
        "1. Simulate a UR5 in rapier with hidden friction and a hidden {HIDDEN} on joint \
         {HIDDEN_JOINT}: two recordings of {} s, {} Hz, {} dB",
        args.duration,
        scenario.rate_hz,
        scenario.noise.snr_db.unwrap_or(f64::INFINITY)
    );
    let ([fit, check], _) = simulate::simulate(&made, None)?;
    println!(
        "2. Identify friction, rotor inertia and offset on fit.csv, hold them against check.csv"
    );
    let found = Found::new(&made, &fit, &check, args.seed)?;
    match args.full {
        true => found.print(&made),
        false => found.print_brief(&made),
    }
    println!("\n3. Diagnose what the identified twin lacks\n");
    let recordings = [&fit, &check].map(|run| &run.recording);
    let done = diagnosed(&found.open(), recordings, args.seed)?;
    println!("{}", hidden(&done.diagnosis));
    let truth = Truth::new(&scenario, &made, &fit, &check);
    simulate::write(&args.out, &fit, &check, &truth)?;
    diagnose::write(&done, &args.out)?;
    println!("Everything is in {}:\n{}", args.out.display(), diagnose::written(&args.out));
    if let Some(path) = &args.json {
        let file = |name: &str| args.out.join(name);
        let all = serde_json::json!({
            "seed": args.seed, "dropped": found.dropped, "identified": found.results,
            "truth": file("truth.json"), "diagnosis": file("diagnosis.json"),
        });
        save::json(path, "armtwin.demo/1", &all)?;
    }
    match args.view {
        true => view::open(&args.out.join("twin.rrd")),
        false => Ok(()),
    }
}

fn hide(scenario: &mut Scenario) {
    let values = HIDDEN_VALUES.into_iter().chain([("joints", HIDDEN_JOINT as f64)]);
    let table = values.map(|(key, value)| (key.to_string(), PerJoint::All(value)));
    scenario.effects.insert(HIDDEN.into(), table.collect());
}

/// What was hidden beside what was found of it.
fn hidden(found: &Diagnosis) -> String {
    let values = found.causes.iter().filter(|c| c.effect == HIDDEN).flat_map(|c| &c.parameters);
    let row = |v: &diagnosis::Value| {
        let (_, truth) = HIDDEN_VALUES.into_iter().find(|(name, _)| *name == v.name)?;
        let held = if (v.low..=v.high).contains(&truth) { "holds the truth" } else { "MISSES it" };
        let [value, low, high] = to_uncertainty(v.value, v.low, v.high);
        Some(vec![v.name.clone(), v.unit.clone(), truth.to_string(), value, low, high, held.into()])
    };
    const HEADER: [&str; 7] = ["hidden", "unit", "true", "found", "90 % low", "high", ""];
    table(&HEADER, 2, values.filter_map(row)) + "\n"
}

/// Prints the answer.
fn diagnosed(twin: &Twin, [fit, check]: [&Recording; 2], seed: u64) -> anyhow::Result<Diagnosed> {
    let watch = Progress::default();
    let done = Diagnose::default().seed(seed).run(twin, fit, check, &watch)?;
    watch.end();
    out::page(&diagnose::findings(&done));
    Ok(done)
}
