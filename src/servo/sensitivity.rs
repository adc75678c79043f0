//! How simulated positions change with parameters, by the sensitivity equation of each: one simulation, and for
//! each parameter the torque that it changes, as the servos give way to it ([`Response`]).
//!
//! Joints are taken alone, and a joint that sticks in the simulation sticks beside it: a search steps by these,
//! what it finds is judged by differences between simulations.
//!
//! [`Response`]: crate::signals::Response

use std::ops::Range;

use rayon::prelude::*;

use super::linear::Along;
use super::parameters::{Free, with_values};
use super::{ServoError, Track};
use crate::effects::{Effect, Motion, Rigid, Role, Scope};
use crate::series::JointSeries;
use crate::twin::Twin;

/// d position / d parameter along the stretches of a track, rad per unit of each of `free`, at the values `x`;
/// `steps` are those of differences of torque.
///
/// # Errors
/// If the twin cannot be simulated.
pub fn sensitivities(
    twin: &Twin,
    free: &[Free],
    (x, steps): (&[f64], &[f64]),
    track: &Track,
    stretches: Vec<Range<usize>>,
) -> Result<Vec<JointSeries>, ServoError> {
    let now = with_values(twin, free, x);
    let along = Along::new(&now, track, stretches)?;
    let (laden, rigid) = (now.laden(), Rigid::new(track.joints()));
    let motion = Motion { rigid: Some(&rigid), ..along.motion(&laden, track) };
    let of_arm = free.iter().any(|f| f.effect.about().scope != Scope::Joint);
    let all = of_arm.then(|| now.torque(&along.motion(&now.robot, track)));
    let column = |i: usize| -> JointSeries {
        let mut x = x.to_vec();
        x[i] += steps[i];
        let moved = with_values(twin, free, &x);
        let f = &free[i];
        let more = match &all {
            _ if f.effect.about().scope == Scope::Joint => {
                let here = f.joint.map_or(0..track.joints(), |j| j..j + 1);
                let more = |j: usize| {
                    let [before, after] = [&now, &moved].map(|t| of_joint(t, f.effect, j, &motion));
                    less(&after, &before)
                };
                at_joints(here, more, track)
            }
            Some(before) => {
                let after = moved.torque(&along.motion(&moved.robot, track));
                after.map_joints(|j, after| less(after, before.joint(j)))
            }
            None => JointSeries::zeros(track.joints(), track.len()),
        };
        more.map_joints(|j, torque| {
            let scale = -1.0 / (along.response.joints[j].scale * steps[i]);
            along.response.to(j, torque).into_iter().map(|d| scale * d).collect()
        })
    };
    Ok((0..free.len()).into_par_iter().map(column).collect())
}

/// N.m of an effect at its joint.
fn of_joint(twin: &Twin, effect: &dyn Effect, joint: usize, motion: &Motion<'_>) -> Vec<f64> {
    let mut sum = vec![0.0; motion.samples()];
    let Some(values) = twin.values_at(effect, joint) else { return sum };
    let linear = effect.about().parameters.iter().filter(|p| p.role == Role::Linear).count();
    let (linear, nonlinear) = values.split_at(linear);
    for (column, value) in effect.columns(motion, joint, nonlinear).iter().zip(linear) {
        sum.iter_mut().zip(column).for_each(|(s, c)| *s += value * c);
    }
    sum
}

fn at_joints(
    joints: Range<usize>,
    torque: impl Fn(usize) -> Vec<f64>,
    track: &Track,
) -> JointSeries {
    let mut series = JointSeries::zeros(track.joints(), track.len());
    joints.for_each(|j| series.joint_mut(j).copy_from_slice(&torque(j)));
    series
}

fn less(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
