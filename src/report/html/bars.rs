//! Numbers as bars from zero, line under line, so that equal ones are both seen.

use maud::{Markup, html};

use crate::numbers::significant;

pub struct Bars<'a> {
    pub about: &'a str,
    /// Name and colour of the bars of every row.
    pub names: Vec<(&'a str, &'static str)>,
    pub rows: Vec<Row>,
    pub caption: &'a str,
}

pub struct Row {
    pub label: String,
    /// As many as there are names; `None` where a number is not known.
    pub values: Vec<Option<f64>>,
}

impl Bars<'_> {
    pub fn markup(&self) -> Markup {
        let values = || self.rows.iter().flat_map(|r| &r.values).flatten();
        let most = values().copied().filter(|v| v.is_finite()).fold(0.0, f64::max);
        html! {
            figure.bars role="img" aria-label=(self.about) {
                (super::plot::key(&self.names))
                div.rows {
                    @for row in &self.rows {
                        span { (row.label) }
                        div {
                            @for (value, (name, colour)) in row.values.iter().zip(&self.names) {
                                (bar(*value, most, name, colour))
                            }
                        }
                    }
                }
                figcaption { (self.caption) }
            }
        }
    }
}

fn bar(value: Option<f64>, most: f64, name: &str, colour: &str) -> Markup {
    let Some(value) = value.filter(|v| v.is_finite()) else { return html! {} };
    let share = if most > 0.0 { (value / most).clamp(0.0, 1.0) } else { 0.0 };
    html! {
        div.bar title=(name) {
            i style={ "background: var(" (colour) "); --share: " (format!("{share:.4}")) } {}
            (significant(value))
        }
    }
}
