//! Two recordings that are to be different: what is fitted to one is held against the other.

use super::{Recording, RecordingError};

/// # Errors
/// Both hold the same samples, whatever their files are called.
pub fn refuse_same(first: &Recording, second: &Recording) -> Result<(), RecordingError> {
    if first.time != second.time || first.channels != second.channels {
        return Ok(());
    }
    let [first, second] = [first, second].map(|r| r.provenance.source.clone());
    Err(RecordingError::Same { first, second })
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
            provenance: Provenance { source: "log.csv".into(), ..Provenance::default() },
        };
        let [first, second] = whole.halves();
        assert!(refuse_same(&first, &second).is_ok());
        let copy = Recording {
            provenance: Provenance { source: "copy.csv".into(), ..Provenance::default() },
            ..whole.clone()
        };
        let message = refuse_same(&whole, &copy).unwrap_err().to_string();
        assert!(message.starts_with("copy.csv: holds the same samples as log.csv"), "{message}");
    }
}
