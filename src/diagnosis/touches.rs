//! Who was touched, and how strongly, in the stretches that stand out: the force from outside over
//! time, from all joints (`external_wrench`), held against what the mended twin leaves.
//!
//! A stretch is one because it is louder than anything in the other recording, a touch because a
//! force of any shape is more probable than none. Both must agree.

use super::episodes::{Episode, Touch};
use crate::external_wrench::{Contact, Criteria, Heard, Left, Noise, Residual, contacts, left};
use crate::signals::{Samples, SignalError};
use crate::twin::Twin;

impl From<Contact> for Touch {
    fn from(c: Contact) -> Self {
        let Contact {
            link, link_probability, start_s, end_s, peak_time_s, peak_n, peak_sd_n, ..
        } = c;
        Self { link, link_probability, start_s, end_s, peak_time_s, peak_n, peak_sd_n }
    }
}

/// The fit recording and the check recording, as the `mended` twin sees them; the strongest touch of
/// every stretch is put into it.
///
/// # Errors
/// If the torque cannot be filtered.
pub fn touched(
    mended: &Twin,
    samples: &[Samples; 2],
    episodes: &mut [Episode],
) -> Result<(), SignalError> {
    if episodes.is_empty() {
        return Ok(());
    }
    let seen = samples.each_ref().map(|s| mended.correct(s));
    let left = [left(mended, &seen[0])?, left(mended, &seen[1])?];
    for (which, name) in ["fit", "check"].into_iter().enumerate() {
        if !episodes.iter().any(|e| e.recording == name) {
            continue;
        }
        let found = in_recording(
            mended,
            [&seen[which], &seen[1 - which]],
            [&left[which], &left[1 - which]],
        );
        for episode in episodes.iter_mut().filter(|e| e.recording == name && e.every_s.is_none()) {
            let meets = |c: &&Contact| c.start_s <= episode.end && episode.start <= c.end_s;
            let strongest = found.iter().filter(meets).max_by(|a, b| a.peak_n.total_cmp(&b.peak_n));
            episode.touch = strongest.cloned().map(Touch::from);
        }
    }
    Ok(())
}

/// Contacts of a recording; what the twin leaves besides is learned from it and from the other.
fn in_recording(
    twin: &Twin,
    [own, other]: [&Samples; 2],
    [left, free]: [&Left; 2],
) -> Vec<Contact> {
    let heard = |samples: &Samples, left| Heard {
        left,
        every: samples.decimation(),
        dt: samples.decimation() as f64 * samples.dt,
    };
    let noise = Noise::learn(heard(own, left), &[heard(other, free)]);
    let residual = Residual {
        recording: "",
        robot: &twin.robot,
        start: own.start,
        dt: own.dt,
        q: &own.q,
        left,
        usable: &own.usable,
        every: own.decimation(),
        noise: &noise,
    };
    contacts(&residual, &Criteria::default(), &())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::point_jacobian;
    use crate::signals::testing::{noisy, samples};

    const FORCE_N: [f64; 3] = [20.0, -35.0, 25.0];
    const PUSH_S: [f64; 2] = [20.0, 22.0];

    /// A known arm along a motion, with or without a push at its flange.
    fn recorded(twin: &Twin, pushed: bool) -> Samples {
        let mut made = samples(6, 5000, |j, t| {
            0.7 * (0.9 * t + j as f64).sin() + 0.2 * ((2.1 + 0.2 * j as f64) * t).sin()
        });
        made.torque = twin.torque(&twin.motion(&made));
        noisy(&mut made, 0.5);
        let mut q = vec![0.0; 6];
        for k in (0..made.len()).filter(|_| pushed) {
            let [from, until] = PUSH_S;
            if (from..until).contains(&made.time(k)) {
                made.q.sample_into(k, &mut q);
                let jacobian = point_jacobian(&twin.robot, &q, 5, &twin.robot.flange.translation);
                for j in 0..6 {
                    let push: f64 = (0..3).map(|axis| jacobian[(axis, j)] * FORCE_N[axis]).sum();
                    made.torque.joint_mut(j)[k] -= push;
                }
            }
        }
        made
    }

    fn stretch(start: f64, end: f64) -> Episode {
        let (recording, joints) = ("check".into(), vec![2, 3]);
        let (peak_nm, force_n, explained) = (20.0, [0.0; 3], 0.0);
        Episode {
            recording,
            start,
            end,
            joints,
            peak_nm,
            force_n,
            explained,
            every_s: None,
            touch: None,
        }
    }

    #[test]
    fn a_push_is_told_where_a_stretch_stands_out() {
        let twin = Twin::default();
        let both = [recorded(&twin, false), recorded(&twin, true)];
        let mut episodes = vec![stretch(20.5, 21.5), stretch(5.0, 6.0)];
        touched(&twin, &both, &mut episodes).unwrap();
        let touch = episodes[0].touch.as_ref().expect("a touch");
        let size = FORCE_N.iter().map(|f| f * f).sum::<f64>().sqrt();
        assert!((touch.peak_n - size).abs() < 0.25 * size, "{touch:?}");
        assert!((touch.start_s - PUSH_S[0]).abs() < 0.3, "{touch:?}");
        assert!((touch.end_s - PUSH_S[1]).abs() < 0.3, "{touch:?}");
        assert_eq!(episodes[1].touch, None);
    }
}
