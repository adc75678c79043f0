//! A row a minute for weeks, and what changed.

use std::io::Write;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use anyhow::Context;
use serde_json::Value;

use crate::files::Growing;
use crate::recording::Journal;
use crate::twin::Twin;
use crate::watch::{Seen, Watch};

/// Changes, answers and notes of all that was watched into a folder, a JSON object a line.
pub const EVENTS: &str = "events.jsonl";

/// Between rows, s.
const EVERY_S: f64 = 60.0;

/// Name of a column, from the joint (from 0).
pub fn column(what: &str, joint: usize) -> String {
    format!("{what}_{joint}")
}

pub struct History {
    rows: Journal,
    events: Growing,
    begun: Option<f64>,
    last: Option<f64>,
}

impl History {
    /// Begins a file in a folder, which is made if need be.
    pub fn begin(dir: &Path, twin: &Twin) -> anyhow::Result<Self> {
        std::fs::create_dir_all(dir).with_context(|| format!("cannot make {}", dir.display()))?;
        let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
        let date = crate::numbers::day(now as f64);
        let name = format!("watch-{date}-{:05}.parquet", now % 86400);
        let of = |what: &'static str| (0..twin.robot.dof()).map(move |j| column(what, j));
        let mut names: Vec<String> = of("gap_nm")
            .chain(of("level_nm"))
            .chain(of("along_nm"))
            .chain(of("temperature_c"))
            .collect();
        names.push("flange_force_n".into());
        let events = dir.join(EVENTS);
        let opened = Growing::go_on(&events);
        Ok(Self {
            rows: Journal::begin(&dir.join(name), &names)?,
            events: opened.with_context(|| format!("cannot write {}", events.display()))?,
            begun: None,
            last: None,
        })
    }

    /// Adds a row if a minute has passed.
    pub fn add(&mut self, watch: &Watch, time: f64, seen: &Seen) -> anyhow::Result<()> {
        if self.last.is_some_and(|last| time - last < EVERY_S) {
            return Ok(());
        }
        let (figures, joints) = (watch.figures(), 0..watch.figures().joints());
        // The first row waits for all joints to have moved, as long as a row is.
        let begun = *self.begun.get_or_insert(time);
        let moved = joints.clone().all(|j| figures.now(j)[0].is_some());
        if self.last.is_none() && !moved && time - begun < EVERY_S {
            return Ok(());
        }
        self.last = Some(time);
        let level = figures.level();
        let mut row = vec![time];
        // What never moved has no gap.
        row.extend(joints.clone().map(|j| figures.now(j)[0].map_or(0.0, |f| f.rms_nm)));
        row.extend(joints.clone().map(|j| level.0[j][0].map_or(0.0, |f| f.rms_nm)));
        row.extend(joints.clone().map(|j| figures.now(j)[0].map_or(0.0, |f| f.along_nm)));
        let temperature = seen.stretch.temperature_c.as_ref();
        row.extend(joints.map(|j| temperature.map_or(0.0, |t| t[j])));
        row.push(watch.flange().force().map_or(0.0, |f| f.norm()));
        self.rows.add(&row)?;
        Ok(self.rows.hand_over()?)
    }

    pub fn event(&mut self, event: &Value) -> anyhow::Result<()> {
        writeln!(self.events, "{event}")?;
        Ok(self.events.hand_over()?)
    }

    /// Where it is.
    pub fn end(self) -> anyhow::Result<String> {
        let path = self.rows.end("armtwin watch")?;
        let dir = crate::files::guard::folder_of(&path).display().to_string();
        Ok(format!("{}: a row a minute; armtwin history {dir}", path.display()))
    }
}
