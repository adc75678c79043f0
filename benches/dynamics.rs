//! Rigid-body dynamics of the UR5, one core: `cargo bench --bench dynamics`.

use std::hint::black_box;

use armtwin::robot::{
    Workspace, body_regressor_series, builtin, equation_of_motion, forward_dynamics,
    inverse_dynamics, inverse_dynamics_series, mass_matrix,
};
use armtwin::series::JointSeries;
use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::DMatrix;

const Q: [f64; 6] = [0.3, -1.2, 0.8, 2.0, -0.7, 1.9];
const QD: [f64; 6] = [1.0, -0.5, 0.7, 2.0, -1.7, 0.9];
const QDD: [f64; 6] = [0.4, 3.0, -2.0, 1.0, 5.0, -4.0];

fn single_calls(c: &mut Criterion) {
    let robot = builtin("ur5").expect("built in");
    let mut ws = Workspace::new(&robot);
    let mut out = [0.0; 6];
    c.bench_function("inverse dynamics", |b| {
        b.iter(|| {
            inverse_dynamics(&robot, &mut ws, &black_box(Q), &QD, &QDD, &mut out);
            out
        })
    });
    c.bench_function("forward dynamics", |b| {
        b.iter(|| {
            forward_dynamics(&robot, &mut ws, &black_box(Q), &QD, &QDD, &mut out);
            out
        })
    });
    c.bench_function("mass matrix", |b| b.iter(|| mass_matrix(&robot, &mut ws, &black_box(Q))));
    let mut m = DMatrix::zeros(6, 6);
    c.bench_function("mass matrix and forces", |b| {
        b.iter(|| {
            equation_of_motion(&robot, &mut ws, [&black_box(Q), &QD], &mut m, &mut out);
            out
        })
    });
}

fn series(c: &mut Criterion) {
    let robot = builtin("ur5").expect("built in");
    let wave = |phase: f64| {
        let row =
            |j: i32| (0..6000).map(move |k| (phase + 0.01 * f64::from(k) + f64::from(j)).sin());
        JointSeries::from_joints(&(0..6).map(|j| row(j).collect()).collect::<Vec<Vec<f64>>>())
    };
    let (q, qd, qdd) = (wave(0.0), wave(1.0), wave(2.0));
    c.bench_function("inverse dynamics of 6000 samples", |b| {
        b.iter(|| inverse_dynamics_series(&robot, &q, &qd, &qdd))
    });
    c.bench_function("payload columns of 6000 samples", |b| {
        b.iter(|| body_regressor_series(&robot, &q, &qd, &qdd, 5))
    });
}

criterion_group!(benches, single_calls, series);
criterion_main!(benches);
