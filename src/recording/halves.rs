//! One recording made two.

use super::{Channel, Provenance, Recording};

impl Recording {
    /// The first and the second half, for want of another recording.
    pub fn halves(&self) -> [Self; 2] {
        let n = self.time.len();
        [("first half", 0..n / 2), ("second half", n / 2..n)].map(|(which, rows)| {
            let part = |c: &Channel| Channel {
                name: c.name.clone(),
                values: c.values[rows.clone()].to_vec(),
            };
            Self {
                time: self.time[rows.clone()].to_vec(),
                channels: self.channels.iter().map(part).collect(),
                provenance: Provenance {
                    source: format!("{}, {which}", self.provenance.source),
                    ..self.provenance.clone()
                },
            }
        })
    }
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
        let [first, second] = whole.halves();
        assert_eq!([first.time.clone(), second.time.clone()].concat(), values);
        assert_eq!(second.channels[0].values, second.time);
        assert_eq!(second.provenance.source, "log.csv, second half");
    }
}
