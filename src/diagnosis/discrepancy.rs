//! The model discrepancy: what a twin of this kind may leave out, whatever the law.
//!
//! Per joint a smooth function of the motion of any shape, a channel that is a part of a sample late, what changes slowly in
//! time, and friction that is another on another day, each of a size that the data decide (Kennedy and O'Hagan, "Bayesian
//! calibration of computer models", J. R. Stat. Soc. B 63, 2001): on an exact twin it goes to
//! nothing, on a real arm it is what is always left. A cause has to earn its place beside it, which
//! a law does where one number holds for many poses, or where it jumps.

use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::Settings;
use super::model::Model;
use super::observed::Observed;
use crate::effects::Motion;
use crate::regression::random_effects::Features;
use crate::signals::central_difference;

/// Groups, each with a size of its own.
pub const GROUPS: [&str; 4] = ["posture", "timing", "time", "friction"];
/// Groups whose size is known beforehand: no larger than the features as they come.
pub const KNOWN: [&str; 1] = ["timing"];
/// The group of what the twin leaves open: its mean belongs to that.
const OPEN: &str = "friction";
/// Share of the time between samples: channels are not taken at one instant better than this.
pub(super) const SIMULTANEOUS: f64 = 0.125;

/// Features of a smooth function of all angles and speeds (Rahimi and Recht, "Random features for
/// large-scale kernel machines", NIPS 2007), and the standard deviations over which it bends.
const POSTURE_FEATURES: usize = 100;
const POSTURE_LENGTH: f64 = 2.5;
/// The features are constant over so long, s: they are smooth, and a low-passed recording has no more
/// rows.
const CONSTANT_S: f64 = 0.05;
/// Slower than this is not told from the motion, which repeats within seconds, Hz.
const SLOW_HZ: f64 = 0.05;

type Series = Vec<f64>;

/// Location and scale of every joint's motion over all recordings.
struct Scales {
    q: Vec<[f64; 2]>,
    qd: Vec<f64>,
}

/// Everything the features are made from.
pub struct Discrepancy<'a> {
    parts: &'a [&'a Observed<'a>],
    scales: Scales,
    waves: Vec<(Vec<f64>, f64)>,
}

impl<'a> Discrepancy<'a> {
    pub fn new(parts: &'a [&'a Observed<'a>], settings: &'a Settings) -> Self {
        let joints = parts[0].joints();
        let over = |pick: &dyn Fn(&Observed, usize) -> Vec<f64>, j: usize| -> Vec<f64> {
            parts.iter().flat_map(|p| pick(p, j)).collect()
        };
        let used = |p: &Observed, series: &crate::series::JointSeries, j: usize| -> Vec<f64> {
            let all = series.joint(j);
            p.samples.usable.iter().zip(all).filter(|(u, _)| **u).map(|(_, x)| *x).collect()
        };
        let q = |j| spread(&over(&|p, j| used(p, &p.samples.q, j), j));
        let qd = |j| spread(&over(&|p, j| used(p, &p.samples.qd, j), j))[1];
        let each = 0..joints;
        let scales = Scales { q: each.clone().map(q).collect(), qd: each.map(qd).collect() };
        let mut rng = ChaCha8Rng::seed_from_u64(settings.seed);
        let mut wave = || {
            let direction: Vec<f64> = (0..2 * joints)
                .map(|_| {
                    let x: f64 = StandardNormal.sample(&mut rng);
                    x / POSTURE_LENGTH
                })
                .collect();
            (direction, rng.random::<f64>() * TAU)
        };
        let waves = (0..POSTURE_FEATURES).map(|_| wave()).collect();
        Self { parts, scales, waves }
    }

