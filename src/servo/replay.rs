//! A twin led along what its servos were told.

use std::ops::Range;

use rayon::prelude::*;

use super::{Plant, ServoError, Track};
use crate::series::{JointSeries, at_place};
use crate::signals::LONGEST_STEP_S;
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

/// Leads the arm through a stretch from the measured state at its begin; `see` is called at every sample.
pub(super) fn lead(
    plant: &mut Plant,
    track: &Track,
    stretch: &Range<usize>,
    mut see: impl FnMut(&Plant),
) -> Result<(), ServoError> {
    let dof = track.joints();
    let steps = (track.dt / LONGEST_STEP_S).ceil().max(1.0);
    let h = track.dt / steps;
    let at = |series: &JointSeries, k: usize| -> Vec<f64> {
        (0..dof).map(|j| series.joint(j)[k]).collect()
    };
    let first = stretch.start;
    plant.set_state(first as f64 * track.dt, &at(&track.smooth_q, first), &at(&track.qd, first));
    see(plant);
    let late: Vec<f64> = plant.servo().delay.iter().map(|d| d / track.dt).collect();
    let (mut command, mut gain) = (vec![0.0; dof], vec![0.0; dof]);
    for k in first..stretch.end - 1 {
        if let Some(temperature) = &track.temperature {
            plant.set_temperature(&at(temperature, k));
        }
        for (j, gain) in gain.iter_mut().enumerate() {
            *gain = track.factor.joint(j)[k] * plant.servo().gain[j];
        }
        for step in 0..steps as usize {
            let now = k as f64 + step as f64 / steps;
            for (j, command) in command.iter_mut().enumerate() {
                *command = at_place(track.command.joint(j), now - late[j]);
            }
            plant.step(h, &command, &gain);
        }
        plant.check()?;
        see(plant);
    }
    Ok(())
}
