//! Swarm and separable least squares at the paper's settings: six joints, 6000 samples, the six
//! parameters of Eq. 1, building the cost included. `benches/peers/identification.py` does the
//! same in numpy.

use std::hint::black_box;

use armtwin::identification::quadratic::QuadraticCost;
use armtwin::identification::{problem::JointProblem, pso, separable, testing};
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

criterion_group!(benches, searches, costs);
criterion_main!(benches);
