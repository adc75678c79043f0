//! Rows as they came -> a recording of them.

use crate::recording::{Channel, Provenance, Recording};

/// Rows whose numbers are time (s) and then what `names` says.
pub fn recording<'a>(
    names: &[String],
    rows: impl Iterator<Item = &'a Vec<f64>> + Clone,
    source: &str,
) -> Recording {
    let column = |c: usize| rows.clone().map(|row| row[c]).collect::<Vec<f64>>();
    let channel =
        |(c, name): (usize, &String)| Channel { name: name.clone(), values: column(c + 1) };
    Recording {
        time: column(0),
        channels: names.iter().enumerate().map(channel).collect(),
        provenance: Provenance { source: source.into(), ..Provenance::default() },
    }
}
