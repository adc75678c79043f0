//! How much of the rows is independent, and the level at which intervals hold.

use super::data::Data;
use super::fit::Fit;
use super::likely::INCONSISTENT;
use super::model::Model;
use super::observed::Observed;
use crate::statistics::effective_samples;

/// Confidence level of the intervals.
pub const LEVEL: f64 = 0.9;

/// Passes of counting rows and sizing the discrepancy: they agree after three to five.
const MOST_PASSES: usize = 8;

/// These recordings, each row counted by what is independent of what a model leaves beside a discrepancy. Where rows
/// count too much, noise that is correlated in time passes for a discrepancy, which takes it away, so that the rest
/// looks independent: counts and sizes have to agree.
pub fn counted<'a>(all_rows: &Data<'a>, model: &Model) -> Data<'a> {
    let joints: Vec<usize> = (0..all_rows.joints()).collect();
    let mut data = all_rows.again();
    for _ in 0..MOST_PASSES {
        let fit = Fit::plain(&data, model.clone());
        let sizes = fit.likely_sizes(&joints);
        let shares = shares(&fit.beside(sizes));
        let agree = are_near(&shares, &data.shares);
        data = data.counted(shares);
        if agree {
            break;
        }
    }
    data
}

/// Do rows count as much, recording by recording and joint by joint?
pub fn are_near(shares: &[Vec<f64>], others: &[Vec<f64>]) -> bool {
    let pairs = shares.iter().flatten().zip(others.iter().flatten());
    pairs.into_iter().all(|(a, b)| (a - b).abs() <= INCONSISTENT * b)
}

/// Share of each joint's rows that is independent in what model and discrepancy leave, over that by which
/// they count already.
pub fn independent(fit: &Fit<'_>) -> Vec<f64> {
    let now = shares(fit);
    let count = |shares: &[Vec<f64>], j: usize| -> f64 {
        let parts = fit.data.parts.iter().zip(shares);
        parts.map(|(p, shares)| shares[j] * p.rows[j].len().max(1) as f64).sum()
    };
    (0..fit.data.joints()).map(|j| count(&now, j) / count(&fit.data.shares, j)).collect()
}

/// Share of the rows that is independent in what model and discrepancy leave, recording by recording and joint by joint:
/// neighbours are alike, and so are cycles of a motion.
pub fn shares(fit: &Fit<'_>) -> Vec<Vec<f64>> {
    let joint = |j: usize| {
        let rows = fit.innovations(j);
        let among =
            if rows.is_empty() { 1.0 } else { effective_samples(&rows) / rows.len() as f64 };
        not_again(fit, j, &rows).into_iter().map(|once| among * once).collect()
    };
    by_recording((0..fit.data.joints()).map(joint).collect(), fit.data.parts.len())
}

/// Joint by joint and recording by recording -> the other way round.
fn by_recording(joints: Vec<Vec<f64>>, recordings: usize) -> Vec<Vec<f64>> {
    (0..recordings).map(|p| joints.iter().map(|joint| joint[p]).collect()).collect()
}

/// Share of the rows of a joint in each recording, which have these values, that do not come again with the motion.
fn not_again(fit: &Fit<'_>, joint: usize, values: &[f64]) -> Vec<f64> {
    let mut rest = values;
    let mut of = |part: &&Observed<'_>| {
        let (own, others) = rest.split_at(part.rows[joint].len());
        rest = others;
        1.0 / part.design_effect(joint, own)
    };
    fit.data.parts.iter().map(&mut of).collect()
}

