//! Swarm and separable least squares at the paper's settings: six joints, 6000 samples, the six
//! parameters of Eq. 1, building the cost included. `benches/peers/identification.py` does the
//! same in numpy.

use std::hint::black_box;

use armtwin::identification::quadratic::QuadraticCost;
use armtwin::identification::{
    BoundsByName, Found, Inertial, Terms, assemble, problem::JointProblem, pso, separable, testing,
};
use armtwin::series::JointSeries;
use armtwin::signals::{Conditioning, Samples};
use armtwin::twin::Twin;
use criterion::{Criterion, criterion_group, criterion_main};
use rayon::prelude::*;

const SAMPLES: usize = 6000;
const JOINTS: usize = 6;

fn joints() -> Vec<JointProblem> {
    (0..JOINTS).map(|j| testing::problem(SAMPLES + j, 0.3, false)).collect()
}

fn swarm(problem: &JointProblem) -> f64 {
    let bounds = problem.bounds().expect("the problem's own");
    let cost = QuadraticCost::new(problem, &bounds);
    pso::minimise(|x| cost.rms(x), &bounds, &pso::Settings::default(), 1).cost
}

fn nlse(problem: &JointProblem) -> f64 {
    let bounds = problem.bounds().expect("the problem's own");
    let cost = QuadraticCost::new(problem, &bounds);
    separable::minimise(problem, &cost, &bounds, &Default::default()).sum_of_squares
}

fn searches(c: &mut Criterion) {
    let joints = joints();
    let mut group = c.benchmark_group("six joints x 6000 samples");
    group.sample_size(20);
    group.bench_function("pso, 60 particles x 1000 iterations", |b| {
        b.iter(|| black_box(joints.par_iter().map(swarm).sum::<f64>()));
    });
    group.bench_function("pso, one thread", |b| {
        b.iter(|| black_box(joints.iter().map(swarm).sum::<f64>()));
    });
    group.bench_function("nlse", |b| {
        b.iter(|| black_box(joints.par_iter().map(nlse).sum::<f64>()));
    });
    group.bench_function("nlse, one thread", |b| {
        b.iter(|| black_box(joints.iter().map(nlse).sum::<f64>()));
    });
    group.finish();
}

fn costs(c: &mut Criterion) {
    let problem = testing::problem(SAMPLES, 0.3, false);
    let bounds = problem.bounds().expect("the problem's own");
    let cost = QuadraticCost::new(&problem, &bounds);
    let mut group = c.benchmark_group("cost of Eq. 1 at 6000 samples");
    group.bench_function("interpolated", |b| b.iter(|| cost.rms(black_box(&testing::TRUTH))));
    group.bench_function("direct", |b| b.iter(|| problem.direct_cost(black_box(&testing::TRUTH))));
    group.bench_function("building the interpolant", |b| {
        b.iter(|| QuadraticCost::new(black_box(&problem), &bounds));
    });
    group.finish();
}

/// A UR5 with one link more, and what it shows in a minute at 125 Hz.
fn seven_joints() -> (Twin, Samples) {
    let mut twin = Twin::default();
    let mut last = twin.robot.bodies[5].clone();
    last.parent = Some(5);
    last.joint.placement = last.joint.placement.compose(&twin.robot.bodies[4].joint.placement);
    twin.robot.bodies.push(last);
    let drive = &mut twin.drive;
    drive.gear_ratio.push(101.0);
    drive.torque_constant.push(0.09);
    drive.rotor_inertia.push(0.0);
    let (n, dt) = (7500, 0.008);
    let wave = |f: fn(f64, f64) -> f64| {
        let at = |j: usize| {
            let w = 0.9 + 0.23 * j as f64;
            (0..n).map(|k| f(w, w * k as f64 * dt)).collect::<Vec<f64>>()
        };
        JointSeries::from_joints(&(0..7).map(at).collect::<Vec<_>>())
    };
    let mut samples = Samples {
        dt,
        start: 0.0,
        q: wave(|_, a| a.sin()),
        qd: wave(|w, a| w * a.cos()),
        qdd: wave(|w, a| -w * w * a.sin()),
        torque: JointSeries::zeros(7, n),
        told: None,
        response: None,
        sensed: None,
        smoothed_further: None,
        temperature: None,
        usable: vec![true; n],
        conditioning: Conditioning::default(),
        notes: Vec::new(),
    };
    samples.torque = twin.torque(&twin.motion(&samples));
    (twin, samples)
}

/// Base parameters beside friction, rotors and offsets, and the links that bodies can have.
fn links(twin: &Twin, samples: &Samples) -> f64 {
    let names = ["coulomb", "viscous", "rotor_inertia", "current_offset"];
    let terms = Terms::named(names).expect("they are in the catalogue");
    let mut arm = assemble(samples, twin, &terms, &BoundsByName::new()).expect("a whole recording");
    let mut inertial = Inertial::of(twin, &terms);
    inertial.attach(&mut arm, samples, twin).expect("a whole recording");
    let found = Found::of(&arm).expect("bounds of the catalogue");
    inertial.links(&arm, &found, &twin.robot, None).expect("possible links").spread
}

fn rigid_body(c: &mut Criterion) {
    let (twin, samples) = seven_joints();
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let mut group = c.benchmark_group("links of seven joints, 60 s at 125 Hz");
    group.sample_size(10);
    group.bench_function("one thread", |b| {
        b.iter(|| one.install(|| black_box(links(&twin, &samples))));
    });
    group.bench_function("all threads", |b| b.iter(|| black_box(links(&twin, &samples))));
    group.finish();
}

criterion_group!(benches, searches, costs, rigid_body);
criterion_main!(benches);
