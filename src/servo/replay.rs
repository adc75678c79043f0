//! A twin led along what its servos were told.

use std::ops::Range;

use rayon::prelude::*;

use super::{Plant, ServoError, Track};
use crate::series::JointSeries;
use crate::twin::Twin;

/// Positions of the twin along a track, rad as the encoders show them, where it begins each of the
/// `stretches` in the measured state; what is recorded elsewhere.
///
/// # Errors
/// If the twin has no servos, an effect this simulation does not have, or runs away.
pub fn replay(
    twin: &Twin,
    track: &Track,
    stretches: &[Range<usize>],
) -> Result<JointSeries, ServoError> {
    let of = |stretch: &Range<usize>| {
        let mut positions = vec![Vec::with_capacity(stretch.len()); track.joints()];
        let mut plant = Plant::new(twin, track.start)?;
        lead(&mut plant, track, stretch, |plant| {
            positions.iter_mut().enumerate().for_each(|(j, p)| p.push(plant.shown(j)));
        })?;
        Ok(positions)
    };
    let parts: Vec<Vec<Vec<f64>>> =
        stretches.par_iter().map(of).collect::<Result<_, ServoError>>()?;
    let mut q = track.q.clone();
    for (stretch, part) in stretches.iter().zip(parts) {
        for (j, positions) in part.iter().enumerate() {
            q.joint_mut(j)[stretch.clone()].copy_from_slice(positions);
        }
    }
    Ok(q)
}

/// What is led along a recording: an arm, and whatever goes along with it.
pub(super) trait Led {
    fn plant(&mut self) -> &mut Plant;

    /// The plant has been put where a stretch begins.
    fn begin(&mut self) {}

    /// One step of `h` s with what was told at sample `k`, and between it and the next at `place`.
    fn follow(&mut self, h: f64, track: &Track, k: usize, place: f64);
}

/// Leads an arm through a stretch from the measured state at its begin; `see` is called at every sample.
pub(super) fn lead<L: Led>(
    led: &mut L,
    track: &Track,
    stretch: &Range<usize>,
    mut see: impl FnMut(&L),
) -> Result<(), ServoError> {
    let (steps, h) = (track.steps as f64, track.step_s());
    let at = |series: &JointSeries, k: usize| -> Vec<f64> {
        (0..track.joints()).map(|j| series.joint(j)[k]).collect()
    };
    let (first, plant) = (stretch.start, led.plant());
    plant.set_state(first as f64 * track.dt, &at(&track.smooth_q, first), &at(&track.qd, first));
    led.begin();
    see(led);
    for k in first..stretch.end - 1 {
        if let Some(temperature) = &track.temperature {
            led.plant().set_temperature(&at(temperature, k));
        }
        for step in 0..track.steps {
            led.follow(h, track, k, k as f64 + step as f64 / steps);
        }
        led.plant().check()?;
        see(led);
    }
    Ok(())
}
