//! Panels as interactive plots: drawn in the reader's browser, in the page's colours.

use maud::{Markup, PreEscaped, html};
use serde_json::{Map, Value, json};

use super::scale::{axis, rounded};
use crate::figure::{Colour, Drawn, Line, Panel, Shaded, thinned};

/// Places along a line where the least and the largest value are kept.
const PLACES: usize = 300;

/// Colours by role: variables of the style sheet.
pub const BEFORE: &str = "--before";
pub const AFTER: &str = "--after";
pub const MEASURED: &str = "--measured";
pub const NOISE: &str = "--floor";
/// What should be.
pub const NOMINAL: &str = "--ink";
const SERIES: [&str; 10] = [
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

/// How a panel stands on the page.
#[derive(Clone, Copy, Default)]
pub struct Look<'a> {
    /// Names of lines that are told apart by colour, in all panels beside each other.
    pub names: &'a [&'a str],
    /// Is it as wide as the page, and lower?
    pub whole: bool,
    /// Panels of one group show the same stretch of the horizontal axis.
    pub group: Option<&'a str>,
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

/// The style sheet's variable for a colour; `series` is the place of the line's name.
pub fn variable(colour: Colour, series: usize) -> &'static str {
    match colour {
        Colour::ByName => SERIES[series % SERIES.len()],
        Colour::Measured => MEASURED,
        Colour::Before => BEFORE,
        Colour::After => AFTER,
    }
}

pub fn plot(panel: &Panel, look: Look<'_>) -> Markup {
    // The text must not end the element it stands in.
    let json = spec(panel, look.names).to_string().replace("</", "<\\/");
    let class = if look.whole { "plot low" } else { "plot" };
    let about = format!("{}: {} over {}", panel.title, panel.up.0, panel.across.0);
    html! {
        div.framed.whole[look.whole] {
            p.plotted { (panel.title) }
            div class=(class) role="img" aria-label=(about) data-group=[look.group] {
                script type="application/json" { (PreEscaped(json)) }
                div style="height:100%" {}
            }
        }
    }
}

/// What the library is given: traces, layout, configuration.
fn spec(panel: &Panel, names: &[&str]) -> Value {
    let place = |line: &Line| names.iter().position(|n| *n == line.label).unwrap_or(0);
    let lines = || panel.lines.iter().map(|line| (line, variable(line.colour, place(line))));
    let mut traces: Vec<Value> = lines()
        .filter(|(line, _)| !line.band.is_empty())
        .map(|(line, colour)| band(panel, line, colour))
        .collect();
    traces.extend(lines().map(|(line, colour)| trace(panel, line, colour)));
    traces.extend(nominal(panel));
    let mut layout = json!({
        "font": { "size": 11, "color": NOMINAL },
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "margin": { "l": 48, "r": 10, "t": 8, "b": 38 },
        "showlegend": false,
        "hovermode": if panel.lines.iter().all(|l| l.drawn == Drawn::Points) { "closest" } else { "x unified" },
        "hoverlabel": { "bgcolor": "--panel", "bordercolor": "--line", "font": { "color": NOMINAL } },
        "xaxis": axis(panel, 0),
        "yaxis": axis(panel, 1),
        "shapes": panel.shaded.iter().map(shape).collect::<Vec<_>>(),
        "annotations": panel.shaded.iter().filter(|s| !s.name.is_empty()).map(label).collect::<Vec<_>>(),
    });
    if panel.equal {
        layout["yaxis"]["scaleanchor"] = json!("x");
    }
    let config = json!({ "responsive": true, "displayModeBar": false });
    json!({ "data": traces, "layout": layout, "config": config })
}

fn trace(panel: &Panel, line: &Line, colour: &str) -> Value {
    let points = match line.drawn {
        Drawn::Points => line.points.clone(),
        Drawn::Joined | Drawn::Marked => thinned(&line.points, PLACES),
    };
    let style = match line.drawn {
        Drawn::Points => {
            json!({ "mode": "markers", "marker": { "color": colour, "size": 4, "opacity": 0.55 } })
        }
        // What was recorded is seen below what follows it.
        Drawn::Joined => {
            let width = if line.colour == Colour::Measured { 3.0 } else { 1.3 };
            json!({ "mode": "lines", "line": { "color": colour, "width": width } })
        }
        Drawn::Marked => json!({
            "mode": "lines+markers",
            "line": { "color": colour, "width": 1.6 },
            "marker": { "color": colour, "size": 5 },
        }),
    };
    scatter(panel.written(&points), json!({ "name": line.label }), style)
}

/// The interval of a line as an area in its colour.
fn band(panel: &Panel, line: &Line, colour: &str) -> Value {
    let low = line.band.iter().map(|b| (b.0, b.1));
    let outline: Vec<(f64, f64)> = low.chain(line.band.iter().rev().map(|b| (b.0, b.2))).collect();
    let style = json!({
        "mode": "lines",
        "line": { "color": colour, "width": 0 },
        "fill": "toself",
        "fillcolor": colour,
        "opacity": 0.18,
        "hoverinfo": "skip",
    });
    scatter(panel.written(&outline), json!({}), style)
}

fn nominal(panel: &Panel) -> Option<Value> {
    let style =
        json!({ "mode": "lines", "line": { "color": NOMINAL, "width": 1, "dash": "dash" } });
    let points = panel.written(&panel.nominal);
    (!points.is_empty()).then(|| scatter(points, json!({ "name": "what should be" }), style))
}

/// A trace of short numbers; gaps where y is none.
fn scatter(points: Vec<(f64, f64)>, name: Value, style: Value) -> Value {
    let (x, y): (Vec<f64>, Vec<f64>) =
        points.into_iter().map(|(x, y)| (rounded(x), rounded(y))).unzip();
    let mut trace = Map::new();
    trace.extend([
        ("type".into(), json!("scatter")),
        ("x".into(), json!(x)),
        ("y".into(), json!(y)),
    ]);
    for part in [name, style] {
        trace.extend(part.as_object().cloned().unwrap_or_default());
    }
    Value::Object(trace)
}

fn shape(s: &Shaded) -> Value {
    json!({
        "type": "rect", "layer": "below", "xref": "x", "yref": "paper",
        "x0": rounded(s.from), "x1": rounded(s.to), "y0": 0, "y1": 1,
        "fillcolor": "--regime", "opacity": 0.16, "line": { "width": 0 },
    })
}

fn label(s: &Shaded) -> Value {
    json!({
        "text": s.name, "xref": "x", "yref": "paper", "x": rounded(0.5 * (s.from + s.to)), "y": 0,
        "yanchor": "bottom", "showarrow": false, "font": { "size": 10, "color": "--quiet" },
    })
}
