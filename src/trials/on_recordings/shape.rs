//! What an effect looks like on a pair of recordings before its strength is set.

use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;

use super::Ground;
use super::foreign;
use crate::effects::{self, Role, Seen, Size};
use crate::simulation::Injection;
use crate::trials::shapes;

/// Share of the catalogue's range that a size may use: a value at the very end could not be told from one
/// beyond it.
const INTERIOR: f64 = 0.95;

/// An effect at unit size.
pub struct Shape {
    pub injection: Injection,
    /// Parameters that grow together.
    scaled: Vec<usize>,
    /// Factor at which the first of them leaves its range.
    pub limit: f64,
}

/// `name` at a random joint that moves in both recordings, with random proportions. Times count from
/// the start of a recording.
pub fn draw(name: &str, [fit, check]: [&Ground; 2], rng: &mut ChaCha8Rng) -> Option<Shape> {
    let (one, other) = (fit.moving(), check.moving());
    let moving: Vec<usize> = one.into_iter().filter(|j| other.contains(j)).collect();
    let still: Vec<usize> = (0..fit.dof()).filter(|j| !moving.contains(j)).collect();
    let ground = shapes::Ground {
        q: &fit.samples.q,
        torque: &fit.samples.torque,
        // Sizes are set later; proportions are to 1 N.m.
        coulomb: &vec![1.0; fit.dof()],
        duration_s: fit.duration_s().min(check.duration_s()),
        scale: 1.0,
    };
    let joint = *moving.choose(rng)?;
    let injection = match foreign::proportions(name, joint, &ground, rng) {
        Some(values) => {
            Injection { effect: foreign::find(name)?, joints: vec![joint], values: vec![values] }
        }
        None => shapes::shape(name, &ground, &still, rng)?.injection,
    };
    Some(Shape::new(with_memory(injection, rng), &fit.size))
}

/// Friction with memory comes on top of the arm's own, its width inside the catalogue's range.
fn with_memory(mut injection: Injection, rng: &mut ChaCha8Rng) -> Injection {
    let mut ratio = |low: f64, high: f64| rng.random_range(low.ln()..high.ln()).exp();
    let values = match injection.effect.about().name {
        "presliding" => vec![1.0, ratio(5e-4, 0.02)],
        "lugre" => {
            vec![1.0, ratio(0.1, 0.6), ratio(5e-4, 0.02), ratio(0.1, 0.6), ratio(0.02, 0.1)]
        }
        "maxwell_slip" => {
            vec![ratio(0.5, 1.5), ratio(0.5, 1.5), ratio(0.5, 1.5), ratio(1e-3, 0.03)]
        }
        _ => return injection,
    };
    injection.values = vec![values; injection.joints.len()];
    injection
}

impl Shape {
    fn new(injection: Injection, size: &Size) -> Self {
        let about = injection.effect.about();
        let linear = about.parameters.iter().filter(|p| p.role == Role::Linear).count();
        let by_columns = effects::find(about.name).is_some_and(|e| e.seen() == Seen::Columns);
        let scaled: Vec<usize> = if by_columns { (0..linear).collect() } else { vec![0] };
        let most = |row: &Vec<f64>| {
            let factor = |i: &usize| {
                let (p, value) = (about.parameters[*i].on(size), row[*i]);
                let end = if value < 0.0 { p.min } else { p.max };
                if value == 0.0 { f64::INFINITY } else { INTERIOR * end / value }
            };
            scaled.iter().map(factor).fold(f64::INFINITY, f64::min)
        };
        let limit = injection.values.iter().map(most).fold(f64::INFINITY, f64::min);
        Self { injection, scaled, limit }
    }

    /// `x` times as large, as far as the range allows; references follow.
    pub fn sized(&self, x: f64) -> Injection {
        let x = x.min(self.limit);
        let mut injection = self.injection.clone();
        let about = injection.effect.about();
        let linear = about.parameters.iter().filter(|p| p.role == Role::Linear).count();
        for row in &mut injection.values {
            self.scaled.iter().for_each(|i| row[*i] *= x);
            let (linear, nonlinear) = row.split_at_mut(linear);
            injection.effect.settle(linear, nonlinear);
        }
        injection
    }
}

/// Times that count from the start of a recording, as the clock of that recording has them.
pub fn placed(injection: &Injection, ground: &Ground) -> Injection {
    let mut placed = injection.clone();
    let is_time = |name: &str| name == "contact_start" || name == "seizing_start";
    let parameters = injection.effect.about().parameters;
    if let Some(i) = parameters.iter().position(|p| is_time(p.name)) {
        placed.values.iter_mut().for_each(|row| row[i] += ground.samples.start);
    }
    placed
}
