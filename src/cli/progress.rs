//! Progress of long work; bars hide themselves where standard error is not a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// A bar over simulated milliseconds.
pub fn simulating(seconds: f64) -> ProgressBar {
    let style = ProgressStyle::with_template("simulating {wide_bar} {percent} %, {eta} left");
    ProgressBar::new((1000.0 * seconds) as u64)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
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
