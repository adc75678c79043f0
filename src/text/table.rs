//! Aligned tables for a terminal or a pipe.

use comfy_table::{Cell, CellAlignment, ContentArrangement, Table, presets};

/// A table whose first `left` columns are text (left-aligned) and the rest numbers.
pub fn table(header: &[&str], left: usize, rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_content_arrangement(ContentArrangement::Disabled);
    table.set_header(cells(header.iter().map(ToString::to_string), left));
    for row in rows {
        table.add_row(cells(row, left));
    }
    table.lines().map(|l| l.trim_end().to_string()).collect::<Vec<_>>().join("\n")
}

fn cells(texts: impl IntoIterator<Item = String>, left: usize) -> Vec<Cell> {
    let align = |i| if i < left { CellAlignment::Left } else { CellAlignment::Right };
    texts.into_iter().enumerate().map(|(i, t)| Cell::new(t).set_alignment(align(i))).collect()
}
