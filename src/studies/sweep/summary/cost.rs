//! How time and memory grow along every axis that is varied.

use std::collections::BTreeMap;

use super::seen::in_order;
use super::{Page, distinct, quantile};
use crate::figure::{Figure, Line, Panel, Scale};
use crate::numbers::digits;
use crate::studies::sweep::study::Study;
use crate::studies::sweep::table::Table;
use crate::text::markdown_table;

/// More samples of a longer motion, and of the same at a higher rate.
const LONGER: &str = "samples (duration)";
const FASTER: &str = "samples (rate)";

/// Excess of the last stretch's exponent over the whole's from which it is told.
const STEEPER: f64 = 0.5;

/// Cost of one cell.
struct Cost {
    method: String,
    axis: BTreeMap<&'static str, f64>,
    seconds: f64,
    megabytes: f64,
}

/// One method along one axis: (x, seconds, megabytes), medians over seeds.
struct Growth {
    axis: &'static str,
    grid: usize,
    method: String,
    points: Vec<(f64, f64, f64)>,
}

pub fn page(study: &Study, cells: &Table, timings: &Table) -> Page {
    let costs = costs(cells, timings);
    let mut growths = Vec::new();
    let mut before = 0;
    for (number, grid) in study.grid.iter().enumerate() {
        let here: Vec<&Cost> =
            (before..before + grid.cells()).filter_map(|n| costs.get(&n)).collect();
        before += grid.cells();
        let varied = [
            (LONGER, grid.duration_s.len() > 1),
            (FASTER, grid.rate_hz.len() > 1),
            ("joints", grid.joints.len() > 1),
            ("effects", grid.terms.len() > 1),
            ("particles", grid.particles.len() > 1),
        ];
        for (axis, _) in varied.into_iter().filter(|v| v.1) {
            growths.extend(along(axis, number, &here));
        }
    }
    let says: String = growths.iter().map(|g| format!("* {}\n", g.in_words())).collect();
    let rows: Vec<Vec<String>> = growths.iter().map(Growth::row).collect();
    let header = [
        "method",
        "over",
        "from",
        "to",
        "s, first",
        "s, last",
        "exponent",
        "MB, first",
        "MB, last",
    ];
    let figure = |name: &str, panels| Figure {
        file: format!("{}.svg", name.to_lowercase()),
        caption: name.into(),
        panels,
        columns: 3,
    };
    let figures = vec![
        figure("Time", panels(&growths, "s", |p| p.1)),
        figure("Memory", panels(&growths, "MB", |p| p.2)),
    ];
    let text = format!(
        "{says}\nTime is processor time of the method's own work, median over seeds; memory is the \
         largest resident set of a process that simulates the recordings and then does it. The \
         exponent is the slope of log time over log x.\n\n{}\n![Time](time.svg)\n\n\
         ![Memory](memory.svg)\n",
        markdown_table(&header, 2, &rows)
    );
    let headline = headline(&growths);
    Page { headline, text, picture: figures[0].panels.first().cloned(), figures }
}

/// What takes longest, in plain words.
fn headline(growths: &[Growth]) -> String {
    let last = |g: &Growth| g.points.last().copied().filter(|p| p.1.is_finite());
    let ends: Vec<(&Growth, (f64, f64, f64))> =
        growths.iter().filter_map(|g| Some((g, last(g)?))).collect();
    let longest = ends.iter().max_by(|a, b| a.1.1.total_cmp(&b.1.1));
    let hungriest = ends.iter().max_by(|a, b| a.1.2.total_cmp(&b.1.2));
    let (Some((slow, (x, seconds, _))), Some((large, (_, _, megabytes)))) = (longest, hungriest)
    else {
        return "Nothing was measured.".into();
    };
    format!(
        "What takes longest is {}: {} s of one core for {x} {}. The most memory, {} MB, is taken by {}.",
        slow.method,
        digits(*seconds),
        slow.axis,
        digits(*megabytes),
        large.method
    )
}

/// Costs by the number of the cell.
fn costs(cells: &Table, timings: &Table) -> BTreeMap<usize, Cost> {
    let spent: BTreeMap<u64, usize> =
        timings.wholes("cell").iter().enumerate().map(|(i, cell)| (*cell, i)).collect();
    let whole = |name: &str, i: usize| cells.wholes(name).get(i).map_or(f64::NAN, |n| *n as f64);
    let time = |name: &str, at: usize| timings.numbers(name).get(at).copied().unwrap_or(f64::NAN);
    let row = |i: usize| {
        let cell = cells.wholes("cell")[i];
        let at = *spent.get(&cell)?;
        let method = cells.texts("method")[i].clone();
        let seconds =
            time(if method == "simulation" { "simulating_seconds" } else { "seconds" }, at);
        let axis = BTreeMap::from([
            (LONGER, whole("samples", i)),
            (FASTER, whole("samples", i)),
            ("joints", whole("joints", i)),
            ("effects", whole("terms", i)),
            ("particles", whole("particles", i)),
        ]);
        let megabytes = timings.wholes("peak_bytes").get(at).map_or(f64::NAN, |b| *b as f64 / 1e6);
        Some((cell as usize, Cost { method, axis, seconds, megabytes }))
    };
    let whole = (0..cells.rows()).filter(|i| cells.texts("failed")[*i].is_empty());
    whole.filter_map(row).collect()
}

