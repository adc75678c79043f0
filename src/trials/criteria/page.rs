//! The page: a row per criterion and direction.

use super::Row;
use crate::text::markdown_table;
use crate::trials::Figure;

/// Markdown; `command` made it, `made` says how its cases were.
pub fn criteria_page(command: &str, made: &str, cases: usize, rows: &[Row]) -> String {
    let head = include_str!("page.md")
        .replace("{command}", command)
        .replace("{version}", env!("CARGO_PKG_VERSION"))
        .replace("{made}", made)
        .replace("{cases}", &cases.to_string());
    let Some(base) = rows.first() else { return head };
    head + &table(base, rows) + &most_moved(cases, rows) + &which(rows)
}

fn table(base: &Row, rows: &[Row]) -> String {
    let names = base.figures.iter().map(|f| f.name);
    let header: Vec<&str> =
        ["criterion", "value"].into_iter().chain(names).chain(["other causes"]).collect();
    let line = |label: &str, value: String, figures: Vec<String>, last: String| {
        [vec![label.to_string(), value], figures, vec![last]].concat()
    };
    let counted = base.figures.iter().map(|f| f.cases.to_string()).collect();
    let mut lines = vec![line("cases counted", String::new(), counted, String::new())];
    for row in rows {
        let (label, value) = said(row);
        let cells = row.figures.iter().zip(&base.figures).map(|(f, base)| cell(f, base)).collect();
        lines.push(line(label, value, cells, row.differs.len().to_string()));
    }
    let largest = (0..base.figures.len()).map(|i| largest(i, base, rows)).collect();
    let most = rows.iter().map(|r| r.differs.len()).max().unwrap_or(0);
    lines.push(line("largest change", String::new(), largest, most.to_string()));
    markdown_table(&header, 1, &lines)
}

/// `least_nats`, `3 -> 2`
fn said(row: &Row) -> (&str, String) {
    match &row.moved {
        Some(moved) => (&moved.criterion, format!("{} -> {}", moved.from, moved.to)),
        None => ("as they are", String::new()),
    }
}

fn change(figure: &Figure, base: &Figure) -> Option<f64> {
    Some(figure.value? - base.value?)
}

fn cell(figure: &Figure, base: &Figure) -> String {
    let Some(value) = figure.value else { return "-".into() };
    match change(figure, base) {
        Some(change) if change.abs() >= SHOWN => format!("{value:.3} ({change:+.3})"),
        _ => format!("{value:.3}"),
    }
}

/// Smallest change that three decimals show.
const SHOWN: f64 = 5e-4;

fn largest(i: usize, base: &Row, rows: &[Row]) -> String {
    let changes = rows.iter().filter_map(|r| change(&r.figures[i], &base.figures[i]));
    let largest = changes.map(f64::abs).reduce(f64::max);
    largest.map_or("-".into(), |c| format!("{c:.3}"))
}

fn most_moved(cases: usize, rows: &[Row]) -> String {
    let most = rows.iter().map(|r| r.differs.len()).max().unwrap_or(0);
    if most == 0 {
        return "\nThe causes are the same in every case, whatever is moved.\n".into();
    }
    let named = |row: &Row| {
        let (criterion, value) = said(row);
        format!("{criterion} ({value})")
    };
    let all: Vec<_> = rows.iter().filter(|r| r.differs.len() == most).map(named).collect();
    let all = all.join(", ");
    format!("\nMost is changed by {all}: other causes in {most} of {cases} cases.\n")
}

/// Table of the cases to look into.
fn which(rows: &[Row]) -> String {
    let line = |row: &Row| {
        let (criterion, value) = said(row);
        vec![criterion.to_string(), value, row.differs.join(", ")]
    };
    let lines: Vec<_> = rows.iter().filter(|r| !r.differs.is_empty()).map(line).collect();
    match lines.is_empty() {
        true => String::new(),
        false => format!(
            "\n## Cases with other causes\n\n{}",
            markdown_table(&["criterion", "value", "cases"], 3, &lines)
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trials::criteria::Moved;

    fn row(moved: Option<(&str, f64, f64)>, values: [Option<f64>; 2], differs: &[&str]) -> Row {
        let figure = |(name, value)| Figure { name, value, cases: 4 };
        let moved = moved.map(|(name, from, to)| Moved { criterion: name.into(), from, to });
        let figures = ["top-1, set", "false alarms"].into_iter().zip(values).map(figure).collect();
        Row { moved, figures, differs: differs.iter().map(ToString::to_string).collect() }
    }

    #[test]
    fn a_row_says_what_moved_and_where() {
        let rows = [
            row(None, [Some(0.75), None], &[]),
            row(Some(("least_nats", 3.0, 2.0)), [Some(1.0), None], &["case-0003"]),
            row(Some(("least_nats", 3.0, 4.0)), [Some(0.75), None], &[]),
        ];
        let page = criteria_page("armtwin trial criteria cases", "Drawn", 4, &rows);
        for line in [
            "Made by `armtwin trial criteria cases`, armtwin",
            "Drawn. Cases answered: 4.",
            "| criterion | value | top-1, set | false alarms | other causes |",
            "| cases counted |  | 4 | 4 |  |",
            "| as they are |  | 0.750 | - | 0 |",
            "| least_nats | 3 -> 2 | 1.000 (+0.250) | - | 1 |",
            "| least_nats | 3 -> 4 | 0.750 | - | 0 |",
            "| largest change |  | 0.250 | - | 1 |",
            "Most is changed by least_nats (3 -> 2): other causes in 1 of 4 cases.",
            "| least_nats | 3 -> 2 | case-0003 |",
        ] {
            assert!(page.contains(line), "no {line} in {page}");
        }
    }

    #[test]
    fn where_nothing_moves_the_page_says_so() {
        let rows = [row(None, [Some(1.0), None], &[])];
        let page = criteria_page("", "", 4, &rows);
        assert!(page.contains("the same in every case") && !page.contains("## Cases"), "{page}");
    }
}
