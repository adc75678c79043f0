//! Line plots with bands as SVG, panels side by side below one legend.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

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

#[derive(Debug, Clone, Default)]
pub struct Line {
    /// Lines of one name have one colour in all panels.
    pub label: String,
    pub points: Vec<(f64, f64)>,
    /// (x, low, high)
    pub band: Vec<(f64, f64, f64)>,
}

/// How numbers stand along an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    Linear,
    Log,
    /// dB; infinite ones stand right of the others as "none".
    Decibel,
    /// 0 to 100 %
    Share,
}

#[derive(Debug, Clone)]
pub struct Panel {
    pub title: String,
    pub across: (&'static str, Scale),
    pub up: (&'static str, Scale),
    pub lines: Vec<Line>,
    /// A dashed line: what should be.
    pub nominal: Vec<(f64, f64)>,
}

fn failed(e: impl std::fmt::Display) -> StudyError {
    StudyError::Table(format!("a plot cannot be drawn: {e}"))
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Panels in rows of `columns`.
///
/// # Errors
/// If the plotting library refuses.
pub fn draw(panels: &[Panel], columns: usize) -> Result<String, StudyError> {
    let rows = panels.len().div_ceil(columns).max(1);
    let columns = columns.min(panels.len()).max(1);
    let width = PANEL.0 * columns as u32;
    let mut labels: Vec<&str> = Vec::new();
    for label in panels.iter().flat_map(|p| &p.lines).map(|l| l.label.as_str()) {
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    let places = placed(&labels, width);
    let top = LEGEND_HEIGHT * places.last().map_or(1, |p| p.1 + 1);
    let size = (width, PANEL.1 * rows as u32 + top);
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let (top, below) = root.split_vertically(top);
        legend(&top, &labels, &places)?;
        for (panel, area) in panels.iter().zip(below.split_evenly((rows, columns))) {
            panel.draw(&area, &labels)?;
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

impl Scale {
    fn place(self, x: f64, none: f64) -> f64 {
        match self {
            Self::Log => x.max(1e-12).log10(),
            Self::Share => 100.0 * x,
            Self::Decibel if x.is_infinite() => none,
            _ => x,
        }
    }

    fn text(self, x: f64, none: f64) -> String {
        match self {
            Self::Log => digits(rounded(10f64.powf(x))),
            Self::Decibel if (x - none).abs() < 1e-6 => "none".into(),
            _ => digits(x),
        }
    }
}

/// To two significant digits.
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

impl Panel {
    fn draw(&self, area: &Area<'_>, labels: &[&str]) -> Result<(), StudyError> {
        let all = || self.lines.iter().flat_map(|l| &l.points).chain(&self.nominal);
        let finite = all().map(|p| p.0).filter(|x| x.is_finite());
        let none = finite.fold(0.0, f64::max) + 10.0;
        let (sx, sy) = (self.across.1, self.up.1);
        let place = |p: (f64, f64)| (sx.place(p.0, none), sy.place(p.1, none));
        let x = range(all().map(|p| place(*p).0), 0.03);
        let bands = self.lines.iter().flat_map(|l| &l.band);
        let edges = bands.flat_map(|b| [sy.place(b.1, none), sy.place(b.2, none)]);
        let y = match sy {
            Scale::Share => -3.0..103.0,
            _ => range(all().map(|p| place(*p).1).chain(edges), 0.06),
        };
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, ("sans-serif", 14))
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
            .x_desc(self.across.0)
            .y_desc(self.up.0)
            .x_label_formatter(&|x| sx.text(*x, none))
            .y_label_formatter(&|y| sy.text(*y, none))
            .label_style(("sans-serif", 11))
            .draw()
            .map_err(failed)?;
        for line in &self.lines {
            let colour = colour(labels.iter().position(|l| *l == line.label).unwrap_or(0));
            let low = line.band.iter().map(|b| place((b.0, b.1)));
            let high = line.band.iter().rev().map(|b| place((b.0, b.2)));
            let outline: Vec<(f64, f64)> = low.chain(high).collect();
            if !outline.is_empty() {
                let band = Polygon::new(outline, colour.mix(0.15).filled());
                chart.draw_series(std::iter::once(band)).map_err(failed)?;
            }
            let points: Vec<(f64, f64)> = line.points.iter().map(|p| place(*p)).collect();
            let dots = points.iter().map(|p| Circle::new(*p, 2, colour.filled()));
            chart.draw_series(dots).map_err(failed)?;
            let stroke = colour.stroke_width(2);
            chart.draw_series(LineSeries::new(points, stroke)).map_err(failed)?;
        }
        let nominal = self.nominal.iter().map(|p| place(*p));
        let dashed = DashedLineSeries::new(nominal, 5, 4, BLACK.stroke_width(1));
        chart.draw_series(dashed).map_err(failed)?;
        Ok(())
    }
}

/// From least to greatest, `more` of the span added at both ends.
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
        let svg = draw(&[panel(vec![line("a"), line("b")]), panel(vec![])], 2).unwrap();
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
