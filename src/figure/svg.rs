//! Panels drawn as SVG, side by side below one legend.

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::{Drawn, Line, Panel, Scale, labels, runs, thinned};
use crate::numbers::digits;

#[derive(Debug, thiserror::Error)]
#[error("a figure cannot be drawn: {0}")]
pub struct FigureError(String);

fn failed(e: impl std::fmt::Display) -> FigureError {
    FigureError(e.to_string())
}

const PANEL: (u32, u32) = (400, 260);
/// What margins and labels leave of a panel.
const PLOT: (f64, f64) = (332.0, 190.0);
const LEGEND_HEIGHT: u32 = 26;
const MARGIN: u32 = 14;
const SHADE: RGBColor = RGBColor(138, 164, 200);

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Panels in rows of `columns`, all of one size.
///
/// # Errors
/// If the plotting library refuses.
pub fn draw(panels: &[Panel], columns: usize) -> Result<String, FigureError> {
    let columns = columns.min(panels.len()).max(1);
    let rows = panels.len().div_ceil(columns).max(1);
    let width = PANEL.0 * columns as u32;
    let labels = labels(panels);
    let places = placed(&labels, width);
    let top = places.last().map_or(0, |p| LEGEND_HEIGHT * (p.1 + 1));
    let size = (width, PANEL.1 * rows as u32 + top);
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let (top, below) = root.split_vertically(top);
        let colours = labels.iter().map(|label| {
            let lines = panels.iter().flat_map(|p| &p.lines).find(|l| l.label == *label);
            lines.map_or(BLACK, |line| colour(line, &labels))
        });
        legend(&top, &labels, &colours.collect::<Vec<_>>(), &places)?;
        for (panel, area) in panels.iter().zip(below.split_evenly((rows, columns))) {
            draw_panel(panel, &area, &labels)?;
        }
        root.present().map_err(failed)?;
    }
    Ok(svg)
}

/// Where labels begin: pixels from the left, and row; broken like words.
fn placed(labels: &[&str], width: u32) -> Vec<(u32, u32)> {
    let (mut x, mut row) = (MARGIN, 0);
    let mut places = Vec::new();
    for label in labels {
        let needed = 46 + 7 * label.chars().count() as u32;
        if x + needed > width && x > MARGIN {
            (x, row) = (MARGIN, row + 1);
        }
        places.push((x, row));
        x += needed;
    }
    places
}

fn legend(
    area: &Area<'_>,
    labels: &[&str],
    colours: &[RGBColor],
    places: &[(u32, u32)],
) -> Result<(), FigureError> {
    for ((label, colour), (x, row)) in labels.iter().zip(colours).zip(places) {
        let (x, y) = (*x as i32, (row * LEGEND_HEIGHT + LEGEND_HEIGHT / 2) as i32);
        let stroke = vec![(x, y), (x + 18, y)];
        area.draw(&PathElement::new(stroke, colour.stroke_width(3))).map_err(failed)?;
        let place = Pos::new(HPos::Left, VPos::Center);
        let style = ("sans-serif", 13).into_text_style(area).pos(place);
        area.draw_text(label, &style, (x + 23, y)).map_err(failed)?;
    }
    Ok(())
}

fn colour(line: &Line, labels: &[&str]) -> RGBColor {
    let place = labels.iter().position(|l| *l == line.label).unwrap_or(0);
    let [r, g, b] = line.colour.rgb(place);
    RGBColor(r, g, b)
}

/// What stands at a place along an axis.
fn text(scale: Scale, x: f64, none: f64) -> String {
    match scale {
        Scale::Log => digits(rounded(10f64.powf(x))),
        Scale::Decibel if (x - none).abs() < 1e-6 => "none".into(),
        _ => digits(x),
    }
}

/// A number rounded to two significant digits.
fn rounded(x: f64) -> f64 {
    let unit = 10f64.powf(x.abs().log10().floor() - 1.0);
    (x / unit).round() * unit
}

fn draw_panel(panel: &Panel, area: &Area<'_>, labels: &[&str]) -> Result<(), FigureError> {
    let none = panel.none();
    let (sx, sy) = (panel.across.1, panel.up.1);
    let [x, y] = ranges(panel);
    let (from, to) = (y.start, y.end);
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.title, ("sans-serif", 14))
        .margin(8)
        .x_label_area_size(36)
        .y_label_area_size(52)
        .build_cartesian_2d(x, y)
        .map_err(failed)?;
    let shades = panel
        .shaded
        .iter()
        .map(|s| Rectangle::new([(s.from, from), (s.to, to)], SHADE.mix(0.16).filled()));
    chart.draw_series(shades).map_err(failed)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(225, 225, 225))
        .x_labels(8)
        .y_labels(6)
        .x_desc(panel.across.0)
        .y_desc(panel.up.0)
        .x_label_formatter(&|x| text(sx, *x, none))
        .y_label_formatter(&|y| text(sy, *y, none))
        .label_style(("sans-serif", 11))
        .draw()
        .map_err(failed)?;
    for line in &panel.lines {
        draw_line(&mut chart, panel, line, colour(line, labels))?;
    }
    let nominal = panel.placed(&panel.nominal);
    let dashed = DashedLineSeries::new(nominal, 5, 4, BLACK.stroke_width(1));
    chart.draw_series(dashed).map_err(failed)?;
    Ok(())
}

