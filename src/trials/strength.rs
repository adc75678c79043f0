//! How much of an effect can be seen: its torque over the noise, while sliding.

use super::truth::Strength;
use crate::effects::{ArmState, Channels, JointLoad, Motion, Role, Scope, Seen};
use crate::regression::qr::{Qr, unexplained};
use crate::series::JointSeries;
use crate::simulation::Injection;

/// Joints slower than this do not slide, rad/s.
pub const SLIDING_RAD_S: f64 = 0.03;

/// N.m the drive must supply for an effect along a motion, every joint. `torque` is the drive's
/// without the effect. An effect on recorded channels gives what it changes in the torque.
pub fn own_torque(injection: &Injection, motion: &Motion<'_>, torque: &JointSeries) -> JointSeries {
    let effect = injection.effect;
    let foreign = crate::effects::find(effect.about().name).is_none();
    match effect.seen() {
        _ if foreign => stepped(injection, motion),
        Seen::Columns => by_columns(injection, &Motion { known: Some(torque), ..*motion }),
        Seen::Channels => by_channels(injection, motion, torque),
        Seen::Simulation => JointSeries::zeros(torque.joints(), torque.samples()),
    }
}

fn by_columns(injection: &Injection, motion: &Motion<'_>) -> JointSeries {
    let about = injection.effect.about();
    let linear = about.parameters.iter().filter(|p| p.role == Role::Linear).count();
    let mut own = JointSeries::zeros(motion.q.joints(), motion.samples());
    for (i, &joint) in injection.joints.iter().enumerate() {
        let row = if about.scope == Scope::Arm { 0 } else { i };
        let (values, nonlinear) = injection.values[row].split_at(linear);
        if about.scope == Scope::Link {
            for (series, value) in
                injection.effect.reach(motion, joint, nonlinear).iter().zip(values)
            {
                (0..own.joints()).for_each(|j| add(own.joint_mut(j), *value, series.joint(j)));
            }
        } else {
            for (column, value) in
                injection.effect.columns(motion, joint, nonlinear).iter().zip(values)
            {
                add(own.joint_mut(joint), *value, column);
            }
        }
    }
    own
}

fn by_channels(injection: &Injection, motion: &Motion<'_>, torque: &JointSeries) -> JointSeries {
    let mut own = JointSeries::zeros(torque.joints(), torque.samples());
    for (row, &joint) in injection.values.iter().zip(&injection.joints) {
        let mut channels = Channels {
            dt: motion.dt,
            q: motion.q.joint(joint).to_vec(),
            qd: motion.qd.joint(joint).to_vec(),
            qdd: motion.qdd.joint(joint).to_vec(),
            torque: torque.joint(joint).to_vec(),
            velocity_is_recorded: true,
        };
        injection.effect.measure(row, &mut channels);
        add(own.joint_mut(joint), 1.0, &channels.torque);
        add(own.joint_mut(joint), -1.0, torque.joint(joint));
    }
    own
}

/// Sample by sample, as in a simulation.
fn stepped(injection: &Injection, motion: &Motion<'_>) -> JointSeries {
    let (dof, samples) = (motion.q.joints(), motion.samples());
    let load = motion.drive_torque();
    let mut own = JointSeries::zeros(dof, samples);
    let mut memory = vec![vec![0.0; injection.effect.about().memory]; injection.joints.len()];
    let mut now = [(); 3].map(|()| vec![0.0; dof]);
    for k in 0..samples {
        let [q, qd, transmitted] = &mut now;
        motion.q.sample_into(k, q);
        motion.qd.sample_into(k, qd);
        load.sample_into(k, transmitted);
        let arm = ArmState {
            robot: motion.robot,
            time: motion.time(k),
            dt: motion.dt,
            q,
            qd,
            transmitted,
            temperature: &vec![25.0; dof],
        };
        for (i, &joint) in injection.joints.iter().enumerate() {
            let mut load = JointLoad::default();
            let row = i.min(injection.values.len() - 1);
            let state = arm.joint(joint);
            injection.effect.act(&injection.values[row], &state, &mut memory[i], &mut load);
            let dry = load.dry * qd[joint].signum();
            own.joint_mut(joint)[k] += dry + load.damping * qd[joint] + load.torque;
        }
    }
    own
}

/// Own torque and visible gap per joint over `noise` (N.m), where `qd` slides.
pub fn over_noise(own: &JointSeries, qd: &JointSeries, noise: &[f64]) -> Strength {
    let per_joint = |f: fn(&[f64], &[f64]) -> f64| {
        (0..own.joints())
            .map(|j| {
                let sliding = |(_, qd): &(&f64, &f64)| qd.abs() > SLIDING_RAD_S;
                let both = own.joint(j).iter().zip(qd.joint(j)).filter(sliding);
                let (own, qd): (Vec<f64>, Vec<f64>) = both.unzip();
                f(&own, &qd) / noise[j].max(1e-12)
            })
            .collect()
    };
    Strength { drawn: None, own: per_joint(|own, _| rms(own)), gap: per_joint(beyond_friction) }
}

/// Root mean square of what Coulomb and viscous friction cannot take up.
pub fn beyond_friction(x: &[f64], qd: &[f64]) -> f64 {
    rms(&without_friction(x, qd))
}

/// `x` less its least-squares fit by sign(qd) and qd.
pub fn without_friction(x: &[f64], qd: &[f64]) -> Vec<f64> {
    let dry = qd.iter().map(|v| v.signum()).collect();
    unexplained(&Qr::new(vec![dry, qd.to_vec()]).q, x.to_vec())
}

pub fn rms(x: &[f64]) -> f64 {
    (x.iter().map(|x| x * x).sum::<f64>() / x.len().max(1) as f64).sqrt()
}

pub fn add(out: &mut [f64], factor: f64, x: &[f64]) {
    out.iter_mut().zip(x).for_each(|(o, x)| *o += factor * x);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_leaves_no_gap_and_a_cosine_does() {
        let qd: Vec<f64> = (0..400).map(|k| (f64::from(k) * 0.05).sin()).collect();
        let friction: Vec<f64> = qd.iter().map(|v| 3.0 * v.signum() + 2.0 * v).collect();
        assert!(beyond_friction(&friction, &qd) < 1e-9);
        let other: Vec<f64> = (0..400).map(|k| (f64::from(k) * 0.05).cos()).collect();
        let both: Vec<f64> = friction.iter().zip(&other).map(|(a, b)| a + b).collect();
        let left = beyond_friction(&both, &qd);
        assert!((left / rms(&other) - 1.0).abs() < 0.02, "{left}");
    }

    #[test]
    fn strength_is_the_largest_gap_over_its_noise() {
        let own = JointSeries::from_joints(&[vec![1.0, -1.0, 1.0, -1.0], vec![0.5; 4]]);
        let qd = JointSeries::from_joints(&[vec![1.0, 0.5, 2.0, 0.7], vec![0.0; 4]]);
        let strength = over_noise(&own, &qd, &[0.5, 0.1]);
        assert_eq!(strength.own, [2.0, 0.0]);
        assert!(strength.gap[0] < 2.0 && strength.gap[0] > 1.0);
        assert_eq!(strength.reached(), strength.gap[0]);
    }
}
