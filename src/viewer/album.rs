//! The figures of the case studies in the viewer: a tab per figure, paths of the flange in space.

use nalgebra::Vector3;
use rerun::{Color, LineStrips3D, Radius, RecordingStream, TimeColumn, ViewCoordinates};

use super::blueprint::{Node, columns, grid, space, stack, tabs, time_series};
use super::palette::Rgb;
use super::plots::{TIMELINE, curve, log_curves};
use super::scene::Shown;
use super::{Error, arm, log_error};
use crate::case_studies::figures::Figure;
use crate::figure::{Line, Panel, SERIES, labels, thinned};

/// Figures under one name.
pub struct Album<'a> {
    pub title: &'a str,
    pub figures: &'a [Figure],
}

/// Most points of one line: more are not seen.
const MOST_POINTS: usize = 10_000;
/// Length of the axes at the base, m.
const AXIS: f32 = 0.25;

impl Shown for Album<'_> {
    fn title(&self) -> &str {
        self.title
    }

    fn check(&self) -> Result<(), Error> {
        if self.figures.is_empty() { Err(Error::Empty) } else { Ok(()) }
    }

    fn arrangement(&self) -> Node {
        tabs("Figures", self.figures.iter().map(tab).collect())
    }

    fn log(&self, stream: &RecordingStream) -> Result<(), Error> {
        for figure in self.figures {
            match figure.path.is_empty() {
                true => log_panels(stream, figure)?,
                false => log_path(stream, figure)?,
            }
        }
        Ok(())
    }
}

fn tab(figure: &Figure) -> Node {
    if !figure.path.is_empty() {
        let view = space(&figure.caption, &figure.name, &frame(&figure.path));
        return columns(&figure.name, vec![view], vec![1.0]);
    }
    let plot = |p: &Panel| {
        let legend = p.lines.iter().any(|l| !l.label.is_empty());
        time_series(format!("{} / {}", p.title, p.up.0), entity(figure, p), legend)
    };
    let plots: Vec<Node> = figure.panels.iter().map(plot).collect();
    if plots.len() > 3 { grid(&figure.name, plots) } else { stack(&figure.name, plots) }
}

fn entity(figure: &Figure, panel: &Panel) -> String {
    format!("{}/{}", figure.name, panel.title.to_lowercase().replace(' ', "_"))
}

/// The base and all of the path.
fn frame(path: &[[f64; 3]]) -> arm::Frame {
    let points = || path.iter().map(|p| Vector3::from(*p));
    let low = points().fold(Vector3::zeros(), |low, p| low.inf(&p));
    let high = points().fold(Vector3::zeros(), |high, p| high.sup(&p));
    let centre = (low + high) / 2.0;
    let ahead = Vector3::new(centre.x, centre.y, 0.0).try_normalize(1e-6);
    arm::Frame { centre, ahead: ahead.unwrap_or(Vector3::x()), size: (high - low).norm() }
}

fn log_panels(stream: &RecordingStream, figure: &Figure) -> Result<(), Error> {
    let names = labels(&figure.panels);
    for panel in &figure.panels {
        for (k, line) in panel.lines.iter().enumerate() {
            let entity = format!("{}/{}", entity(figure, panel), k + 1);
            log_line(stream, &entity, line, &panel.title, &names)?;
        }
    }
    Ok(())
}

/// Logs one line; a value that is not known leaves a gap.
fn log_line(
    stream: &RecordingStream,
    entity: &str,
    line: &Line,
    title: &str,
    names: &[&str],
) -> Result<(), Error> {
    let points = thinned(&line.points, MOST_POINTS / 2);
    let time = TimeColumn::new_duration_secs(TIMELINE, points.iter().map(|p| p.0));
    let values: Vec<f64> = points.iter().map(|p| p.1).collect();
    let place = names.iter().position(|name| *name == line.label).unwrap_or(0);
    let [r, g, b] = line.colour.rgb(place);
    let name = if line.label.is_empty() { title } else { &line.label };
    log_curves(stream, &time, entity, &[curve(name, Rgb(r, g, b), &values)])
}

fn log_path(stream: &RecordingStream, figure: &Figure) -> Result<(), Error> {
    let name = &figure.name;
    stream.log_static(name.as_str(), &ViewCoordinates::RIGHT_HAND_Z_UP()).map_err(log_error)?;
    let strip = |points: Vec<[f32; 3]>, colour: Color, radius: f32| {
        LineStrips3D::new([points])
            .with_colors([colour])
            .with_radii([Radius::new_ui_points(radius)])
    };
    let path = figure.path.iter().map(|p| p.map(|v| v as f32)).collect();
    let [r, g, b] = SERIES[1];
    let path = strip(path, Rgb(r, g, b).into(), 1.2);
    stream.log_static(format!("{name}/path"), &path).map_err(log_error)?;
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let mut end = [0.0; 3];
        end[k] = AXIS;
        let mut colour = [60; 3];
        colour[k] = 255;
        let [r, g, b] = colour;
        let line = strip(vec![[0.0; 3], end], Rgb(r, g, b).into(), 2.0);
        stream.log_static(format!("{name}/base/{axis}"), &line).map_err(log_error)?;
    }
    Ok(())
}
