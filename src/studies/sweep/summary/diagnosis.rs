//! Diagnosis: is the hidden effect named, over noise and strength?

use super::seen::in_order;
use super::{Page, decibel, distinct, down_to, listed, over_snr, percent};
use crate::figure::{Figure, Line, Panel, Scale};
use crate::studies::sweep::study::NO_EFFECT;
use crate::studies::sweep::table::Table;
use crate::text::markdown_table;

/// Named in so many of the cases counts as found.
const FOUND: f64 = 0.9;
/// Bounds of bins of the largest gap over its noise.
const GAPS: [f64; 5] = [0.0, 1.2, 1.5, 2.5, f64::INFINITY];

struct Case {
    effect: String,
    strength: f64,
    snr_db: f64,
    named: bool,
    right: bool,
    place: bool,
    wrong: bool,
    probability: f64,
    gap: f64,
}

fn cases(cells: &Table) -> Vec<Case> {
    let number = |name: &str, i: usize| cells.numbers(name).get(i).copied().unwrap_or(f64::NAN);
    let flag = |name: &str, i: usize| cells.flags(name).get(i).copied().unwrap_or(false);
    let case = |i: usize| Case {
        effect: cells.texts("effect")[i].clone(),
        strength: number("strength", i),
        snr_db: number("snr_db", i),
        named: !cells.texts("causes")[i].is_empty(),
        right: flag("right", i),
        place: flag("place", i),
        wrong: flag("wrong", i),
        probability: number("probability", i),
        gap: number("gap_over_noise", i),
    };
    (0..cells.rows()).filter(|i| cells.texts("failed")[*i].is_empty()).map(case).collect()
}

fn share(cases: &[&Case], which: impl Fn(&Case) -> bool) -> f64 {
    cases.iter().filter(|c| which(c)).count() as f64 / cases.len() as f64
}

pub fn page(cells: &Table) -> Page {
    let all = cases(cells);
    let snrs = distinct(all.iter().map(|c| c.snr_db));
    let (clean, hidden): (Vec<&Case>, Vec<&Case>) = all.iter().partition(|c| c.effect == NO_EFFECT);
    let effects = in_order(hidden.iter().map(|c| c.effect.as_str()));
    let strengths = distinct(hidden.iter().map(|c| c.strength));
    let right = |effect: &str, strength: f64, db: f64| {
        let fits = |c: &&&Case| c.effect == effect && c.strength == strength && c.snr_db == db;
        let here: Vec<&Case> = hidden.iter().filter(fits).copied().collect();
        share(&here, |c| c.right)
    };
    let mut rows = Vec::new();
    for effect in &effects {
        for strength in &strengths {
            let first = std::iter::once(format!("{effect} x {strength}"));
            let shares = snrs.iter().map(|db| percent(right(effect, *strength, *db)));
            rows.push(first.chain(shares).collect::<Vec<String>>());
        }
    }
    let alarm = |db: f64| {
        let here: Vec<&Case> = clean.iter().filter(|c| c.snr_db == db).copied().collect();
        share(&here, |c| c.named)
    };
    let mut panels: Vec<Panel> = effects
        .iter()
        .map(|effect| {
            panel(
                effect,
                strengths
                    .iter()
                    .map(|s| line(&snrs, &format!("strength {s}"), |db| right(effect, *s, db)))
                    .collect(),
            )
        })
        .collect();
    if !clean.is_empty() {
        panels.push(panel("false alarms on a clean arm", vec![line(&snrs, "clean", alarm)]));
    }
    let says = [
        names_in_words(&hidden),
        alarms_in_words(&clean),
        limits_in_words(&effects, &strengths, &snrs, right),
    ];
    let text = format!(
        "{}\n## Named right\n\nThe first cause, or what the diagnosis says would look the same, is \
         the hidden effect: share of the seeds.\n\n{}\n![Named right over SNR](named.svg)\n\n\
         ## By what there was to see\n\nThe largest gap of a joint over its noise floor, before \
         anything is explained. Right place is the share of all cases; the probability is what the \
         ranking gives the hidden effect, on average.\n\n{}",
        says.iter().filter(|s| !s.is_empty()).map(|s| format!("* {s}\n")).collect::<String>(),
        over_snr("effect", &snrs, &rows),
        by_gap(&hidden)
    );
    let caption = "Named right over SNR".to_string();
    let figure = Figure { file: "named.svg".into(), caption, panels, columns: 3 };
    Page {
        headline: headline(&clean, &hidden),
        text,
        picture: Some(overview(&clean, &hidden, &snrs, &strengths)),
        figures: vec![figure],
    }
}

