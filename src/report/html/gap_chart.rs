//! The first picture: the gap of every joint before and after, against the noise floor.

use maud::{Markup, html};

use crate::diagnosis::Diagnosis;

/// In units of the picture, which a phone shows at about its own size.
const WIDTH: f64 = 430.0;
const LEFT: f64 = 58.0;
const RIGHT: f64 = 318.0;
const TOP: f64 = 30.0;
const ROW: f64 = 26.0;

/// One joint, N.m.
struct Row {
    joint: usize,
    before: f64,
    after: Option<f64>,
    floor: f64,
}

pub fn gap_chart(d: &Diagnosis) -> Markup {
    let rows = rows(d);
    let Some(scale) = Scale::new(&rows) else { return html! {} };
    let bottom = TOP + ROW * rows.len() as f64;
    let height = bottom + 34.0;
    html! {
        figure {
            svg viewBox={ "0 0 " (WIDTH) " " (height) } role="img"
                aria-label="Gap of every joint before and after, against the noise floor" {
                (legend(!d.causes.is_empty()))
                @for tick in scale.ticks() {
                    @let x = scale.x(tick);
                    line x1=(px(x)) x2=(px(x)) y1=(px(TOP)) y2=(px(bottom)) stroke="var(--line)" {}
                    text.quiet x=(px(x)) y=(px(bottom + 13.0)) text-anchor="middle" { (tick) }
                }
                text.quiet x=(px(0.5 * (LEFT + RIGHT))) y=(px(bottom + 28.0)) text-anchor="middle" {
                    "recorded torque less the twin's, rms on the check recording, N.m"
                }
                @for (i, row) in rows.iter().enumerate() {
                    (row.markup(&scale, TOP + ROW * (i as f64 + 0.5)))
                }
            }
            figcaption {
                "How far the twin is from the arm at each joint, and how far it would be by the "
                "sensors' noise alone (grey). The scale is logarithmic."
            }
        }
    }
}

fn rows(d: &Diagnosis) -> Vec<Row> {
    let after = |joint: usize| {
        let found = d.shrink.torque.joints.iter().find(|j| j.joint == joint);
        found.filter(|_| !d.causes.is_empty()).map(|j| j.after_nm)
    };
    let row = |j: &crate::diagnosis::JointGap| Row {
        joint: j.joint,
        before: j.rms_nm,
        after: after(j.joint),
        floor: j.noise_floor_nm,
    };
    d.gap.joints.iter().map(row).collect()
}

fn legend(both: bool) -> Markup {
    let entry = |x: f64, colour: &str, name: &str| {
        html! {
            circle cx=(px(x)) cy="12" r="5" fill=(colour) {}
            text x=(px(x + 9.0)) y="16" { (name) }
        }
    };
    html! {
        (entry(LEFT + 4.0, "var(--before)", "twin as given"))
        @if both { (entry(LEFT + 108.0, "var(--after)", "mended twin")) }
        rect x=(px(LEFT + 212.0)) y="6" width="12" height="12" fill="var(--floor)" {}
        text x=(px(LEFT + 229.0)) y="16" { "noise" }
    }
}

impl Row {
    fn markup(&self, scale: &Scale, y: f64) -> Markup {
        let x = |nm: f64| px(scale.x(nm));
        let numbers = match self.after {
            Some(after) => format!("{} → {}", short(self.before), short(after)),
            None => short(self.before),
        };
        html! {
            text x="0" y=(px(y + 4.0)) { "joint " (self.joint) }
            rect x=(px(LEFT)) y=(px(y - 9.0)) width=(px((scale.x(self.floor) - LEFT).max(0.0)))
                height="18" fill="var(--floor)" {}
            @if let Some(after) = self.after {
                line x1=(x(self.before)) x2=(x(after)) y1=(px(y)) y2=(px(y))
                    stroke="var(--quiet)" stroke-width="1.5" {}
            }
            @if self.before > 0.0 {
                circle cx=(x(self.before)) cy=(px(y)) r="5.5" fill="var(--before)" {}
            }
            @if let Some(after) = self.after.filter(|a| *a > 0.0) {
                circle cx=(x(after)) cy=(px(y)) r="5.5" fill="var(--after)" {}
            }
            text x=(px(RIGHT + 12.0)) y=(px(y + 4.0)) { (numbers) }
        }
    }
}

/// N.m to places across, by their logarithms.
struct Scale {
    low: f64,
    high: f64,
}

impl Scale {
    fn new(rows: &[Row]) -> Option<Self> {
        let values = rows.iter().flat_map(|r| [Some(r.before), r.after, Some(r.floor)]).flatten();
        let (low, high) = values
            .filter(|v| *v > 0.0 && v.is_finite())
            .fold((f64::INFINITY, 0.0f64), |(low, high), v| (low.min(v), high.max(v)));
        (high > 0.0).then(|| Self { low: low / 1.6, high: high * 1.3 })
    }

    fn x(&self, nm: f64) -> f64 {
        let share = (nm.max(self.low) / self.low).ln() / (self.high / self.low).ln();
        LEFT + share * (RIGHT - LEFT)
    }

    /// 1, 2, 5, 10, ...; powers of ten alone where those are too many.
    fn ticks(&self) -> Vec<f64> {
        let decades = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let steps: &[f64] = if self.high / self.low > 200.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let at = |decade: i32, step: f64| match decade < 0 {
            true => step / 10f64.powi(-decade),
            false => step * 10f64.powi(decade),
        };
        let all = decades.flat_map(|d| steps.iter().map(move |s| at(d, *s)));
        all.filter(|t| (self.low..=self.high).contains(t)).collect()
    }
}

fn px(x: f64) -> String {
    format!("{x:.1}")
}

/// Two or three digits.
fn short(nm: f64) -> String {
    match nm {
        x if x < 1.0 => format!("{x:.3}"),
        x if x < 10.0 => format!("{x:.2}"),
        x => format!("{x:.1}"),
    }
}