/// A recording of the same arm beside `model`, with noise like that of the recording of `known`: its rows are as dependent
/// on their neighbours, but its motion comes again by itself.
pub fn as_dependent<'a>(all_rows: Data<'a>, known: &Fit<'_>, model: &Model) -> Data<'a> {
    let own = Fit::plain(&all_rows, model.clone());
    let once = |fit: &Fit<'_>, j: usize| not_again(fit, j, &fit.innovations(j))[0];
    let share = |j: usize| known.data.shares[0][j] / once(known, j) * once(&own, j);
    let shares = vec![(0..all_rows.joints()).map(share).collect()];
    all_rows.counted(shares)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::sizes::Sizes;
    use crate::diagnosis::{DiagnosisError, Settings};
    use crate::signals::Samples;
    use crate::signals::testing::samples;
    use crate::twin::Twin;

    const NOISE_NM: f64 = 0.3;

    /// Of an exact twin whose torque has noise that is correlated over ten samples, and `more` of its posture.
    fn recorded(more: f64) -> Samples {
        let twin = Twin::default();
        let mut made = samples(6, 5000, |j, t| {
            0.7 * ((0.9 + 0.2 * j as f64) * t).sin() + 0.4 * (0.6 * t + j as f64).cos()
        });
        let torque = twin.torque(&twin.motion(&made));
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        made.torque = torque.map_joints(|j, torque| {
            let mut slow = 0.0;
            let of = |(t, q): (&f64, &f64)| {
                let [a, white]: [f64; 2] = [(); 2].map(|()| StandardNormal.sample(&mut rng));
                slow = 0.9 * slow + 0.19f64.sqrt() * a;
                t + NOISE_NM * 0.5f64.sqrt() * (slow + white) + more * (3.0 * q).sin()
            };
            torque.iter().zip(made.q.joint(j)).map(of).collect()
        });
        made
    }

    fn sizes(made: &Samples, agree: bool) -> Result<Sizes, DiagnosisError> {
        let twin = Twin::default();
        let settings = Settings { mass_error: 0.0, ..Settings::default() };
        let observed = Observed::new(0, &twin, made, &noise_floor(made, &twin))?;
        let mut data = Data::new(vec![&observed], &settings);
        if agree {
            data = counted(&data, &Model::of(&twin));
        }
        Ok(Fit::plain(&data, Model::of(&twin)).likely_sizes(&[0, 1, 2, 3, 4, 5]))
    }

    #[test]
    fn slow_noise_is_no_discrepancy() {
        let made = recorded(0.0);
        let of_joints = |agree: bool| {
            let joints = sizes(&made, agree).unwrap().joints;
            joints.iter().filter(|groups| groups.iter().any(|step| *step > 0)).count()
        };
        assert_eq!(of_joints(false), 6);
        assert!(of_joints(true) <= 1);
    }

    #[test]
    fn a_discrepancy_stands_beside_slow_noise() {
        let found = sizes(&recorded(NOISE_NM), true).unwrap();
        assert!(found.joints.iter().all(|groups| groups[0] > 0), "{found:?}");
    }

    /// How many rows count of so many cycles of a motion, where the twin lacks what no law describes.
    fn counted_of(cycles: usize) -> f64 {
        const CYCLE: usize = 1600;
        let twin = Twin::default();
        let mut made = samples(6, cycles * CYCLE, |j, t| {
            let w = std::f64::consts::TAU / (CYCLE as f64 * 0.008);
            0.7 * (2.0 * w * t + j as f64).sin() + 0.4 * ((3 + j) as f64 * w * t).cos()
        });
        let torque = twin.torque(&twin.motion(&made));
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        made.torque = torque.map_joints(|j, torque| {
            let mut of = |(t, q): (&f64, &f64)| {
                let white: f64 = StandardNormal.sample(&mut rng);
                t + 0.1 * NOISE_NM * white + NOISE_NM * (40.0 * q).sin()
            };
            torque.iter().zip(made.q.joint(j)).map(&mut of).collect()
        });
        let observed = Observed::new(0, &twin, &made, &noise_floor(&made, &twin)).unwrap();
        let data = Data::plain(vec![&observed]);
        let shares = shares(&Fit::plain(&data, Model::of(&twin)));
        (0..6).map(|j| shares[0][j] * data.rows(j) as f64).sum()
    }

    #[test]
    fn a_motion_that_comes_again_says_the_same_again() {
        let [one, four] = [1, 4].map(counted_of);
        assert!((four / one - 1.0).abs() < 0.25, "{one} {four}");
    }
}
