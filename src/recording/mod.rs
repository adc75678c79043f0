//! A recording: named SI columns on one time column, and where they came from.
//! One file per format; every reader yields the same [`Recording`].

mod arrays;
mod bag;
#[cfg_attr(not(feature = "bags"), allow(dead_code))]
mod bag_map;
mod bam_json;
mod blocks;
mod check;
mod columns;
mod cut;
mod draft;
mod error;
mod file;
mod format;
mod formats;
#[cfg(feature = "parquet")]
mod guard;
mod halves;
pub mod inspection;
#[cfg(feature = "live")]
mod journal;
#[cfg(feature = "parquet")]
mod lerobot;
#[cfg_attr(not(feature = "parquet"), allow(dead_code))]
mod lerobot_map;
mod mapped_csv;
mod mend;
mod movement_folder;
#[cfg(feature = "parquet")]
mod parquet_file;
#[cfg(feature = "parquet")]
mod parquet_lists;
#[cfg(feature = "parquet")]
mod parquet_sizes;
mod rtde_csv;
mod sage_folder;
mod same;
mod scale;
mod table;
mod text;
#[cfg(feature = "parquet")]
mod thrift;
mod whole;

pub use bag::settle_effort;
pub use check::{FEWEST_SAMPLES, JOINT_SIGNALS};
pub use columns::ColumnMap;
pub use draft::{Draft, draft};
pub use error::RecordingError;
pub use format::{Format, WriteOptions};
pub use formats::{FORMATS, read, read_by, read_unfinished, write, writer};
#[cfg(feature = "live")]
pub use journal::{JOURNALED, Journal, journal_of, journaled};
pub use rtde_csv::write_csv;
pub use same::refuse_same;
pub use text::Delimiter;

use crate::series::JointSeries;

/// Named columns of equal length. RTDE names (`actual_q_0` .. `actual_q_5`, `actual_current_*`).
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// s, strictly increasing.
    pub time: Vec<f64>,
    /// In the order of the file; the time column is not among them.
    pub channels: Vec<Channel>,
    pub provenance: Provenance,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// With the joint index at its end: `actual_q_0`.
    pub name: String,
    /// `Recording::time.len()` values, all finite.
    pub values: Vec<f64>,
}

/// Where a recording came from and what was done to it while reading.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize)]
pub struct Provenance {
    /// Path as the user gave it, or the scenario.
    pub source: String,
    /// For example "RTDE CSV, comma".
    pub format: String,
    /// What a reader dropped or mended, one sentence each ("dropped the cut last line 6887").
    pub notes: Vec<String>,
}

impl Recording {
    pub fn channel(&self, name: &str) -> Option<&[f64]> {
        self.channels.iter().find(|c| c.name == name).map(|c| c.values.as_slice())
    }

    /// `actual_q` -> `actual_q_0`, `actual_q_1`, ... as long as they exist; `None` without any.
    pub fn joints(&self, stem: &str) -> Option<JointSeries> {
        let rows: Vec<Vec<f64>> = (0..)
            .map_while(|j| self.channel(&format!("{stem}_{j}")).map(<[f64]>::to_vec))
            .collect();
        (!rows.is_empty()).then(|| JointSeries::from_joints(&rows))
    }
}

#[cfg(test)]
mod hostile_tests;
#[cfg(test)]
mod tests;
