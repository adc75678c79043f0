//! The report page.

use super::chapter::Chapter;
use super::goals::goals;
use super::{Judged, Kind, on_recordings, tables, tenths};
use crate::text::markdown_table;

/// The page in Markdown; `command` made it.
pub fn page(command: &str, chapters: &[Chapter]) -> String {
    let head = include_str!("page.md")
        .replace("{command}", command)
        .replace("{version}", env!("CARGO_PKG_VERSION"));
    let own = match chapters.iter().any(|c| on_recordings::are(&c.cases)) {
        true => include_str!("on_recordings.md"),
        false => "",
    };
    let texts: Vec<String> = chapters.iter().map(chapter).collect();
    format!("{head}{own}\n{}\n{}", texts.join("\n"), tenths::section(chapters))
}

fn chapter(chapter: &Chapter) -> String {
    let all = &chapter.cases;
    let count = |kind: Kind| all.iter().filter(|j| j.kind == kind).count();
    let kinds: Vec<String> = Kind::SIMULATED
        .into_iter()
        .chain(Kind::ON_RECORDINGS)
        .map(|kind| (kind, count(kind)))
        .filter(|(_, n)| *n > 0)
        .map(|(kind, n)| format!("{n} {}", kind.name()))
        .collect();
    let failed = all.iter().filter(|j| j.verdict.is_none()).count();
    let failed = match failed {
        0 => String::new(),
        n => format!(" {n} of them could not be diagnosed and count as not right."),
    };
    let mut text = format!(
        "## {}\n\n{}. {} cases: {}.{failed}\n\n### Against the goals\n\n{}",
        chapter.title,
        chapter.made,
        all.len(),
        kinds.join(", "),
        goals_table(all),
    );
    let parts = match on_recordings::are(all) {
        true => on_recordings::parts(all),
        false => parts(all),
    };
    for (title, table) in parts {
        text += &format!("\n### {title}\n\n{table}");
    }
    text
}

fn goals_table(all: &[Judged]) -> String {
    let met = |m: Option<bool>| m.map_or("-", |m| if m { "yes" } else { "no" }).to_string();
    let rows: Vec<_> = goals(all)
        .into_iter()
        .map(|g| vec![g.figure.to_string(), g.found, g.goal.to_string(), met(g.met)])
        .collect();
    markdown_table(&["figure", "found", "goal", "met"], 1, &rows)
}

/// Titles and tables of a trial of simulated cases.
fn parts(all: &[Judged]) -> Vec<(&'static str, String)> {
    let mut parts = vec![
        ("By strength, single effects", tables::by_strength(all)),
        ("By effect, strength 1 and above", tables::by_effect(all)),
        ("Where no name is right", tables::without_a_name(all)),
        ("Two effects", tables::pairs(all)),
        ("Calibration", tables::calibration(all)),
        ("Parameters of effects named exactly", tables::parameters(all)),
        ("Shrink of the mean square of the gap, medians", tables::shrink(all)),
    ];
    // They ask for a torque.
    if all.iter().any(|j| !j.baselines.is_empty()) {
        parts.push(("Simpler rules on the same cases", tables::baselines(all)));
    }
    parts.push(("Not right", tables::missed(all)));
    parts
}
