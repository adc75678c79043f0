//! What other programs read: a JSON object a line.

use std::fs::OpenOptions;
use std::io::Write;
use std::path::PathBuf;

use anyhow::Context;
use serde_json::{Value, json};

use super::Clock;
use crate::cli::outputs::Output;
use crate::files::{self, Growing};
use crate::watch::{Figure, REGIMES, Seen, Watch};

pub struct Lines {
    out: Box<dyn Write>,
    /// A file gets its name at the end.
    file: Option<(PathBuf, PathBuf)>,
}

impl Lines {
    pub fn begin(path: &Output) -> anyhow::Result<Self> {
        let cannot = || format!("cannot write {}", path.display());
        if files::is_stdout(path) {
            return Ok(Self { out: Box::new(std::io::stdout()), file: None });
        }
        if files::is_stream(path) {
            let opened = OpenOptions::new().append(true).open(path).with_context(cannot)?;
            return Ok(Self { out: Box::new(opened), file: None });
        }
        let mut part = path.as_os_str().to_owned();
        part.push(".part");
        let part = PathBuf::from(part);
        let grows =
            Growing::begin(&part).with_context(|| format!("cannot write {}", part.display()))?;
        Ok(Self { out: Box::new(grows), file: Some((part, path.to_path_buf())) })
    }

    pub fn put(&mut self, line: &Value) -> anyhow::Result<()> {
        let mut line = line.clone();
        line["schema"] = "armtwin.watch/1".into();
        let put = writeln!(self.out, "{line}").and_then(|()| self.out.flush());
        match put {
            // Who has seen enough is no error; the watching goes on.
            Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => {
                self.out = Box::new(std::io::sink());
                Ok(())
            }
            put => put.context("cannot write what is seen"),
        }
    }

    pub fn gap(&mut self, watch: &Watch, clock: &Clock, seen: &Seen) -> anyhow::Result<()> {
        let figures = watch.figures();
        let level = figures.level();
        let all = |of: &[Option<Figure>; REGIMES.len()]| -> Value {
            let pairs = REGIMES.iter().zip(of).filter_map(|(name, f)| f.map(|f| (*name, f)));
            pairs
                .map(|(name, f)| (name.to_string(), json!(f)))
                .collect::<serde_json::Map<_, _>>()
                .into()
        };
        let joint = |j: usize| json!({ "joint": j + 1, "now": all(&figures.now(j)), "level": all(&level.0[j]) });
        let joints: Vec<Value> = (0..figures.joints()).map(joint).collect();
        let force = watch.flange().force().map(|f| [f.x, f.y, f.z]);
        let time = seen.stretch.time.last().map(|t| clock.of(*t));
        self.put(&json!({
            "kind": "gap", "time": time, "joints": joints, "level_known": figures.knows_level(),
            "flange_force_n": force, "temperature_c": seen.stretch.temperature_c,
        }))
    }

    pub fn end(mut self) -> anyhow::Result<()> {
        self.out.flush()?;
        drop(self.out);
        let Some((part, path)) = self.file else { return Ok(()) };
        let done = Growing::go_on(&part).and_then(|grows| grows.becomes(&path));
        done.with_context(|| format!("cannot write {}", path.display()))
    }
}
