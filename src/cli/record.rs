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
use crate::live::{Feed, LiveError, News, Pace, Recorded, Recorder};
use crate::recording::JOURNALED;

/// Record what a robot's controller streams (RTDE), or a file that is being written
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin record --from rtde://192.168.0.10 --rate 125 --seconds 60 -o run.parquet
  armtwin record --from rtde://192.168.0.10 --rate 500 --reconnect -o day.parquet
  armtwin record --from bag.mcap --follow -o run.csv

Rows go to run.parquet.part.csv as they come, which is a recording at any moment, also after the program was killed \
or the power failed (all but the last second of it): read it as it is, or `armtwin convert` it. At the end, by \
--seconds or Ctrl-C, it becomes run.parquet. Before a recording has more rows than armtwin reads (83 minutes at 1 kHz \
with few columns, 53 at 500 Hz with the usual ones) it goes on in run.2.parquet. Gaps in the controller's clock stay \
gaps.")]
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
    let source = &args.source;
    let mut recorder = Recorder::begin(&args.out, source.name(), source.rate, &names)?;
    let ended = take_all(&mut recorder, &feed, args.seconds, &stop);
    let done = Done::new(recorder.end()?, feed.lost());
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

/// What is done now and then. Time counts from when it was done: between two syncs of a slow disk there is
/// time to take all rows that came meanwhile.
struct Now {
    every: Duration,
    last: Instant,
}

impl Now {
    fn is_due(&self) -> bool {
        self.last.elapsed() >= self.every
    }

    fn done(&mut self) {
        self.last = Instant::now();
    }
}

/// Until the source ends, time is up or somebody stops it.
fn take_all(
    recorder: &mut Recorder,
    feed: &Feed,
    seconds: Option<f64>,
    stop: &Arc<AtomicBool>,
) -> anyhow::Result<()> {
    let spinner = std::io::stderr().is_terminal().then(|| progress::spinner("recording"));
    let [mut hands_over, mut settles, mut tells] =
        [HANDS_OVER, SETTLES, TELLS].map(|every| Now { every, last: Instant::now() });
    let mut stopped = false;
    loop {
        feed.pause(TOGGLES.load(Ordering::Relaxed) % 2 == 1);
        match feed.next(HANDS_OVER / 2) {
            Some(News::Row(row)) if !stopped => {
                if let Some(note) = recorder.add(&row)? {
                    eprintln!("note: {note}");
                }
            }
            Some(News::Note(note)) => match &spinner {
                Some(spinner) => spinner.println(note),
                None => eprintln!("{note}"),
            },
            Some(News::End(ended)) => {
                if let Some(spinner) = spinner {
                    spinner.finish_and_clear();
                }
                // Somebody wanted it to end: how the other side took it is no matter.
                return if stopped { Ok(()) } else { ended.map_err(|e| cut(recorder, &e)) };
            }
            _ => {}
        }
        let over = seconds.is_some_and(|s| recorder.length_s() >= s - 1e-9);
        if !stopped && (over || stop.load(Ordering::Relaxed)) {
            stopped = true;
            feed.stop();
        }
        if settles.is_due() {
            recorder.settle()?;
            settles.done();
        } else if hands_over.is_due() {
            recorder.hand_over()?;
            hands_over.done();
        }
        if tells.is_due()
            && let Some(spinner) = &spinner
        {
            spinner.set_message(state(recorder, feed));
            tells.done();
        }
    }
}

fn cut(recorder: &Recorder, error: &LiveError) -> anyhow::Error {
    anyhow::anyhow!("{error}\nwhat came before is recorded ({:.1} s)", recorder.length_s())
}

fn state(recorder: &Recorder, feed: &Feed) -> String {
    let lost = match feed.lost() {
        0 => String::new(),
        n => format!(", {n} rows dropped: the disk is too slow"),
    };
    format!("{} rows, {:.0} s{lost}", recorder.rows(), recorder.length_s())
}

impl Done {
    fn new(recorded: Recorded, dropped: u64) -> Self {
        let Recorded { files, rows, seconds, gaps } = recorded;
        Self {
            files,
            rows,
            seconds,
            dropped,
            gaps: gaps.count,
            longest_gap_s: gaps.longest_s,
            missing_rows: gaps.missing,
            repeated_rows: gaps.repeated,
            words: gaps.words().into_iter().collect(),
        }
    }

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
