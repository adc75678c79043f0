//! Posteriors known in closed form, and coverage where noise remembers.

use rayon::prelude::*;

use super::*;
use crate::identification::problem::Parameter;
use crate::identification::testing::{self, TRUTH};
use crate::statistics::{Cycle, student_quantile};

/// y = 1.5 sign + 0.7 w + e with e_t = rho e_{t-1} + white, every sixth stretch of samples masked.
fn linear(n: usize, rho: f64, seed: u64) -> JointProblem {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut e = vec![0.0; n];
    for t in 0..n {
        let shock: f64 = StandardNormal.sample(&mut rng);
        e[t] = shock + if t > 0 { rho * e[t - 1] } else { 0.0 };
    }
    let slots: Vec<usize> = (0..n).filter(|t| (t / 40) % 6 != 0).collect();
    let w = |t: usize| (0.05 * t as f64).sin() + 0.5 * (0.021 * t as f64).cos();
    let parameter =
        |name: &str| Parameter { name: name.into(), unit: "N.m".into(), lower: -50.0, upper: 60.0 };
    let column = |name: &str, f: &dyn Fn(f64) -> f64| {
        Column::linear(parameter(name), slots.iter().map(|&t| f(w(t))).collect())
    };
    let columns = vec![column("coulomb", &f64::signum), column("viscous", &|w| w)];
    let y: Vec<f64> =
        slots.iter().map(|&t| 1.5 * w(t).signum() + 0.7 * w(t) + 0.3 * e[t]).collect();
    let speed = slots.iter().map(|&t| w(t).abs()).collect();
    JointProblem {
        joint: 1,
        dt: 0.01,
        measured: y.clone(),
        y,
        columns,
        curve: None,
        speed,
        slots,
        cycle: None,
    }
}

fn quick(draws: usize) -> metropolis::Settings {
    metropolis::Settings { chains: 4, warm_up: 10_000, draws, thinning: 10 }
}

fn draw(problem: &JointProblem, settings: &metropolis::Settings) -> Sampled {
    let prepared = Prepared::new(problem.clone()).unwrap();
    sample(&prepared, settings, &separable::Settings::default(), 5, &()).unwrap()
}

/// With white noise the posterior of a linear model is Student's t about the least-squares
/// estimate, scale s sqrt((X'X)^-1), n - k degrees of freedom.
#[test]
fn a_linear_models_posterior_is_students_t() {
    let problem = linear(400, 0.0, 11);
    let sampled = draw(&problem, &quick(8000));
    let (white, order) = whitened(&problem, &sampled.x);
    assert_eq!(order, 0);
    let design = nalgebra::DMatrix::from_fn(white.samples(), 2, |i, k| white.columns[k].values[i]);
    let inverse = (design.transpose() * &design).try_inverse().unwrap();
    let best = &inverse * design.transpose() * nalgebra::DVector::from_column_slice(&white.y);
    let dof = white.samples() as f64 - 2.0;
    let s2 = white.residual(best.as_slice()).iter().map(|e| e * e).sum::<f64>() / dof;
    for k in 0..2 {
        let posterior = Posterior::of(&sampled.draws[k].1);
        let scale = (s2 * inverse[(k, k)]).sqrt();
        let half = student_quantile(0.01, dof) * scale;
        assert!(posterior.converged, "{posterior:?}");
        assert!((posterior.mean - best[k]).abs() < 0.06 * scale, "{posterior:?}");
        assert!(((posterior.high - best[k]) / half - 1.0).abs() < 0.08, "{posterior:?}");
        assert!(((best[k] - posterior.low) / half - 1.0).abs() < 0.08, "{posterior:?}");
    }
}

/// Both parameters' 99 % intervals over 150 recordings.
#[test]
fn intervals_hold_their_level_where_noise_remembers() {
    let inside = |seed: u64| {
        let sampled = draw(&linear(900, 0.8, seed), &quick(1000));
        let holds = |(truth, (_, chains)): (f64, &(String, Vec<Vec<f64>>))| {
            let p = Posterior::of(chains);
            usize::from(p.low < truth && truth < p.high)
        };
        [1.5, 0.7].into_iter().zip(&sampled.draws).map(holds).sum::<usize>()
    };
    let covered: usize = (0..150u64).into_par_iter().map(inside).sum();
    assert!(covered >= 291, "{covered} of 300");
}

/// Three times the same, what the model lacks with it, is known no better than once.
#[test]
fn what_comes_again_with_the_motion_counts_once() {
    const SLOTS: usize = 400;
    let once = linear(SLOTS, 0.0, 12);
    let thrice = |rows: &[f64]| rows.repeat(3);
    let slots = (0..3).flat_map(|k| once.slots.iter().map(move |slot| k * SLOTS + slot));
    let again = |cycle| JointProblem {
        measured: thrice(&once.measured),
        y: thrice(&once.y),
        columns: once
            .columns
            .iter()
            .map(|c| Column { values: thrice(&c.values), ..c.clone() })
            .collect(),
        speed: thrice(&once.speed),
        slots: slots.clone().collect(),
        cycle,
        ..once.clone()
    };
    let cycle = Cycle { slots: SLOTS, count: 3.0 };
    let [one, known, unknown] = [once.clone(), again(Some(cycle)), again(None)].map(|problem| {
        let p = Posterior::of(&draw(&problem, &quick(2000)).draws[0].1);
        p.high - p.low
    });
    // Whitening chooses its order anew.
    assert!((known / one - 1.0).abs() < 0.2, "{one} {known}");
    assert!((unknown * 3f64.sqrt() / one - 1.0).abs() < 0.2, "{one} {unknown}");
}

#[test]
fn the_papers_law_is_found_and_converges() {
    let problem = testing::problem(3000, 0.3, true);
    let settings = metropolis::Settings { thinning: 20, draws: 2000, ..Default::default() };
    let sampled = draw(&problem, &settings);
    assert!(sampled.converged());
    for ((name, chains), truth) in sampled.draws.iter().zip(TRUTH) {
        let p = Posterior::of(chains);
        assert!(p.low < truth && truth < p.high, "{name} {truth}: {p:?}");
    }
}

#[test]
fn chains_that_were_too_short_are_told_and_their_intervals_withdrawn() {
    let problem = testing::problem(800, 0.3, false);
    let short = metropolis::Settings { chains: 4, warm_up: 20, draws: 40, thinning: 1 };
    let sampled = draw(&problem, &short);
    assert!(!sampled.converged());
    let mut rows = judge::judge(&problem, &sampled.x).unwrap();
    sampled.replace(&mut rows);
    let coulomb = rows.iter().find(|r| r.name == "coulomb").unwrap();
    assert!(!coulomb.identifiable && [coulomb.low, coulomb.high] == coulomb.bounds);
    assert!(coulomb.why_not.as_ref().unwrap().contains("not converged"), "{coulomb:?}");
}
