//! The two recordings of a diagnosis.

use anyhow::Context;

use crate::cli::conditioning::ConditioningArgs;
use crate::diagnosis::conditioning;
use crate::recording::Recording;
use crate::signals::{Conditioning, Samples, condition as to_samples};
use crate::twin::Twin;

/// A recording and what became of it.
pub struct Recorded {
    pub recording: Recording,
    pub samples: Samples,
}

/// Both conditioned alike.
pub fn condition(
    recordings: [Recording; 2],
    twin: &Twin,
    flags: &ConditioningArgs,
) -> anyhow::Result<[Recorded; 2]> {
    let dof = twin.robot.dof();
    let how = flags.over(common(&recordings, dof));
    let recorded = |recording: Recording| -> anyhow::Result<Recorded> {
        let samples = to_samples(&recording, &twin.drive, dof, &how)
            .with_context(|| recording.provenance.source.clone())?;
        Ok(Recorded { recording, samples })
    };
    let [fit, check] = recordings;
    Ok([recorded(fit)?, recorded(check)?])
}

/// Where one of them lacks the command, both are conditioned without; where one is long, both are
/// low-passed alike.
fn common(recordings: &[Recording; 2], dof: usize) -> Conditioning {
    let [fit, check] = recordings.each_ref().map(|r| conditioning(r, dof));
    match (fit.derivatives == check.derivatives, fit.torque_cutoff_hz >= check.torque_cutoff_hz) {
        (false, _) => Conditioning::default(),
        (true, true) => fit,
        (true, false) => check,
    }
}
