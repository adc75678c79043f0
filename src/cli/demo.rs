//! `armtwin demo`: the main job in one go, on an arm whose parameters are known.

use std::path::PathBuf;

use anyhow::Context;

use super::outputs::{self, Output};
use super::progress::Progress;
use super::{diagnose, out, save, simulate, view};
use crate::diagnosis::{self, Diagnosis};
use crate::effects::{CATALOGUE, Role};
use crate::identification::{
    ArmProblem, BoundsByName, Dropped, MethodResult, Settings, Terms, assemble, fitted_twin,
    identify, reduce,
};
use crate::recording::Recording;
use crate::report::{table, to_uncertainty};
use crate::signals::condition;
use crate::simulation::{Experiment, Run, Scenario, Truth};
use crate::studies::recovery::{Recovered, blank_twin, conditioning, recovered};
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
        Scenario::parse(include_str!("../../scenarios/ur5_friction.toml"), SCENARIO)?;
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
    println!("2. Identify Eq. 1, rotor inertia and offset on fit.csv, hold them against check.csv");
    let found = Found::new(&made, &fit, &check, args.seed)?;
    found.print(&made);
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

/// What identification made of the recordings.
struct Found {
    dropped: Vec<Dropped>,
    results: Vec<MethodResult>,
    twin: Twin,
}

impl Found {
    fn new(made: &Experiment, fit: &Run, check: &Run, seed: u64) -> anyhow::Result<Self> {
        let blank = blank_twin(made);
        let terms = Terms::usual()?;
        let problem = |run: &Run| -> anyhow::Result<ArmProblem> {
            let dof = blank.robot.dof();
            let samples = condition(&run.recording, &blank.drive, dof, &conditioning())?;
            Ok(assemble(&samples, &blank, &terms, &BoundsByName::new())?)
        };
        let (mut fit, mut check) = (problem(fit)?, problem(check)?);
        let settings = Settings { seed, ..Settings::default() };
        let dropped = reduce(&mut fit, Some(&mut check), &settings.nlse)?;
        let results = identify(&fit, Some(&check), &settings)?;
        let nlse = results.last().context("no method ran")?;
        let twin = fitted_twin(&blank, &terms, &fit, nlse)?;
        Ok(Self { dropped, results, twin })
    }

    /// The identified twin with the linear values of its friction open: what it lacks has misled them
    /// (a ripple hides a Stribeck curve), so that they are fitted again with what it lacks.
    fn open(&self) -> Twin {
        let mut open = self.twin.clone();
        let parameters = CATALOGUE.iter().flat_map(|e| e.about().parameters);
        let linear = parameters.filter(|p| p.role == Role::Linear);
        linear.for_each(|p| drop(open.values.remove(p.name)));
        open
    }

    fn print(&self, made: &Experiment) {
        println!("\n   Dropped, because the robust test does not show them:");
        let mut terms: Vec<&str> = self.dropped.iter().map(|d| d.term.as_str()).collect();
        terms.sort_unstable();
        terms.dedup();
        for term in terms {
            let joints = self.dropped.iter().filter(|d| d.term == term);
            let joints: Vec<_> = joints.map(|d| d.joint.to_string()).collect();
            println!("   {term} on joints {}", joints.join(", "));
        }
        println!("\n{}", self.parameters(made));
        if self.misled(made) {
            println!(
                "   At joint {HIDDEN_JOINT} the hidden {HIDDEN} pulls at the friction found: the twin lacks \
                 it, which no interval can know. Part 3 finds it."
            );
        }
        println!("\n{}", self.fits());
    }

    /// Does an interval miss the truth where the effect is hidden?
    fn misled(&self, made: &Experiment) -> bool {
        let last = self.results.last().map(std::slice::from_ref).unwrap_or_default();
        let missed = |r: &Recovered| !r.within(r.estimate.low, r.estimate.high);
        recovered(last, made).iter().any(|r| r.joint == HIDDEN_JOINT && missed(r))
    }

    fn parameters(&self, made: &Experiment) -> String {
        let by_method: Vec<Vec<Recovered>> =
            self.results.iter().map(|r| recovered(std::slice::from_ref(r), made)).collect();
        let [pso, nlse] = &by_method[..] else { return String::new() };
        let row = |(pso, nlse): (&Recovered, &Recovered)| {
            let e = &nlse.estimate;
            let held = if nlse.within(e.low, e.high) { "holds the truth" } else { "MISSES it" };
            let error = nlse.relative_error().map_or("-".into(), |e| format!("{:+.1}", 100.0 * e));
            let verdict = if e.identifiable { held } else { "not identifiable" };
            vec![
                nlse.joint.to_string(),
                e.name.clone(),
                e.unit.clone(),
                format!("{:.4}", nlse.truth),
                format!("{:.4}", pso.estimate.value),
                format!("{:.4}", e.value),
                error,
                format!("{:.4}", e.low),
                format!("{:.4}", e.high),
                verdict.into(),
            ]
        };
        const HEADER: [&str; 10] = [
            "joint",
            "parameter",
            "unit",
            "true",
            "PSO",
            "NLSE",
            "error %",
            "99 % low",
            "high",
            "",
        ];
        table(&HEADER, 3, pso.iter().zip(nlse).map(row))
    }

    fn fits(&self) -> String {
        let rows = self.results.iter().flat_map(|m| {
            m.joints.iter().map(move |j| {
                vec![
                    m.method.clone(),
                    j.joint.to_string(),
                    format!("{:.6}", j.cost),
                    j.evaluations.to_string(),
                    format!("{:.1}", 1e3 * j.seconds),
                    format!("{:.4}", j.fit.r2),
                    j.check.map_or("-".into(), |c| format!("{:.4}", c.r2)),
                ]
            })
        });
        table(&["method", "joint", "cost N.m", "evaluations", "ms", "R2", "check R2"], 1, rows)
    }
}
