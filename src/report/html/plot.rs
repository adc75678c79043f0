//! Interactive plots: drawn in the reader's browser, in the page's colours.

use maud::{Markup, PreEscaped, html};
use plotly::common::{DashType, ExponentFormat, Fill, Font, HoverInfo, Line, Marker, Mode, Title};
use plotly::configuration::DisplayModeBar;
use plotly::layout::{
    Annotation, Axis, AxisRange, AxisType, HoverMode, Margin, Shape, ShapeLayer, ShapeLine,
    ShapeType,
};
use plotly::{Configuration, Layout, Scatter};

/// Digits that are kept of a value: a plot is no data store.
const DIGITS: i32 = 4;

/// Colours by role: variables of the style sheet.
pub const BEFORE: &str = "--before";
pub const AFTER: &str = "--after";
pub const MEASURED: &str = "--measured";
const REGIME: &str = "--regime";
/// What has no role is told apart by these.
pub const SERIES: [&str; 10] = [
    "--series-1",
    "--series-2",
    "--series-3",
    "--series-4",
    "--series-5",
    "--series-6",
    "--series-7",
    "--series-8",
    "--series-9",
    "--series-10",
];
/// What should be.
pub const NOMINAL: &str = "--ink";

/// One set of points.
pub struct Curve<'a> {
    pub name: &'a str,
    pub colour: &'static str,
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    pub drawn: Drawn,
}

/// How a curve is drawn. Lines have gaps where a value is not a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drawn {
    Points,
    Joined,
    /// Few points, joined.
    Marked,
    Dashed,
}

/// An area in a curve's colour, below the curves: its interval.
pub struct Area {
    pub colour: &'static str,
    /// (x, y) once around.
    pub outline: Vec<(f64, f64)>,
}

/// How numbers stand along an axis; plainly, as far as the points go, by default.
#[derive(Default)]
pub struct Scale {
    pub log: bool,
    /// First and last number.
    pub range: Option<[f64; 2]>,
    /// What is written where, in place of numbers.
    pub ticks: Vec<(f64, String)>,
}

/// An interval on the horizontal axis.
pub struct Band {
    pub name: String,
    pub from: f64,
    pub to: f64,
}

#[derive(Default)]
pub struct Plot<'a> {
    pub title: String,
    pub across: &'a str,
    pub up: &'a str,
    pub curves: Vec<Curve<'a>>,
    pub areas: Vec<Area>,
    pub bands: Vec<Band>,
    /// Across and up.
    pub scales: [Scale; 2],
    /// Is it as wide as the page, and lower?
    pub whole: bool,
}

/// What the colours of the plots mean.
pub fn key(entries: &[(&str, &str)]) -> Markup {
    html! {
        p.key {
            @for (name, colour) in entries {
                span { i style={ "background: var(" (colour) ")" } {} (name) }
            }
        }
    }
}

impl Plot<'_> {
    pub fn markup(&self) -> Markup {
        let mut plot = plotly::Plot::new();
        for area in &self.areas {
            plot.add_trace(area.trace());
        }
        for curve in &self.curves {
            plot.add_trace(curve.trace());
        }
        plot.set_layout(self.layout());
        plot.set_configuration(
            Configuration::new().responsive(true).display_mode_bar(DisplayModeBar::False),
        );
        // The text must not end the element it stands in.
        let json = plot.to_json().replace("</", "<\\/");
        let class = if self.whole { "plot low whole" } else { "plot" };
        html! {
            div class=(class) role="img" aria-label=(format!("{}: {} over {}", self.title, self.up, self.across)) {
                script type="application/json" { (PreEscaped(json)) }
                div style="height:100%" {}
            }
        }
    }

    fn layout(&self) -> Layout {
        let [across, up] = &self.scales;
        let title = Font::new().size(13).color("--ink");
        Layout::new()
            .title(Title::with_text(&self.title).font(title).x(0.0))
            .font(Font::new().size(11).color("--ink"))
            .paper_background_color("rgba(0,0,0,0)")
            .plot_background_color("rgba(0,0,0,0)")
            .margin(Margin::new().left(48).right(16).top(34).bottom(40))
            .show_legend(false)
            .hover_mode(HoverMode::Closest)
            .x_axis(across.axis(self.across, across.range.or_else(|| self.extent())))
            .y_axis(up.axis(self.up, up.range))
            .shapes(self.bands.iter().map(Band::shape).collect())
            .annotations(
                self.bands.iter().filter(|b| !b.name.is_empty()).map(Band::label).collect(),
            )
    }

    /// Range of the points, so that bands do not widen the plot; as the library counts along the axis.
    fn extent(&self) -> Option<[f64; 2]> {
        let values = self.curves.iter().flat_map(|c| &c.x).map(|x| self.scales[0].place(*x));
        let (low, high) = values
            .filter(|x| x.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let room = 0.02 * (high - low);
        (high > low).then(|| [rounded(low - room), rounded(high + room)])
    }
}

impl Scale {
    /// Where the library has a number along the axis.
    fn place(&self, x: f64) -> f64 {
        if self.log { x.log10() } else { x }
    }

