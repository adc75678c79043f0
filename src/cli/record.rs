//! `armtwin record`: what an arm streams, into a file that is whole at any moment.

use std::io::{BufRead, IsTerminal};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use anyhow::bail;

use super::outputs::Output;
use super::source::{SourceArgs, columns, seconds};
use super::{interrupt, progress, save};
use crate::files;
use crate::limits::{NUMBERS, ROWS};
use crate::live::{Feed, Gaps, LiveError, News, Pace, Step};
use crate::recording::{JOURNALED, Journal, RecordingError, journal_of};

/// Record what a robot's controller streams (RTDE), or a file that is being written
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin record --from rtde://192.168.0.10 --rate 125 --seconds 60 -o run.parquet
  armtwin record --from rtde://192.168.0.10 --rate 500 --reconnect -o day.parquet
  armtwin record --from bag.mcap --follow -o run.csv

Rows go to run.parquet.part.csv as they come, which is a recording at any moment, also after the
program was killed or the power failed (all but the last second of it): read it as it is, or
`armtwin convert` it. At the end, by --seconds or Ctrl-C, it becomes run.parquet. Before a recording has more
rows than armtwin reads (83 minutes at 1 kHz with few columns, 53 at 500 Hz with the usual ones) it goes on in
run.2.parquet. Gaps in the controller's clock stay gaps.")]
pub struct Args {
    #[command(flatten)]
    source: SourceArgs,
    /// File to write: .parquet, .csv or .csv.gz
    #[arg(short, long, value_name = "FILE")]
    out: Output,
    /// Stop after so many seconds of the controller's clock [default: when the source ends]
    #[arg(long, value_name = "S", value_parser = seconds)]
    seconds: Option<f64>,
    /// Quantities of RTDE to ask for [default: the usual ones]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    fields: Vec<String>,
    /// Every line on standard input (Enter) asks the controller to pause, or to go on
    #[arg(long)]
    pause_by_enter: bool,
    /// Write what was recorded, lost and missing as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

/// How often rows are handed over to the system, and to the disk.
const HANDS_OVER: Duration = Duration::from_millis(200);
const SETTLES: Duration = Duration::from_secs(1);
/// How often a terminal is told.
const TELLS: Duration = Duration::from_millis(500);

pub fn run(args: &Args) -> anyhow::Result<()> {
    let stop = interrupt::flag();
    if files::is_stream(&args.out) || !journaled(&args.out) {
        bail!(
            "-o {}: a recording is made as {}; `armtwin convert` makes other formats of it",
            args.out.display(),
            JOURNALED.join(", ")
        );
    }
    let feed = args.source.open(&args.fields, Pace::AsFastAsItGoes)?;
    let Some(names) = columns(&feed, &stop)? else { bail!("stopped before the first row") };
    if args.pause_by_enter {
        listen_to_lines()?;
    }
    let mut making = Making::begin(args, &names)?;
    let ended = making.take_all(&feed, args.seconds, &stop);
    let done = making.end(&feed)?;
    done.print(&args.source);
    args.json.as_ref().map_or(Ok(()), |path| save::json(path, "armtwin.record/1", &done))?;
    // What came is kept and said; that it was cut is a failure all the same.
    ended
}

fn journaled(path: &Path) -> bool {
    let name = path.to_string_lossy().to_lowercase();
    JOURNALED.iter().any(|end| name.ends_with(end))
}

static TOGGLES: std::sync::atomic::AtomicU64 = std::sync::atomic::AtomicU64::new(0);

fn listen_to_lines() -> anyhow::Result<()> {
    std::thread::Builder::new().name("keys".into()).spawn(|| {
        for line in std::io::stdin().lock().lines() {
            if line.is_err() {
                break;
            }
            TOGGLES.fetch_add(1, Ordering::Relaxed);
        }
    })?;
    Ok(())
}

/// What a recording came to.
#[derive(Debug, serde::Serialize)]
struct Done {
    files: Vec<PathBuf>,
    rows: u64,
    seconds: f64,
    /// Rows that found no room in the queue, for the disk was too slow.
    dropped: u64,
    /// In the controller's clock.
    gaps: u64,
    longest_gap_s: f64,
    missing_rows: u64,
    repeated_rows: u64,
    #[serde(skip)]
    words: Vec<String>,
}

/// A recording in the making; the next file begins where one is full.
struct Making<'a> {
    args: &'a Args,
    names: Vec<String>,
    journal: Option<Journal>,
    /// Of files that are full, and are being turned into what was asked for.
    finishing: Vec<std::thread::JoinHandle<Result<PathBuf, RecordingError>>>,
    parts: u64,
    rows: u64,
    gaps: Gaps,
    first: Option<f64>,
    last: f64,
    recorded_s: f64,
}

