//! What a twin states within limits: masses and centres of all links, and the scale of every joint's torque.
//!
//! A link's mass and first moments are as far from the twin's as these are known, one standard deviation, and the same
//! at all joints and in all recordings. So is the factor on a joint's torque: unloaded motions hardly tell it from links
//! that are heavier. All are fitted beside a model as further columns, each expected to be as large as its
//! tolerance times one size. The data decide that size, up to 1: of an exact twin it is nothing. (What a model takes for
//! known as random, with what is known of it: Kennedy and O'Hagan 2001; that scales of torque need a known load: Gautier
//! and Briot, "Global identification of joint drive gains and dynamic parameters of robots", J. Dyn. Sys. Meas. Control
//! 136(5), 2014.)

use std::sync::Arc;

use nalgebra::{DMatrix, SymmetricEigen};

use super::Settings;
use super::observed::Observed;
use crate::effects::Motion;
use crate::regression::Blocks;
use crate::regression::random_effects::STEPS;
use crate::robot::Body;

/// Values of a link that are known within limits: its mass and three first moments.
pub const PER_LINK: usize = 4;
/// Combinations of these that change what all rows show by less, in squared standard deviations of the noise at their
/// tolerance: no data tell them.
const UNTOLD: f64 = 0.1;

/// Share of the tolerances for a step of the grid: a half for every step below the largest.
pub fn size(step: u8) -> f64 {
    if step == 0 { 0.0 } else { 0.5f64.powi(i32::from(STEPS - step)) }
}

/// Tolerances of an arm, as recordings of it tell them.
#[derive(Clone)]
pub struct Tolerances {
    /// Every link's values, kg and kg.m.
    links: Vec<f64>,
    /// What the recordings tell of them: orthonormal combinations, in units of their tolerances.
    told: DMatrix<f64>,
    /// Scale of a joint's torque, relative.
    scale: f64,
}

impl Tolerances {
    /// A twin that is exact.
    pub fn none() -> Self {
        Self { links: Vec::new(), told: DMatrix::zeros(0, 0), scale: 0.0 }
    }

