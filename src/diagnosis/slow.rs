//! Values of what shakes an arm faster than its motion is followed, from torque below the usual
//! low-pass.
//!
//! A motor answers the blow of slack teeth, the ringing of a spring and a ripple of high order faster
//! than its conditioned motion shows. What unfiltered torque holds of that answer tells such effects
//! from others, but belongs to the controller: gap, stiffness and amplitude would make up for it (a gap
//! of 4 mrad at a UR5's base came out as 3.6 mrad, and a third of its stiffness).

use super::Value;
use super::evidence::Evidence;
use super::floor::noise_floor;
use super::intervals;
use super::locate::refine_together;
use super::model::{Fit, Model};
use crate::signals::{Conditioning, Samples};

/// Values of the causes that outrun the motion, with their indices; `None` where there are none, or
/// where the torque of a recording has passed a low-pass already. Units as the catalogue has them.
pub fn values(fit: &Fit<'_, '_>, check: &Evidence<'_>) -> Option<Vec<(usize, Vec<Value>)>> {
    let twin = fit.evidence.twin;
    let causes = fit.model.causes.iter().enumerate();
    let outruns = causes.filter(|(_, t)| t.candidate.effect.outruns_motion());
    let sought: Vec<usize> = outruns.map(|(i, _)| i).collect();
    if sought.is_empty() {
        return None;
    }
    let [fit_samples, check_samples] = [low_passed(fit.evidence)?, low_passed(check)?];
    let evidence = |samples| Evidence::new(twin, samples, &noise_floor(samples, twin)).ok();
    let (on_fit, on_check) = (evidence(&fit_samples)?, evidence(&check_samples)?);
    let mut model: Model = fit.model.clone();
    refine_together(&on_fit, &mut model, &sought);
    let again = Fit::new(&on_fit, model);
    let all = intervals::of_fit(&again, &on_check, &again.held_against(&on_check));
    Some(all.into_iter().enumerate().filter(|(i, _)| sought.contains(i)).collect())
}

/// The samples of a recording whose torque is taken as it is, to be low-passed as usual.
fn low_passed(evidence: &Evidence<'_>) -> Option<Samples> {
    let samples = evidence.samples;
    let Conditioning { torque_cutoff_hz, guard_s, .. } = Conditioning::default();
    let conditioning = Conditioning { torque_cutoff_hz, guard_s, ..samples.conditioning.clone() };
    let sharp = samples.conditioning.torque_cutoff_hz == 0.0;
    sharp.then(|| Samples { conditioning, ..samples.clone() })
}
