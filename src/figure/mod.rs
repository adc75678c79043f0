//! What a plot shows, as data: lines over one quantity, panel by panel. `svg` draws a figure as a file,
//! `report::html` as plots that can be zoomed, `viewer` shows its lines in a window.

#[cfg(feature = "studies")]
mod svg;
mod thin;

#[cfg(feature = "studies")]
pub use svg::{FigureError, draw};
pub use thin::{every, over_time, runs, thinned};

/// Panels with one legend.
#[derive(Debug, Clone, Default)]
pub struct Figure {
    /// File its drawing goes to; its name ends in `.svg`.
    pub file: String,
    pub caption: String,
    pub panels: Vec<Panel>,
    /// Panels side by side where there is room.
    pub columns: usize,
}

/// Lines over one quantity.
#[derive(Debug, Clone, Default)]
pub struct Panel {
    pub title: String,
    /// Quantity with its unit, and how its numbers stand along the axis.
    pub across: (&'static str, Scale),
    pub up: (&'static str, Scale),
    pub lines: Vec<Line>,
    /// What should be, as (x, y).
    pub nominal: Vec<(f64, f64)>,
    pub shaded: Vec<Shaded>,
    /// Both axes have one scale, as a map has.
    pub equal: bool,
}

#[derive(Debug, Clone, Default)]
pub struct Line {
    pub label: String,
    pub colour: Colour,
    pub drawn: Drawn,
    /// (x, y); a line ends where y is not a number.
    pub points: Vec<(f64, f64)>,
    /// Interval of every point as (x, low, high), x rising; empty where none is known.
    pub band: Vec<(f64, f64, f64)>,
}

/// A colour by what a line means.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Colour {
    /// Lines of one name have one colour in all panels of a figure.
    #[default]
    ByName,
    Measured,
    /// The twin as it was given.
    Before,
    /// The twin with what was found.
    After,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Drawn {
    /// Few points, joined.
    #[default]
    Marked,
    Joined,
    Points,
}

/// A stretch along the horizontal axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Shaded {
    pub name: String,
    pub from: f64,
    pub to: f64,
}

/// How numbers stand along an axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Scale {
    #[default]
    Linear,
    Log,
    /// dB; infinite ones stand right of the others as "none".
    Decibel,
    /// 0 to 100 %
    Share,
}

/// Red, green and blue of the lines that are told apart by their names.
pub const SERIES: [[u8; 3]; 10] = [
    [31, 119, 180],
    [214, 90, 20],
    [44, 140, 60],
    [130, 90, 170],
    [190, 40, 50],
    [120, 120, 120],
    [160, 122, 0],
    [20, 150, 159],
    [194, 81, 158],
    [122, 82, 48],
];

impl Colour {
    /// Red, green, blue; `series` is the place of the line's name among the figure's.
    pub fn rgb(self, series: usize) -> [u8; 3] {
        match self {
            Self::ByName => SERIES[series % SERIES.len()],
            Self::Measured => [123, 135, 148],
            Self::Before => [194, 65, 12],
            Self::After => [15, 118, 110],
        }
    }
}

impl Figure {
    /// Different names of lines in the order they come.
    pub fn labels(&self) -> Vec<&str> {
        labels(&self.panels)
    }

    /// # Errors
    /// If the plotting library refuses.
    #[cfg(feature = "studies")]
    pub fn svg(&self) -> Result<String, FigureError> {
        draw(&self.panels, self.columns)
    }
}

/// Different names of lines in the order they come.
pub fn labels(panels: &[Panel]) -> Vec<&str> {
    let mut labels: Vec<&str> = Vec::new();
    for line in panels.iter().flat_map(|p| &p.lines) {
        if !line.label.is_empty() && !labels.contains(&line.label.as_str()) {
            labels.push(&line.label);
        }
    }
    labels
}

impl Scale {
    /// Where a number stands: log10, percent, or the number itself.
    fn place(self, x: f64, none: f64) -> f64 {
        match self {
            Self::Log => x.max(1e-12).log10(),
            Self::Share => 100.0 * x,
            Self::Decibel if x.is_infinite() => none,
            _ => x,
        }
    }
}

impl Panel {
    /// Where "none" stands along an axis of dB.
    pub fn none(&self) -> f64 {
        let points = self.lines.iter().flat_map(|l| &l.points).chain(&self.nominal);
        points.map(|p| p.0).filter(|x| x.is_finite()).fold(0.0, f64::max) + 10.0
    }

    /// Where points stand along both axes: log10 on a [`Scale::Log`], percent on a [`Scale::Share`].
    pub fn placed(&self, points: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let none = self.none();
        let place = |p: &(f64, f64)| (self.across.1.place(p.0, none), self.up.1.place(p.1, none));
        points.iter().map(place).collect()
    }

    /// Points as they are written along the axes: percent on a [`Scale::Share`], "none" as a place on a
    /// [`Scale::Decibel`].
    pub fn written(&self, points: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let none = self.none();
        let number = |scale: Scale, x: f64| match scale {
            Scale::Log => x,
            _ => scale.place(x, none),
        };
        points.iter().map(|p| (number(self.across.1, p.0), number(self.up.1, p.1))).collect()
    }

    /// Outline of a line's band: there along its low edge, back along the high one.
    pub fn outline(&self, line: &Line) -> Vec<(f64, f64)> {
        let low = line.band.iter().map(|b| (b.0, b.1));
        let high = line.band.iter().rev().map(|b| (b.0, b.2));
        self.placed(&low.chain(high).collect::<Vec<_>>())
    }
}
