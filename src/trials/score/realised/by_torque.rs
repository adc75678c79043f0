//! The gap in the torque of the drives.

use super::Left;
use crate::recording::Recording;
use crate::signals::{Conditioning, Derivatives, Samples};
use crate::trials::TrialError;
use crate::trials::strength::{SLIDING_RAD_S, rms, without_friction};
use crate::trials::third::BY_TORQUE;
use crate::twin::Twin;

/// Mean square over all joints of what a twin leaves while sliding, friction fitted, N.m^2.
///
/// # Errors
/// If a channel is missing.
pub fn left(third: &Recording, case: &str) -> Result<Left, TrialError> {
    let samples = samples(third, case)?;
    Ok(Box::new(move |twin| Ok(mean_square(twin, &samples))))
}

fn samples(third: &Recording, case: &str) -> Result<Samples, TrialError> {
    let dt = match third.time.as_slice() {
        [a, b, ..] => b - a,
        _ => 1.0,
    };
    let series = |stem: &str| {
        let lacks = || format!("{case}: the third recording has no {stem}; draw the cases again");
        let missing = || TrialError::Usage(lacks());
        third.joints(stem).ok_or_else(missing)
    };
    let [q, qd, qdd, torque, temperature] = BY_TORQUE;
    Ok(Samples {
        dt,
        start: third.time.first().copied().unwrap_or(0.0),
        q: series(q)?,
        qd: series(qd)?,
        qdd: series(qdd)?,
        torque: series(torque)?,
        told: None,
        response: None,
        sensed: None,
        smoothed_further: None,
        temperature: Some(series(temperature)?),
        usable: vec![true; third.time.len()],
        conditioning: Conditioning {
            derivatives: Derivatives::TrackingError,
            ..Conditioning::default()
        },
        notes: Vec::new(),
    })
}

fn mean_square(twin: &Twin, samples: &Samples) -> f64 {
    let samples = twin.correct(samples);
    let known = twin.torque(&twin.motion(&samples));
    let squares = |j: usize| {
        let qd = samples.qd.joint(j);
        let sliding = |k: &usize| qd[*k].abs() > SLIDING_RAD_S;
        let gap = |k: usize| (samples.torque.joint(j)[k] - known.joint(j)[k], qd[k]);
        let (gap, qd): (Vec<f64>, Vec<f64>) = (0..samples.len()).filter(sliding).map(gap).unzip();
        rms(&without_friction(&gap, &qd)).powi(2)
    };
    let joints = samples.joints();
    (0..joints).map(squares).sum::<f64>() / joints as f64
}
