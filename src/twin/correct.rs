//! Conditioned samples with the twin's knowledge of the sensors taken into account.

use super::Twin;
use crate::effects::{CATALOGUE, Channels, Effect, Motion, Seen};
use crate::signals::{Derivatives, Samples};

impl Twin {
    /// The motion of `samples` as this twin's effects are explained with.
    pub fn motion<'a>(&'a self, samples: &'a Samples) -> Motion<'a> {
        let Samples { dt, q, qd, qdd, .. } = samples;
        Motion {
            start: samples.start,
            told: samples.told.as_ref(),
            gear_ratio: &self.drive.gear_ratio,
            temperature: samples.temperature.as_ref(),
            band_hz: match samples.conditioning.torque_cutoff_hz {
                cutoff if cutoff > 0.0 => cutoff,
                _ => f64::INFINITY,
            },
            ..Motion::new(&self.robot, *dt, q, qd, qdd)
        }
    }

    /// Undoes what the known effects on recorded channels (delays, lags) did to `samples`.
    pub fn correct(&self, samples: &Samples) -> Samples {
        let mut corrected = samples.clone();
        let of_channels = |e: &&&dyn Effect| e.seen() == Seen::Channels && self.knows_of(**e);
        // Measured in the order of the catalogue, so undone from the last to the first.
        for effect in CATALOGUE.iter().rev().filter(of_channels) {
            for joint in 0..self.robot.dof().min(samples.joints()) {
                if let Some(values) = self.values_at(*effect, joint) {
                    correct_joint(*effect, &values, joint, &mut corrected);
                }
            }
        }
        corrected
    }
}

fn correct_joint(effect: &dyn Effect, values: &[f64], joint: usize, samples: &mut Samples) {
    use Derivatives::{Paper, Recorded};
    let mut channels = Channels {
        dt: samples.dt,
        q: samples.q.joint(joint).to_vec(),
        qd: samples.qd.joint(joint).to_vec(),
        qdd: samples.qdd.joint(joint).to_vec(),
        torque: samples.torque.joint(joint).to_vec(),
        velocity_is_recorded: matches!(samples.conditioning.derivatives, Recorded | Paper),
    };
    effect.correct(values, &mut channels);
    let Channels { q, qd, qdd, torque, .. } = channels;
    samples.q.joint_mut(joint).copy_from_slice(&q);
    samples.qd.joint_mut(joint).copy_from_slice(&qd);
    samples.qdd.joint_mut(joint).copy_from_slice(&qdd);
    samples.torque.joint_mut(joint).copy_from_slice(&torque);
}