impl<'a> Making<'a> {
    fn begin(args: &'a Args, columns: &[String]) -> anyhow::Result<Self> {
        let [time, names @ ..] = columns else {
            bail!("{}: it has no columns", args.source.name())
        };
        if time != "timestamp" {
            bail!(
                "{}: its first column is {time}, where timestamp is expected",
                args.source.name()
            );
        }
        let mut making = Self {
            args,
            names: names.to_vec(),
            journal: None,
            finishing: Vec::new(),
            parts: 0,
            rows: 0,
            gaps: Gaps::new(args.source.rate),
            first: None,
            last: 0.0,
            recorded_s: 0.0,
        };
        making.next_file()?;
        Ok(making)
    }

    /// Begins the next file; the one before is finished meanwhile.
    fn next_file(&mut self) -> anyhow::Result<()> {
        self.finish_file()?;
        self.parts += 1;
        let path = numbered(&self.args.out, self.parts);
        files::may_write(&path)
            .map_err(|refused| anyhow::anyhow!("{}: {refused}", path.display()))?;
        self.journal = Some(Journal::begin(&path, &self.names)?);
        Ok(())
    }

    fn finish_file(&mut self) -> anyhow::Result<()> {
        if let Some(journal) = self.journal.take() {
            let source = self.args.source.name().to_string();
            let work = std::thread::Builder::new().name("finishes".into());
            self.finishing.push(work.spawn(move || journal.end(&source))?);
        }
        Ok(())
    }

    fn is_full(&self) -> bool {
        let rows = self.journal.as_ref().map_or(0, Journal::rows);
        rows >= ROWS.most || rows * (self.names.len() as u64 + 1) >= NUMBERS.most - 1_000_000
    }

    /// Until the source ends, time is up or somebody stops it.
    fn take_all(
        &mut self,
        feed: &Feed,
        seconds: Option<f64>,
        stop: &Arc<AtomicBool>,
    ) -> anyhow::Result<()> {
        let spinner = std::io::stderr().is_terminal().then(|| progress::spinner("recording"));
        let mut clocks = [Instant::now(); 3];
        let mut due = |which: usize, every: Duration| {
            let now = clocks[which].elapsed() >= every;
            if now {
                clocks[which] = Instant::now();
            }
            now
        };
        let mut stopped = false;
        loop {
            feed.pause(TOGGLES.load(Ordering::Relaxed) % 2 == 1);
            match feed.next(HANDS_OVER / 2) {
                Some(News::Row(row)) if !stopped => self.add(&row)?,
                Some(News::Note(note)) => match &spinner {
                    Some(spinner) => spinner.println(note),
                    None => eprintln!("{note}"),
                },
                Some(News::End(ended)) => {
                    if let Some(spinner) = spinner {
                        spinner.finish_and_clear();
                    }
                    // Somebody wanted it to end: how the other side took it is no matter.
                    return if stopped { Ok(()) } else { ended.map_err(|e| self.cut(&e)) };
                }
                _ => {}
            }
            let over = seconds.is_some_and(|s| self.length_s() >= s - 1e-9);
            if !stopped && (over || stop.load(Ordering::Relaxed)) {
                stopped = true;
                feed.stop();
            }
            if let Some(journal) = &mut self.journal {
                if due(1, SETTLES) {
                    journal.settle()?;
                } else if due(0, HANDS_OVER) {
                    journal.hand_over()?;
                }
            }
            if due(2, TELLS)
                && let Some(spinner) = &spinner
            {
                spinner.set_message(self.state(feed));
            }
        }
    }

