//! Monte Carlo coverage of the robust 99 % interval on what residuals of arms look like: the reason
//! for the estimators in `long_run.rs`.

use std::f64::consts::TAU;

use nalgebra::DMatrix;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

use armtwin::signals::LowPass;
use armtwin::statistics::*;

const PARAMETERS: usize = 5;

fn white(n: usize, rng: &mut ChaCha8Rng) -> Vec<f64> {
    (0..n).map(|_| StandardNormal.sample(&mut *rng)).collect()
}

fn first_order(n: usize, rho: f64, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let mut e = white(n + 300, rng);
    for t in 1..e.len() {
        e[t] = rho * e[t - 1] + (1.0 - rho * rho).sqrt() * e[t];
    }
    e.split_off(300)
}

/// White, zero-phase low-passed at `cutoff` of the sample rate, every `keep`-th sample.
fn low_passed(n: usize, cutoff: f64, keep: usize, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let mut e = white(n * keep + 200, rng);
    LowPass::new(cutoff, 1.0, 4).unwrap().apply(&mut e);
    e[100..100 + n * keep].iter().step_by(keep).copied().collect()
}

#[derive(Debug, Clone, Copy)]
enum Noise {
    White,
    FirstOrder(f64),
    /// Cutoff over sample rate, decimation.
    LowPassed(f64, usize),
    /// White plus a drift.
    Mixed,
    /// Louder where the joint moves faster.
    Spread,
}

impl Noise {
    fn draw(self, qd: &[f64], rng: &mut ChaCha8Rng) -> Vec<f64> {
        let n = qd.len();
        match self {
            Self::White => white(n, rng),
            Self::FirstOrder(rho) => first_order(n, rho, rng),
            Self::LowPassed(cutoff, keep) => low_passed(n, cutoff, keep, rng),
            Self::Mixed => {
                let drift = first_order(n, 0.97, rng);
                white(n, rng).iter().zip(drift).map(|(a, b)| a + b).collect()
            }
            Self::Spread => {
                let e = first_order(n, 0.8, rng);
                e.iter().zip(qd).map(|(e, v)| e * (0.2 + v.abs())).collect()
            }
        }
    }
}

/// Five sinusoids of random frequency at 20 Hz, the slow part masked; sliding friction's columns,
/// an inertia, gravity and an offset.
fn arm(n: usize, rng: &mut ChaCha8Rng) -> (DMatrix<f64>, Vec<f64>, Vec<usize>) {
    let waves: Vec<[f64; 3]> = (0..5)
        .map(|_| {
            [rng.random_range(0.05..0.35), rng.random_range(0.2..1.0), rng.random_range(0.0..TAU)]
        })
        .collect();
    let sum = |k: usize, f: &dyn Fn(f64, f64, f64) -> f64| -> f64 {
        waves.iter().map(|[hz, a, p]| f(TAU * hz, *a, TAU * hz * 0.05 * k as f64 + p)).sum()
    };
    let rows: Vec<[f64; PARAMETERS]> = (0..n)
        .map(|k| {
            let q = sum(k, &|w, a, phase| a / w * phase.sin());
            let qd = sum(k, &|_, a, phase| a * phase.cos());
            let qdd = sum(k, &|w, a, phase| -a * w * phase.sin());
            [qd, qd.signum(), 1.0, qdd, q.cos()]
        })
        .collect();
    let slots: Vec<usize> = (0..n).filter(|&k| rows[k][0].abs() > 0.08).collect();
    let jacobian = DMatrix::from_fn(slots.len(), PARAMETERS, |i, k| rows[slots[i]][k]);
    (jacobian, rows.iter().map(|r| r[0]).collect(), slots)
}

/// Per convention (robust, asymptotic): which of the five true values (0) lie inside.
fn trial(noise: Noise, n: usize, seed: u64) -> [usize; 2] {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (jacobian, qd, slots) = arm(n, &mut rng);
    let e = noise.draw(&qd, &mut rng);
    let y: Vec<f64> = slots.iter().map(|&k| e[k]).collect();
    inside(&jacobian, &y, &slots, None)
}

