//! How much sharper designed motions tell than random sines, over the seeds of the search.

use serde::Serialize;

use crate::excitation::{Design, ExcitationError, Report, Request, design};
use crate::text::markdown_table;
use crate::twin::Twin;

/// One goal, designed for with several seeds.
#[derive(Debug, Serialize)]
pub struct Measured {
    /// The goal as it was asked for.
    pub goal: String,
    /// One report per seed.
    pub reports: Vec<Report>,
}

/// Designs for `goal` with `seeds` seeds from that of `request` on; `done` hears how many motions
/// were tried.
///
/// # Errors
/// As [`design`].
pub fn measure(
    twin: &Twin,
    goal: &str,
    request: &Request,
    seeds: u64,
    mut done: impl FnMut(usize),
) -> Result<Measured, ExcitationError> {
    let mut reports = Vec::new();
    for i in 0..seeds {
        let request = Request { seed: request.seed.wrapping_add(i), ..request.clone() };
        let before = i as usize * request.evaluations;
        let Design { report, .. } = design(twin, &request, |tried| done(before + tried))?;
        reports.push(report);
    }
    Ok(Measured { goal: goal.into(), reports })
}

/// Page of one goal, in Markdown.
pub fn page(measured: &Measured) -> String {
    let reports = &measured.reports;
    let Some(first) = reports.first() else { return String::new() };
    let rows: Vec<Vec<String>> = (0..first.groups.len()).map(|g| row(reports, g)).collect();
    let header = [
        "asked for",
        "parameters",
        "designed",
        "random sines",
        "narrower (median)",
        "least",
        "most",
    ];
    let overall = spread(reports.iter().filter_map(|r| r.narrower).collect());
    let noise: Vec<String> = first.recorder.noise_nm.iter().map(|n| format!("{n:.2}")).collect();
    format!(
        "## {goal}\n\n{seconds} s, {tried} motions tried per seed, seeds {from} to {to}. Limits: \
         {range} rad from the middle pose, {speed} rad/s and {acceleration} rad/s2 or the joint's own. \
         {known} base parameters; \
         {random} of {drawn} random sines hold the same limits. Noise: {noise} N.m, {rate} Hz.\n\n\
         {table}\nOver all parameters: {overall} times narrower (geometric mean; least, median and most \
         of the seeds).\n",
        goal = measured.goal,
        seconds = first.seconds,
        tried = first.evaluations,
        from = first.seed,
        to = first.seed.wrapping_add(reports.len() as u64 - 1),
        range = first.commanded.angle_rad.limit,
        speed = first.commanded.speed_rad_s.limit,
        acceleration =
            first.commanded.acceleration_rad_s2.as_ref().map_or(f64::INFINITY, |r| r.limit),
        known = first.told.len(),
        random = first.random_sines.motions,
        drawn = first.random_sines.drawn,
        noise = noise.join(" "),
        rate = first.recorder.rate_hz,
        table = markdown_table(&header, 1, &rows),
        overall = overall.map_or("-".into(), |s| s.map(|x| format!("{x:.2}")).join(", ")),
    )
}

/// One group: half-widths over sizes (geometric mean, %), and how many times narrower.
fn row(reports: &[Report], group: usize) -> Vec<String> {
    let groups = || reports.iter().filter_map(|r| r.groups.get(group));
    let percent =
        |s: Option<[f64; 3]>| s.map_or("-".into(), |[_, m, _]| format!("{:.3} %", 100.0 * m));
    let here = spread(groups().map(|g| g.relative_half_width).collect());
    let random = groups().filter_map(|g| g.random_sines_relative_half_width).collect();
    let ratio =
        groups().filter_map(|g| Some(g.random_sines_relative_half_width? / g.relative_half_width));
    let ratios = spread(ratio.collect());
    let at = |i: usize| ratios.map_or("-".into(), |r| format!("{:.2}", r[i]));
    let name = reports.first().and_then(|r| r.groups.get(group));
    vec![
        name.map_or_else(String::new, |g| g.name.clone()),
        name.map_or(0, |g| g.parameters).to_string(),
        percent(here),
        percent(spread(random)),
        at(1),
        at(0),
        at(2),
    ]
}

/// Least, median and largest value; `None` where there are none.
fn spread(mut values: Vec<f64>) -> Option<[f64; 3]> {
    values.sort_by(f64::total_cmp);
    Some([*values.first()?, values[values.len() / 2], *values.last()?])
}