    /// Of the arm in `parts`, whose noise has these variances, (N.m)^2. None where no torque was recorded: a position
    /// servo's gain is the scale of all torque, and a simulation decides what is there.
    pub fn new(parts: &[&Observed<'_>], noise: &[f64], settings: &Settings) -> Self {
        let by_position = parts.iter().any(|p| p.samples.response.is_some());
        if settings.mass_error <= 0.0 || by_position {
            return Self::none();
        }
        let bodies = &parts[0].twin.robot.bodies;
        let links: Vec<f64> = bodies.iter().flat_map(|b| mass_errors(b, settings)).collect();
        let columns: Vec<Arc<Vec<Blocks>>> = parts.iter().map(|p| of_links(p)).collect();
        let product = |i: usize, k: usize| {
            let of = |c: &Arc<Vec<Blocks>>| -> f64 {
                noise.iter().enumerate().map(|(j, s)| c[i].dot(&c[k], j) / s).sum()
            };
            columns.iter().map(of).sum::<f64>() * links[i] * links[k]
        };
        let told = combinations(DMatrix::from_fn(links.len(), links.len(), product));
        Self { links, told, scale: settings.mass_error }
    }

    /// How far the scale of a joint's torque, and so of what the arm weighs, may be off: relative, one standard deviation;
    /// nothing where the twin is exact.
    pub fn of_scale(&self) -> f64 {
        self.scale
    }

    /// Limits of every link's values, kg and kg.m, then of every joint's scale; none where the twin is exact.
    pub fn limits(&self) -> Vec<f64> {
        let scales = vec![self.scale; self.links.len() / PER_LINK];
        self.links.iter().copied().chain(scales).collect()
    }

    /// How many columns they are.
    pub fn count(&self) -> usize {
        if self.links.is_empty() { 0 } else { self.told.ncols() + self.links.len() / PER_LINK }
    }

    /// Torque at the rows of a recording for one tolerance of each combination of links' values, N.m.
    pub fn of_links(&self, observed: &Observed<'_>) -> Vec<Blocks> {
        let links = of_links(observed);
        let combined = |along: usize| {
            let mut sum = Blocks(vec![Vec::new(); observed.joints()]);
            for (i, column) in links.iter().enumerate() {
                sum.gather(self.links[i] * self.told[(i, along)], column);
            }
            sum
        };
        (0..self.told.ncols()).map(combined).collect()
    }

    /// Torque at the rows of a recording for one tolerance of the scale of each joint's torque, where the rigid arm
    /// needs `carried`, N.m.
    pub fn of_scales(&self, carried: &Blocks) -> Vec<Blocks> {
        let mut all = of_scales(carried);
        all.iter_mut().flat_map(|b| &mut b.0).flatten().for_each(|t| *t *= self.scale);
        all
    }

    /// What `x`, the values of all their columns, give at the rows of a recording, N.m.
    pub fn torque(&self, observed: &Observed<'_>, carried: &Blocks, x: &[f64]) -> Blocks {
        let mut sum = Blocks(vec![Vec::new(); observed.joints()]);
        if !x.is_empty() {
            let columns = self.of_links(observed).into_iter().chain(self.of_scales(carried));
            columns.zip(x).for_each(|(c, x)| sum.gather(*x, &c));
        }
        sum
    }
}

/// Combinations that the products of all columns, in units of noise, tell.
fn combinations(products: DMatrix<f64>) -> DMatrix<f64> {
    let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(products);
    let told = (0..eigenvalues.len()).filter(|i| eigenvalues[*i] > UNTOLD);
    let columns: Vec<_> = told.map(|i| eigenvectors.column(i).into_owned()).collect();
    match columns.is_empty() {
        true => DMatrix::zeros(eigenvectors.nrows(), 0),
        false => DMatrix::from_columns(&columns),
    }
}

/// Torque at the rows per unit of every link's mass and first moments, link by link.
pub fn of_links(observed: &Observed<'_>) -> Arc<Vec<Blocks>> {
    observed.kept.get("values of all links", || {
        let robot = &observed.twin.robot;
        let rigid = observed.rigid(robot);
        let motion = Motion { rigid: Some(&rigid), ..observed.motion(robot) };
        let of = |link: usize| {
            let all = motion.regressor(link);
            let rows = |i: usize| {
                let joint = |j: usize| match j <= link {
                    true => observed.block(j, all[i].joint(j)),
                    false => Vec::new(),
                };
                Blocks((0..observed.joints()).map(joint).collect())
            };
            (0..PER_LINK).map(rows).collect::<Vec<Blocks>>()
        };
        (0..robot.bodies.len()).flat_map(of).collect()
    })
}

/// Torque of each joint at its rows, of all that the rigid arm needs, N.m.
pub fn of_scales(carried: &Blocks) -> Vec<Blocks> {
    let joints = carried.0.len();
    let alone = |j: usize| {
        let mut rows = vec![Vec::new(); joints];
        rows[j].clone_from(&carried.0[j]);
        Blocks(rows)
    };
    (0..joints).map(alone).collect()
}

/// How far mass (kg) and first moments (kg.m) of a link may be off, standard deviations.
pub fn mass_errors(body: &Body, settings: &Settings) -> [f64; PER_LINK] {
    let mass = settings.mass_error * body.inertia.mass;
    let moment = settings.centre_error_m * body.inertia.mass + mass * body.inertia.com.norm();
    [mass, moment, moment, moment].map(|sd| sd.max(f64::MIN_POSITIVE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::data::Data;
    use crate::diagnosis::fit::Fit;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::model::Model;
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    const KNOWN_TO: f64 = 0.05;

    /// The most likely size of the tolerances where links are off by this share, up and down in turn.
    fn likely(off: f64) -> f64 {
        let twin = Twin::default();
        let mut arm = twin.clone();
        for (i, body) in arm.robot.bodies.iter_mut().enumerate() {
            body.inertia.mass *= if i % 2 == 0 { 1.0 + off } else { 1.0 - off };
        }
        let mut made = samples(6, 4000, |j, t| {
            0.7 * ((0.9 + 0.2 * j as f64) * t).sin() + 0.4 * (0.6 * t + j as f64).cos()
        });
        made.torque = arm.torque(&arm.motion(&made));
        noisy(&mut made, 0.3);
        let floor = noise_floor(&made, &twin);
        let observed = Observed::new(0, &twin, &made, &floor).unwrap();
        let settings = Settings { mass_error: KNOWN_TO, ..Settings::default() };
        let data = Data::new(vec![&observed], &settings);
        size(Fit::plain(&data, Model::of(&twin)).likely_sizes(&[0, 1, 2, 3, 4, 5]).tolerances)
    }

    #[test]
    fn the_data_say_how_far_links_are_off() {
        assert_eq!(likely(0.0), 0.0);
        let [little, much] = [likely(0.2 * KNOWN_TO), likely(2.0 * KNOWN_TO)];
        assert!(little > 0.0 && little < much && much <= 1.0, "{little} {much}");
    }

    /// Combinations keep what rows show of links, and drop what they do not.
    #[test]
    fn what_no_row_shows_is_left_out() {
        let twin = Twin::default();
        let made = samples(6, 2000, |j, t| 0.7 * ((0.9 + 0.2 * j as f64) * t).sin());
        let floor = noise_floor(&made, &twin);
        let observed = Observed::new(0, &twin, &made, &floor).unwrap();
        let settings = Settings::default();
        let tolerances = Tolerances::new(&[&observed], &[0.01; 6], &settings);
        let (told, all) = (tolerances.told.ncols(), PER_LINK * 6);
        assert!(told > 0 && told < all, "{told} of {all}");
        let square = |columns: &[Blocks]| -> f64 { columns.iter().flat_map(|c| c.squares()).sum() };
        let links = of_links(&observed);
        let scaled: Vec<Blocks> = links
            .iter()
            .zip(&tolerances.links)
            .map(|(c, sd)| Blocks(c.0.iter().map(|r| r.iter().map(|v| sd * v).collect()).collect()))
            .collect();
        let kept = square(&tolerances.of_links(&observed)) / square(&scaled);
        assert!((kept - 1.0).abs() < 1e-3, "{kept}");
    }
}
