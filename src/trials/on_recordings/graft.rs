//! What an effect does to a recording: torque it asks for, channels it changes.

use super::Ground;
use crate::effects::{Channels, Motion};
use crate::recording::Recording;
use crate::robot::Drive;
use crate::series::JointSeries;
use crate::simulation::Injection;
use crate::trials::strength::own_torque;

/// N.m that the effect adds to what is recorded, at every joint, on the samples' grid. For an encoder
/// that is off, the torque its owner cannot explain.
pub fn torque(injection: &Injection, ground: &Ground) -> JointSeries {
    let motion = ground.motion();
    match name(injection) {
        "velocity_lag" => JointSeries::zeros(ground.dof(), motion.samples()),
        "encoder_offset" => {
            let shown = shifted(injection, motion.q);
            own_torque(injection, &Motion { q: &shown, ..motion }, &ground.samples.torque)
        }
        _ => own_torque(injection, &motion, &ground.samples.torque),
    }
}

/// rad/s that a lagging velocity is off, on the samples' grid; zero where none is recorded.
pub fn velocity_error(injection: &Injection, ground: &Ground) -> JointSeries {
    let samples = &ground.samples;
    let mut error = JointSeries::zeros(ground.dof(), samples.len());
    let Some(sensed) = &samples.sensed else { return error };
    for (row, &joint) in injection.values.iter().zip(&injection.joints) {
        let recorded = sensed.qd.joint(joint);
        let mut channels = Channels {
            dt: samples.dt,
            q: sensed.q.joint(joint).to_vec(),
            qd: recorded.to_vec(),
            qdd: samples.qdd.joint(joint).to_vec(),
            torque: vec![0.0; samples.len()],
            velocity_is_recorded: true,
        };
        injection.effect.measure(row, &mut channels);
        let off = channels.qd.iter().zip(recorded).map(|(late, qd)| late - qd);
        error.joint_mut(joint).copy_from_slice(&off.collect::<Vec<_>>());
    }
    error
}

/// The recording with the effect on it; what it does not touch stays as it was.
pub fn onto(ground: &Ground, injection: &Injection, drive: &Drive) -> Recording {
    let mut recording = ground.recording.clone();
    match name(injection) {
        "encoder_offset" => {
            for (row, joint) in injection.values.iter().zip(&injection.joints) {
                for stem in ["actual_q", "target_q"] {
                    change(&mut recording, stem, *joint, |_, q| q + row[0]);
                }
            }
        }
        "torque_constant" => {
            for (row, joint) in injection.values.iter().zip(&injection.joints) {
                change(&mut recording, torque_stem(ground), *joint, |_, x| x * (1.0 + row[0]));
            }
        }
        "velocity_lag" => {
            add(&mut recording, ground, "actual_qd", &velocity_error(injection, ground), |_| 1.0);
        }
        _ => {
            let stem = torque_stem(ground);
            let per_unit = |j: usize| match stem {
                "joint_torque" => 1.0,
                _ => drive.torque_per_ampere(j),
            };
            add(&mut recording, ground, stem, &torque(injection, ground), per_unit);
        }
    }
    recording
}

fn name(injection: &Injection) -> &'static str {
    injection.effect.about().name
}

/// The channel that a diagnosis takes torque from.
fn torque_stem(ground: &Ground) -> &'static str {
    match ground.recording.channel("joint_torque_0") {
        Some(_) => "joint_torque",
        None => "actual_current",
    }
}

/// Where the encoders say the joints are.
fn shifted(injection: &Injection, q: &JointSeries) -> JointSeries {
    let mut shown = q.clone();
    for (row, &joint) in injection.values.iter().zip(&injection.joints) {
        shown.joint_mut(joint).iter_mut().for_each(|q| *q += row[0]);
    }
    shown
}

/// Adds a series on the samples' grid, over `per_unit`, to the channels of a signal.
fn add(
    recording: &mut Recording,
    ground: &Ground,
    stem: &str,
    series: &JointSeries,
    per_unit: impl Fn(usize) -> f64,
) {
    let (start, dt) = (ground.samples.start, ground.samples.dt);
    for joint in 0..series.joints() {
        let values = series.joint(joint);
        if values.iter().any(|v| *v != 0.0) {
            let at = |t: f64| between(values, (t - start) / dt);
            change(recording, stem, joint, |t, x| x + at(t) / per_unit(joint));
        }
    }
}

/// Puts every value of a channel, with its time, through `f`.
fn change(recording: &mut Recording, stem: &str, joint: usize, f: impl Fn(f64, f64) -> f64) {
    let name = format!("{stem}_{joint}");
    let Recording { time, channels, .. } = recording;
    if let Some(channel) = channels.iter_mut().find(|c| c.name == name) {
        channel.values.iter_mut().zip(time).for_each(|(x, t)| *x = f(*t, *x));
    }
}

/// Cubic between samples (Catmull-Rom), the ends held; a sample's own value at its place.
fn between(x: &[f64], place: f64) -> f64 {
    let at = |k: isize| x[k.clamp(0, x.len() as isize - 1) as usize];
    let (k, u) = (place.floor() as isize, place - place.floor());
    let [a, b, c, d] = [at(k - 1), at(k), at(k + 1), at(k + 2)];
    let slope = 0.5 * (c - a);
    let curve = a - 2.5 * b + 2.0 * c - 0.5 * d;
    let twist = 0.5 * (d - a) + 1.5 * (b - c);
    b + u * (slope + u * (curve + u * twist))
}
