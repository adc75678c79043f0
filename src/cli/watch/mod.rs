//! `armtwin watch`: the gap while the arm moves, and a word when it changes.

mod background;
mod clock;
mod history;
mod lines;
mod screen;

pub(super) use history::{EVENTS, column};

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use anyhow::{Context, bail};

use self::background::Background;
use self::clock::Clock;
use self::history::History;
use self::lines::Lines;
use self::screen::Screen;
use super::outputs::Output;
use super::source::{SourceArgs, columns, seconds};
use super::stream::{Deliveries, StreamArgs, Watched};
use super::twin::{Arm, ArmArgs};
use super::{compare, interrupt};
use crate::diagnosis::conditioning;
use crate::live::{Feed, Gaps, News, Pace};
use crate::numbers;
use crate::recording;
use crate::signals::condition;
use crate::twin::Twin;
use crate::watch::{Answer, Memory, Seen, Settings, Watch};

/// Watch the gap between arm and twin while the arm works, and say when it changes, and why
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin watch --twin twin.toml --from rtde://192.168.0.10 --history watched
  armtwin watch --twin twin.toml --from run.csv --follow
  armtwin watch --twin twin.toml --from day.parquet --fast --json - | jq .kind

Predicted against measured torque, joint by joint and regime by regime: how large the gap is now (exponentially \
weighted) beside the level the twin left of the recording it was fitted on (--fitted-on), or in the first minutes. \
When a joint's gap changes, that is said at once with the time since when; a minute later the minutes before and \
after are diagnosed in the background, and what is new in them is named. A joint has to slide for \
48 s before a change of it can be noticed, in that recording (--fitted-on) or here: what is there from the begin on is \
taken for usual. --false-alarm-every states how often that may happen \
without a change; docs/alarms.md has what was measured. Without a terminal a line a minute is printed.")]
pub struct Args {
    #[command(flatten)]
    arm: ArmArgs,
    #[command(flatten)]
    source: SourceArgs,
    /// Recording that the twin was fitted on: the gap it left there is the level, and what is usual [default: the
    /// first minutes]
    #[arg(long, value_name = "RECORDING")]
    fitted_on: Option<PathBuf>,
    /// Mean time between false alarms of all joints together, in hours of motion
    #[arg(long, value_name = "HOURS", default_value_t = 168.0)]
    false_alarm_every: f64,
    /// Play a recording as fast as it goes, not at its own pace
    #[arg(long)]
    fast: bool,
    /// Do not diagnose what changed
    #[arg(long)]
    no_diagnosis: bool,
    /// Stop after so many seconds of the arm's clock [default: when the source ends]
    #[arg(long, value_name = "S", value_parser = seconds)]
    seconds: Option<f64>,
    /// Folder for a file with a row a minute (Parquet) and the changes (events.jsonl), for `armtwin history`
    /// [default: none is kept]
    #[arg(long, value_name = "DIR")]
    history: Option<PathBuf>,
    #[command(flatten)]
    live: StreamArgs,
    /// Write what is seen as JSON, a line every two seconds and at every change; a FILE is FILE.part until the end
    #[arg(long, value_name = "FILE")]
    json: Option<Output>,
}

/// What is remembered for a diagnosis: minutes before a change, and after it, s.
const REMEMBERS_S: f64 = 240.0;

pub fn run(args: &Args) -> anyhow::Result<()> {
    let stop = interrupt::flag();
    let settings = args.settings()?;
    let arm = args.arm.load()?;
    let link = args.live.open()?;
    let pace = if args.fast { Pace::AsFastAsItGoes } else { Pace::Times(1.0) };
    let feed = args.source.open(&[], pace)?;
    let Some(names) = columns(&feed, &stop)? else { bail!("stopped before the first row") };
    let watch = args.watch(&arm, &names, &settings)?;
    let title = format!("watching {}", args.source.name());
    let shown = link.as_ref().map(|link| link.watch(title, &watch.twin().robot)).transpose()?;
    println!("{}", arm.line());
    let mut watching = Watching {
        memory: Memory::new(&names, REMEMBERS_S, args.source.rate),
        clock: args.clock(),
        gaps: Gaps::new(args.source.rate),
        screen: Screen::new(),
        lines: args.json.as_ref().map(Lines::begin).transpose()?,
        history: args
            .history
            .as_deref()
            .map(|dir| History::begin(dir, watch.twin()))
            .transpose()?,
        background: (!args.no_diagnosis).then(|| Background::new(watch.twin().clone())),
        shown,
        first: None,
        last: 0.0,
        changes: 0,
        watch,
    };
    watching.say_what_is_expected();
    let ended = watching.take_all(&feed, args, &stop);
    let shown = watching.end(&feed)?;
    let mut sent = Deliveries::default();
    if let Some(delivery) = shown.map(Watched::end) {
        sent.push(delivery);
    }
    ended?;
    sent.end(link)
}

