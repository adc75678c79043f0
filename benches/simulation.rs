//! Cost of a step of the simulated arm, beside the Runge-Kutta reference and a whole closed loop.

use std::hint::black_box;

use armtwin::effects::JointLoad;
use armtwin::robot::builtin;
use armtwin::simulation::accuracy::{Bench, Friction};
use armtwin::simulation::{Plant, Reference, Scenario, Simulation};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

const STEP_S: f64 = 5e-4;
/// As in mujoco_step.py: rad, rad/s.
const MOTION: [[f64; 6]; 2] = [[0.0, -1.0, 1.0, 0.5, -0.5, 0.3], [1.0, -0.8, 1.0, 1.5, -1.5, 2.0]];
const STEPS_IN_MOTION: u64 = 200;

fn bench() -> Bench {
    Bench::new(builtin("ur5").expect("built in"), Friction { dry: 1.0, viscous: 1.0 })
}

fn rapier(c: &mut Criterion) {
    let bench = bench();
    let mut plant = Plant::new(&bench.mechanism, STEP_S).expect("a UR5");
    let (tau, mut loads) = ([3.0; 6], [JointLoad::default(); 6]);
    c.bench_function("simulation/rapier step", |b| {
        b.iter(|| {
            bench.loads(plant.v(), &mut loads);
            plant.step(black_box(&tau), &loads);
        });
    });
}

/// From the same motion again and again: at rest friction is another problem to the solver.
fn rapier_in_motion(c: &mut Criterion) {
    let bench = bench();
    let mut plant = Plant::new(&bench.mechanism, STEP_S).expect("a UR5");
    let (tau, mut loads) = ([3.0; 6], [JointLoad::default(); 6]);
    let mut group = c.benchmark_group("simulation");
    group.throughput(Throughput::Elements(STEPS_IN_MOTION));
    group.bench_function("rapier in motion, 200 steps", |b| {
        b.iter(|| {
            plant.set_state(&MOTION[0], &MOTION[1]);
            for _ in 0..STEPS_IN_MOTION {
                bench.loads(plant.v(), &mut loads);
                plant.step(black_box(&tau), &loads);
            }
        });
    });
    group.finish();
}

fn runge_kutta(c: &mut Criterion) {
    let bench = bench();
    let mut arm = Reference::new(bench.mechanism.clone(), &[0.0; 6]);
    c.bench_function("simulation/Runge-Kutta step", |b| {
        b.iter(|| {
            arm.step(STEP_S, &mut |_: f64,
                                   _: &[f64],
                                   v: &[f64],
                                   tau: &mut [f64],
                                   loads: &mut [JointLoad]| {
                tau.fill(3.0);
                bench.loads(v, loads);
            });
        });
    });
}

/// 12500 steps, 2500 controller calls, 625 samples.
fn closed_loop(c: &mut Criterion) {
    let text = include_str!("../scenarios/ur5_friction.toml");
    let mut scenario = Scenario::parse(text, "ur5_friction.toml").expect("a scenario");
    scenario.shorten(5.0);
    let made = scenario.work_out("ur5_friction.toml").expect("a scenario");
    let mut simulation = Simulation::new(&made.setup).expect("a UR5");
    let mut group = c.benchmark_group("simulation");
    group.sample_size(10);
    group.bench_function("5 s in closed loop", |b| {
        b.iter(|| simulation.run(&made.fit, 1, 0, &mut |_| true).expect("a run"));
    });
}

criterion_group!(benches, rapier, rapier_in_motion, runge_kutta, closed_loop);
criterion_main!(benches);
