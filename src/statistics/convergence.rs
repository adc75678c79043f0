//! Do Markov chains agree, and how many independent draws are they worth?
//!
//! Vehtari, Gelman, Simpson, Carpenter and Buerkner, "Rank-normalization, folding, and
//! localization: an improved R-hat", Bayesian Analysis 16(2), 2021; equations are numbered as there.
//! Every chain is split in halves, so that a drift within one shows as well.

use statrs::distribution::{ContinuousCDF, Normal};

/// Above it chains are taken to differ (their section 4).
const LARGEST_R_HAT: f64 = 1.01;
/// Effective draws wanted per chain (their section 4).
const FEWEST_PER_CHAIN: f64 = 100.0;
/// Quantiles at which the tails are looked at.
const TAILS: [f64; 2] = [0.05, 0.95];

/// Convergence of one parameter's chains. All NaN for chains without spread or of fewer than 8 draws.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Convergence {
    /// Rank-normalised split R-hat, the larger of bulk and folded: 1 where chains agree.
    pub r_hat: f64,
    /// Independent draws that would tell the centre as well.
    pub ess_bulk: f64,
    /// Independent draws that would tell the 5 % and 95 % quantiles as well, the smaller number.
    pub ess_tail: f64,
}

impl Convergence {
    /// `chains`: the draws of one parameter, all chains equally long.
    pub fn of(chains: &[Vec<f64>]) -> Self {
        let nan = f64::NAN;
        let halves = split(chains);
        if halves.first().is_none_or(|h| h.len() < 4) || spread(&halves) <= 0.0 {
            return Self { r_hat: nan, ess_bulk: nan, ess_tail: nan };
        }
        let normal = rank_normalised(&halves);
        let tail = |p| effective_draws(&split(&indicators(chains, p)));
        Self {
            r_hat: r_hat(&normal).max(r_hat(&rank_normalised(&folded(&halves)))),
            ess_bulk: effective_draws(&normal),
            ess_tail: tail(TAILS[0]).min(tail(TAILS[1])),
        }
    }

    /// R-hat below 1.01 and 100 effective draws per chain, in the bulk and in the tails.
    pub fn reached(&self, chains: usize) -> bool {
        let wanted = FEWEST_PER_CHAIN * chains as f64;
        self.r_hat < LARGEST_R_HAT && self.ess_bulk >= wanted && self.ess_tail >= wanted
    }
}

/// First and last half of every chain; of an odd number of draws the middle one is left out.
fn split(chains: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let halves = |c: &Vec<f64>| {
        let half = c.len() / 2;
        [c[..half].to_vec(), c[c.len() - half..].to_vec()]
    };
    chains.iter().flat_map(halves).collect()
}

fn spread(chains: &[Vec<f64>]) -> f64 {
    let ends = |(low, high): (f64, f64), x: &f64| (low.min(*x), high.max(*x));
    let (low, high) = chains.iter().flatten().fold((f64::INFINITY, f64::NEG_INFINITY), ends);
    high - low
}

/// z = Phi^-1((r - 3/8) / (S + 1/4)), r the rank among all S draws, ties sharing theirs (Eq. 14).
fn rank_normalised(chains: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let length = chains[0].len();
    let all = chains.concat();
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by(|&a, &b| all[a].total_cmp(&all[b]));
    let mut z = vec![0.0; all.len()];
    let standard = Normal::standard();
    let mut rank = 0.0;
    for tied in order.chunk_by(|&a, &b| all[a] == all[b]) {
        let middle = rank + 0.5 * (tied.len() as f64 + 1.0);
        let value = standard.inverse_cdf((middle - 0.375) / (all.len() as f64 + 0.25));
        tied.iter().for_each(|&i| z[i] = value);
        rank += tied.len() as f64;
    }
    z.chunks(length).map(<[f64]>::to_vec).collect()
}

/// |x - median| (Eq. 15): chains of different width have different means of it.
fn folded(chains: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let sorted = sorted(chains);
    let n = sorted.len();
    let median = 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]);
    chains.iter().map(|c| c.iter().map(|x| (x - median).abs()).collect()).collect()
}

/// Is a draw at or below the `p` quantile of all?
fn indicators(chains: &[Vec<f64>], p: f64) -> Vec<Vec<f64>> {
    let sorted = sorted(chains);
    let quantile = sorted[(p * (sorted.len() - 1) as f64) as usize];
    let below = |x: &f64| if *x <= quantile { 1.0 } else { 0.0 };
    chains.iter().map(|c| c.iter().map(below).collect()).collect()
}

