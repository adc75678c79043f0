//! What a person sees: on a terminal one table that stays where it is, in a pipe a line a minute.

use std::io::IsTerminal;

use indicatif::ProgressBar;

use crate::cli::out;
use crate::cli::progress;
use crate::report::table;
use crate::watch::{Figure, REGIMES, Seen, Watch};

/// In a pipe, s.
const EVERY_S: f64 = 60.0;

pub struct Screen {
    bar: Option<ProgressBar>,
    told: Option<f64>,
    temperature: Option<Vec<f64>>,
}

impl Screen {
    pub fn new() -> Self {
        let bar = std::io::stderr().is_terminal().then(progress::calm);
        Self { bar, told: None, temperature: None }
    }

    /// Something that is worth a line of its own.
    pub fn event(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| println!("{text}")),
            None => println!("{text}"),
        }
    }

    /// `time` in words and in s.
    pub fn show(&mut self, watch: &Watch, time: &str, seen: &Seen, time_s: f64) {
        self.temperature.clone_from(&seen.stretch.temperature_c);
        if let Some(bar) = &self.bar {
            bar.set_message(self.page(watch, time));
            return;
        }
        if self.told.is_none_or(|told| time_s - told >= EVERY_S || time_s < told) {
            self.told = Some(time_s);
            println!("{time}: {}", line(watch));
        }
    }

    /// The last table stays, with what all of it came to.
    pub fn end(&self, watch: &Watch, length_s: f64, changes: u64) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        let changed = match changes {
            0 => "nothing changed".into(),
            1 => "1 change".to_string(),
            n => format!("{n} changes"),
        };
        out::page(&format!(
            "{}\n",
            self.page(watch, &format!("watched for {length_s:.0} s, {changed}"))
        ));
    }

    fn page(&self, watch: &Watch, head: &str) -> String {
        let figures = watch.figures();
        let level = figures.level();
        let nm = |figure: Option<Figure>| figure.map_or("-".into(), |f| format!("{:.2}", f.rms_nm));
        let rows = (0..figures.joints()).map(|j| {
            let (now, level) = (figures.now(j), level.0[j]);
            let more = now[0].zip(level[0]).map(|(n, l)| n.along_nm - l.along_nm);
            let warm = self.temperature.as_ref().map_or("-".into(), |t| format!("{:.1}", t[j]));
            let mut cells = vec![(j + 1).to_string(), nm(now[0]), nm(level[0])];
            cells.push(more.map_or("-".into(), |m| format!("{m:+.2}")));
            cells.extend(now[1..].iter().map(|f| nm(*f)));
            cells.push(warm);
            cells
        });
        let mut header = vec!["joint", "gap N.m", "level", "along"];
        header.extend(&REGIMES[1..]);
        header.push("deg C");
        format!("{head}\n{}\n{}", table(&header, 1, rows), force(watch))
    }
}

/// `gap N.m rms (level): 1 0.41 (0.40), 2 ...; force at the flange 4 N`
fn line(watch: &Watch) -> String {
    let figures = watch.figures();
    let level = figures.level();
    let joint = |j: usize| {
        let (now, level) = (figures.now(j)[0]?, level.0[j][0]?);
        Some(format!("{} {:.2} ({:.2})", j + 1, now.rms_nm, level.rms_nm))
    };
    let joints: Vec<String> = (0..figures.joints()).filter_map(joint).collect();
    match joints.is_empty() {
        true => "nothing moves".into(),
        false => format!("gap N.m rms (level): {}; {}", joints.join(", "), force(watch)),
    }
}

fn force(watch: &Watch) -> String {
    match (watch.flange().force(), watch.flange().usual_n()) {
        (Some(f), Some(usual)) => {
            format!("a force at the flange would be {:.0} N ({usual:.0} N is usual)", f.norm())
        }
        (Some(f), None) => format!("a force at the flange would be {:.0} N", f.norm()),
        (None, _) => "too few joints move to tell a force at the flange".into(),
    }
}
