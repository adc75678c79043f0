//! What the torque of a joint may depend on, whatever the law: many plain functions of the motion.

use super::evidence::Evidence;

/// Of friction that falls with speed, rad/s.
const FADING_RAD_S: [f64; 2] = [0.05, 0.2];
/// Orders over a joint's own angle.
const ORDERS: usize = 4;

/// Columns over a joint's rows, filtered as the torque is, in an order that depends on the arm
/// alone: its own speed and load, waves over all angles and their products, what the others do.
pub fn features(evidence: &Evidence<'_>, joint: usize) -> Vec<Vec<f64>> {
    let series = own(evidence, joint).into_iter().chain(of_angles(evidence, joint));
    let series = series.chain(of_others(evidence, joint));
    series.map(|series| evidence.block(joint, &series)).collect()
}

fn own(evidence: &Evidence<'_>, joint: usize) -> Vec<Vec<f64>> {
    let samples = evidence.samples;
    let (qd, qdd) = (samples.qd.joint(joint), samples.qdd.joint(joint));
    let load = evidence.known.joint(joint);
    let map = |f: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
        qd.iter().zip(load).map(|(qd, load)| f(*qd, *load)).collect()
    };
    let mut all = vec![
        vec![1.0; qd.len()],
        qdd.to_vec(),
        map(&|qd, _| qd),
        map(&|qd, _| qd * qd.abs()),
        map(&|qd, _| qd.signum()),
        map(&|_, load| load),
        map(&|_, load| load.abs()),
        map(&|qd, load| qd.signum() * load),
        map(&|qd, load| qd.signum() * load.abs()),
        map(&|qd, load| qd * load.abs()),
    ];
    all.extend(FADING_RAD_S.map(|v| map(&|qd, _| qd.signum() * (-qd.abs() / v).exp())));
    all
}

fn of_angles(evidence: &Evidence<'_>, joint: usize) -> Vec<Vec<f64>> {
    let samples = evidence.samples;
    let qd = samples.qd.joint(joint);
    let wave = |j: usize, order: usize| -> [Vec<f64>; 2] {
        let turns = samples.q.joint(j).iter().map(|q| (order as f64 * q).sin_cos());
        let (sin, cos) = turns.unzip();
        [sin, cos]
    };
    let times = |a: &[f64], f: &dyn Fn(usize) -> f64| -> Vec<f64> {
        a.iter().enumerate().map(|(k, a)| a * f(k)).collect()
    };
    let waves: Vec<Vec<f64>> = (0..samples.joints()).flat_map(|j| wave(j, 1)).collect();
    let mut all: Vec<Vec<f64>> = (2..=ORDERS).flat_map(|order| wave(joint, order)).collect();
    for (i, a) in waves.iter().enumerate() {
        // Friction that changes along the travel, its own or a neighbour's.
        all.extend([times(a, &|k| qd[k].signum()), times(a, &|k| qd[k])]);
        let later = waves.iter().enumerate().filter(|(k, _)| k / 2 > i / 2);
        all.extend(later.map(|(_, b)| times(a, &|k| b[k])));
    }
    all.extend(waves);
    all
}

fn of_others(evidence: &Evidence<'_>, joint: usize) -> Vec<Vec<f64>> {
    let samples = evidence.samples;
    let others = (0..samples.joints()).filter(|j| *j != joint);
    let of = |j: usize| {
        let qd = samples.qd.joint(j);
        let sign = qd.iter().map(|qd| qd.signum()).collect();
        [qd.to_vec(), sign, samples.qdd.joint(j).to_vec()]
    };
    others.flat_map(of).collect()
}
