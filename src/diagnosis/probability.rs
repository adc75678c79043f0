//! How probable each candidate, "none" and "unknown" are.

use super::leftover::{LOUD, Remains, SYSTEMATIC};
use super::rank::LEAST_NATS;

/// Of "unknown": steepness over the logarithm of what is left, and over the share explained.
const STEEP_LEFT: f64 = 4.0;
/// Over that of what is left at all frequencies, which varies less.
const STEEP_FAST: f64 = 16.0;
const STEEP_SHARE: f64 = 10.0;
/// Share of what was systematic that the causes have to explain.
const LEAST_SHARE: f64 = 0.5;
/// Where a leftover counts as much for as against the cause: times the systematic limit, and more
/// by this share of what there was before (no signature is exact: of effects that were named rightly
/// up to 0.01 stayed where much stood out).
const HALFWAY: f64 = 2.0;
const INEXACT: f64 = 0.01;
/// Times the best joint's leftover, where the twin is inexact throughout: a joint that keeps as much
/// lacks something of its own.
const FAR: f64 = 20.0;

/// Gain of a declined candidate that speaks as much for it as for a signature that is not exact, nats.
const REAL_NATS: f64 = 50.0;
/// Of all declined candidates together, at most.
const MOST_DECLINED: f64 = 0.5;

/// That something outside the catalogue is at work at `joints`, where the causes leave `remains`.
///
/// Where some joint is at its noise the twin is exact, and anything systematic that stays at a
/// joint a cause acts on speaks against it. Where no joint is, the twin is inexact throughout and
/// the share explained counts, and that no joint stays far from what the best one shows to be
/// possible.
pub fn of_unknown(remains: &Remains, joints: &[usize]) -> f64 {
    let by_share = logistic(STEEP_SHARE * (LEAST_SHARE - remains.explained(joints)));
    match remains.is_exact() {
        true => {
            let left = |&j: &usize| {
                let halfway = HALFWAY * SYSTEMATIC + INEXACT * remains.before[j];
                (remains.after[j] / halfway).ln()
            };
            let worst = joints.iter().map(left).fold(f64::NEG_INFINITY, f64::max);
            by_share.max(logistic(STEEP_LEFT * worst))
        }
        false => by_share.max(logistic(STEEP_LEFT * (remains.farthest() / FAR).ln())),
    }
}

/// That something is at work although no cause could be told, by what stands out where the arm
/// moves.
pub fn of_something(remains: &Remains) -> f64 {
    let slow = remains.before.iter().copied().fold(1.0, f64::max);
    let loud = remains.loud(&remains.chi2_before).map(|j| remains.chi2_before[j]);
    let fast = loud.fold(1.0, f64::max);
    logistic((STEEP_LEFT * (slow / SYSTEMATIC).ln()).max(STEEP_FAST * (fast / LOUD).ln()))
}

/// Of all candidates together where none was accepted, besides "unknown": what chance finds in a
/// share `p` of surrogates is hardly one, nor is what gains `score` nats where a signature that is
/// not quite exact gains as much. At most as probable as "none".
pub fn of_declined(p: f64, score: f64) -> f64 {
    let real = (score / REAL_NATS).powi(2);
    MOST_DECLINED * (1.0 - p).powi(2) * real / (1.0 + real)
}

fn logistic(x: f64) -> f64 {
    1.0 / (1.0 + (-x).exp())
}

/// Probabilities from log-likelihoods in nats, of which differences up to `tolerance` count as none:
/// where signatures are inexact a nat says less, as much less as the tolerance is above the least.
pub fn shares(scores: &[f64], tolerance: f64) -> Vec<f64> {
    let top = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let nats = (tolerance / LEAST_NATS).max(1.0);
    let weights: Vec<f64> = scores.iter().map(|s| ((s - top) / nats).exp()).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|w| w / sum.max(f64::MIN_POSITIVE)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_sum_to_one() {
        let p = shares(&[1000.0, 999.0, -4000.0], LEAST_NATS);
        assert!((p.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!((p[0] / p[1] - 1f64.exp()).abs() < 1e-9 && p[2] == 0.0);
        let inexact = shares(&[1000.0, 999.0], 10.0 * LEAST_NATS);
        assert!((inexact[0] / inexact[1] - 0.1f64.exp()).abs() < 1e-9);
    }

    #[test]
    fn an_exact_twin_doubts_what_leaves_much() {
        let remains = |after: f64| Remains {
            before: vec![50.0, 1.0],
            after: vec![after, 1.0],
            chi2_before: vec![3.0, 1.0],
            chi2_per_sample: vec![1.0; 2],
            answered: vec![false; 2],
        };
        assert!(of_unknown(&remains(1.0), &[0]) < 0.05);
        assert!(of_unknown(&remains(20.0), &[0]) > 0.95);
        let inexact = Remains {
            before: vec![500.0, 90.0],
            after: vec![40.0, 40.0],
            chi2_before: vec![300.0; 2],
            chi2_per_sample: vec![30.0; 2],
            answered: vec![false; 2],
        };
        assert!(of_unknown(&inexact, &[0]) < 0.05);
    }

    #[test]
    fn what_was_declined_counts_by_chance_and_by_what_it_gains() {
        assert!(of_declined(0.0, 10.0) < 0.05 && of_declined(0.9, 1000.0) < 0.05);
        assert!((of_declined(0.0, REAL_NATS) - 0.25).abs() < 1e-12);
        assert!(of_declined(0.0, 1e6) <= 0.5);
    }

    #[test]
    fn without_a_cause_what_stands_out_decides() {
        let remains = |before: f64| Remains {
            before: vec![1.1, before],
            after: vec![1.1, before],
            chi2_before: vec![1.0; 2],
            chi2_per_sample: vec![1.0; 2],
            answered: vec![false; 2],
        };
        assert!(of_something(&remains(1.2)) < 0.15);
        assert!(of_something(&remains(8.0)) > 0.99);
        let rattling = |chi2: f64| Remains { chi2_before: vec![1.0, chi2], ..remains(1.2) };
        assert!(of_something(&rattling(1.2)) < 0.15);
        assert!(of_something(&rattling(3.0)) > 0.99);
        let answered = Remains { answered: vec![false, true], ..rattling(3.0) };
        assert!(of_something(&answered) < 0.15);
    }
}