fn along(axis: &'static str, grid: usize, costs: &[&Cost]) -> Vec<Growth> {
    let growth = |method: &str| {
        let ours = || costs.iter().filter(|c| c.method == method);
        let point = |x: f64| {
            let here: Vec<&&Cost> = ours().filter(|c| c.axis[axis] == x).collect();
            let middle = |of: fn(&Cost) -> f64| {
                quantile(&here.iter().map(|c| of(c)).collect::<Vec<_>>(), 0.5)
            };
            (x, middle(|c| c.seconds), middle(|c| c.megabytes))
        };
        let points = distinct(ours().map(|c| c.axis[axis])).into_iter().map(point).collect();
        Growth { axis, grid, method: method.into(), points }
    };
    in_order(costs.iter().map(|c| c.method.as_str())).into_iter().map(growth).collect()
}

impl Growth {
    /// Slope of ln time over ln x; NaN where less than two times are longer than the clock's step.
    fn exponent(&self) -> f64 {
        let measured = self.points.iter().filter(|p| p.1 > 0.0);
        let logs: Vec<(f64, f64)> = measured.map(|p| (p.0.ln(), p.1.ln())).collect();
        let n = logs.len() as f64;
        let (mx, my) =
            (logs.iter().map(|l| l.0).sum::<f64>() / n, logs.iter().map(|l| l.1).sum::<f64>() / n);
        let above: f64 = logs.iter().map(|l| (l.0 - mx) * (l.1 - my)).sum();
        above / logs.iter().map(|l| (l.0 - mx).powi(2)).sum::<f64>()
    }

    /// Where the last stretch is steeper than the whole: what would be forecast too low.
    fn steeper(&self) -> String {
        let [.., before, last] = &self.points[..] else { return String::new() };
        let exponent = (last.1 / before.1).ln() / (last.0 / before.0).ln();
        match exponent > self.exponent() + STEEPER {
            true => format!("; steeper at the end, from {} s at {}", digits(before.1), before.0),
            false => String::new(),
        }
    }

    fn ends(&self) -> [(f64, f64, f64); 2] {
        let nothing = (f64::NAN, f64::NAN, f64::NAN);
        [self.points.first(), self.points.last()].map(|p| p.copied().unwrap_or(nothing))
    }

    fn row(&self) -> Vec<String> {
        let [first, last] = self.ends();
        let numbers = [first.0, last.0, first.1, last.1];
        let mut row = vec![self.method.clone(), self.axis.to_string()];
        row.extend(numbers.map(digits));
        row.push(told(self.exponent()));
        row.extend([first.2, last.2].map(|mb| format!("{mb:.0}")));
        row
    }

    fn in_words(&self) -> String {
        let [first, last] = self.ends();
        let exponent = self.exponent();
        let how = match exponent {
            e if e.is_nan() => "is too quick to tell how it grows with",
            e if e < 0.25 => "hardly grows with",
            e if e < 0.8 => "grows more slowly than",
            e if e < 1.25 => "grows in proportion to",
            _ => "grows faster than",
        };
        format!(
            "**{}** {how} {}: {} s at {}, {} s at {} (exponent {}){}; memory {:.0} to {:.0} MB.",
            self.method,
            self.axis,
            digits(first.1),
            digits(first.0),
            digits(last.1),
            digits(last.0),
            told(exponent),
            self.steeper(),
            first.2,
            last.2
        )
    }
}

/// An exponent to two digits after the point.
fn told(exponent: f64) -> String {
    if exponent.is_nan() { "-".into() } else { format!("{exponent:.2}") }
}

/// One panel per axis and grid.
fn panels(growths: &[Growth], up: &'static str, of: fn(&(f64, f64, f64)) -> f64) -> Vec<Panel> {
    let mut panels: Vec<(usize, Panel)> = Vec::new();
    for growth in growths {
        let points = growth.points.iter().map(|p| (p.0, of(p))).filter(|p| p.1 > 0.0).collect();
        let line = Line { label: growth.method.clone(), points, ..Line::default() };
        let key = |(grid, panel): &&mut (usize, Panel)| {
            *grid == growth.grid && panel.across.0 == growth.axis
        };
        match panels.iter_mut().find(key) {
            Some((_, panel)) => panel.lines.push(line),
            None => panels.push((
                growth.grid,
                Panel {
                    title: format!("over {}", growth.axis),
                    across: (growth.axis, Scale::Log),
                    up: (up, Scale::Log),
                    lines: vec![line],
                    ..Panel::default()
                },
            )),
        }
    }
    panels.into_iter().map(|(_, panel)| panel).collect()
}
