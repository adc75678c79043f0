//! What a search finds in gaps without a cause.
//!
//! Candidates differ in how much they gain by chance: one at a single joint has one residual to
//! follow, a load moves in all of them. So every gain counts in units of what the same candidate
//! gains on average by chance (and no less than half of what candidates do), and the largest of a
//! whole search is what a finding has to beat (the single-step maximum of Westfall and Young,
//! Resampling-Based Multiple Testing, 1993, section 2.3).

use super::search::Trial;

pub struct Chance {
    /// Of every candidate; what changes channels is not tried on surrogates and has a gain only.
    found: Vec<Found>,
    /// Largest in units of chance and largest gain of all candidates, per surrogate.
    relative: Vec<f64>,
    gain: Vec<f64>,
}

enum Found {
    Relative(f64),
    Gain(f64),
}

impl Chance {
    /// `gains` of the candidates of `screened` on every surrogate.
    pub fn new(screened: &[Trial], gains: &[Vec<f64>], surrogates: usize) -> Self {
        let logs = |(t, by_chance): (&Trial, &Vec<f64>)| -> Vec<f64> {
            by_chance.iter().map(|gain| log_gain(*gain, t.most)).collect()
        };
        let by_log: Vec<Vec<f64>> = screened.iter().zip(gains).map(logs).collect();
        let tried = screened.iter().zip(&by_log).filter(|(t, _)| !t.candidate.senses());
        let means: Vec<f64> = tried.map(|(_, by_chance)| mean(by_chance)).collect();
        let usual = mean(&means);
        let mut chance =
            Self { found: vec![], relative: vec![0.0; surrogates], gain: vec![0.0; surrogates] };
        for ((trial, by_chance), gains) in screened.iter().zip(&by_log).zip(gains) {
            let unit = (0.5 * (mean(by_chance) + usual)).max(f64::MIN_POSITIVE);
            chance.found.push(match trial.candidate.senses() {
                true => Found::Gain(trial.gain),
                false => Found::Relative(log_gain(trial.gain, trial.most) / unit),
            });
            for (s, (log, gain)) in by_chance.iter().zip(gains).enumerate() {
                chance.relative[s] = chance.relative[s].max(log / unit);
                chance.gain[s] = chance.gain[s].max(*gain);
            }
        }
        chance
    }

    /// Share of surrogate gaps in which the search finds as much as candidate `i`.
    pub fn p(&self, i: usize) -> f64 {
        let (largest, found) = match self.found[i] {
            Found::Relative(relative) => (&self.relative, relative),
            Found::Gain(gain) => (&self.gain, gain),
        };
        let as_good = largest.iter().filter(|l| **l >= found).count();
        (1 + as_good) as f64 / (1 + largest.len()) as f64
    }
}

/// n/2 ln(before / after) of a gain 1/2 (before - after) in units of the noise before.
fn log_gain(gain: f64, most: f64) -> f64 {
    let left = (1.0 - gain / most.max(f64::MIN_POSITIVE)).max(1e-9);
    -most * left.ln()
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::diagnosis::candidate::{Candidate, Place};
    use crate::effects::find;

    fn trial(name: &str, place: Place, gain: f64) -> Trial {
        let candidate = Candidate { effect: find(name).unwrap(), place };
        let (linear, nonlinear, starts) = (vec![], vec![], Arc::new(vec![]));
        Trial { candidate, linear, nonlinear, gain, most: 1000.0, starts }
    }

    /// A load gains much by chance; that is not held against a spring at one joint.
    #[test]
    fn a_gain_counts_in_units_of_its_own_chance() {
        let screened = [
            trial("payload", Place::Arm, 30.0),
            trial("cable_spring", Place::Joint(0), 20.0),
            trial("time_delay", Place::Joint(0), 20.0),
        ];
        let gains = [vec![22.0; 39], vec![1.0; 39], vec![0.0; 39]];
        let chance = Chance::new(&screened, &gains, 39);
        assert_eq!(chance.p(1), 1.0 / 40.0);
        assert_eq!(chance.p(0), 1.0 / 40.0);
        assert_eq!(chance.p(2), 1.0, "other gains are larger by chance");
        let weak =
            [trial("payload", Place::Arm, 21.0), trial("cable_spring", Place::Joint(0), 2.0)];
        let chance = Chance::new(&weak, &gains[..2], 39);
        assert_eq!([chance.p(0), chance.p(1)], [1.0, 1.0]);
    }
}
