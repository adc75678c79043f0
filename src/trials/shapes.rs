//! What an effect looks like in a case, before its strength is set: where, and in what proportions.

use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;

use super::foreign;
use crate::effects::{self, Effect, Scope};
use crate::series::JointSeries;
use crate::simulation::Injection;

/// What the shape of an effect may depend on.
pub struct Ground<'a> {
    /// Angles it is planned to pass, rad.
    pub q: &'a JointSeries,
    /// Torque of the arm without the effect along it, N.m.
    pub torque: &'a JointSeries,
    /// Coulomb friction of every joint, N.m.
    pub coulomb: &'a [f64],
    pub duration_s: f64,
    /// Forces and masses of the arm beside those of a UR5.
    pub scale: f64,
}

/// An effect at unit size.
#[derive(Clone)]
pub struct Shape {
    pub injection: Injection,
    pub size: Size,
    /// Stands in place of the joint's Coulomb friction.
    pub replaces_coulomb: bool,
}

/// What makes it stronger.
#[derive(Debug, Clone, PartialEq)]
pub enum Size {
    /// These parameters grow together, up to the limit for the first.
    Factor { parameters: Vec<usize>, limit: f64 },
    /// This parameter moves between the limits.
    Knob { parameter: usize, low: f64, high: f64 },
    /// There is nothing to set.
    Fixed,
}

impl Shape {
    /// The injection with its strength set to `x` (a factor or the knob's value) as far as the limits allow.
    pub fn sized(&self, x: f64) -> Injection {
        let mut injection = self.injection.clone();
        for row in &mut injection.values {
            match &self.size {
                Size::Factor { parameters, limit } => {
                    let first = row[parameters[0]].abs().max(1e-300);
                    let x = x.min(limit / first);
                    parameters.iter().for_each(|p| row[*p] *= x);
                }
                Size::Knob { parameter, low, high } => row[*parameter] = x.clamp(*low, *high),
                Size::Fixed => {}
            }
        }
        injection
    }
}

/// `name` at a random place with random proportions; `None` if there is no such effect.
/// `taken` are joints that another effect has.
pub fn shape(
    name: &str,
    ground: &Ground<'_>,
    taken: &[usize],
    rng: &mut ChaCha8Rng,
) -> Option<Shape> {
    let effect = effects::find(name).or_else(|| foreign::find(name))?;
    let dof = ground.coulomb.len();
    let joint = *places(name, dof, taken).choose(rng).or([&0].into_iter().next())?;
    let (mut values, size) = proportions(name, effect, joint, ground, rng);
    let rest = effect.about().parameters.iter().skip(values.len());
    values.extend(rest.map(|p| p.typical));
    let everywhere = match name {
        "velocity_lag" => true,
        "time_delay" => rng.random_bool(0.5),
        _ => effect.about().scope == Scope::Arm,
    };
    let joints = if everywhere { (0..dof).collect() } else { vec![joint] };
    let rows = if effect.about().scope == Scope::Arm { 1 } else { joints.len() };
    Some(Shape {
        injection: Injection { effect, joints, values: vec![values; rows] },
        size,
        replaces_coulomb: HYSTERETIC.contains(&name),
    })
}

/// Friction with memory, in place of Coulomb's.
const HYSTERETIC: [&str; 3] = ["presliding", "lugre", "maxwell_slip"];

/// Joints where the effect does something, from 0: nothing at the base depends on its angle, and
/// the last link is nearly round.
fn places(name: &str, dof: usize, taken: &[usize]) -> Vec<usize> {
    let inner = match name {
        "encoder_offset" => 1..dof.saturating_sub(1),
        "link_inertia" => 1..dof,
        // What hangs on the first and the last joint hardly loads them.
        "wandering_gain" => 1..dof.saturating_sub(1),
        _ => 0..dof,
    };
    inner.filter(|j| !taken.contains(j)).collect()
}

fn sign(rng: &mut ChaCha8Rng) -> f64 {
    if rng.random_bool(0.5) { 1.0 } else { -1.0 }
}

/// A random number between `low` and `high`, uniform in the logarithm.
fn ratio(rng: &mut ChaCha8Rng, low: f64, high: f64) -> f64 {
    (rng.random_range(low.ln()..high.ln())).exp()
}

