//! Counterparts of the paper's figures as SVG.

use plotters::prelude::*;

use super::ur5::{Part, Study};
use crate::robot::{Robot, flange_placement};

/// A picture and what it shows.
pub struct Figure {
    /// Without folder.
    pub file: String,
    pub caption: String,
    pub svg: String,
}

/// Where figures stand, seen from the page.
pub const FOLDER: &str = "img/case-studies";

impl Figure {
    pub fn path(&self) -> String {
        format!("{FOLDER}/{}", self.file)
    }
}

#[derive(Debug, thiserror::Error)]
#[error("a figure cannot be drawn: {0}")]
pub struct FigureError(String);

fn failed(e: impl std::fmt::Display) -> FigureError {
    FigureError(e.to_string())
}

/// Points of one line are thinned to about so many: a page is not a data store.
const MOST_POINTS: usize = 300;
const PANEL: (u32, u32) = (460, 230);
/// What axes and caption leave of a panel.
const PLOT: (f64, f64) = (402.0, 170.0);
/// Room for the legend at the right, as a share of the span.
const LEGEND: f64 = 0.22;
const COLOURS: [RGBColor; 6] = [
    RGBColor(31, 119, 180),
    RGBColor(214, 90, 20),
    RGBColor(44, 140, 60),
    RGBColor(190, 40, 50),
    RGBColor(130, 90, 170),
    RGBColor(120, 120, 120),
];

/// Stretches of points; nothing is drawn between two stretches.
pub struct Line {
    pub label: String,
    pub colour: usize,
    pub stretches: Vec<Vec<(f64, f64)>>,
}

pub struct Panel {
    pub title: String,
    pub across: &'static str,
    pub up: &'static str,
    pub lines: Vec<Line>,
    /// One scale across and up.
    pub equal: bool,
}

impl Line {
    pub fn new(label: &str, colour: usize, points: Vec<(f64, f64)>) -> Self {
        let thin = points.len().div_ceil(MOST_POINTS).max(1);
        let points = points.into_iter().step_by(thin).collect();
        Self { label: label.into(), colour, stretches: vec![points] }
    }

    /// Rows with gaps: `slots` count steps of `dt`.
    fn with_gaps(label: &str, colour: usize, slots: &[usize], dt: f64, y: &[f64]) -> Self {
        let thin = slots.len().div_ceil(MOST_POINTS).max(1);
        let point = |k: usize| (slots[k] as f64 * dt, y[k]);
        let stretch = |r: std::ops::Range<usize>| r.step_by(thin).map(point).collect();
        let stretches = crate::statistics::contiguous(slots).into_iter().map(stretch).collect();
        Self { label: label.into(), colour, stretches }
    }
}

/// Panels in rows of `columns`.
///
/// # Errors
/// If the plotting library refuses.
pub fn draw(panels: &[Panel], columns: usize) -> Result<String, FigureError> {
    let rows = panels.len().div_ceil(columns);
    let size = (PANEL.0 * columns as u32, PANEL.1 * rows as u32);
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        for (panel, area) in panels.iter().zip(root.split_evenly((rows, columns))) {
            panel.draw(&area)?;
        }
        root.present().map_err(failed)?;
    }
    Ok(svg)
}

impl Panel {
    fn draw(
        &self,
        area: &DrawingArea<SVGBackend<'_>, plotters::coord::Shift>,
    ) -> Result<(), FigureError> {
        let points = || self.lines.iter().flat_map(|l| l.stretches.iter().flatten());
        let [mut x, mut y] =
            [range(points().map(|p| p.0), 0.0), range(points().map(|p| p.1), 0.08)];
        if self.lines.iter().any(|l| !l.label.is_empty()) {
            x.end += LEGEND * (x.end - x.start);
        }
        if self.equal {
            let scale = ((x.end - x.start) / PLOT.0).max((y.end - y.start) / PLOT.1);
            (x, y) = (around(&x, scale * PLOT.0), around(&y, scale * PLOT.1));
        }
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, ("sans-serif", 14))
            .margin(6)
            .x_label_area_size(30)
            .y_label_area_size(46)
            .build_cartesian_2d(x, y)
            .map_err(failed)?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(RGBColor(225, 225, 225))
            .x_labels(6)
            .y_labels(5)
            .x_desc(self.across)
            .y_desc(self.up)
            .label_style(("sans-serif", 11))
            .draw()
            .map_err(failed)?;
        for line in &self.lines {
            let colour = COLOURS[line.colour % COLOURS.len()];
            let mut named = false;
            for stretch in &line.stretches {
                let drawn = chart.draw_series(LineSeries::new(stretch.iter().copied(), colour));
                let drawn = drawn.map_err(failed)?;
                if !named && !line.label.is_empty() {
                    drawn
                        .label(line.label.as_str())
                        .legend(move |(x, y)| PathElement::new([(x, y), (x + 14, y)], colour));
                    named = true;
                }
            }
        }
        if self.lines.iter().any(|l| !l.label.is_empty()) {
            let labels = &mut chart.configure_series_labels();
            labels
                .position(SeriesLabelPosition::UpperRight)
                .background_style(WHITE.mix(0.75))
                .label_font(("sans-serif", 10))
                .draw()
                .map_err(failed)?;
        }
        Ok(())
    }
}

/// The same middle with another span.
fn around(r: &std::ops::Range<f64>, span: f64) -> std::ops::Range<f64> {
    let middle = 0.5 * (r.start + r.end);
    middle - 0.5 * span..middle + 0.5 * span
}

