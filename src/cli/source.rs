//! `--from`: where rows come from as they come.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, bail};

use crate::live::{Feed, News, Pace, Reconnect, RtdeSource, WELCOME, follow, replay};
use crate::recording::{self, ColumnMap};
use crate::rtde::{self, Wish};

/// What every command that takes rows as they come takes with it.
#[derive(clap::Args, Clone)]
pub struct SourceArgs {
    /// Where rows come from: rtde://HOST[:PORT], or a recording
    #[arg(long, value_name = "SOURCE")]
    from: String,
    /// Rows per second that a controller is asked for
    #[arg(long, value_name = "HZ", default_value_t = 125.0, value_parser = rate)]
    pub rate: f64,
    /// The file is still being written: take what is there and what comes, until Ctrl-C
    #[arg(long)]
    follow: bool,
    /// Connect again, every second, after a connection broke
    #[arg(long)]
    reconnect: bool,
    /// Column map (TOML) of a recording without RTDE names, or of a bag; `armtwin map` drafts one [default: RTDE names]
    #[arg(long, value_name = "MAP.toml")]
    columns: Option<PathBuf>,
}

fn rate(text: &str) -> Result<f64, String> {
    let hz = text.trim().trim_end_matches("Hz").trim().parse::<f64>().ok();
    let hz = hz.filter(|hz| (1.0..=1000.0).contains(hz));
    hz.ok_or("give rows per second, 1 to 1000; controllers send 125 or 500 at most".into())
}

/// A number of seconds, with or without an `s`.
pub fn seconds(text: &str) -> Result<f64, String> {
    let number = text.trim().trim_end_matches('s').trim().parse::<f64>().ok();
    number
        .filter(|s| s.is_finite() && *s >= 0.0)
        .ok_or("give seconds, for example 60 or 60s".into())
}

impl SourceArgs {
    /// The controller, if it is one.
    pub fn controller(&self) -> Option<&str> {
        self.from.strip_prefix("rtde://").map(|rest| rest.trim_end_matches('/'))
    }

    pub fn name(&self) -> &str {
        &self.from
    }

    /// Whether rows come as they are made.
    pub fn is_live(&self) -> bool {
        self.controller().is_some() || self.follow
    }

    /// Begins to read. `fields` are what a controller is asked for, where the usual ones are not wanted.
    ///
    /// # Errors
    /// If the flags do not go together, or a file cannot be read.
    pub fn open(&self, fields: &[String], pace: Pace) -> anyhow::Result<Feed> {
        match self.controller() {
            Some(host) => self.talk(host, fields),
            None if self.from.contains("://") => {
                bail!("--from {}: only rtde://HOST[:PORT] and files are read", self.from)
            }
            None if self.reconnect => {
                bail!("--reconnect is for rtde:// sources; follow a file with --follow")
            }
            None if !fields.is_empty() => {
                bail!("--fields is for rtde:// sources; a file has its own columns")
            }
            None => self.read(pace),
        }
    }

    fn read(&self, pace: Pace) -> anyhow::Result<Feed> {
        let path = Path::new(&self.from);
        crate::files::guard::reads(path);
        let map = self.columns.as_deref().map(ColumnMap::load).transpose()?;
        if self.follow {
            if !path.is_file() {
                bail!("{}: no such file; name the one that is being written", self.from);
            }
            return Ok(follow(path, map)?);
        }
        Ok(replay(recording::read_by(path, map.as_ref())?, pace)?)
    }

    fn talk(&self, host: &str, fields: &[String]) -> anyhow::Result<Feed> {
        if self.follow || self.columns.is_some() {
            bail!("--follow and --columns are for files, --from {} is a controller", self.from);
        }
        let names = |list: &[&str]| list.iter().map(ToString::to_string).collect::<Vec<_>>();
        let mut wish =
            Wish { rate_hz: self.rate, needed: names(&["timestamp"]), welcome: names(&WELCOME) };
        if !fields.is_empty() {
            wish.welcome.clear();
            wish.needed.extend(fields.iter().filter(|f| *f != "timestamp").cloned());
            if let Some(unknown) = fields.iter().find(|f| !rtde::is_known(f)) {
                eprintln!(
                    "note: {unknown} is none of the quantities of RTDE known here; asked for all the same"
                );
            }
        }
        let address = with_port(host).with_context(|| format!("--from {}", self.from))?;
        let reconnect = if self.reconnect { Reconnect::Always } else { Reconnect::Never };
        Ok(RtdeSource { address, wish, reconnect }.open()?)
    }
}

/// `HOST`, `HOST:PORT`, `[::1]`, `[::1]:PORT`.
fn with_port(host: &str) -> anyhow::Result<String> {
    let bracketed = host.starts_with('[');
    let ported = if bracketed { host.contains("]:") } else { host.contains(':') };
    let address = if ported { host.to_string() } else { format!("{host}:{}", rtde::PORT) };
    let port = address.rsplit(':').next().map(str::parse::<u16>);
    let name = address.rsplit_once(':').map_or("", |(name, _)| name);
    match port {
        Some(Ok(_)) if !name.is_empty() && (bracketed || !name.contains(':')) => Ok(address),
        _ => bail!("write rtde://HOST or rtde://HOST:PORT, for example rtde://192.168.0.10"),
    }
}

/// Waits for the columns, saying notes meanwhile.
///
/// # Errors
/// If the source ends before.
pub fn columns(
    feed: &Feed,
    stop: &std::sync::atomic::AtomicBool,
) -> anyhow::Result<Option<Vec<String>>> {
    loop {
        match feed.next(Duration::from_millis(50)) {
            Some(News::Columns(names)) => return Ok(Some(names)),
            Some(News::Note(note)) => eprintln!("{note}"),
            Some(News::End(ended)) => {
                ended.map_err(anyhow::Error::from)?;
                return Ok(None);
            }
            Some(News::Row(_)) | None => {}
        }
        if stop.load(std::sync::atomic::Ordering::Relaxed) {
            return Ok(None);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::with_port;

    #[test]
    fn a_controller_has_the_usual_port_unless_told_otherwise() {
        for (given, address) in [
            ("robot", "robot:30004"),
            ("10.0.0.5:31000", "10.0.0.5:31000"),
            ("[::1]", "[::1]:30004"),
            ("[::1]:30", "[::1]:30"),
        ] {
            assert_eq!(with_port(given).unwrap(), address);
        }
        for bad in ["", ":30004", "robot:port", "robot:99999", "fe80::1"] {
            assert!(with_port(bad).unwrap_err().to_string().contains("rtde://HOST:PORT"), "{bad}");
        }
    }
}
