//! A diagnosis of position servos, held against positions: the twin before and after it was mended, led along
//! the command of the check recording, and without each of its causes.

use rayon::prelude::*;

use super::{PositionGap, ServoError, Track, replay};
use crate::diagnosis::{
    By, Cause, Diagnosis, JointPositionShrink, Position, PositionShrink, SimulationShrink, mend,
};
use crate::series::JointSeries;
use crate::signals::Samples;
use crate::twin::Twin;

/// Effects with a degree of freedom of their own.
const ELASTIC: [&str; 2] = ["backlash", "joint_flexibility"];

/// Adds to `diagnosis` what its causes bring in simulated position; returns the positions (rad) of the twin as
/// given and of the mended one.
///
/// # Errors
/// If the twin has no servos or runs away.
pub fn simulate_again(
    diagnosis: &mut Diagnosis,
    twin: &Twin,
    check: &Samples,
) -> Result<Vec<JointSeries>, ServoError> {
    let servo = twin.drive.servo.as_ref().ok_or(ServoError::NoServo)?;
    let track = Track::new(check, servo)?;
    let stretches = track.stretches(f64::INFINITY);
    let changes = diagnosis.changes();
    let mut notes = Vec::new();
    let before = rigid(mend(twin, &diagnosis.fitted_before, &[]), &mut notes);
    let with = |causes: &[Cause]| rigid(mend(twin, &diagnosis.fitted, causes), &mut Vec::new());
    let mended = rigid(mend(twin, &diagnosis.fitted, &changes), &mut notes);
    let of = |twin: &Twin| replay(twin, &track, &stretches);
    let (q_before, q_after) = rayon::join(|| of(&before), || of(&mended));
    let (q_before, q_after) = (q_before?, q_after?);
    let gaps = [&q_before, &q_after].map(|q| PositionGap::new(&track, q));
    let after = gaps[1].rms_rad();
    let without = |i: usize| -> Result<PositionShrink, ServoError> {
        let others: Vec<Cause> =
            changes.iter().enumerate().filter(|(k, _)| *k != i).map(|(_, c)| c.clone()).collect();
        let before = PositionGap::new(&track, &of(&with(&others))?).rms_rad();
        let Cause { effect, joints, .. } = changes[i].clone();
        Ok(PositionShrink {
            effect,
            joints,
            before_rad: before,
            after_rad: after,
            fraction: share(before, after),
        })
    };
    let causes =
        (0..diagnosis.causes.len()).into_par_iter().map(without).collect::<Result<_, _>>()?;
    diagnosis.notes.append(&mut notes);
    put(diagnosis, &gaps, causes);
    Ok(vec![q_before, q_after])
}

fn put(diagnosis: &mut Diagnosis, [before, after]: &[PositionGap; 2], causes: Vec<PositionShrink>) {
    let joint = |(b, a): (&super::JointPosition, &super::JointPosition)| JointPositionShrink {
        joint: b.joint,
        before_rad: b.rms_rad,
        after_rad: a.rms_rad,
        rounding_rad: b.rounding_rad,
    };
    let joints: Vec<JointPositionShrink> =
        before.joints.iter().zip(&after.joints).map(joint).collect();
    for (gap, position) in diagnosis.gap.joints.iter_mut().zip(&joints) {
        gap.rms_rad = Some(position.before_rad);
        gap.noise_floor_rad = Some(position.rounding_rad);
    }
    let (before_rad, after_rad) = (before.rms_rad(), after.rms_rad());
    let fraction = share(before_rad, after_rad);
    diagnosis.by = By::Simulation;
    diagnosis.shrink.simulation =
        Some(SimulationShrink { before_rad, after_rad, fraction, ..SimulationShrink::default() });
    diagnosis.position = Some(Position { before_rad, after_rad, fraction, joints, causes });
}

/// Share of a mean square that is taken off between two root mean squares.
fn share(before: f64, after: f64) -> f64 {
    if before > 0.0 { 1.0 - (after / before).powi(2) } else { 0.0 }
}

/// The twin without what gives way between motor and link, which is not simulated here; a note says so.
fn rigid(mut twin: Twin, notes: &mut Vec<String>) -> Twin {
    let elastic: Vec<&str> =
        ELASTIC.into_iter().filter(|e| twin.effects.iter().any(|own| own == e)).collect();
    if elastic.is_empty() {
        return twin;
    }
    twin.effects.retain(|e| !elastic.contains(&e.as_str()));
    notes.push(format!("the simulation of position leaves {} out", elastic.join(" and ")));
    twin
}