    /// The features of a joint over the rows of all recordings, whose noise has this standard
    /// deviation (N.m); `rows` makes rows of a series over the samples of recording number p.
    pub fn features(
        &self,
        joint: usize,
        noise: f64,
        rows: impl Fn(usize, &[f64]) -> Vec<f64>,
    ) -> Features {
        let mut largest = Vec::new();
        let mut columns: Vec<Vec<f64>> = Vec::new();
        let mut group = Vec::new();
        for (g, name) in GROUPS.iter().enumerate() {
            let parts: Vec<Vec<Series>> =
                (0..self.parts.len()).map(|p| self.series(name, p, joint)).collect();
            let count = parts.iter().map(Vec::len).max().unwrap_or(0);
            let of = |i: usize| -> Vec<f64> {
                let row = |p: usize| rows(p, &parts[p][i]);
                (0..self.parts.len()).flat_map(row).collect()
            };
            let mut made: Vec<Vec<f64>> = (0..count).map(of).collect();
            let known = KNOWN.contains(name);
            if *name != OPEN {
                made.iter_mut().for_each(|column| centre(column));
            }
            let sd = normalise(&mut made, known);
            if known {
                largest.push((g, sd / noise.max(f64::MIN_POSITIVE)));
            }
            made.retain(|c| c.iter().any(|v| *v != 0.0));
            group.extend(vec![g; made.len()]);
            columns.append(&mut made);
        }
        let mut ends = self.parts.iter().map(|p| p.rows[joint].len()).collect::<Vec<_>>();
        (1..ends.len()).for_each(|p| ends[p] += ends[p - 1]);
        let features = Features::over_runs(&columns, group, GROUPS.len(), self.runs(joint), &ends);
        largest.into_iter().fold(features, |features, (g, most)| features.bounded(g, most))
    }

    /// Runs of a joint's rows over which the features are constant: where each begins, and the end.
    fn runs(&self, joint: usize) -> Vec<usize> {
        let cell = |p: &Observed<'_>, k: usize| (k as f64 * p.samples.dt / CONSTANT_S) as usize;
        let all = self
            .parts
            .iter()
            .enumerate()
            .flat_map(|(i, p)| p.rows[joint].iter().map(move |k| (i, cell(p, *k))));
        let cells: Vec<(usize, usize)> = all.collect();
        let begins = |i: &usize| *i == 0 || cells[*i] != cells[*i - 1];
        (0..cells.len()).filter(begins).chain([cells.len()]).collect()
    }

    fn series(&self, group: &str, part: usize, joint: usize) -> Vec<Series> {
        match group {
            "posture" => self.posture(part),
            "timing" => self.timing(part, joint),
            "time" => self.time(part),
            _ => self.friction(part, joint),
        }
    }

    /// Anything smooth in all angles and speeds.
    fn posture(&self, part: usize) -> Vec<Series> {
        let samples = self.parts[part].samples;
        let joints = samples.joints();
        let mut scaled = vec![Vec::with_capacity(samples.len()); 2 * joints];
        for j in 0..joints {
            let [centre, scale] = self.scales.q[j];
            scaled[j] = samples.q.joint(j).iter().map(|q| (q - centre) / scale.max(1e-6)).collect();
            let scale = self.scales.qd[j].max(1e-6);
            scaled[joints + j] = samples.qd.joint(j).iter().map(|v| v / scale).collect();
        }
        let wave = |(direction, phase): &(Vec<f64>, f64)| {
            let mut sum = vec![*phase; samples.len()];
            for (x, w) in scaled.iter().zip(direction) {
                crate::kernels::axpy(*w, x, &mut sum);
            }
            sum.iter_mut().for_each(|s| *s = s.cos());
            sum
        };
        self.waves.iter().map(wave).collect()
    }

    /// A torque that is recorded a part of a sample earlier or later than the motion.
    fn timing(&self, part: usize, joint: usize) -> Vec<Series> {
        let Observed { samples, known, .. } = self.parts[part];
        let rate = central_difference(known.joint(joint), samples.dt);
        vec![rate.into_iter().map(|r| SIMULTANEOUS * samples.dt * r).collect()]
    }

    /// What changes slowly while it is recorded, in each recording by itself.
    fn time(&self, part: usize) -> Vec<Series> {
        let mut all = Vec::new();
        for (p, of) in self.parts.iter().enumerate() {
            let n = of.samples.len();
            let most = (2.0 * SLOW_HZ * n as f64 * of.samples.dt).ceil() as usize;
            for order in 1..=most.max(1) {
                let here = self.parts[part].samples.len();
                let wave = |k: usize| {
                    (std::f64::consts::PI * order as f64 * (k as f64 + 0.5) / n as f64).cos()
                };
                all.push(if p == part { (0..here).map(wave).collect() } else { vec![0.0; here] });
            }
        }
        all
    }

