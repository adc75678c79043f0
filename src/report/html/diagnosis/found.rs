//! What the twin lacks, every candidate, and what the causes bring.

use maud::{Markup, html};

use super::super::table::table;
use crate::diagnosis::{Cause, Checked, Diagnosis, Named, Ranked, Value, words};
use crate::report::to_uncertainty;

/// Candidates that are shown at once, besides "none" and "unknown".
const RANKED: usize = 8;

pub fn causes(d: &Diagnosis) -> Markup {
    html! {
        @if d.causes.is_empty() {
            p { "None is named." }
        }
        @for cause in &d.causes { (one(cause)) }
    }
}

fn one(c: &Cause) -> Markup {
    let Checked { check_before_nm, check_after_nm, fraction, low, high } = c.shrink;
    let same: Vec<String> = c.equivalent.iter().map(named).collect();
    html! {
        h3 { (c.effect) " at " (words::place(&c.joints)) ": probability " (words::percent(c.probability)) }
        p { (sentence(&c.cause)) }
        (table(&["parameter", "unit", "value", "90 % low", "high", ""], 2, c.parameters.iter().map(value)))
        p {
            "On the check recording, added to the others: "
            (format!("{check_before_nm:.3} → {check_after_nm:.3} N.m, "))
            (words::percent(fraction)) " of the mean square "
            "(90 % interval " (words::percent(low)) " to " (words::percent(high)) ")."
        }
        @if !same.is_empty() { p { "Looks the same in these data: " (same.join("; ")) "." } }
        p { b { "To mend it: " } (c.remedy) "." }
    }
}

/// With a capital and a full stop.
pub fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first: String = letters.next().map(|c| c.to_uppercase().collect()).unwrap_or_default();
    format!("{first}{}.", letters.as_str().trim_end_matches('.'))
}

fn named(n: &Named) -> String {
    format!("{} at {}", n.effect, words::place(&n.joints))
}

fn value(v: &Value) -> Vec<String> {
    let [value, low, high] = to_uncertainty(v.value, v.low, v.high);
    let bound = if v.at_bound { "at its bound" } else { "" };
    vec![v.name.clone(), v.unit.clone(), value, low, high, bound.into()]
}

pub fn ranking(ranking: &[Ranked]) -> Markup {
    if ranking.is_empty() {
        return html! {};
    }
    let special = |r: &&Ranked| ["none", "unknown"].contains(&r.effect.as_str());
    let (special, effects): (Vec<&Ranked>, Vec<&Ranked>) = ranking.iter().partition(special);
    let (first, rest) = effects.split_at(effects.len().min(RANKED));
    let mut shown: Vec<&Ranked> = first.iter().copied().chain(special).collect();
    shown.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let header = ["effect", "at", "probability", "gain fit", "check"];
    html! {
        (table(&header, 2, shown.into_iter().map(row)))
        p.legend {
            "gain: in log-likelihood over the twin, on the recording searched and on the other. "
            "none: chance. unknown: a cause that is not in the catalogue. Probabilities sum to 1."
        }
        @if !rest.is_empty() {
            details {
                summary { (rest.len()) " more" }
                (table(&header, 2, rest.iter().copied().map(row)))
            }
        }
    }
}

fn row(r: &Ranked) -> Vec<String> {
    let special = ["none", "unknown"].contains(&r.effect.as_str());
    let place = if special { String::new() } else { words::place(&r.joints) };
    let gain = |x: f64| if special { "-".into() } else { format!("{x:.1}") };
    vec![
        r.effect.clone(),
        place,
        words::percent(r.probability),
        gain(r.gain_fit),
        gain(r.gain_check),
    ]
}

pub fn episodes(d: &Diagnosis) -> Markup {
    if d.episodes.is_empty() {
        return html! {};
    }
    html! {
        (table(&words::EPISODES, 3, d.episodes.iter().map(words::episode)))
        p.legend { (sentence(words::LOUDER)) }
    }
}

pub fn shrink(d: &Diagnosis) -> Markup {
    let t = &d.shrink.torque;
    let row = |what: String, before: f64, after: f64, share: String| {
        vec![what, format!("{before:.3}"), format!("{after:.3}"), share]
    };
    let joints = t.joints.iter().map(|j| {
        row(format!("joint {}", j.joint), j.before_nm, j.after_nm, words::percent(j.fraction))
    });
    let [share, low, high] = [t.fraction, t.low, t.high].map(words::percent);
    let total =
        row("all joints".into(), t.before_nm, t.after_nm, format!("{share} ({low} to {high})"));
    let header = ["torque on the check recording", "before N.m", "after N.m", "of mean square"];
    html! {
        (table(&header, 1, joints.chain([total])))
        p { "Of what lies above the noise floor: " (words::percent(t.reducible)) "." }
        (simulated(d))
    }
}

fn simulated(d: &Diagnosis) -> Markup {
    let Some(s) = &d.shrink.simulation else { return html! {} };
    let mrad = |rad: f64| format!("{:.3}", 1e3 * rad);
    let nm = |nm: f64| format!("{nm:.3}");
    let open =
        format!("position {} s after a recorded state, driven by its torque, mrad", s.window_s);
    let rows = [
        ["position, closed loop, mrad".into(), mrad(s.before_rad), mrad(s.after_rad)],
        ["torque, closed loop, N.m".into(), nm(s.torque_before_nm), nm(s.torque_after_nm)],
        [open, mrad(s.open_loop_before_rad), mrad(s.open_loop_after_rad)],
    ];
    table(
        &["twin simulated again, less recorded (rms)", "before", "after"],
        1,
        rows.map(|r| r.to_vec()),
    )
}
