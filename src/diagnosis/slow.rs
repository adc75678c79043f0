//! Values of what shakes an arm faster than its motion is followed, from torque below the usual
//! low-pass.
//!
//! A motor answers the blow of slack teeth, the ringing of a spring and a ripple of high order faster
//! than its conditioned motion shows. What unfiltered torque holds of that answer tells such effects
//! from others, but belongs to the controller: gap, stiffness and amplitude would make up for it (a gap
//! of 4 mrad at a UR5's base came out as 3.6 mrad, and a third of its stiffness).

use super::Value;
use super::conditioning::GUARD_S;
use super::data::Data;
use super::fit::Fit;
use super::floor::noise_floor;
use super::intervals;
use super::locate::refine_together;
use super::model::Model;
use super::observed::Observed;
use super::profile;
use crate::signals::{Conditioning, Samples};

/// Values of every cause with intervals, in the order of the causes. Of what outruns the motion those
/// of slow torque, which tells them better.
pub fn values(fit: &Fit<'_>) -> Vec<Vec<Value>> {
    let mut values = intervals::of_fit(fit);
    for (i, of_cause) in slow(fit).into_iter().flatten() {
        values[i] = of_cause;
    }
    values
}

/// Values of the causes that outrun the motion, with their indices; `None` where there are none, or
/// where the torque of a recording has passed a low-pass already. Units as the catalogue has them.
fn slow(fit: &Fit<'_>) -> Option<Vec<(usize, Vec<Value>)>> {
    let twin = fit.data.twin;
    let causes = fit.model.causes.iter().enumerate();
    let outruns = causes.filter(|(_, t)| t.candidate.effect.outruns_motion());
    let sought: Vec<usize> = outruns.map(|(i, _)| i).collect();
    if sought.is_empty() {
        return None;
    }
    let samples: Vec<Samples> =
        fit.data.parts.iter().map(|p| low_passed(p)).collect::<Option<_>>()?;
    let mut parts = Vec::new();
    for (part, samples) in fit.data.parts.iter().zip(&samples) {
        let floor = noise_floor(samples, twin);
        parts.push(Observed::new(part.index, twin, samples, &floor).ok()?);
    }
    let data = Data::plain(parts.iter().collect());
    let mut model: Model = fit.model.clone();
    refine_together(&data, &mut model, &sought);
    let again = Fit::plain(&data, model);
    let mut all = intervals::of_fit(&again);
    sought.iter().for_each(|&i| profile::widen(&again, i, &mut all[i]));
    Some(all.into_iter().enumerate().filter(|(i, _)| sought.contains(i)).collect())
}

/// The samples of a recording whose torque is taken as it is, to be low-passed as usual.
fn low_passed(evidence: &Observed<'_>) -> Option<Samples> {
    let samples = evidence.samples;
    let torque_cutoff_hz = Conditioning::default().torque_cutoff_hz;
    let guard_s = samples.conditioning.guard_s.max(GUARD_S);
    let conditioning = Conditioning { torque_cutoff_hz, guard_s, ..samples.conditioning.clone() };
    let sharp = samples.conditioning.torque_cutoff_hz == 0.0;
    sharp.then(|| Samples { conditioning, ..samples.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::candidate::{Candidate, Place};
    use crate::diagnosis::refine::refine;
    use crate::diagnosis::screen::screen;
    use crate::effects::find;
    use crate::signals::SavitzkyGolay;
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    const JOINT: usize = 3;
    const LEVELS_NM: [f64; 3] = [0.5, 0.6, 0.4];
    const WIDTH_RAD: f64 = 0.001;
    /// kg m^2 that springs jerk, and for how long the controller lets them.
    const INERTIA: f64 = 0.3;
    const SLOW_HZ: f64 = 5.0;

    /// A joint with springs instead of Coulomb friction. Its controller is slow: what it does not meet
    /// of them jerks the arm, and accelerations are known below 12 Hz.
    fn jerked(twin: &Twin) -> Samples {
        let mut made = samples(6, 6000, |j, t| {
            0.5 * ((1.1 + 0.1 * j as f64) * t).sin() + 0.2 * ((2.3 + 0.2 * j as f64) * t).cos()
        });
        let columns =
            find("maxwell_slip").unwrap().columns(&twin.motion(&made), JOINT, &[WIDTH_RAD]);
        let each = |k: usize| columns.iter().zip(LEVELS_NM).map(|(c, level)| level * c[k]).sum();
        let friction: Vec<f64> = (0..made.len()).map(each).collect();
        let met = SavitzkyGolay::with_cutoff(SLOW_HZ, made.rate_hz(), 2).apply(&friction, 0);
        let jerk: Vec<f64> =
            met.iter().zip(&friction).map(|(met, f)| (met - f) / INERTIA).collect();
        let seen = SavitzkyGolay::with_cutoff(12.0, made.rate_hz(), 4).apply(&jerk, 0);
        let mut known = made.clone();
        known.qdd.joint_mut(JOINT).iter_mut().zip(&seen).for_each(|(a, seen)| *a += seen);
        made.qdd.joint_mut(JOINT).iter_mut().zip(&jerk).for_each(|(a, jerk)| *a += jerk);
        known.torque = twin.torque(&twin.motion(&made));
        let torque = known.torque.joint_mut(JOINT);
        torque.iter_mut().zip(&friction).for_each(|(t, f)| *t += f);
        noisy(&mut known, 0.02);
        known.conditioning.torque_cutoff_hz = 0.0;
        known.conditioning.standstill_rad_s = 0.03;
        known.conditioning.guard_s = 0.008;
        known
    }

    #[test]
    fn springs_that_jerk_an_arm_are_as_wide_as_they_are() {
        let mut twin = Twin::default();
        twin.drive.rotor_inertia = vec![INERTIA; 6];
        let made = jerked(&twin);
        let observed = Observed::new(0, &twin, &made, &noise_floor(&made, &twin)).unwrap();
        let data = Data::plain(vec![&observed]);
        let fit = Fit::plain(&data, Model::of(&twin));
        let effect = find("maxwell_slip").unwrap();
        let candidate = Candidate::new(effect, Place::Joint(JOINT));
        let start = screen(&fit, &[candidate]).remove(0).trial;
        let fit = Fit::plain(&data, Model::of(&twin).with(refine(&fit, &start).term()));
        let width = |values: &[Vec<Value>]| values[0][3].value / WIDTH_RAD - 1.0;
        let sharp = width(&intervals::of_fit(&fit));
        let slow = width(&values(&fit));
        assert!(sharp.abs() > 0.03 && slow.abs() < 0.01, "{sharp} {slow}");
    }
}