    fn cut(&self, error: &LiveError) -> anyhow::Error {
        anyhow::anyhow!("{error}\nwhat came before is recorded ({:.1} s)", self.length_s())
    }

    fn length_s(&self) -> f64 {
        self.recorded_s + self.first.map_or(0.0, |first| self.last - first)
    }

    fn state(&self, feed: &Feed) -> String {
        let lost = match feed.lost() {
            0 => String::new(),
            n => format!(", {n} rows dropped: the disk is too slow"),
        };
        format!("{} rows, {:.0} s{lost}", self.rows, self.length_s())
    }

    fn add(&mut self, row: &[f64]) -> anyhow::Result<()> {
        let time = row[0];
        match self.gaps.step(time) {
            // A row that came twice.
            Step::Back(0.0) => return Ok(()),
            Step::Back(by) => {
                eprintln!(
                    "note: the controller's clock went back by {by:.3} s: the recording goes on in a new file"
                );
                self.recorded_s = self.length_s();
                self.first = None;
                self.next_file()?;
            }
            _ => {}
        }
        if self.is_full() {
            self.next_file()?;
        }
        self.first.get_or_insert(time);
        self.last = time;
        self.rows += 1;
        match &mut self.journal {
            Some(journal) => Ok(journal.add(row)?),
            None => Ok(()),
        }
    }

    fn end(mut self, feed: &Feed) -> anyhow::Result<Done> {
        if self.rows == 0 {
            if let Some(journal) = self.journal.take() {
                let left = journal_of(journal.path());
                drop(journal);
                std::fs::remove_file(left)?;
            }
            bail!("{}: not one row came", self.args.source.name());
        }
        let seconds = self.length_s();
        self.finish_file()?;
        let mut files = Vec::new();
        for work in self.finishing {
            let finished =
                work.join().map_err(|_| anyhow::anyhow!("a file could not be finished"))?;
            files.push(finished?);
        }
        Ok(Done {
            files,
            rows: self.rows,
            seconds,
            dropped: feed.lost(),
            gaps: self.gaps.count,
            longest_gap_s: self.gaps.longest_s,
            missing_rows: self.gaps.missing,
            repeated_rows: self.gaps.repeated,
            words: self.gaps.words().into_iter().collect(),
        })
    }
}

/// `run.parquet`, `run.2.parquet`, ...
fn numbered(path: &Path, part: u64) -> PathBuf {
    if part == 1 {
        return path.into();
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let end = JOURNALED.iter().rev().find(|end| name.to_lowercase().ends_with(*end));
    let (stem, end) = name.split_at(name.len() - end.map_or(0, |e| e.len()));
    path.with_file_name(format!("{stem}.{part}{end}"))
}

impl Done {
    fn print(&self, source: &SourceArgs) {
        let files: Vec<String> = self.files.iter().map(|f| f.display().to_string()).collect();
        println!(
            "{}: {} rows, {:.3} s of {}",
            files.join(", "),
            self.rows,
            self.seconds,
            source.name()
        );
        self.words.iter().for_each(|words| println!("{words}"));
        match self.dropped {
            0 => println!("no row was dropped here"),
            n => println!("{n} rows were dropped here, for the disk was slower than they came"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn further_files_are_numbered_before_the_extension() {
        let name = |path: &str, part| numbered(Path::new(path), part).display().to_string();
        assert_eq!(name("a/run.parquet", 1), "a/run.parquet");
        assert_eq!(name("a/run.parquet", 2), "a/run.2.parquet");
        assert_eq!(name("run.csv.gz", 12), "run.12.csv.gz");
    }
}
