//! What a search found of position servos, held against positions: its values are fitted by simulation, and the
//! twin before and after, and without each cause, is led along the command of the check recording.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::following::AsSent;
use super::parameters::stated;
use super::refit::{Refitted, taken_out};
use super::{Estimate, PositionGap, ServoError, Track, replay};
use crate::diagnosis::{
    By, Cause, Change, CrossValidated, Diagnosis, JointPositionShrink, Position, PositionShrink,
    SimulationShrink, Value, Verdict,
};
use crate::effects::find;
use crate::series::JointSeries;
use crate::twin::Twin;

/// What stands, and with which values.
pub struct Mended {
    pub changes: Vec<Change>,
    /// As both recordings have them, with intervals.
    pub told: Refitted,
    /// As the fit recording alone has them.
    pub alone: Twin,
    pub decided: CrossValidated,
    /// The recording that decides, with its commands as what was found tells them.
    pub check: AsSent,
    /// How many times wider intervals are than errors of the fits say ([`super::scatter::birge_ratio`]).
    pub birge_ratio: f64,
}

/// Leads along the command of the check recording the twin as given, its open values as the other recording has them (`before`), the one
/// that the same recording alone mended, and that one without each cause; adds to `diagnosis` what that shows, and returns the
/// positions of the first two, rad. Values are told by both recordings, and causes come in the order of the changes.
///
/// # Errors
/// If one of the first two runs away.
pub fn prove(
    diagnosis: &mut Diagnosis,
    twin: &Twin,
    before: &Twin,
    mended: &Mended,
) -> Result<Vec<JointSeries>, ServoError> {
    let Mended { changes, told, alone: after, check, .. } = mended;
    let track = &check.track;
    keep_open(&mut diagnosis.fitted_before, twin, before);
    keep_open(&mut diagnosis.fitted, twin, &told.twin);
    let is_of = |change: &Change, cause: &Cause| {
        (&change.effect, &change.joints) == (&cause.effect, &cause.joints)
    };
    diagnosis.causes.sort_by_key(|cause| changes.iter().position(|c| is_of(c, cause)));
    diagnosis.causes.iter_mut().for_each(|cause| keep_cause(cause, twin, &told.estimates));
    diagnosis.verdict = Verdict::of(&diagnosis.causes, &diagnosis.unexplained, &diagnosis.ranking);
    let stretches = track.stretches(f64::INFINITY);
    let of = |twin: &Twin| replay(twin, track, &stretches);
    let (q_before, q_after) = rayon::join(|| of(before), || of(after));
    let (q_before, q_after) = (q_before?, q_after?);
    let gaps = [&q_before, &q_after].map(|q| PositionGap::new(track, q));
    let rms = gaps[1].rms_rad();
    let without = |cause: &Cause| -> Result<PositionShrink, ServoError> {
        let twin = taken_out(after, twin, &Change::from(cause));
        let before_rad = rms_rad(&twin, track)?;
        let Cause { effect, joints, .. } = cause.clone();
        let fraction = share(before_rad.unwrap_or(f64::INFINITY), rms);
        Ok(PositionShrink { effect, joints, before_rad, after_rad: rms, fraction })
    };
    let causes = diagnosis.causes.par_iter().map(without).collect::<Result<_, _>>()?;
    put(diagnosis, &gaps, mended, causes);
    Ok(vec![q_before, q_after])
}

/// Error of a twin led along the command of a recording, root mean square over joints, rad; `None` where it runs away.
///
/// # Errors
/// If it cannot be simulated for another reason.
pub fn rms_rad(twin: &Twin, track: &Track) -> Result<Option<f64>, ServoError> {
    match replay(twin, track, &track.stretches(f64::INFINITY)) {
        Ok(q) => Ok(Some(PositionGap::new(track, &q).rms_rad())),
        Err(ServoError::Diverged { .. }) => Ok(None),
        Err(other) => Err(other),
    }
}

/// What the twin leaves open takes the values that were fitted by simulation.
fn keep_open(kept: &mut BTreeMap<String, Vec<f64>>, twin: &Twin, fitted: &Twin) {
    for parameter in twin.open().flat_map(|e| e.about().parameters) {
        if let Some(values) = fitted.values.get(parameter.name) {
            kept.insert(parameter.name.into(), values.clone());
        }
    }
}

/// A cause takes the values that were fitted by simulation: the twin's own, or what is added to them.
fn keep_cause(cause: &mut Cause, twin: &Twin, estimates: &[Estimate]) {
    let replaces = cause.replaces.is_some();
    let first = cause.joints.first().copied();
    for value in &mut cause.parameters {
        let joint = value.joint.or(first);
        let own = |e: &&Estimate| e.name == value.name && (e.joint.is_none() || e.joint == joint);
        let Some(found) = estimates.iter().find(own) else { continue };
        (value.value, [value.low, value.high]) = (found.value, interval(found));
        value.at_bound = found.at_bound;
        if let Some(effect) = find(&cause.effect).filter(|_| !replaces) {
            let joint = found.joint.map_or(0, |joint| joint - 1);
            shift(value, -stated(twin, effect, found.name, joint));
        }
    }
}

/// The interval of a value; what the recordings do not tell may be anything that was searched.
fn interval(found: &Estimate) -> [f64; 2] {
    if found.identifiable { [found.low, found.high] } else { found.range }
}

fn shift(value: &mut Value, by: f64) {
    value.value += by;
    value.low += by;
    value.high += by;
}

fn put(
    diagnosis: &mut Diagnosis,
    [before, after]: &[PositionGap; 2],
    mended: &Mended,
    causes: Vec<PositionShrink>,
) {
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
    let Mended { decided: cross_validated, birge_ratio, .. } = *mended;
    diagnosis.position = Some(Position {
        before_rad,
        after_rad,
        fraction,
        cross_validated,
        birge_ratio,
        time_offset: mended.check.time_offset,
        step_s: Some(mended.check.track.step_s()),
        joints,
        causes,
    });
}

/// Share of a mean square that is taken off between two root mean squares.
fn share(before: f64, after: f64) -> f64 {
    if before > 0.0 { 1.0 - (after / before).powi(2) } else { 0.0 }
}
