//! The two recordings of a diagnosis.

use std::path::Path;

use anyhow::{Context, bail};

use crate::cli::conditioning::ConditioningArgs;
use crate::diagnosis::conditioning;
use crate::recording::{Channel, Provenance, Recording};
use crate::signals::{Conditioning, Samples, condition as to_samples};
use crate::twin::Twin;

/// A recording and what became of it.
pub struct Recorded {
    pub recording: Recording,
    pub samples: Samples,
}

/// The first and the second half of a recording, for want of another one.
pub fn halves(recording: &Recording) -> [Recording; 2] {
    let n = recording.time.len();
    [("first half", 0..n / 2), ("second half", n / 2..n)].map(|(which, rows)| {
        let part =
            |c: &Channel| Channel { name: c.name.clone(), values: c.values[rows.clone()].to_vec() };
        Recording {
            time: recording.time[rows.clone()].to_vec(),
            channels: recording.channels.iter().map(part).collect(),
            provenance: Provenance {
                source: format!("{}, {which}", recording.provenance.source),
                ..recording.provenance.clone()
            },
        }
    })
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

    #[test]
    fn halves_part_a_recording_without_losing_a_row() {
        let values: Vec<f64> = (0..11).map(f64::from).collect();
        let whole = Recording {
            time: values.clone(),
            channels: vec![Channel { name: "actual_q_0".into(), values: values.clone() }],
            provenance: Provenance { source: "log.csv".into(), ..Provenance::default() },
        };
        let [first, second] = halves(&whole);
        assert_eq!([first.time.clone(), second.time.clone()].concat(), values);
        assert_eq!(second.channels[0].values, second.time);
        assert_eq!(second.provenance.source, "log.csv, second half");
        assert!(refuse_same_samples(&[first, second]).is_ok());
        assert!(refuse_same_samples(&[whole.clone(), whole]).is_err());
    }
}
