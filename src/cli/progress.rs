//! Progress of long work; bars hide themselves where standard error is not a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

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

/// A page that stays where it is and changes when there is something new.
pub fn calm() -> ProgressBar {
    let style = ProgressStyle::with_template("{msg}");
    ProgressBar::new_spinner()
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()))
}