    /// The friction that the twin leaves open, in each recording by itself: gears that are warmer have less.
    fn friction(&self, part: usize, joint: usize) -> Vec<Series> {
        let here = self.parts[part];
        let laden = here.twin.laden();
        let rigid = here.rigid(&laden);
        let motion =
            Motion { known: Some(&here.known), rigid: Some(&rigid), ..here.motion(&laden) };
        let model = Model::of(here.twin);
        let open = model.open.iter().filter(|t| t.candidate.effect.about().dissipates);
        let columns =
            open.flat_map(|t| t.series(&motion, here.index)).map(|mut c| c.swap_remove(joint));
        let columns: Vec<Series> = columns.filter(|c| !c.is_empty()).collect();
        let none = vec![vec![0.0; here.samples.len()]; columns.len()];
        let of = |p: usize| if p == part { columns.clone() } else { none.clone() };
        (0..self.parts.len()).flat_map(of).collect()
    }
}

/// Mean and standard deviation of a series.
fn spread(x: &[f64]) -> [f64; 2] {
    let n = x.len().max(1) as f64;
    let mean = x.iter().sum::<f64>() / n;
    let variance = x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
    [mean, variance.sqrt()]
}

/// Takes the mean off a column, so that a constant is no part of it.
fn centre(column: &mut [f64]) {
    let [mean, sd] = spread(column);
    let varies = sd > 1e-9 * mean.abs();
    column.iter_mut().for_each(|v| *v = if varies { *v - mean } else { 0.0 });
}

/// Columns such that a group of size 1 has mean square 1 over the rows: every column alike, or `together` as they
/// come. Returns the root mean square of the group before that.
fn normalise(columns: &mut [Vec<f64>], together: bool) -> f64 {
    let count = columns.len().max(1) as f64;
    let mut sum = 0.0;
    for column in columns.iter_mut() {
        let [mean, sd] = spread(column);
        let size = mean.hypot(sd);
        let scale = match together {
            true => 1.0,
            false if size > 0.0 => 1.0 / (size * count.sqrt()),
            false => 0.0,
        };
        column.iter_mut().for_each(|v| *v *= scale);
        sum += (scale * size).powi(2);
    }
    if together && sum > 0.0 {
        columns.iter_mut().flatten().for_each(|v| *v /= sum.sqrt());
    }
    sum.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::data::Data;
    use crate::diagnosis::fit::Fit;
    use crate::diagnosis::floor::noise_floor;
    use crate::signals::Samples;
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    const JOINT: usize = 2;
    const FRICTION: usize = 3;

    /// A run of an arm with viscous friction of `viscous` N.m.s/rad at `JOINT`.
    fn recorded(speed: f64, viscous: f64) -> Samples {
        let mut arm = Twin::default();
        let mut values = vec![8.0; 6];
        values[JOINT] = viscous;
        arm.values.insert("viscous".into(), values);
        let mut made = samples(6, 4000, |j, t| 0.6 * ((speed + 0.1 * j as f64) * t).sin());
        made.torque = arm.torque(&arm.motion(&made));
        noisy(&mut made, 0.2);
        made
    }

    /// Size of the group of friction at every joint, where the twin leaves viscous friction open.
    fn sizes(viscous: [f64; 2]) -> Vec<u8> {
        let twin = Twin { effects: vec!["viscous".into()], ..Twin::default() };
        let made = [recorded(0.9, viscous[0]), recorded(1.3, viscous[1])];
        let floors = made.each_ref().map(|s| noise_floor(s, &twin));
        let [fit, check] = [0, 1].map(|i| Observed::new(i, &twin, &made[i], &floors[i]).unwrap());
        let data = Data::new(vec![&fit, &check], &Settings::default());
        let all: Vec<usize> = (0..6).collect();
        let sizes = Fit::plain(&data, Model::of(&twin)).likely_sizes(&all);
        sizes.joints.iter().map(|joint| joint[FRICTION]).collect()
    }

    #[test]
    fn friction_that_is_another_in_another_recording_has_a_place() {
        assert_eq!(GROUPS[FRICTION], "friction");
        assert_eq!(sizes([8.0, 8.0]), [0; 6]);
        let warm = sizes([9.0, 7.0]);
        let others = (0..6).filter(|j| *j != JOINT);
        assert!(warm[JOINT] > 0 && others.into_iter().all(|j| warm[j] == 0), "{warm:?}");
    }
}