fn inside(jacobian: &DMatrix<f64>, y: &[f64], slots: &[usize], cycle: Option<Cycle>) -> [usize; 2] {
    let beta = Design::new(jacobian).unwrap().solve(y);
    let residual: Vec<f64> = (jacobian * &beta).iter().zip(y).map(|(p, y)| y - p).collect();
    let null = [0.0; PARAMETERS];
    let found = infer(beta.as_slice(), &null, jacobian, &residual, slots, cycle, 0.99).unwrap();
    let inside = |i: &[Inference]| i.iter().filter(|i| i.low < 0.0 && 0.0 < i.high).count();
    [inside(&found.robust), inside(&found.asymptotic)]
}

/// Three cycles of a motion, each of so many samples, where most of what the model lacks is the same in all of them: how
/// many true values lie inside the robust interval, where the cycle is known or not.
fn repeated(n: usize, seed: u64) -> [usize; 2] {
    const CYCLES: usize = 3;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (once, qd, slots) = arm(n, &mut rng);
    let lacks = Noise::FirstOrder(0.8).draw(&qd, &mut rng);
    let rows = slots.len();
    let jacobian = DMatrix::from_fn(CYCLES * rows, PARAMETERS, |i, k| once[(i % rows, k)]);
    let (mut y, mut all) = (Vec::new(), Vec::new());
    for cycle in 0..CYCLES {
        let noise = white(rows, &mut rng);
        y.extend(slots.iter().zip(noise).map(|(&k, noise)| lacks[k] + 0.3 * noise));
        all.extend(slots.iter().map(|k| cycle * n + k));
    }
    let known = Cycle { slots: n, count: CYCLES as f64 };
    [Some(known), None].map(|cycle| inside(&jacobian, &y, &all, cycle)[0])
}

/// Share of true values inside the robust and the asymptotic interval.
fn coverage(noise: Noise, n: usize, replications: u64) -> [f64; 2] {
    let inside = (0..replications)
        .into_par_iter()
        .map(|seed| trial(noise, n, seed))
        .reduce(|| [0, 0], |a, b| [a[0] + b[0], a[1] + b[1]]);
    inside.map(|i| i as f64 / (replications * PARAMETERS as u64) as f64)
}

/// Half-width of the robust over that of the asymptotic interval, mean over parameters.
fn price(noise: Noise, n: usize, seed: u64) -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (jacobian, qd, slots) = arm(n, &mut rng);
    let e = noise.draw(&qd, &mut rng);
    let residual: Vec<f64> = slots.iter().map(|&k| e[k]).collect();
    let zero = [0.0; PARAMETERS];
    let found = infer(&zero, &zero, &jacobian, &residual, &slots, None, 0.99).unwrap();
    let pairs = found.robust.iter().zip(&found.asymptotic);
    pairs.map(|(r, a)| r.high / a.high).sum::<f64>() / PARAMETERS as f64
}

#[test]
fn robustness_costs_little_where_it_is_not_needed() {
    let price = (0..40).map(|seed| price(Noise::White, 1000, seed)).sum::<f64>() / 40.0;
    assert!((0.98..1.15).contains(&price), "{price}");
}

#[test]
fn robust_intervals_hold_their_level() {
    let cases = [
        (Noise::White, 600, 0.985),
        (Noise::FirstOrder(0.5), 600, 0.98),
        (Noise::FirstOrder(0.8), 600, 0.98),
        (Noise::FirstOrder(0.95), 600, 0.975),
        (Noise::LowPassed(0.064, 6), 600, 0.98),
        (Noise::LowPassed(0.1, 1), 600, 0.975),
        (Noise::Mixed, 1000, 0.975),
        (Noise::Spread, 1000, 0.97),
    ];
    for (noise, n, least) in cases {
        let [robust, asymptotic] = coverage(noise, n, 300);
        eprintln!("{noise:?}, {n} samples: robust {robust:.4}, asymptotic {asymptotic:.4}");
        assert!(robust >= least, "{noise:?}: {robust}");
    }
}

#[test]
fn what_comes_again_with_the_motion_is_no_further_evidence() {
    const REPLICATIONS: u64 = 300;
    let all = (0..REPLICATIONS).into_par_iter().map(|seed| repeated(600, seed));
    let inside = all.reduce(|| [0, 0], |a, b| [a[0] + b[0], a[1] + b[1]]);
    let [known, unknown] = inside.map(|i| i as f64 / (REPLICATIONS * PARAMETERS as u64) as f64);
    eprintln!("three cycles: {known:.4} where that is known, {unknown:.4} where it is not");
    assert!(known >= 0.97 && unknown < 0.95, "{known} {unknown}");
}
