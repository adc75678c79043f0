//! What the twin lacks, every candidate, and what the causes bring.

use maud::{Markup, html};

use super::super::table::table;
use crate::diagnosis::{Cause, Checked, Diagnosis, Ranked, words};
use crate::report::diagnosis as rows;

pub fn causes(d: &Diagnosis) -> Markup {
    html! {
        @if d.causes.is_empty() {
            p { "None is named." }
        }
        @for cause in &d.causes { (one(d, cause)) }
    }
}

fn one(d: &Diagnosis, c: &Cause) -> Markup {
    let (sizes, share) = words::takes_off(d, c);
    let Checked { low, high, .. } = c.shrink;
    let same: Vec<String> = c.equivalent.iter().map(rows::named).collect();
    html! {
        h3 { (c.effect) " at " (words::acts(c)) ": probability " (words::percent(c.probability)) }
        p { (sentence(&c.cause)) }
        (table(&rows::PARAMETERS, 2, c.read().into_iter().map(rows::parameter)))
        p {
            "On the check recording, added to the others, beside what no cause explains: "
            (sizes.replace("->", "→")) ", " (words::percent(share)) " of the mean square"
            @if d.position.is_none() {
                " (90 % interval " (words::percent(low)) " to " (words::percent(high)) ")"
            }
            "."
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

pub fn ranking(ranking: &[Ranked]) -> Markup {
    if ranking.is_empty() {
        return html! {};
    }
    let (shown, rest) = rows::ranked(ranking);
    html! {
        (table(&rows::CANDIDATES, 2, shown.into_iter().map(rows::candidate)))
        p.legend { (sentence(rows::EVIDENCE)) }
        @if !rest.is_empty() {
            details.screen {
                summary { (rest.len()) " more" }
                (table(&rows::CANDIDATES, 2, rest.iter().copied().map(rows::candidate)))
            }
        }
    }
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
    html! {
        p { (sentence(&words::how_far(d))) }
        (table(&rows::TORQUE, 1, rows::torque(d)))
        @if let Some(s) = &d.shrink.simulation { (table(&rows::SIMULATED, 1, rows::simulated(s))) }
    }
}
