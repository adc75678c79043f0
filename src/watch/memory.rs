//! The last minutes of rows, for a diagnosis when something changes.

use std::collections::VecDeque;

use crate::recording::{Channel, Provenance, Recording};

/// Rows of at most so many seconds, and never more than so many.
#[derive(Debug, Clone)]
pub struct Memory {
    names: Vec<String>,
    rows: VecDeque<Vec<f64>>,
    keeps_s: f64,
    most: usize,
}

impl Memory {
    /// `columns` are those of the rows, time first.
    pub fn new(columns: &[String], keeps_s: f64, rate_hz: f64) -> Self {
        let most = (1.5 * keeps_s * rate_hz) as usize + 1;
        Self { names: columns[1..].to_vec(), rows: VecDeque::new(), keeps_s, most }
    }

    pub fn add(&mut self, row: &[f64]) {
        match self.rows.back().map(|last| row[0] - last[0]) {
            Some(0.0) => return,
            // Another clock.
            Some(after) if after < 0.0 => self.rows.clear(),
            _ => {}
        }
        self.rows.push_back(row.to_vec());
        let old = row[0] - self.keeps_s;
        while self.rows.len() > self.most || self.rows.front().is_some_and(|row| row[0] < old) {
            self.rows.pop_front();
        }
    }

    /// Time of the last row, s.
    pub fn now(&self) -> Option<f64> {
        self.rows.back().map(|row| row[0])
    }

    /// What is remembered from one time to another, s.
    pub fn between(&self, from_s: f64, to_s: f64) -> Recording {
        let rows: Vec<&Vec<f64>> =
            self.rows.iter().filter(|row| (from_s..=to_s).contains(&row[0])).collect();
        let column = |c: usize| rows.iter().map(|row| row[c]).collect::<Vec<f64>>();
        let channels = self.names.iter().enumerate();
        Recording {
            time: column(0),
            channels: channels
                .map(|(c, name)| Channel { name: name.clone(), values: column(c + 1) })
                .collect(),
            provenance: Provenance { source: "the last minutes".into(), ..Provenance::default() },
        }
    }

    /// Rows that are remembered, at most so many.
    pub fn held(&self) -> (usize, usize) {
        (self.rows.len(), self.most)
    }
}
