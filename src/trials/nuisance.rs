//! What a real arm has besides: link masses and centres off, coloured noise, skewed channels.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::Serialize;

use crate::effects;
use crate::recording::Recording;
use crate::robot::Robot;
use crate::series::JointSeries;
use crate::simulation::{Injection, Run, Setup};

/// Standard deviations of link masses (relative) and centres (m).
pub const MASS_ERROR: f64 = 0.05;
pub const CENTRE_ERROR_M: f64 = 0.005;

/// Share of the noise's power that is coloured, and its correlation from sample to sample.
const COLOURED: f64 = 0.5;
const POLE: f64 = 0.9;

/// Largest time between current and position, s.
const SKEW_S: f64 = 0.001;

/// What was drawn; sealed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Nuisance {
    /// [dm, d(m cx), d(m cy), d(m cz)] of every link, kg and kg.m.
    pub links: Vec<Vec<f64>>,
    /// Delay by which the current is recorded late, s.
    pub skew_s: f64,
}

impl Nuisance {
    pub fn draw(robot: &Robot, rng: &mut ChaCha8Rng) -> Self {
        let mut normal = || -> f64 { StandardNormal.sample(rng) };
        let links = robot
            .bodies
            .iter()
            .map(|body| {
                let mass = body.inertia.mass * MASS_ERROR * normal();
                let heavy = body.inertia.mass + mass;
                let moment = |i: usize, shift: f64| mass * body.inertia.com[i] + heavy * shift;
                let mut row = vec![mass];
                row.extend((0..3).map(|i| moment(i, CENTRE_ERROR_M * normal())));
                row
            })
            .collect();
        Self { links, skew_s: rng.random_range(-SKEW_S..SKEW_S) }
    }

    /// The errors of the link masses and centres, to be put into the arm.
    pub fn injection(&self) -> Option<Injection> {
        let effect = effects::find("link_inertia")?;
        let joints = (0..self.links.len()).collect();
        Some(Injection { effect, joints, values: self.links.clone() })
    }

    /// The recorded current once more: skewed, part of its noise coloured, rounded.
    pub fn record_current(
        &self,
        run: &Run,
        setup: &Setup,
        dt: f64,
        rng: &mut ChaCha8Rng,
    ) -> JointSeries {
        let step = setup.quantisation.current_a;
        run.shown.current.map_joints(|j, clean| {
            let mut coloured = 0.0;
            let late = shifted(clean, self.skew_s / dt);
            let noisy = late.iter().map(|clean| {
                let [a, b]: [f64; 2] = [StandardNormal.sample(rng), StandardNormal.sample(rng)];
                coloured = POLE * coloured + (1.0 - POLE * POLE).sqrt() * a;
                let noise = COLOURED.sqrt() * coloured + (1.0 - COLOURED).sqrt() * b;
                let noisy = clean + run.current_noise_a[j] * noise;
                (noisy / step).round() * step
            });
            noisy.collect()
        })
    }
}

/// x(k - shift) by cubic interpolation through four neighbours, the ends held; |shift| <= 1.
fn shifted(x: &[f64], shift: f64) -> Vec<f64> {
    let last = x.len() as isize - 1;
    let at = |k: isize| x[k.clamp(0, last) as usize];
    let lagrange = |k: usize| {
        let position = k as f64 - shift;
        let (k, u) = (position.floor() as isize, position - position.floor());
        let [a, b, c, d] = [at(k - 1), at(k), at(k + 1), at(k + 2)];
        -u * (u - 1.0) * (u - 2.0) / 6.0 * a + (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0 * b
            - (u + 1.0) * u * (u - 2.0) / 2.0 * c
            + (u + 1.0) * u * (u - 1.0) / 6.0 * d
    };
    (0..x.len()).map(lagrange).collect()
}

/// Replaces the channel `stem` of every joint.
pub fn replace(recording: &mut Recording, stem: &str, series: &JointSeries) {
    for j in 0..series.joints() {
        let name = format!("{stem}_{j}");
        if let Some(channel) = recording.channels.iter_mut().find(|c| c.name == name) {
            channel.values.copy_from_slice(series.joint(j));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shift_moves_a_sine() {
        let wave = |s: f64| (0..200).map(|k| (0.1 * (f64::from(k) - s)).sin()).collect::<Vec<_>>();
        for shift in [-0.4, 0.0, 0.3] {
            let (found, wanted) = (shifted(&wave(0.0), shift), wave(shift));
            let worst = (3..197).map(|k| (found[k] - wanted[k]).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-5, "{shift}: {worst}");
        }
    }
}