    fn axis(&self, title: &str, range: Option<[f64; 2]>) -> Axis {
        let font = Font::new().size(11).color("--quiet");
        let mut axis = Axis::new()
            .title(Title::with_text(title).font(font))
            .grid_color("--line")
            .zero_line_color("--line")
            .line_color("--line")
            .exponent_format(ExponentFormat::SmallE)
            .auto_margin(true);
        if self.log {
            axis = axis.type_(AxisType::Log);
        }
        if let Some([low, high]) = range {
            axis = axis.range(AxisRange::new(low, high));
        }
        if !self.ticks.is_empty() {
            let (at, text) = self.ticks.iter().cloned().unzip();
            axis = axis.tick_values(at).tick_text(text);
        }
        axis
    }
}

/// A trace of short numbers.
fn scatter(points: impl Iterator<Item = (f64, f64)>) -> Box<Scatter<f64, f64>> {
    let (x, y): (Vec<f64>, Vec<f64>) = points.map(|(x, y)| (rounded(x), rounded(y))).unzip();
    Scatter::new(x, y)
}

impl Curve<'_> {
    fn trace(&self) -> Box<Scatter<f64, f64>> {
        let points = self.x.iter().copied().zip(self.y.iter().copied());
        let trace = scatter(points).name(self.name).connect_gaps(false);
        let line = Line::new().color(self.colour);
        let marker = Marker::new().color(self.colour);
        match self.drawn {
            Drawn::Points => trace.mode(Mode::Markers).marker(marker.size(4).opacity(0.55)),
            Drawn::Joined => trace.mode(Mode::Lines).line(line.width(1.2)),
            Drawn::Marked => {
                trace.mode(Mode::LinesMarkers).line(line.width(1.6)).marker(marker.size(5))
            }
            Drawn::Dashed => trace.mode(Mode::Lines).line(line.width(1.0).dash(DashType::Dash)),
        }
    }
}

impl Area {
    fn trace(&self) -> Box<Scatter<f64, f64>> {
        scatter(self.outline.iter().copied())
            .mode(Mode::Lines)
            .line(Line::new().width(2.0).color(self.colour))
            .fill(Fill::ToSelf)
            .fill_color(self.colour)
            .opacity(0.18)
            .hover_info(HoverInfo::Skip)
    }
}

impl Band {
    fn shape(&self) -> Shape {
        Shape::new()
            .shape_type(ShapeType::Rect)
            .layer(ShapeLayer::Below)
            .x_ref("x")
            .y_ref("paper")
            .x0(rounded(self.from))
            .x1(rounded(self.to))
            .y0(0.0)
            .y1(1.0)
            .fill_color(REGIME)
            .opacity(0.16)
            .line(ShapeLine::new().width(0.0).dash(DashType::Solid))
    }

    fn label(&self) -> Annotation {
        Annotation::new()
            .text(&self.name)
            .x_ref("x")
            .y_ref("paper")
            .x(rounded(0.5 * (self.from + self.to)))
            .y(0.0)
            .y_anchor(plotly::common::Anchor::Bottom)
            .show_arrow(false)
            .font(Font::new().size(10).color("--quiet"))
    }
}

/// Least and largest value of each of `places` stretches of the same length, in the order they come:
/// peaks stay.
pub fn thinned(x: &[f64], y: &[f64], places: usize) -> [Vec<f64>; 2] {
    let stretch = y.len().div_ceil(places.max(1)).max(1);
    if stretch <= 2 {
        return [x.to_vec(), y.to_vec()];
    }
    let kept = y.chunks(stretch).enumerate().flat_map(|(place, values)| {
        let by_value = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]);
        let least = (0..values.len()).min_by(by_value).unwrap_or(0);
        let largest = (0..values.len()).max_by(by_value).unwrap_or(0);
        [least.min(largest), least.max(largest)].map(|k| place * stretch + k)
    });
    let mut kept: Vec<usize> = kept.collect();
    kept.dedup();
    [x, y].map(|series| kept.iter().map(|k| series[*k]).collect())
}

/// Rows in order of time, a NaN where some are further apart than `step`; of every so many one, so that
/// `most` are left.
pub fn with_gaps(time: &[f64], y: &[f64], step: f64, most: usize) -> [Vec<f64>; 2] {
    let stride = time.len().div_ceil(most).max(1);
    let mut out = [Vec::new(), Vec::new()];
    let mut last: Option<f64> = None;
    for (k, (&t, &y)) in time.iter().zip(y).enumerate() {
        let gap = last.is_some_and(|last| t - last > 1.5 * step);
        if gap {
            out[0].push(t);
            out[1].push(f64::NAN);
        }
        if gap || k % stride == 0 {
            out[0].push(t);
            out[1].push(y);
        }
        last = Some(t);
    }
    out
}

/// The number rounded to [`DIGITS`] digits.
pub fn rounded(x: f64) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return x;
    }
    let scale = 10f64.powi(DIGITS - 1 - x.abs().log10().floor() as i32);
    // Division by a power of ten comes out as the nearest short number.
    if scale >= 1.0 {
        (x * scale).round() / scale
    } else {
        (x * scale).round() * (1.0 / scale).round()
    }
}
