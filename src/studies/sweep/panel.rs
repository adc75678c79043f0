//! What a study's plots show, as data: a file of its own as SVG, or a plot of a page.

/// Panels with one legend, and the file their drawing goes to.
#[derive(Debug, Clone)]
pub struct Figure {
    /// Its name ends in `.svg`.
    pub file: String,
    pub caption: String,
    pub panels: Vec<Panel>,
    /// Side by side where there is room.
    pub columns: usize,
}

/// Lines over one quantity.
#[derive(Debug, Clone)]
pub struct Panel {
    pub title: String,
    /// Quantity with its unit, and how its numbers stand along the axis.
    pub across: (&'static str, Scale),
    pub up: (&'static str, Scale),
    pub lines: Vec<Line>,
    /// What should be, as (x, y).
    pub nominal: Vec<(f64, f64)>,
}

#[derive(Debug, Clone, Default)]
pub struct Line {
    /// Lines of one name have one colour in all panels.
    pub label: String,
    /// (x, y), x rising.
    pub points: Vec<(f64, f64)>,
    /// (x, low, high), x rising; empty where nothing is said of them.
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

impl Figure {
    /// Different names of lines in the order they come.
    pub fn labels(&self) -> Vec<&str> {
        let mut labels: Vec<&str> = Vec::new();
        for label in self.panels.iter().flat_map(|p| &p.lines).map(|l| l.label.as_str()) {
            if !labels.contains(&label) {
                labels.push(label);
            }
        }
        labels
    }
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

    /// Outline of a line's band: there along its low edge, back along the high one.
    pub fn outline(&self, line: &Line) -> Vec<(f64, f64)> {
        let low = line.band.iter().map(|b| (b.0, b.1));
        let high = line.band.iter().rev().map(|b| (b.0, b.2));
        self.placed(&low.chain(high).collect::<Vec<_>>())
    }
}