/// How often the diagnosis is right, in plain words.
fn headline(clean: &[&Case], hidden: &[&Case]) -> String {
    let count =
        |cases: &[&Case], which: fn(&Case) -> bool| cases.iter().filter(|c| which(c)).count();
    let [right, wrong, silent] =
        [count(hidden, |c| c.right), count(hidden, |c| c.wrong), count(hidden, |c| !c.named)];
    let alarms = match clean.len() {
        0 => String::new(),
        n => format!(
            " In {n} arms that lack nothing it names an effect {} times.",
            count(clean, |c| c.named)
        ),
    };
    format!(
        "Of {} hidden effects the diagnosis names {right} rightly and {wrong} wrongly, and stays silent about \
         {silent}.{alarms}",
        hidden.len()
    )
}

/// All effects together, and false alarms: the answer at a glance.
fn overview(clean: &[&Case], hidden: &[&Case], snrs: &[f64], strengths: &[f64]) -> Panel {
    let of = |cases: &[&Case], db: f64, which: fn(&Case) -> bool| {
        let here: Vec<&Case> = cases.iter().filter(|c| c.snr_db == db).copied().collect();
        share(&here, which)
    };
    let named = |strength: &f64| {
        let ours: Vec<&Case> = hidden.iter().filter(|c| c.strength == *strength).copied().collect();
        line(snrs, &format!("strength {strength}"), |db| of(&ours, db, |c| c.right))
    };
    let mut lines: Vec<Line> = strengths.iter().map(named).collect();
    if !clean.is_empty() {
        lines.push(line(snrs, "false alarms", |db| of(clean, db, |c| c.named)));
    }
    panel("Named right, all effects", lines)
}

fn by_gap(hidden: &[&Case]) -> String {
    let header =
        ["gap / noise", "cases", "right", "right place", "a wrong name", "no name", "probability"];
    let row = |bin: &[f64]| {
        let inside = |c: &&&Case| bin[0] <= c.gap && c.gap < bin[1];
        let here: Vec<&Case> = hidden.iter().filter(inside).copied().collect();
        let mean = here.iter().map(|c| c.probability).sum::<f64>() / here.len() as f64;
        let name = match bin[1].is_infinite() {
            true => format!("{} and more", bin[0]),
            false => format!("{} to {}", bin[0], bin[1]),
        };
        vec![
            name,
            here.len().to_string(),
            percent(share(&here, |c| c.right)),
            percent(share(&here, |c| c.place)),
            percent(share(&here, |c| c.wrong)),
            percent(share(&here, |c| !c.named)),
            percent(mean),
        ]
    };
    let rows: Vec<Vec<String>> = GAPS.windows(2).map(row).collect();
    markdown_table(&header, 1, &rows)
}

fn line(snrs: &[f64], label: &str, of: impl Fn(f64) -> f64) -> Line {
    let points = snrs.iter().map(|db| (*db, of(*db))).filter(|p| p.1.is_finite()).collect();
    Line { label: label.into(), points, ..Line::default() }
}

fn panel(title: &str, lines: Vec<Line>) -> Panel {
    Panel {
        title: title.into(),
        across: ("SNR, dB", Scale::Decibel),
        up: ("of the seeds, %", Scale::Share),
        lines,
        ..Panel::default()
    }
}

fn alarms_in_words(clean: &[&Case]) -> String {
    if clean.is_empty() {
        return String::new();
    }
    let alarms = clean.iter().filter(|c| c.named).count();
    format!("**False alarms**: {alarms} of {} arms without a gap.", clean.len())
}

fn limits_in_words(
    effects: &[&str],
    strengths: &[f64],
    snrs: &[f64],
    right: impl Fn(&str, f64, f64) -> f64,
) -> String {
    let mut parts = Vec::new();
    for effect in effects {
        let limit = |s: &f64| match down_to(snrs, |db| right(effect, *s, db) >= FOUND) {
            Some(db) => format!("{} at strength {s}", decibel(db)),
            None => format!("never at strength {s}"),
        };
        parts.push(format!(
            "{effect} {}",
            strengths.iter().map(limit).collect::<Vec<_>>().join(", ")
        ));
    }
    match parts.is_empty() {
        true => String::new(),
        false => format!(
            "**Named right** in {:.0} % of the seeds down to: {}.",
            100.0 * FOUND,
            parts.join("; ")
        ),
    }
}

fn names_in_words(hidden: &[&Case]) -> String {
    if hidden.is_empty() {
        return String::new();
    }
    let count = |which: &dyn Fn(&Case) -> bool| hidden.iter().filter(|c| which(c)).count();
    let parts = [
        format!("{} named right", count(&|c| c.right)),
        format!("{} given no name", count(&|c| !c.named)),
        format!(
            "{} with some name that is neither there nor looks like what is",
            count(&|c| c.wrong)
        ),
    ];
    format!("Of all {} cases with a hidden effect: {}.", hidden.len(), listed(&parts))
}