/// Largest excess of static friction, as a multiple of Coulomb friction. With more a joint sticks and slips
/// all the time, and slow motion is none any more.
const MOST_EXCESS: f64 = 2.0;

fn factor(parameters: &[usize], limit: f64) -> Size {
    Size::Factor { parameters: parameters.to_vec(), limit }
}

/// Parameter values at unit size, and what makes them grow.
fn proportions(
    name: &str,
    effect: &dyn Effect,
    joint: usize,
    ground: &Ground<'_>,
    rng: &mut ChaCha8Rng,
) -> (Vec<f64>, Size) {
    let fc = ground.coulomb[joint];
    let (big, scale) = (joint < 3, ground.scale);
    let width = Size::Knob { parameter: 1, low: 1e-4, high: 0.05 };
    match name {
        "stribeck" => {
            let exponent = if rng.random_bool(0.5) { 1.0 } else { 2.0 };
            (vec![1.0, ratio(rng, 0.02, 0.12), exponent], factor(&[0], MOST_EXCESS * fc))
        }
        "coulomb_asymmetry" => {
            let viscous = if rng.random_bool(0.5) { 0.0 } else { rng.random_range(-0.5..0.5) };
            (vec![sign(rng), viscous], factor(&[0, 1], 18.0 * scale))
        }
        "load_friction" => (vec![0.05], factor(&[0], 0.35)),
        "temperature_friction" => {
            let both = vec![-rng.random_range(0.02..0.06), -rng.random_range(0.02..0.15)];
            (both, factor(&[0, 1], 0.6))
        }
        "presliding" => (vec![fc, 0.002], width),
        "lugre" => {
            let (damping, excess) = (rng.random_range(0.5..4.0), rng.random_range(0.1..0.6));
            let width = Size::Knob { parameter: 2, low: 1e-4, high: 0.05 };
            (vec![fc, damping, 0.002, excess, ratio(rng, 0.02, 0.1)], width)
        }
        "maxwell_slip" => {
            let parts: Vec<f64> = (0..3).map(|_| rng.random_range(0.5..1.5)).collect();
            let sum: f64 = parts.iter().sum();
            let width = Size::Knob { parameter: 3, low: 1e-4, high: 0.05 };
            (vec![fc * parts[0] / sum, fc * parts[1] / sum, fc * parts[2] / sum, 0.003], width)
        }
        "backlash" => {
            let stiffness = if big { ratio(rng, 1e4, 4e4) } else { ratio(rng, 3e3, 1e4) };
            let damping = if big { 20.0 } else { 5.0 };
            (vec![0.001, scale * stiffness, scale * damping, 0.001], factor(&[0, 3], 0.02))
        }
        "joint_flexibility" => {
            let damping =
                if big { rng.random_range(5.0..30.0) } else { rng.random_range(1.0..6.0) };
            let limit = if big { 2e-3 } else { 4e-3 } / scale;
            (vec![1e-4, 0.0, scale * damping, 0.0, 0.001, 1e-4], factor(&[0, 5], limit))
        }
        "torque_ripple" => {
            let phase: f64 = rng.random_range(0.0..std::f64::consts::TAU);
            let order = *[24.0, 36.0, 60.0, 101.0, 202.0].choose(rng).unwrap_or(&202.0);
            (vec![phase.cos(), phase.sin(), order], factor(&[0, 1], 4.5 * scale))
        }
        "cable_spring" => {
            let (hysteresis, rest) = (rng.random_range(0.0..0.5), rng.random_range(-1.5..1.5));
            let width = rng.random_range(0.1..0.5);
            (vec![1.0, hysteresis, rest, width], factor(&[0, 1], 18.0 * scale))
        }
        "joint_coupling" => {
            let both = vec![sign(rng), sign(rng) * rng.random_range(0.3..1.0)];
            (both, factor(&[0, 1], 18.0 * scale))
        }
        "payload" => {
            let height = rng.random_range(0.03..0.12);
            let aside = rng.random_range(-0.02..0.02);
            let centre = [aside, -0.5 * aside, height];
            // A box: the inertia of 1 kg about its centre.
            let [a, b, c]: [f64; 3] =
                std::array::from_fn(|_| rng.random_range(0.02_f64..0.2).powi(2));
            let inertia = [b + c, a + c, a + b, 0.0, 0.0, 0.0].map(|sides| sides / 12.0);
            let values = [&[1.0], &centre[..], &inertia[..], &centre[..]].concat();
            (values, factor(&[0, 1, 2, 3, 4, 5, 6], 5.0 * scale))
        }
        "link_inertia" => {
            let mut moment = || 0.06 * rng.random_range(-1.0..1.0);
            let moments = [moment(), moment(), moment()];
            let values = vec![0.3 * sign(rng), moments[0], moments[1], moments[2]];
            (values, factor(&[0, 1, 2, 3], 2.5 * scale))
        }
        "external_contact" => contact(ground, rng),
        "base_tilt" => {
            let angle: f64 = rng.random_range(0.0..std::f64::consts::TAU);
            (vec![angle.cos() * 0.01, angle.sin() * 0.01], factor(&[0, 1], 0.15))
        }
        "encoder_offset" => (vec![0.01 * sign(rng)], factor(&[0], 0.15)),
        "torque_constant" => (vec![0.02 * sign(rng)], factor(&[0], 0.35)),
        "time_delay" => (vec![0.01], factor(&[0], 0.06)),
        "velocity_lag" => (vec![0.01], factor(&[0], 0.1)),
        "torque_saturation" => {
            let peak = ground.torque.joint(joint).iter().fold(0.0, |m: f64, t| m.max(t.abs()));
            (vec![rng.random_range(0.75..0.9) * peak], Size::Fixed)
        }
        "controller_mismatch" => {
            let mut of = |low, high| rng.random_range(low..high);
            (vec![of(0.5, 1.4), of(0.6, 1.4), of(0.2, 1.6), of(0.0, 0.006)], Size::Fixed)
        }
        "quantisation" => (
            vec![ratio(rng, 5e-5, 3e-4), ratio(rng, 1e-3, 1e-2), ratio(rng, 0.02, 0.1)],
            Size::Fixed,
        ),
        "swinging_load" => {
            (vec![0.5, ratio(rng, 0.8, 2.5), ratio(rng, 0.01, 0.08)], factor(&[0], 2.0 * scale))
        }
        "hum" => {
            let values = vec![1.0, ratio(rng, 0.5, 6.0), rng.random_range(0.0..6.2)];
            (values, factor(&[0], 15.0 * scale))
        }
        "seizing" => {
            let start = rng.random_range(0.3..0.6) * ground.duration_s;
            let length = rng.random_range(0.25..0.4) * ground.duration_s;
            (vec![1.0, start, length], factor(&[0], 20.0 * scale))
        }
        "rubbing" => {
            let angle = *ground.q.joint(joint).choose(rng).unwrap_or(&0.0);
            (vec![1.0, angle, rng.random_range(0.2..0.5)], factor(&[0], 20.0 * scale))
        }
        "wandering_gain" => (
            vec![0.02, rng.random_range(7.0..20.0), rng.random_range(0.0..6.2)],
            factor(&[0], 0.35),
        ),
        "twisted_hose" => (vec![1.0], factor(&[0], 40.0 * scale)),
        // One linear parameter of either sign or none: the catalogue's range is the limit.
        _ => {
            let about = effect.about();
            let first = &about.parameters[0];
            let way = if first.min < 0.0 { sign(rng) } else { 1.0 };
            let most = if way < 0.0 { -first.min } else { first.max };
            let values = about.parameters.iter().map(|p| way * p.typical).collect();
            let force = first.unit.starts_with('N') || first.unit.starts_with("kg");
            (values, factor(&[0], 0.9 * most * if force { scale } else { 1.0 }))
        }
    }
}

/// A push for some time, or whenever the flange is low.
fn contact(ground: &Ground<'_>, rng: &mut ChaCha8Rng) -> (Vec<f64>, Size) {
    let mut force = || 10.0 * rng.random_range(-1.0..1.0);
    let [x, y, z]: [f64; 3] = [force(), force(), force()];
    let start = rng.random_range(0.15..0.5) * ground.duration_s;
    let duration = rng.random_range(0.2..0.4) * ground.duration_s;
    // The limit is for the first of the three.
    let x = if x.abs() < 1.0 { x.signum() } else { x };
    let values = vec![x, y, z, start, duration, 10.0];
    (values, factor(&[0, 1, 2], 150.0 * ground.scale))
}
