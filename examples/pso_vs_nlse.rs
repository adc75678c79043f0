//! How often does each estimator reach the optimum, and at what price? Prints a Markdown table.
//!
//! cargo run --release --example pso_vs_nlse -- RECORDING [SEEDS]
//!
//! The optimum is the lowest cost any method found. NLSE needs no seed; here its descent is also
//! started once per seed from a random point without the global search over the Stribeck
//! velocity, which is what a plain Levenberg-Marquardt fit does.

use std::path::Path;
use std::time::Instant;

use anyhow::Context;
use armtwin::identification::problem::JointProblem;
use armtwin::identification::quadratic::QuadraticCost;
use armtwin::identification::{
    Terms, assemble, levenberg_marquardt as lm, pso, separable, testing,
};
use armtwin::signals::{Conditioning, condition};
use armtwin::{recording, twin::Twin};
use rayon::prelude::*;

/// Within this share of the lowest cost counts as reached.
const REACHED: f64 = 1e-4;

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().context("give a recording")?;
    let seeds: u64 = arguments.next().map_or(Ok(50), |s| s.parse())?;
    let twin = Twin::default();
    let recording = recording::read(Path::new(&path), None)?;
    let samples = condition(&recording, &twin.drive, twin.robot.dof(), &Conditioning::default())?;
    println!("Within {REACHED:e} of the lowest cost, out of {seeds} seeds. Fitted on {path}.\n");
    for (law, terms) in [
        ("Eq. 1 (6 parameters)", Terms::named(["paper"])?),
        ("Eq. 1 + rotor inertia + offset (8)", Terms::usual()?),
    ] {
        let arm = assemble(&samples, &twin, &terms, &Default::default())?;
        println!("{law}\n");
        println!(
            "| joint | lowest cost N.m | NLSE | NLSE ms | PSO | PSO worst | PSO ms | plain LM | LM worst |"
        );
        println!("|---|---|---|---|---|---|---|---|---|");
        for problem in &arm.joints {
            println!("{}", row(problem, seeds)?);
        }
        println!();
    }
    Ok(())
}

fn row(problem: &JointProblem, seeds: u64) -> anyhow::Result<String> {
    let bounds = problem.bounds()?;
    let clock = Instant::now();
    let cost = QuadraticCost::new(problem, &bounds);
    let nlse = separable::minimise(problem, &cost, &bounds, &Default::default());
    let nlse_ms = 1e3 * clock.elapsed().as_secs_f64();
    let nlse = problem.rms(nlse.sum_of_squares);
    let clock = Instant::now();
    let swarm = |seed| pso::minimise(|x| cost.rms(x), &bounds, &Default::default(), seed).cost;
    let swarms: Vec<f64> = (0..seeds).map(swarm).collect();
    let pso_ms = 1e3 * clock.elapsed().as_secs_f64() / seeds as f64;
    let starts = testing::points(&bounds, seeds as usize);
    let descend = |start: &Vec<f64>| {
        let end = lm::minimise(problem, start, &bounds, &lm::Settings::default());
        problem.rms(end.sum_of_squares)
    };
    let descents: Vec<f64> = starts.par_iter().map(descend).collect();
    let all = swarms.iter().chain(&descents).copied();
    let lowest = all.fold(nlse, f64::min);
    let reached = |cost: &&f64| **cost <= lowest * (1.0 + REACHED);
    let share = |costs: &[f64]| {
        let worst = costs.iter().copied().fold(0.0, f64::max) / lowest - 1.0;
        (costs.iter().filter(reached).count(), 100.0 * worst)
    };
    let ((pso, pso_worst), (lm, lm_worst)) = (share(&swarms), share(&descents));
    Ok(format!(
        "| {} | {lowest:.6} | {} | {nlse_ms:.2} | {pso}/{seeds} | +{pso_worst:.3} % | {pso_ms:.2} | \
         {lm}/{seeds} | +{lm_worst:.3} % |",
        problem.joint,
        if reached(&&nlse) { "always" } else { "never" }
    ))
}
