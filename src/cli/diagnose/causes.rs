//! What the twin lacks, and what was set aside.

use crate::diagnosis::{Cause, Diagnosis, Value, by_reason, words};
use crate::report::diagnosis as rows;
use crate::report::{paragraph, table};
use crate::text::titled;

pub fn section(d: &Diagnosis) -> String {
    let body: Vec<String> = d.causes.iter().map(|c| cause(d, c)).collect();
    titled("Which effect: causes, what takes most off first", &body.join("\n"))
}

fn cause(d: &Diagnosis, c: &Cause) -> String {
    let mut text = format!(
        "{} at {}: probability {}\n",
        c.effect,
        words::acts(c),
        words::percent(c.probability)
    );
    let mut header = rows::PARAMETERS;
    header[0] = "  parameter";
    let rows = table(&header, 2, c.read().into_iter().map(parameter));
    text += &format!("{rows}\n");
    let (sizes, share) = words::takes_off(d, c);
    let share = words::percent(share);
    let interval = match d.position {
        Some(_) => String::new(),
        None => format!(" ({} .. {})", words::percent(c.shrink.low), words::percent(c.shrink.high)),
    };
    let takes_off =
        format!("{sizes} when added to the others, {share} of the mean square{interval}");
    text += &paragraph("  check    ", &takes_off);
    if !c.equivalent.is_empty() {
        let same: Vec<String> = c.equivalent.iter().map(rows::named).collect();
        text += &paragraph("  the same ", &format!("in these data: {}", same.join("; ")));
    }
    text += &paragraph("  cause    ", &c.cause);
    text + &paragraph("  remedy   ", &c.remedy)
}

fn parameter(v: &Value) -> Vec<String> {
    let mut cells = rows::parameter(v);
    cells[0].insert_str(0, "  ");
    cells
}

/// What cannot be tested and what was rejected, grouped by reason.
pub fn set_aside(d: &Diagnosis) -> String {
    let untestable = d.untestable.iter().map(|u| (&*u.effect, &*u.joints, &*u.why));
    let rejected = d.rejected.iter().map(|r| (&*r.effect, &*r.joints, &*r.why));
    titled("What these data cannot test", &grouped(untestable))
        + &titled("Rejected", &grouped(rejected))
}

fn grouped<'a>(all: impl Iterator<Item = (&'a str, &'a [usize], &'a str)>) -> String {
    let line = |[why, effects]: [String; 2]| paragraph("  ", &format!("{why}: {effects}"));
    by_reason(all).into_iter().map(line).collect()
}
