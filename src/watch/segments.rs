//! Rows as they come -> short recordings with margins, for the conditioning that a diagnosis uses.

use std::collections::VecDeque;
use std::ops::Range;

use super::WatchError;
use crate::recording::{Channel, JOINT_SIGNALS, Provenance, Recording};

/// What a segment adds to what was seen, s.
pub const HOP_S: f64 = 2.0;
/// Beside it on both sides, s: more than the margin that conditioning leaves out.
pub const MARGIN_S: f64 = 0.6;
/// Time that is missing for longer begins anew, s: the margins could not bridge it.
const BREAK_S: f64 = 0.5;
/// Rows of a segment at most; a clock that stands still makes no segment.
const MOST_ROWS: usize = 20_000;

/// A stretch of rows, and which of its time (s) is new.
pub struct Segment {
    pub recording: Recording,
    pub core: Range<f64>,
}

/// Rows that are not done with.
pub struct Segments {
    names: Vec<String>,
    /// Which columns are kept, time first.
    kept: Vec<usize>,
    rows: VecDeque<Vec<f64>>,
    /// Up to when all is seen, s.
    seen: Option<f64>,
}

impl Segments {
    /// # Errors
    /// If the rows do not begin with time.
    pub fn new(columns: &[String]) -> Result<Self, WatchError> {
        match columns.first().map(String::as_str) {
            Some("timestamp") => {}
            other => return Err(WatchError::NoTime(other.unwrap_or("nothing").into())),
        }
        let signal = |name: &str| {
            name.rsplit_once('_').is_some_and(|(stem, _)| JOINT_SIGNALS.contains(&stem))
        };
        let kept: Vec<usize> =
            (0..columns.len()).filter(|&c| c == 0 || signal(&columns[c])).collect();
        let names = kept[1..].iter().map(|&c| columns[c].clone()).collect();
        Ok(Self { names, kept, rows: VecDeque::new(), seen: None })
    }

    /// Takes a row; a segment when there is a whole one.
    pub fn add(&mut self, row: &[f64]) -> Option<Segment> {
        let time = row[0];
        let after = self.rows.back().map(|last| time - last[0]);
        match after {
            // A row that came twice.
            Some(0.0) => return None,
            Some(after) if !(0.0..=BREAK_S).contains(&after) || self.rows.len() > MOST_ROWS => {
                self.rows.clear();
                self.seen = None;
            }
            _ => {}
        }
        self.rows.push_back(self.kept.iter().map(|&c| row[c]).collect());
        let first = self.rows.front()?[0];
        let begins = self.seen.unwrap_or(first + MARGIN_S);
        if time < begins + HOP_S + MARGIN_S {
            return None;
        }
        let core = begins..begins + HOP_S;
        let segment = Segment { recording: self.recording(), core: core.clone() };
        self.seen = Some(core.end);
        while self.rows.front().is_some_and(|row| row[0] < core.end - MARGIN_S) {
            self.rows.pop_front();
        }
        Some(segment)
    }

    fn recording(&self) -> Recording {
        let column = |c: usize| self.rows.iter().map(|row| row[c]).collect::<Vec<f64>>();
        let channels = self.names.iter().enumerate();
        Recording {
            time: column(0),
            channels: channels
                .map(|(c, name)| Channel { name: name.clone(), values: column(c + 1) })
                .collect(),
            provenance: Provenance { source: "rows as they come".into(), ..Provenance::default() },
        }
    }

    /// Numbers that wait.
    pub fn held(&self) -> usize {
        self.rows.len() * self.kept.len()
    }
}
