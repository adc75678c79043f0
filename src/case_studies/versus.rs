//! Does PSO beat NLSE? Same data, same cost, many seeds and starts.

use std::time::Instant;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::identification::levenberg_marquardt as lm;
use crate::identification::problem::JointProblem;
use crate::identification::quadratic::QuadraticCost;
use crate::identification::{IdentificationError, pso, separable};
use crate::regression::bounds::Bounds;

/// A cost this close to the lowest, relatively, counts as reached: 0.01 %.
pub const REACHED: f64 = 1e-4;

/// What one method came to, over its runs.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Record {
    pub runs: usize,
    pub reached: usize,
    /// Above the lowest cost, relative: median and worst.
    pub median: f64,
    pub worst: f64,
    /// Per run, mean.
    pub evaluations: f64,
    pub ms: f64,
}

/// One joint.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Duel {
    pub joint: usize,
    pub samples: usize,
    /// J of Eq. 5 by any method, N.m.
    pub lowest: f64,
    pub separable: Record,
    pub swarm: Record,
    pub descent: Record,
    /// J evaluated sample by sample, ms; the swarm is timed on the interpolated cost.
    pub direct_ms: f64,
}

/// A cost, evaluations and ms.
type Run = (f64, usize, f64);

/// Separable least squares once (it draws nothing), the paper's swarm once per seed, and plain
/// Levenberg-Marquardt on all parameters from as many random points of the box.
///
/// # Errors
/// If bounds are the wrong way round.
pub fn duel(problem: &JointProblem, seeds: u64) -> Result<Duel, IdentificationError> {
    let bounds = problem.bounds()?;
    let clock = Instant::now();
    let cost = QuadraticCost::new(problem, &bounds);
    let preparation_ms = ms(clock);
    let separable = timed(|| {
        let o = separable::minimise(problem, &cost, &bounds, &separable::Settings::default());
        (o.x, o.evaluations)
    });
    let settings = pso::Settings::default();
    let swarm = |seed| {
        timed(|| {
            let o = pso::minimise(|x| cost.rms(x), &bounds, &settings, seed);
            (o.best, o.evaluations)
        })
    };
    let descent = |seed| {
        timed(|| {
            let start = anywhere(&bounds, seed);
            let o = lm::minimise(problem, &start, &bounds, &lm::Settings::default());
            (o.x, o.evaluations)
        })
    };
    let judged = |(x, evaluations, ms): (Vec<f64>, usize, f64)| -> Run {
        (problem.direct_cost(&x), evaluations, ms)
    };
    let mut separable = vec![judged(separable)];
    separable[0].2 += preparation_ms;
    let swarms: Vec<Run> = (0..seeds).map(swarm).map(judged).collect();
    let descents: Vec<Run> = (0..seeds).map(descent).map(judged).collect();
    let all = separable.iter().chain(&swarms).chain(&descents).map(|r| r.0);
    let lowest = all.fold(f64::INFINITY, f64::min);
    Ok(Duel {
        joint: problem.joint,
        samples: problem.samples(),
        lowest,
        direct_ms: direct_ms(problem, &anywhere(&bounds, 0)),
        separable: record(&separable, lowest),
        swarm: record(&swarms, lowest),
        descent: record(&descents, lowest),
    })
}

fn timed(search: impl FnOnce() -> (Vec<f64>, usize)) -> (Vec<f64>, usize, f64) {
    let clock = Instant::now();
    let (x, evaluations) = search();
    (x, evaluations, ms(clock))
}

fn ms(clock: Instant) -> f64 {
    1e3 * clock.elapsed().as_secs_f64()
}

fn anywhere(bounds: &Bounds, seed: u64) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    (0..bounds.len()).map(|i| bounds.lower(i) + bounds.span(i) * rng.random::<f64>()).collect()
}

/// The fastest of a few.
fn direct_ms(problem: &JointProblem, x: &[f64]) -> f64 {
    let once = |_| {
        let clock = Instant::now();
        std::hint::black_box(problem.direct_cost(std::hint::black_box(x)));
        ms(clock)
    };
    (0..20).map(once).fold(f64::INFINITY, f64::min)
}

fn record(runs: &[Run], lowest: f64) -> Record {
    let mut above: Vec<f64> = runs.iter().map(|r| r.0 / lowest - 1.0).collect();
    above.sort_by(f64::total_cmp);
    let mean = |f: fn(&Run) -> f64| runs.iter().map(f).sum::<f64>() / runs.len().max(1) as f64;
    Record {
        runs: runs.len(),
        reached: above.iter().filter(|a| **a <= REACHED).count(),
        median: above.get(above.len() / 2).copied().unwrap_or(f64::NAN),
        worst: above.last().copied().unwrap_or(f64::NAN),
        evaluations: mean(|r| r.1 as f64),
        ms: mean(|r| r.2),
    }
}

/// One method over all joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tally {
    pub runs: usize,
    pub reached: usize,
    /// Above the lowest cost, relative.
    pub worst: f64,
}

impl Tally {
    pub fn share(&self) -> f64 {
        self.reached as f64 / self.runs.max(1) as f64
    }
}

/// The runs of one method, summed over joints.
pub fn tally(duels: &[Duel], of: fn(&Duel) -> &Record) -> Tally {
    let records = || duels.iter().map(of);
    Tally {
        runs: records().map(|r| r.runs).sum(),
        reached: records().map(|r| r.reached).sum(),
        worst: records().map(|r| r.worst).fold(0.0, f64::max),
    }
}

/// All joints of one recording, as a sentence.
pub fn answer(duels: &[Duel]) -> String {
    let nlse = tally(duels, |d| &d.separable);
    let pso = tally(duels, |d| &d.swarm);
    let lm = tally(duels, |d| &d.descent);
    let swarm_wins = |other: Tally| match pso.share().total_cmp(&other.share()) {
        std::cmp::Ordering::Greater => "beats",
        std::cmp::Ordering::Equal => "equals",
        std::cmp::Ordering::Less => "does not beat",
    };
    format!(
        "PSO {} separable least squares and {} plain Levenberg-Marquardt from random starts: the \
         lowest cost was reached to 0.01 % in {} of {} runs by separable least squares, {} of {} by \
         PSO (worst +{:.2} %) and {} of {} by Levenberg-Marquardt (worst +{:.2} %).",
        swarm_wins(nlse),
        swarm_wins(lm),
        nlse.reached,
        nlse.runs,
        pso.reached,
        pso.runs,
        100.0 * pso.worst,
        lm.reached,
        lm.runs,
        100.0 * lm.worst
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::testing;

    #[test]
    fn separable_least_squares_reaches_the_lowest_cost_anyone_finds() {
        let duel = duel(&testing::problem(600, 0.3, false), 6).unwrap();
        assert_eq!(duel.separable.reached, 1);
        assert!(duel.separable.worst < 1e-6, "{duel:?}");
        assert_eq!((duel.swarm.runs, duel.swarm.evaluations), (6, 60_060.0));
        assert!(duel.swarm.median <= duel.swarm.worst && duel.descent.worst >= 0.0, "{duel:?}");
        assert!(answer(&[duel]).contains("1 of 1 runs by separable"));
    }
}
