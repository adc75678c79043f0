//! Counterparts of the paper's figures 11 to 17, of the arm.

use super::ur5::{Part, Study};
use crate::figure::{Colour, Drawn, FigureError, Line, Panel, Scale, draw, over_time};
use crate::robot::{Robot, flange_placement};

/// A picture and what it shows.
pub struct Figure {
    /// Part of file names and entity paths.
    pub name: String,
    pub caption: String,
    pub panels: Vec<Panel>,
    /// Panels per row.
    pub columns: usize,
    /// The flange in space, m; empty where a figure is about something else.
    pub path: Vec<[f64; 3]>,
}

/// Folder of the figures, seen from the page.
pub const FOLDER: &str = "img/case-studies";

impl Figure {
    /// Path of the figure's file, seen from the page.
    pub fn file(&self) -> String {
        format!("{FOLDER}/{}.svg", self.name)
    }

    /// # Errors
    /// If the plotting library refuses.
    pub fn svg(&self) -> Result<String, FigureError> {
        draw(&self.panels, self.columns)
    }
}

/// Figures 11 to 17 for one arm.
pub fn of_arm(study: &Study, robot: &Robot) -> Vec<Figure> {
    let mut figures = Vec::new();
    let mut add = |name: &str, caption: &str, panels: Vec<Panel>, columns, path| {
        let caption = format!("{caption}, {} UR5.", study.name);
        let name = format!("{}_{name}", study.name);
        figures.push(Figure { name, caption, panels, columns, path });
    };
    for (part, name, what, numbers) in [
        (&study.fit, "fit", "identification", ["11", "12", "13"]),
        (&study.check, "check", "verification", ["14", "15", "16"]),
    ] {
        let [motion, path, torque] = numbers;
        let caption = format!("As Fig. {motion}: positions, velocities, accelerations, {what}");
        add(&format!("{name}_motion"), &caption, motion_panels(part), 3, vec![]);
        let caption = format!("As Fig. {path}: path of the flange, {what}");
        let places = flange_path(part, robot);
        add(&format!("{name}_path"), &caption, path_panels(&places), 3, places);
        let caption = format!("As Fig. {torque}: torque measured and calculated, {what}");
        add(&format!("{name}_torque"), &caption, torque_panels(study, part, false), 2, vec![]);
    }
    let caption = "As Fig. 17: absolute torque errors, verification";
    add("check_error", caption, torque_panels(study, &study.check, true), 2, vec![]);
    figures
}

/// Time along the horizontal axis.
pub const TIME: (&str, Scale) = ("s", Scale::Linear);
/// Methods by their names in a report, as they are written, in their colours.
pub const METHODS: [(&str, &str, Colour); 2] =
    [("pso", "PSO", Colour::Before), ("nlse", "NLSE", Colour::After)];

pub fn joined(label: &str, colour: Colour, points: Vec<(f64, f64)>) -> Line {
    Line { label: label.into(), colour, drawn: Drawn::Joined, points, band: Vec::new() }
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
        across: TIME,
        up: (up, Scale::Linear),
        lines: (0..series.joints())
            .map(|j| {
                let points = series.joint(j).iter().enumerate().map(|(k, y)| (s.time(k), *y));
                joined(&format!("joint {}", j + 1), Colour::ByName, points.collect())
            })
            .collect(),
        ..Panel::default()
    };
    signals.map(panel).into()
}

/// Most points of a path.
const MOST_PLACES: usize = 1200;

/// Positions of the flange by forward kinematics, m.
fn flange_path(part: &Part, robot: &Robot) -> Vec<[f64; 3]> {
    let s = &part.samples;
    let mut q = vec![0.0; s.joints()];
    let place = |k| {
        s.q.sample_into(k, &mut q);
        flange_placement(robot, &q).translation.into()
    };
    let thin = s.len().div_ceil(MOST_PLACES).max(1);
    (0..s.len()).step_by(thin).map(place).collect()
}

/// Panels of the path from three sides.
fn path_panels(places: &[[f64; 3]]) -> Vec<Panel> {
    let side = |(title, a, b, across, up): (&str, usize, usize, &'static str, &'static str)| {
        let points: Vec<_> = places.iter().map(|p| (p[a], p[b])).collect();
        let (across, up) = ((across, Scale::Linear), (up, Scale::Linear));
        let lines = vec![joined("", Colour::ByName, points)];
        Panel { title: title.into(), across, up, lines, equal: true, ..Panel::default() }
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
        let time: Vec<f64> = p.slots.iter().map(|slot| *slot as f64 * p.dt).collect();
        let line =
            |label: &str, colour, y: &[f64]| joined(label, colour, over_time(&time, y, p.dt));
        if !errors {
            lines.push(line("measured", Colour::Measured, &p.measured));
        }
        for (method, label, colour) in METHODS {
            let Some(r) = study.results.iter().find(|r| r.method == method) else { continue };
            let residual = p.residual(&r.found.joints[j]);
            let y: Vec<f64> = match errors {
                true => residual.iter().map(|e| e.abs()).collect(),
                false => p.measured.iter().zip(&residual).map(|(m, e)| m - e).collect(),
            };
            lines.push(line(label, colour, &y));
        }
        let title = format!("Joint {}", j + 1);
        Panel { title, across: TIME, up: ("N.m", Scale::Linear), lines, ..Panel::default() }
    };
    part.problem.joints.iter().enumerate().map(panel).collect()
}
