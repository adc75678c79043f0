//! Line plots with bands as SVG, panels side by side below one legend.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::panel::{Figure, Panel, Scale};
use crate::studies::StudyError;

const PANEL: (u32, u32) = (400, 260);
const LEGEND_HEIGHT: u32 = 26;
const MARGIN: u32 = 14;
const COLOURS: [RGBColor; 8] = [
    RGBColor(31, 119, 180),
    RGBColor(214, 90, 20),
    RGBColor(44, 140, 60),
    RGBColor(130, 90, 170),
    RGBColor(190, 40, 50),
    RGBColor(120, 120, 120),
    RGBColor(180, 140, 20),
    RGBColor(20, 150, 160),
];

fn failed(e: impl std::fmt::Display) -> StudyError {
    StudyError::Table(format!("a plot cannot be drawn: {e}"))
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

impl Figure {
    /// # Errors
    /// If the plotting library refuses.
    pub fn svg(&self) -> Result<String, StudyError> {
        draw(self)
    }
}

/// Panels in rows, all of one size.
///
/// # Errors
/// If the plotting library refuses.
pub fn draw(figure: &Figure) -> Result<String, StudyError> {
    let columns = figure.columns.min(figure.panels.len()).max(1);
    let rows = figure.panels.len().div_ceil(columns).max(1);
    let width = PANEL.0 * columns as u32;
    let labels = figure.labels();
    let places = placed(&labels, width);
    let top = LEGEND_HEIGHT * places.last().map_or(1, |p| p.1 + 1);
    let size = (width, PANEL.1 * rows as u32 + top);
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let (top, below) = root.split_vertically(top);
        legend(&top, &labels, &places)?;
        for (panel, area) in figure.panels.iter().zip(below.split_evenly((rows, columns))) {
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

fn legend(area: &Area<'_>, labels: &[&str], places: &[(u32, u32)]) -> Result<(), StudyError> {
    for (k, (label, (x, row))) in labels.iter().zip(places).enumerate() {
        let (x, y) = (*x as i32, (row * LEGEND_HEIGHT + LEGEND_HEIGHT / 2) as i32);
        let stroke = vec![(x, y), (x + 18, y)];
        area.draw(&PathElement::new(stroke, colour(k).stroke_width(3))).map_err(failed)?;
        let place = Pos::new(HPos::Left, VPos::Center);
        let style = ("sans-serif", 13).into_text_style(area).pos(place);
        area.draw_text(label, &style, (x + 23, y)).map_err(failed)?;
    }
    Ok(())
}

fn colour(k: usize) -> RGBColor {
    COLOURS[k % COLOURS.len()]
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

/// Three significant digits without trailing zeros.
pub fn digits(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    let after = (2.0 - x.abs().log10().floor()).max(0.0) as usize;
    if after > 6 {
        return format!("{x:.0e}");
    }
    let text = format!("{x:.after$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => text,
    }
}

fn draw_panel(panel: &Panel, area: &Area<'_>, labels: &[&str]) -> Result<(), StudyError> {
    let none = panel.none();
    let (sx, sy) = (panel.across.1, panel.up.1);
    let [x, y] = ranges(panel);
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.title, ("sans-serif", 14))
        .margin(8)
        .x_label_area_size(36)
        .y_label_area_size(52)
        .build_cartesian_2d(x, y)
        .map_err(failed)?;
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
        let colour = colour(labels.iter().position(|l| *l == line.label).unwrap_or(0));
        let outline = panel.outline(line);
        if !outline.is_empty() {
            let band = Polygon::new(outline, colour.mix(0.15).filled());
            chart.draw_series(std::iter::once(band)).map_err(failed)?;
        }
        let points = panel.placed(&line.points);
        let dots = points.iter().map(|p| Circle::new(*p, 2, colour.filled()));
        chart.draw_series(dots).map_err(failed)?;
        let stroke = colour.stroke_width(2);
        chart.draw_series(LineSeries::new(points, stroke)).map_err(failed)?;
    }
    let nominal = panel.placed(&panel.nominal);
    let dashed = DashedLineSeries::new(nominal, 5, 4, BLACK.stroke_width(1));
    chart.draw_series(dashed).map_err(failed)?;
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
    [range(points.iter().map(|p| p.0), 0.03), y]
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
    use super::super::panel::Line;
    use super::*;

    #[test]
    fn panels_share_a_legend_and_no_noise_has_a_place() {
        let line = |label: &str| Line {
            label: label.into(),
            points: vec![(10.0, 0.5), (20.0, 0.9), (f64::INFINITY, 1.0)],
            band: vec![(10.0, 0.4, 0.6), (20.0, 0.8, 1.0), (f64::INFINITY, 0.9, 1.0)],
        };
        let panel = |lines| Panel {
            title: "t".into(),
            across: ("SNR, dB", Scale::Decibel),
            up: ("%", Scale::Share),
            lines,
            nominal: vec![(10.0, 0.99), (20.0, 0.99)],
        };
        let panels = vec![panel(vec![line("a"), line("b")]), panel(vec![])];
        let figure = Figure { file: "f.svg".into(), caption: "c".into(), panels, columns: 2 };
        let svg = draw(&figure).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("none") && svg.contains("SNR, dB"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }

    #[test]
    fn digits_are_few() {
        assert_eq!(
            [1234.0, 12.34, 0.5, 0.0012, 100.0].map(digits),
            ["1234", "12.3", "0.5", "0.0012", "100"]
        );
    }
}