fn draw_line(
    chart: &mut Chart<'_, '_>,
    panel: &Panel,
    line: &Line,
    colour: RGBColor,
) -> Result<(), FigureError> {
    let outline = panel.outline(line);
    if !outline.is_empty() {
        let band = Polygon::new(outline, colour.mix(0.15).filled());
        chart.draw_series(std::iter::once(band)).map_err(failed)?;
    }
    let points = panel.placed(&line.points);
    if line.drawn != Drawn::Joined {
        let there = points.iter().filter(|p| p.1.is_finite());
        let dots = there.map(|p| Circle::new(*p, 2, colour.filled()));
        chart.draw_series(dots).map_err(failed)?;
    }
    if line.drawn == Drawn::Points {
        return Ok(());
    }
    let width = if line.drawn == Drawn::Marked { 2 } else { 1 };
    for run in runs(&thinned(&points, PLOT.0 as usize)) {
        let stroke = colour.stroke_width(width);
        chart.draw_series(LineSeries::new(run.iter().copied(), stroke)).map_err(failed)?;
    }
    Ok(())
}

fn ranges(panel: &Panel) -> [std::ops::Range<f64>; 2] {
    let points = panel.lines.iter().map(|l| &l.points).chain([&panel.nominal]);
    let points: Vec<(f64, f64)> = points.flat_map(|points| panel.placed(points)).collect();
    let edges = panel.lines.iter().flat_map(|line| panel.outline(line)).map(|p| p.1);
    let y = match panel.up.1 {
        Scale::Share => -3.0..103.0,
        _ => range(points.iter().map(|p| p.1).chain(edges), 0.06),
    };
    let x = range(points.iter().map(|p| p.0), 0.03);
    if !panel.equal {
        return [x, y];
    }
    let scale = ((x.end - x.start) / PLOT.0).max((y.end - y.start) / PLOT.1);
    [around(&x, scale * PLOT.0), around(&y, scale * PLOT.1)]
}

/// A range with the middle of `r` and another span.
fn around(r: &std::ops::Range<f64>, span: f64) -> std::ops::Range<f64> {
    let middle = 0.5 * (r.start + r.end);
    middle - 0.5 * span..middle + 0.5 * span
}

/// Range from the least to the greatest value, `more` of the span added at both ends.
fn range(values: impl Iterator<Item = f64>, more: f64) -> std::ops::Range<f64> {
    let ends = |(a, b): (f64, f64), v: f64| (a.min(v), b.max(v));
    let (low, high) =
        values.filter(|v| v.is_finite()).fold((f64::INFINITY, f64::NEG_INFINITY), ends);
    if low > high {
        return 0.0..1.0;
    }
    let pad = (more * (high - low)).max(1e-3 * low.abs()).max(1e-9);
    low - pad..high + pad
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(label: &str, points: Vec<(f64, f64)>) -> Line {
        Line { label: label.into(), points, ..Line::default() }
    }

    #[test]
    fn panels_share_a_legend_and_no_noise_has_a_place() {
        let line = |label: &str| Line {
            band: vec![(10.0, 0.4, 0.6), (20.0, 0.8, 1.0), (f64::INFINITY, 0.9, 1.0)],
            ..line(label, vec![(10.0, 0.5), (20.0, 0.9), (f64::INFINITY, 1.0)])
        };
        let panel = |lines| Panel {
            title: "t".into(),
            across: ("SNR, dB", Scale::Decibel),
            up: ("%", Scale::Share),
            lines,
            nominal: vec![(10.0, 0.99), (20.0, 0.99)],
            ..Panel::default()
        };
        let svg = draw(&[panel(vec![line("a"), line("b")]), panel(vec![])], 2).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("none") && svg.contains("SNR, dB"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }

    #[test]
    fn a_gap_is_not_drawn_across() {
        let points = vec![(0.0, 1.0), (0.1, 2.0), (0.2, f64::NAN), (0.9, 3.0), (1.0, 4.0)];
        let line = Line { drawn: Drawn::Joined, ..line("", points) };
        let panel = Panel { lines: vec![line], equal: true, ..Panel::default() };
        let svg = draw(&[panel], 1).unwrap();
        assert_eq!(svg.matches("stroke=\"#1F77B4\"").count(), 2, "two stretches: {svg}");
    }
}
