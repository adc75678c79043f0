//! Progress of long work; bars hide themselves where standard error is not a terminal.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};

use super::interrupt;
use crate::follow::Watch;

/// Follows the jobs of the program: a bar for what is being done, notes and warnings on standard error.
#[derive(Default)]
pub struct Progress {
    shown: Mutex<Option<(&'static str, ProgressBar)>>,
    /// Raised by Ctrl-C, where the work ends between two files and not at once.
    stop: Option<Arc<AtomicBool>>,
}

impl Progress {
    /// Follows work that Ctrl-C ends when it is asked whether it goes on.
    pub fn interruptible() -> Self {
        Self { shown: Mutex::default(), stop: Some(interrupt::flag()) }
    }

    /// Takes the bar away.
    pub fn end(&self) {
        let shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner).take();
        shown.iter().for_each(|(_, bar)| bar.finish_and_clear());
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.end();
    }
}

impl Watch for Progress {
    fn tell(&self, doing: &'static str, done: u64, of: u64) {
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        if shown.as_ref().is_none_or(|(before, _)| *before != doing) {
            shown.iter().for_each(|(_, bar)| bar.finish_and_clear());
            let bar = match (doing, of) {
                (_, 0) => spinner(doing),
                ("simulating", _) => simulating(of as f64 / 1000.0),
                _ => counting(doing, of),
            };
            *shown = Some((doing, bar));
        }
        if let Some((_, bar)) = shown.as_ref().filter(|_| of > 0) {
            bar.set_position(done.max(bar.position()));
        }
    }

    fn bound(&self, doing: &'static str, done: u64, at_most: u64) {
        self.tell(doing, 0, 0);
        let shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, bar)) = shown.as_ref() {
            bar.set_message(bounded(doing, bar.elapsed(), done, at_most));
        }
    }

    fn stops(&self) -> bool {
        self.stop.as_ref().is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    fn note(&self, text: &str) {
        eprintln!("note: {text}");
    }

    fn warn(&self, text: &str) {
        eprintln!("warning: {text}");
    }
}

/// A bar over simulated milliseconds.
pub fn simulating(seconds: f64) -> ProgressBar {
    let style = ProgressStyle::with_template("simulating {wide_bar} {percent} %, {eta} left");
    ProgressBar::new((1000.0 * seconds) as u64)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// A bar over work that is counted.
pub fn counting(doing: &'static str, of: u64) -> ProgressBar {
    let template = format!("{doing} {{pos}} of {{len}} {{wide_bar}} {{eta}} left");
    let style = ProgressStyle::with_template(&template);
    let bar =
        ProgressBar::new(of).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}

/// Says what is being done for as long as nobody knows.
pub fn spinner(what: &str) -> ProgressBar {
    let style = ProgressStyle::with_template("{spinner} {msg}, {elapsed}");
    let bar = ProgressBar::new_spinner()
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()))
        .with_message(what.to_string());
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}

/// What is being done and how long it takes at most, if rounds take as long as those before.
fn bounded(doing: &str, elapsed: Duration, done: u64, at_most: u64) -> String {
    let left = elapsed.as_secs_f64() / done as f64 * at_most.saturating_sub(done) as f64;
    match left.is_finite() {
        true => {
            format!("{doing}, about {} left at most", HumanDuration(Duration::from_secs_f64(left)))
        }
        false => doing.into(),
    }
}

/// A page that stays where it is and changes when there is something new.
pub fn calm() -> ProgressBar {
    let style = ProgressStyle::with_template("{msg}");
    ProgressBar::new_spinner()
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_left_is_told_once_a_round_is_done() {
        let told = |done, at_most| bounded("searching", Duration::from_secs(6), done, at_most);
        assert_eq!(told(0, 10), "searching");
        assert_eq!(told(3, 10), "searching, about 14 seconds left at most");
        assert_eq!(told(3, 3), "searching, about 0 seconds left at most");
    }
}
