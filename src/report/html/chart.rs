//! The first picture of a report: for every row a grey bar to compare with and dots, on a scale that
//! multiplies.

use maud::{Markup, html};

/// In units of the picture, which a phone shows at about its own size.
const WIDTH: f64 = 430.0;
const LEFT: f64 = 58.0;
const RIGHT: f64 = 318.0;
const TOP: f64 = 30.0;
const ROW: f64 = 26.0;

/// Values that are not positive are not drawn.
pub struct Chart<'a> {
    pub about: &'a str,
    pub across: &'a str,
    /// What the grey bar is.
    pub bar: &'a str,
    /// Name and colour of the dots.
    pub dots: Vec<(&'a str, &'static str)>,
    pub rows: Vec<Row>,
    pub caption: &'a str,
}

pub struct Row {
    pub label: String,
    pub bar: Option<f64>,
    pub dots: Vec<Option<f64>>,
}

impl Chart<'_> {
    pub fn markup(&self) -> Markup {
        let Some(scale) = Scale::new(&self.rows) else { return html! {} };
        let bottom = TOP + ROW * self.rows.len() as f64;
        let middle = px(0.5 * (LEFT + RIGHT));
        html! {
            figure {
                svg viewBox={ "0 0 " (WIDTH) " " (bottom + 34.0) } role="img"
                    aria-label=(self.about) {
                    (self.legend())
                    @for tick in ticks(scale.low, scale.high) {
                        @let x = px(scale.x(tick));
                        line x1=(x) x2=(x) y1=(px(TOP)) y2=(px(bottom)) stroke="var(--line)" {}
                        text.quiet x=(x) y=(px(bottom + 13.0)) text-anchor="middle" { (tick) }
                    }
                    text.quiet x=(middle) y=(px(bottom + 28.0)) text-anchor="middle" {
                        (self.across)
                    }
                    @for (i, row) in self.rows.iter().enumerate() {
                        (self.row(row, &scale, TOP + ROW * (i as f64 + 0.5)))
                    }
                }
                figcaption { (self.caption) }
            }
        }
    }

    fn legend(&self) -> Markup {
        let mut at = LEFT;
        let mut next = |name: &str| {
            let x = at;
            at += 30.0 + 6.3 * name.chars().count() as f64;
            x
        };
        let places: Vec<f64> = self.dots.iter().map(|(name, _)| next(name)).collect();
        let bar = next(self.bar);
        html! {
            @for ((name, colour), x) in self.dots.iter().zip(places) {
                circle cx=(px(x + 5.0)) cy="12" r="5" fill={ "var(" (colour) ")" } {}
                text x=(px(x + 14.0)) y="16" { (name) }
            }
            rect x=(px(bar)) y="6" width="12" height="12" fill="var(--floor)" {}
            text x=(px(bar + 16.0)) y="16" { (self.bar) }
        }
    }

    fn row(&self, row: &Row, scale: &Scale, y: f64) -> Markup {
        let shown = |v: &Option<f64>| v.filter(|v| *v > 0.0 && v.is_finite()).map(|v| scale.x(v));
        let dots: Vec<Option<f64>> = row.dots.iter().map(shown).collect();
        let known: Vec<f64> = dots.iter().flatten().copied().collect();
        let numbers: Vec<String> = row.dots.iter().flatten().map(|v| short(*v)).collect();
        html! {
            text x="0" y=(px(y + 4.0)) { (row.label) }
            @if let Some(end) = shown(&row.bar) {
                rect x=(px(LEFT)) y=(px(y - 9.0)) width=(px(end - LEFT)) height="18"
                    fill="var(--floor)" {}
            }
            @if let [from, .., to] = known[..] {
                line x1=(px(from)) x2=(px(to)) y1=(px(y)) y2=(px(y)) stroke="var(--quiet)"
                    stroke-width="1.5" {}
            }
            @for ((_, colour), x) in self.dots.iter().zip(&dots) {
                @if let Some(x) = x {
                    circle cx=(px(*x)) cy=(px(y)) r="5.5" fill={ "var(" (colour) ")" } {}
                }
            }
            text x=(px(RIGHT + 12.0)) y=(px(y + 4.0)) { (numbers.join(" → ")) }
        }
    }
}

/// Values to places across, by their logarithms.
struct Scale {
    low: f64,
    high: f64,
}

impl Scale {
    fn new(rows: &[Row]) -> Option<Self> {
        let values = rows.iter().flat_map(|r| r.dots.iter().chain([&r.bar])).flatten();
        let (low, high) = values
            .filter(|v| **v > 0.0 && v.is_finite())
            .fold((f64::INFINITY, 0.0f64), |(low, high), v| (low.min(*v), high.max(*v)));
        (high > 0.0).then(|| Self { low: low / 1.6, high: high * 1.3 })
    }

    fn x(&self, value: f64) -> f64 {
        let share = (value.max(self.low) / self.low).ln() / (self.high / self.low).ln();
        LEFT + share * (RIGHT - LEFT)
    }
}

/// 1, 2, 5, 10, ... between positive numbers; powers of ten alone where those are too many.
pub fn ticks(low: f64, high: f64) -> Vec<f64> {
    let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
    let steps: &[f64] = if high / low > 200.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let at = |decade: i32, step: f64| match decade < 0 {
        true => step / 10f64.powi(-decade),
        false => step * 10f64.powi(decade),
    };
    let all = decades.flat_map(|d| steps.iter().map(move |s| at(d, *s)));
    all.filter(|t| (low..=high).contains(t)).collect()
}

fn px(x: f64) -> String {
    format!("{x:.1}")
}

/// Two or three digits.
fn short(value: f64) -> String {
    match value {
        x if x != 0.0 && x < 1e-3 => format!("{x:.0e}"),
        x if x < 1.0 => format!("{x:.3}"),
        x if x < 10.0 => format!("{x:.2}"),
        x if x < 1000.0 => format!("{x:.1}"),
        x => format!("{x:.0}"),
    }
}
