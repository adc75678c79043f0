//! Panels of lines drawn as SVG.

use plotters::prelude::*;

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
/// Red, green, blue.
pub const COLOURS: [[u8; 3]; 6] =
    [[31, 119, 180], [214, 90, 20], [44, 140, 60], [190, 40, 50], [130, 90, 170], [120, 120, 120]];

/// Stretches of points; nothing is drawn between two stretches.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    pub label: String,
    pub colour: usize,
    pub stretches: Vec<Vec<(f64, f64)>>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    pub title: String,
    /// Unit; `s` over time.
    pub across: &'static str,
    pub up: &'static str,
    pub lines: Vec<Line>,
    /// One scale across and up.
    pub equal: bool,
}

impl Line {
    pub fn new(label: &str, colour: usize, points: Vec<(f64, f64)>) -> Self {
        Self { label: label.into(), colour, stretches: vec![points] }
    }

    /// Rows with gaps: `slots` count steps of `dt`.
    pub fn with_gaps(label: &str, colour: usize, slots: &[usize], dt: f64, y: &[f64]) -> Self {
        let point = |k: usize| (slots[k] as f64 * dt, y[k]);
        let stretch = |r: std::ops::Range<usize>| r.map(point).collect();
        let stretches = crate::statistics::contiguous(slots).into_iter().map(stretch).collect();
        Self { label: label.into(), colour, stretches }
    }
}

impl Line {
    fn points(&self) -> usize {
        self.stretches.iter().map(Vec::len).sum()
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
            let [r, g, b] = COLOURS[line.colour % COLOURS.len()];
            let colour = RGBColor(r, g, b);
            let mut named = false;
            let thin = line.points().div_ceil(MOST_POINTS).max(1);
            for stretch in &line.stretches {
                let points = stretch.iter().copied().step_by(thin);
                let drawn = chart.draw_series(LineSeries::new(points, colour));
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

/// A range with the middle of `r` and another span.
fn around(r: &std::ops::Range<f64>, span: f64) -> std::ops::Range<f64> {
    let middle = 0.5 * (r.start + r.end);
    middle - 0.5 * span..middle + 0.5 * span
}

/// Range of the values, with `more` of its span added at both ends.
fn range(values: impl Iterator<Item = f64>, more: f64) -> std::ops::Range<f64> {
    let ends = |(a, b): (f64, f64), v: f64| (a.min(v), b.max(v));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), ends);
    let pad = (more * (high - low)).max(1e-9);
    if low <= high { low - pad..high + pad } else { 0.0..1.0 }
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