fn sorted(chains: &[Vec<f64>]) -> Vec<f64> {
    let mut all = chains.concat();
    all.sort_by(f64::total_cmp);
    all
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

fn variance(x: &[f64]) -> f64 {
    let m = mean(x);
    x.iter().map(|v| (v - m).powi(2)).sum::<f64>() / (x.len() as f64 - 1.0)
}

/// sqrt(((N - 1)/N W + B/N) / W) with the mean variance within chains W and between them B (Eqs.
/// 1 to 4).
fn r_hat(chains: &[Vec<f64>]) -> f64 {
    let n = chains[0].len() as f64;
    let within = mean(&chains.iter().map(|c| variance(c)).collect::<Vec<_>>());
    let between = variance(&chains.iter().map(|c| mean(c)).collect::<Vec<_>>());
    ((n - 1.0) / n + between / within).sqrt()
}

/// S / tau, tau = -1 + 2 sum rho_t over Geyer's initial monotone sequence, with the chains'
/// combined autocorrelation rho_t = 1 - (W - mean gamma_t) / var+ (Eqs. 10 to 13).
fn effective_draws(chains: &[Vec<f64>]) -> f64 {
    let n = chains[0].len();
    let draws = (n * chains.len()) as f64;
    if spread(chains) <= 0.0 {
        return draws;
    }
    let means: Vec<f64> = chains.iter().map(|c| mean(c)).collect();
    let centred: Vec<Vec<f64>> =
        chains.iter().zip(&means).map(|(c, m)| c.iter().map(|x| x - m).collect()).collect();
    let gamma = |t: usize| {
        let of = |c: &Vec<f64>| c[t..].iter().zip(c).map(|(a, b)| a * b).sum::<f64>();
        centred.iter().map(of).sum::<f64>() / draws
    };
    let within = gamma(0) * n as f64 / (n as f64 - 1.0);
    let total = gamma(0) + variance(&means);
    let tau = autocorrelation_time(n, |t| 1.0 - (within - gamma(t)) / total);
    draws / tau.max(1.0 / draws.log10())
}

/// Pairs rho_2k + rho_2k+1 are summed while positive, none taken larger than the one before; half
/// of the first pair left out is added, as in the authors' own program.
fn autocorrelation_time(n: usize, rho: impl Fn(usize) -> f64) -> f64 {
    let mut pair = [1.0, rho(1)];
    let (mut sum, mut least, mut t) = (0.0, f64::INFINITY, 1);
    while t + 3 < n && pair[0] + pair[1] > 0.0 {
        least = least.min(pair[0] + pair[1]);
        sum += least;
        pair = [rho(t + 1), rho(t + 2)];
        t += 2;
    }
    let last = if pair[0] + pair[1] >= 0.0 { pair[0] } else { pair[0].max(0.0) };
    2.0 * sum - 1.0 + last
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Deserialize)]
    struct Case {
        name: String,
        chains: Vec<Vec<f64>>,
        r_hat: f64,
        ess_bulk: f64,
        ess_tail: f64,
    }

    /// `tests/golden/convergence.py`
    fn cases() -> Vec<Case> {
        serde_json::from_str(include_str!("../../tests/golden/convergence.json")).unwrap()
    }

    #[test]
    fn arviz_is_repeated() {
        for case in cases() {
            let found = Convergence::of(&case.chains);
            let pairs = [
                (found.r_hat, case.r_hat),
                (found.ess_bulk, case.ess_bulk),
                (found.ess_tail, case.ess_tail),
            ];
            for (a, b) in pairs {
                assert!((a / b - 1.0).abs() < 1e-9, "{}: {found:?}", case.name);
            }
        }
    }

    #[test]
    fn chains_in_different_places_or_of_different_width_have_not_converged() {
        for case in cases() {
            let good = ["independent", "heavy", "ties"].contains(&case.name.as_str());
            assert_eq!(Convergence::of(&case.chains).r_hat < LARGEST_R_HAT, good, "{}", case.name);
        }
    }

    #[test]
    fn chains_that_never_move_have_not_converged() {
        let stuck = vec![vec![1.0; 100]; 4];
        assert!(!Convergence::of(&stuck).reached(4));
        assert!(!Convergence::of(&[vec![0.0, 1.0]]).reached(1));
    }
}
