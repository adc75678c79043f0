//! A joint with known friction, for tests and benchmarks.

use std::sync::Arc;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::problem::{Column, Curve, JointProblem, Parameter};
use crate::kernels::{axpy, stribeck};
use crate::regression::bounds::Bounds;

/// T_c, T_s, T_v1, T_v2, T_v3, w_s of [`problem`].
pub const TRUTH: [f64; 6] = [6.0, 8.5, 9.0, -1.5, 0.8, 0.05];

fn parameter(name: &str, lower: f64, upper: f64) -> Parameter {
    Parameter { name: name.into(), unit: "N.m".into(), lower, upper }
}

type Law = (&'static str, fn(f64) -> f64);

/// Eq. 1 sampled at `n` speeds of a slow and a fast wave, with white noise of `noise` N.m; with
/// `filtered`, everything went through a short symmetric average and every second sample is kept.
pub fn problem(n: usize, noise: f64, filtered: bool) -> JointProblem {
    let mut rng = ChaCha8Rng::seed_from_u64(n as u64);
    let speed: Vec<f64> = (0..n)
        .map(|k| k as f64 * 48.0 / n as f64)
        .map(|t| 0.7 * (1.3 * t).sin() + 0.3 * (3.1 * t + 1.0).cos())
        .collect();
    let reduce: super::problem::Reduce = if filtered {
        Arc::new(|all| all.iter().map(|c| smooth(c)).collect())
    } else {
        Arc::new(|all| all)
    };
    let reduced = |column: &[f64]| reduce(vec![column.to_vec()]).remove(0);
    let of_speed = |f: fn(f64) -> f64| speed.iter().map(|&w| f(w)).collect::<Vec<f64>>();
    let laws: [Law; 3] = [
        ("viscous", |w| w),
        ("viscous_quadratic", |w| w * w.abs()),
        ("viscous_cubic", |w| w * w * w),
    ];
    let raw: Vec<Vec<f64>> = laws.iter().map(|l| of_speed(l.1)).collect();
    let sign = of_speed(f64::signum);
    let mut torque: Vec<f64> =
        (0..n).map(|_| noise * 3f64.sqrt() * (2.0 * rng.random::<f64>() - 1.0)).collect();
    let mut bend = vec![0.0; n];
    stribeck(&speed, TRUTH[5], 1.0, &mut bend);
    axpy(TRUTH[0], &sign, &mut torque);
    axpy(TRUTH[1] - TRUTH[0], &bend, &mut torque);
    raw.iter().zip(&TRUTH[2..]).for_each(|(c, v)| axpy(*v, c, &mut torque));
    let columns = laws.iter().zip(&raw).map(|((name, _), c)| {
        Column::linear(
            parameter(name, if *name == "viscous" { 0.0 } else { -50.0 }, 100.0),
            reduced(c),
        )
    });
    let y = reduced(&torque);
    JointProblem {
        joint: 1,
        dt: 48.0 / y.len() as f64,
        columns: columns.collect(),
        speed: reduced(&speed).iter().map(|w| w.abs()).collect(),
        slots: (0..y.len()).collect(),
        cycle: None,
        measured: y.clone(),
        y,
        curve: Some(Curve {
            coulomb: parameter("coulomb", 0.0, 60.0),
            static_level: parameter("static", 0.0, 90.0),
            velocity: parameter("stribeck_velocity", 0.005, 0.5),
            exponent: 1.0,
            sign: reduced(&sign),
            speed,
            reduce,
        }),
    }
}

fn smooth(raw: &[f64]) -> Vec<f64> {
    let at = |k: usize| raw[k.min(raw.len() - 1)];
    (1..raw.len()).step_by(2).map(|k| 0.25 * at(k - 1) + 0.5 * at(k) + 0.25 * at(k + 1)).collect()
}

/// `n` points spread over the box.
pub fn points(bounds: &Bounds, n: usize) -> Vec<Vec<f64>> {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let point = |_| {
        (0..bounds.len()).map(|i| bounds.lower(i) + bounds.span(i) * rng.random::<f64>()).collect()
    };
    (0..n).map(point).collect()
}
