//! The chapter's tables.

use super::super::{Judged, tables};
use super::{agreement, found};
use crate::diagnosis::Named;
use crate::text::markdown_table;
use crate::trials::Kind;

/// Titles and tables of a trial on recordings, in order.
pub fn parts(all: &[Judged]) -> Vec<(&'static str, String)> {
    vec![
        ("What could be found on this arm: found / asked", found::by_effect(all)),
        ("By strength", found::by_strength(all)),
        ("Foreign effects", found::foreign(all)),
        ("Do the untouched pairs agree?", agreement::table(all)),
        ("Parameters of effects named exactly", tables::parameters(found::asked(all))),
        ("Not found, or with strays", missed(all)),
    ]
}

fn missed(all: &[Judged]) -> String {
    let fails = |j: &&Judged| match j.kind {
        Kind::Grafted => !found::named(j) || j.wrong,
        Kind::GraftedForeign => !j.right,
        _ => false,
    };
    let list = |names: &[Named]| names.iter().map(tables::said).collect::<Vec<_>>().join(", ");
    let row = |j: &Judged| {
        vec![
            j.case.clone(),
            j.kind.name().into(),
            list(&j.truth),
            format!("{:.2}", j.strength),
            j.verdict.map_or("failed".into(), |v| format!("{v:?}")),
            list(&j.causes),
            list(&j.strays),
            j.base.clone().unwrap_or_default(),
        ]
    };
    let rows: Vec<_> = all.iter().filter(fails).map(row).collect();
    let header =
        ["case", "kind", "grafted", "strength", "verdict", "causes", "strays", "untouched"];
    markdown_table(&header, 3, &rows)
}
