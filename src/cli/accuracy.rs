//! `armtwin accuracy`: how far the simulated ground truth can be trusted.

use std::time::Instant;

use indicatif::ProgressBar;

use super::outputs::Output;
use super::save;
use crate::effects::JointLoad;
use crate::robot::Robot;
use crate::simulation::accuracy::{Bench, Costs, Friction, Study};
use crate::simulation::{Experiment, Plant, Reference, Scenario, Simulation};

/// Measure the accuracy of the simulation and write the page about it
#[derive(clap::Args)]
#[command(after_help = "Example: armtwin accuracy -o docs/accuracy.md")]
pub struct Args {
    /// Markdown file to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    out: Option<Output>,
    /// Write the measurements as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

const SCENARIO: &str = "scenarios/ur5_friction.toml";

pub fn run(args: &Args) -> anyhow::Result<()> {
    let scenario = Scenario::parse(include_str!("../../scenarios/ur5_friction.toml"), SCENARIO)?;
    let made = scenario.work_out(SCENARIO)?;
    let robot = &made.setup.robot;
    let bar = ProgressBar::new_spinner();
    bar.enable_steady_tick(std::time::Duration::from_millis(100));
    let study = Study::run(robot, &made, &mut |what| bar.set_message(what.to_string()))?;
    bar.set_message("cost of a step");
    let costs = costs(robot, &made)?;
    bar.finish_and_clear();
    save::page(args.out.as_deref(), &study.page(&costs))?;
    if let Some(json) = &args.json {
        let all = serde_json::json!({ "study": study, "costs": costs });
        save::json(json, "armtwin.accuracy/1", &all)?;
    }
    Ok(())
}

/// Steps timed together; of many such batches the fastest counts, which others on the machine
/// disturbed least.
const BATCH: usize = 200;
const BATCHES: usize = 100;

fn costs(robot: &Robot, made: &Experiment) -> anyhow::Result<Costs> {
    let bench = Bench::new(robot.clone(), Friction { dry: 1.0, viscous: 1.0 });
    let step_s = made.setup.clock.step_s;
    let tau = vec![3.0; robot.dof()];
    let mut loads = vec![JointLoad::default(); robot.dof()];

    let mut plant = Plant::new(&bench.mechanism, step_s)?;
    let rapier_us = fastest(BATCHES, BATCH, || {
        for _ in 0..BATCH {
            bench.loads(plant.v(), &mut loads);
            plant.step(&tau, &loads);
        }
    });

    let mut reference = Reference::new(bench.mechanism.clone(), &vec![0.0; robot.dof()]);
    let mut forces = |_: f64, _: &[f64], v: &[f64], out: &mut [f64], loads: &mut [JointLoad]| {
        out.copy_from_slice(&tau);
        bench.loads(v, loads);
    };
    let reference_us = fastest(BATCHES / 5, BATCH, || {
        for _ in 0..BATCH {
            reference.step(step_s, &mut forces);
        }
    });

    let closed_loop_us = closed_loop(made)?;
    Ok(Costs { rapier_us, closed_loop_us, reference_us })
}

/// Microseconds per step of the fastest stretch of ten samples.
fn closed_loop(made: &Experiment) -> anyhow::Result<f64> {
    let steps = 10 * made.setup.clock.steps_per_sample;
    let (mut samples, mut start, mut best) = (0, Instant::now(), f64::INFINITY);
    Simulation::new(&made.setup)?.run(&made.fit, made.seed, 0, &mut |_| {
        samples += 1;
        if samples % 10 == 0 {
            best = best.min(start.elapsed().as_secs_f64());
            start = Instant::now();
        }
        true
    })?;
    Ok(1e6 * best / steps as f64)
}

/// Microseconds per step of the fastest of several batches.
fn fastest(batches: usize, steps: usize, mut batch: impl FnMut()) -> f64 {
    let seconds = (0..batches).map(|_| {
        let start = Instant::now();
        batch();
        start.elapsed().as_secs_f64()
    });
    1e6 * seconds.fold(f64::INFINITY, f64::min) / steps as f64
}