impl Args {
    fn settings(&self) -> anyhow::Result<Settings> {
        let hours = self.false_alarm_every;
        if !(0.01..=1e6).contains(&hours) {
            bail!("--false-alarm-every {hours}: give hours, 0.01 to 1000000");
        }
        Ok(Settings { false_alarm_every_s: 3600.0 * hours, ..Settings::default() })
    }

    /// Times of day where rows come as they are made; else the recording's own.
    fn clock(&self) -> Clock {
        if self.source.is_live() { Clock::day() } else { Clock::Own }
    }

    fn watch(&self, arm: &Arm, names: &[String], settings: &Settings) -> anyhow::Result<Watch> {
        let Some(path) = &self.fitted_on else {
            return Ok(Watch::new(arm.twin.clone(), names, settings)?);
        };
        let mut fitted_on = recording::read(path, None)?;
        arm.settle(&mut fitted_on)?;
        let twin = self.fitted(arm, &fitted_on).with_context(|| path.display().to_string())?;
        let mut watch = Watch::new(twin, names, settings)?;
        watch.learn(&fitted_on).with_context(|| path.display().to_string())?;
        Ok(watch)
    }

    /// What the twin leaves open is fitted on that recording.
    fn fitted(&self, arm: &Arm, on: &recording::Recording) -> anyhow::Result<Twin> {
        let dof = arm.twin.robot.dof();
        match compare::fit::terms(&arm.twin, self.arm.given())? {
            None => Ok(arm.twin.clone()),
            Some(terms) => {
                let how = conditioning(on, dof);
                let samples = condition(on, &arm.twin.drive, dof, &how)?;
                compare::fit::fit(&arm.twin, &terms, &samples)
            }
        }
    }
}

/// All that goes on while an arm is watched.
struct Watching {
    watch: Watch,
    memory: Memory,
    clock: Clock,
    gaps: Gaps,
    screen: Screen,
    lines: Option<Lines>,
    history: Option<History>,
    background: Option<Background>,
    shown: Option<Watched>,
    first: Option<f64>,
    last: f64,
    changes: u64,
}

impl Watching {
    fn say_what_is_expected(&mut self) {
        let expected = self.watch.detector().expected();
        let hours = expected.every_s / 3600.0;
        self.screen.event(&format!(
            "changes are looked for in {} charts: one false alarm in {} h of motion is expected",
            expected.charts,
            numbers::digits(hours)
        ));
    }

    /// Until the source ends, time is up or somebody stops it.
    fn take_all(&mut self, feed: &Feed, args: &Args, stop: &AtomicBool) -> anyhow::Result<()> {
        let mut stopped = false;
        loop {
            match feed.next(Duration::from_millis(100)) {
                Some(News::Row(row)) if !stopped => self.row(&row)?,
                Some(News::Note(note)) => self.note(&note)?,
                Some(News::End(ended)) => {
                    return if stopped { Ok(()) } else { Ok(ended?) };
                }
                _ => {}
            }
            self.answers()?;
            let length = self.first.map_or(0.0, |first| self.last - first);
            let over = args.seconds.is_some_and(|s| length >= s - 1e-9);
            if !stopped && (over || stop.load(Ordering::Relaxed)) {
                stopped = true;
                feed.stop();
            }
        }
    }

