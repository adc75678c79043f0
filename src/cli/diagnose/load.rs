//! The two recordings of a diagnosis.

use std::path::Path;

use anyhow::{Context, bail};

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

pub fn refuse_same_file(fit: &Path, check: &Path) -> anyhow::Result<()> {
    if let (Ok(a), Ok(b)) = (fit.canonicalize(), check.canonicalize())
        && a == b
    {
        bail!(
            "--check {}: is the recording the causes are searched on; another one must decide \
             (leave --check out to keep its second half for that)",
            check.display()
        );
    }
    Ok(())
}

pub fn refuse_same_samples([fit, check]: &[Recording; 2]) -> anyhow::Result<()> {
    if fit.time == check.time && fit.channels == check.channels {
        bail!(
            "--check {}: holds the same samples as {}; another recording must decide",
            check.provenance.source,
            fit.provenance.source
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{Channel, Provenance};

    #[test]
    fn a_recording_does_not_decide_on_itself() {
        let values: Vec<f64> = (0..11).map(f64::from).collect();
        let whole = Recording {
            time: values.clone(),
            channels: vec![Channel { name: "actual_q_0".into(), values }],
            provenance: Provenance::default(),
        };
        assert!(refuse_same_samples(&whole.halves()).is_ok());
        assert!(refuse_same_samples(&[whole.clone(), whole]).is_err());
    }
}
