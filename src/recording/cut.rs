//! A stretch of a recording.

use super::{Channel, Provenance, Recording};

impl Recording {
    /// The rows between two times, s from the first row, both included; what is not given is an end of
    /// the recording. Time stays that of the recording.
    pub fn between(&self, from_s: Option<f64>, to_s: Option<f64>) -> Self {
        let origin = self.time.first().copied().unwrap_or(0.0);
        let (from, to) = (from_s.unwrap_or(f64::NEG_INFINITY), to_s.unwrap_or(f64::INFINITY));
        // Times are read from decimals: a row at the very end is meant.
        let slack = 1e-9 * self.time.last().map_or(1.0, |t| t.abs().max(1.0));
        let start = self.time.partition_point(|t| t - origin < from - slack);
        let end = self.time.partition_point(|t| t - origin <= to + slack).max(start);
        let part =
            |c: &Channel| Channel { name: c.name.clone(), values: c.values[start..end].to_vec() };
        let mut provenance: Provenance = self.provenance.clone();
        if end - start < self.time.len() {
            let (kept, all) = (end - start, self.time.len());
            provenance.notes.push(format!("{kept} of {all} rows lie between --from and --to"));
        }
        Self {
            time: self.time[start..end].to_vec(),
            channels: self.channels.iter().map(part).collect(),
            provenance,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretch_counts_from_the_first_row_and_keeps_its_time() {
        let time: Vec<f64> = (0..11).map(|k| 100.0 + 0.1 * f64::from(k)).collect();
        let channels = vec![Channel { name: "actual_q_0".into(), values: time.clone() }];
        let whole = Recording { time: time.clone(), channels, provenance: Provenance::default() };
        let part = whole.between(Some(0.2), Some(0.5));
        assert_eq!(part.time, time[2..6]);
        assert_eq!(part.channels[0].values, time[2..6]);
        assert_eq!(whole.between(None, None), whole);
        assert!(whole.between(Some(7.0), None).time.is_empty());
        assert!(part.provenance.notes[0].contains("4 of 11 rows"));
    }
}