    fn row(&mut self, row: &[f64]) -> anyhow::Result<()> {
        self.gaps.step(row[0]);
        self.first.get_or_insert(row[0]);
        self.last = row[0];
        self.clock.set(row[0]);
        self.memory.add(row);
        let seen = self.watch.row(row)?;
        if let Some(background) = &mut self.background {
            background.look(&self.memory);
        }
        seen.map_or(Ok(()), |seen| self.seen(&seen))
    }

    fn seen(&mut self, seen: &Seen) -> anyhow::Result<()> {
        let time = self.clock.words(self.last);
        self.screen.show(&self.watch, &time, seen, self.clock.of(self.last));
        if let Some(shown) = &mut self.shown {
            shown.see(&seen.stretch);
        }
        if let Some(lines) = &mut self.lines {
            lines.gap(&self.watch, &self.clock, seen)?;
        }
        if let Some(history) = &mut self.history {
            history.add(&self.watch, self.clock.of(self.last), seen)?;
        }
        let Some(alarm) = seen.alarm else { return Ok(()) };
        self.changes += 1;
        let said = format!(
            "{}: the gap of joint {} changed ({}), noticed {}",
            self.clock.words(alarm.since),
            alarm.joint + 1,
            crate::watch::FEATURES[alarm.feature],
            self.clock.words(alarm.noticed)
        );
        self.screen.change(alarm.joint, &self.clock.words(alarm.since));
        self.screen.event(&said);
        let (since, noticed) = (self.clock.of(alarm.since), self.clock.of(alarm.noticed));
        let event = serde_json::json!({
            "kind": "change", "since": since, "noticed": noticed, "joint": alarm.joint + 1,
            "feature": crate::watch::FEATURES[alarm.feature], "more": alarm.more, "says": said,
        });
        self.event(&event)?;
        if let Some(background) = &mut self.background {
            background.change(alarm);
        }
        Ok(())
    }

    /// What diagnoses in the background came to.
    fn answers(&mut self) -> anyhow::Result<()> {
        let Some(background) = &mut self.background else { return Ok(()) };
        let Some(answer) = background.answer() else { return Ok(()) };
        match answer {
            Ok(answer) => self.told(&answer),
            Err(why) => self.note(&format!("what changed could not be diagnosed: {why}")),
        }
    }

    fn told(&mut self, answer: &Answer) -> anyhow::Result<()> {
        let alarm = answer.alarm;
        let now = self.watch.figures().now(alarm.joint);
        let level = self.watch.figures().level();
        let what = alarm.words(&now, &level.0[alarm.joint]);
        let said = format!("since {} {what}: {}", self.clock.words(alarm.since), answer.says);
        self.screen.event(&said);
        let event = serde_json::json!({
            "kind": "answer", "since": self.clock.of(alarm.since), "joint": alarm.joint + 1,
            "says": said, "causes": answer.causes,
        });
        self.event(&event)
    }

    fn note(&mut self, note: &str) -> anyhow::Result<()> {
        self.screen.event(note);
        self.event(
            &serde_json::json!({ "kind": "note", "says": note, "time": self.clock.of(self.last) }),
        )
    }

    fn event(&mut self, event: &serde_json::Value) -> anyhow::Result<()> {
        if let Some(lines) = &mut self.lines {
            lines.put(event)?;
        }
        match &mut self.history {
            Some(history) => history.event(event),
            None => Ok(()),
        }
    }

    /// Waits for the diagnosis that is under way, and says what all of it was.
    fn end(mut self, feed: &Feed) -> anyhow::Result<Option<Watched>> {
        if let Some(background) = &mut self.background {
            background.look_for_the_last_time(&self.memory);
            background.wait();
        }
        self.answers()?;
        if let Some(words) = self.gaps.words() {
            self.note(&words)?;
        }
        if feed.lost() > 0 {
            self.note(&format!(
                "{} rows were dropped: this machine was too slow for them",
                feed.lost()
            ))?;
        }
        let length = self.first.map_or(0.0, |first| self.last - first);
        self.screen.end(&self.watch, length, self.changes);
        if let Some(lines) = self.lines.take() {
            lines.end()?;
        }
        if let Some(history) = self.history.take() {
            println!("{}", history.end()?);
        }
        Ok(self.shown.take())
    }
}