/// From least to greatest, `more` of the span added at both ends.
fn range(values: impl Iterator<Item = f64>, more: f64) -> std::ops::Range<f64> {
    let ends = |(a, b): (f64, f64), v: f64| (a.min(v), b.max(v));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), ends);
    let pad = (more * (high - low)).max(1e-9);
    if low <= high { low - pad..high + pad } else { 0.0..1.0 }
}

/// Figures 11 to 17 for one arm.
///
/// # Errors
/// If the plotting library refuses.
pub fn of_arm(study: &Study, robot: &Robot) -> Result<Vec<Figure>, FigureError> {
    let mut figures = Vec::new();
    let mut add = |file: &str, caption: &str, panels: &[Panel], columns| {
        let svg = draw(panels, columns)?;
        let caption = format!("{caption}, {} UR5.", study.name);
        figures.push(Figure { file: format!("{}_{file}.svg", study.name), caption, svg });
        Ok(())
    };
    for (part, name, what, numbers) in [
        (&study.fit, "fit", "identification", ["11", "12", "13"]),
        (&study.check, "check", "verification", ["14", "15", "16"]),
    ] {
        let [motion, path, torque] = numbers;
        let caption = format!("As Fig. {motion}: positions, velocities, accelerations, {what}");
        add(&format!("{name}_motion"), &caption, &motion_panels(part), 3)?;
        let caption = format!("As Fig. {path}: path of the flange, {what}");
        add(&format!("{name}_path"), &caption, &path_panels(part, robot), 3)?;
        let caption = format!("As Fig. {torque}: torque measured and calculated, {what}");
        add(&format!("{name}_torque"), &caption, &torque_panels(study, part, false), 2)?;
    }
    let caption = "As Fig. 17: absolute torque errors, verification";
    add("check_error", caption, &torque_panels(study, &study.check, true), 2)?;
    Ok(figures)
}

fn motion_panels(part: &Part) -> Vec<Panel> {
    let s = &part.samples;
    let signals = [
        ("Position", "rad", &s.q),
        ("Velocity", "rad/s", &s.qd),
        ("Acceleration", "rad/s2", &s.qdd),
    ];
    let panel = |(title, up, series): (&str, &'static str, &crate::series::JointSeries)| Panel {
        title: title.into(),
        across: "s",
        up,
        lines: (0..series.joints())
            .map(|j| {
                let points = series.joint(j).iter().enumerate().map(|(k, y)| (s.time(k), *y));
                Line::new(&format!("{}", j + 1), j, points.collect())
            })
            .collect(),
        equal: false,
    };
    signals.map(panel).into()
}

/// By forward kinematics, from three sides.
fn path_panels(part: &Part, robot: &Robot) -> Vec<Panel> {
    let s = &part.samples;
    let mut q = vec![0.0; s.joints()];
    let thin = s.len().div_ceil(4 * MOST_POINTS).max(1);
    let places: Vec<[f64; 3]> = (0..s.len())
        .step_by(thin)
        .map(|k| {
            s.q.sample_into(k, &mut q);
            flange_placement(robot, &q).translation.into()
        })
        .collect();
    let side = |(title, a, b, across, up): (&str, usize, usize, &'static str, &'static str)| {
        let points: Vec<_> = places.iter().map(|p| (p[a], p[b])).collect();
        let line = Line { label: String::new(), colour: 0, stretches: vec![points] };
        Panel { title: title.into(), across, up, lines: vec![line], equal: true }
    };
    [
        ("From above", 0, 1, "x m", "y m"),
        ("From the front", 0, 2, "x m", "z m"),
        ("From the side", 1, 2, "y m", "z m"),
    ]
    .map(side)
    .into()
}

/// Measured, PSO, NLSE; or the absolute errors of the two.
fn torque_panels(study: &Study, part: &Part, errors: bool) -> Vec<Panel> {
    let panel = |(j, p): (usize, &crate::identification::problem::JointProblem)| {
        let mut lines = Vec::new();
        let line =
            |label: &str, colour, y: &[f64]| Line::with_gaps(label, colour, &p.slots, p.dt, y);
        if !errors {
            lines.push(line("measured", 5, &p.measured));
        }
        for (k, (method, label)) in [("pso", "PSO"), ("nlse", "NLSE")].iter().enumerate() {
            let Some(r) = study.results.iter().find(|r| r.method == *method) else { continue };
            let residual = p.residual(&r.found.joints[j]);
            let y: Vec<f64> = match errors {
                true => residual.iter().map(|e| e.abs()).collect(),
                false => p.measured.iter().zip(&residual).map(|(m, e)| m - e).collect(),
            };
            lines.push(line(label, [3, 0][k], &y));
        }
        Panel { title: format!("Joint {}", j + 1), across: "s", up: "N.m", lines, equal: false }
    };
    part.problem.joints.iter().enumerate().map(panel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_is_not_drawn_across_and_an_empty_panel_is_no_error() {
        let line = Line::with_gaps("a", 0, &[1, 2, 3, 9, 10], 0.1, &[1.0, 2.0, 1.0, 3.0, 4.0]);
        assert_eq!(line.stretches.len(), 2);
        let panel =
            |lines| Panel { title: "t".into(), across: "s", up: "N.m", lines, equal: false };
        let svg = draw(&[panel(vec![line]), panel(vec![])], 2).unwrap();
        // Two stretches and the legend.
        assert_eq!(svg.matches("stroke=\"#1F77B4\"").count(), 3, "{svg}");
        assert!(svg.starts_with("<svg") && svg.contains("N.m"));
    }
}
