//! Aligned tables for a terminal or a pipe.

use comfy_table::{Cell, CellAlignment, ContentArrangement, Table, presets};

use super::width::{width, words_in_lines};
use crate::numbers::unsigned_zeros;

/// A table whose first `left` columns are text (left-aligned) and the rest numbers. Where the terminal is
/// narrow its texts are broken between words; what is wider still is told in several tables.
pub fn table(header: &[&str], left: usize, rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let header = header.iter().map(ToString::to_string).collect();
    let rows = rows.into_iter().map(|row| row.iter().map(|cell| unsigned_zeros(cell)).collect());
    let all: Vec<Vec<String>> = std::iter::once(header).chain(rows).collect();
    match width() {
        Some(most) => fitted(&all, left, most),
        None => drawn(&all, left),
    }
}

/// Letters around a cell.
const PADDING: usize = 2;
/// A cell of so many words is text, wherever it stands.
const PROSE_WORDS: usize = 4;

/// The first row is the header.
fn drawn(rows: &[Vec<String>], left: usize) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_content_arrangement(ContentArrangement::Disabled);
    for (i, row) in rows.iter().enumerate() {
        let cells = cells(row, left);
        if i == 0 {
            table.set_header(cells)
        } else {
            table.add_row(cells)
        };
    }
    table.lines().map(|l| l.trim_end().to_string()).collect::<Vec<_>>().join("\n")
}

fn cells(texts: &[String], left: usize) -> Vec<Cell> {
    let align = |i| if i < left { CellAlignment::Left } else { CellAlignment::Right };
    texts.iter().enumerate().map(|(i, t)| Cell::new(t).set_alignment(align(i))).collect()
}

/// No wider than `most` letters, as far as words and numbers stay whole.
fn fitted(rows: &[Vec<String>], left: usize, most: usize) -> String {
    let columns: Vec<Column> = (0..rows[0].len()).map(|i| Column::new(rows, i, i < left)).collect();
    let width = |widths: &[usize]| widths.iter().map(|w| w + PADDING).sum::<usize>();
    let mut widths: Vec<usize> = columns.iter().map(|c| c.natural).collect();
    let slack = |widths: &[usize]| {
        let free = (0..widths.len()).filter(|i| widths[*i] > columns[*i].least);
        free.max_by_key(|i| widths[*i])
    };
    while width(&widths) > most {
        let Some(widest) = slack(&widths) else { return in_parts(rows, left, most, &columns) };
        widths[widest] -= 1;
    }
    let broken = |row: &Vec<String>| -> Vec<String> {
        row.iter().zip(&widths).map(|(cell, width)| lines(cell, *width)).collect()
    };
    drawn(&rows.iter().map(broken).collect::<Vec<_>>(), left)
}

/// Letters that a column has, and those that it needs at least.
struct Column {
    natural: usize,
    least: usize,
}

impl Column {
    fn new(rows: &[Vec<String>], i: usize, is_text: bool) -> Self {
        let cells = || rows.iter().filter_map(|row| row.get(i));
        let longest = |lengths: &mut dyn Iterator<Item = usize>| lengths.max().unwrap_or(0);
        let natural = longest(&mut cells().map(|c| c.chars().count()));
        let words = |c: &String| c.split_whitespace().count();
        let is_text = is_text || cells().skip(1).any(|c| words(c) >= PROSE_WORDS);
        let word =
            longest(&mut cells().flat_map(|c| c.split_whitespace()).map(|w| w.chars().count()));
        // A header is broken anywhere; numbers with their signs and units are not.
        let numbers = longest(&mut cells().skip(1).map(|c| c.chars().count())).max(word);
        Self { natural, least: if is_text { word } else { numbers } }
    }
}

fn lines(cell: &str, width: usize) -> String {
    if cell.chars().count() <= width {
        return cell.into();
    }
    words_in_lines(cell, ["", ""], width).join("\n")
}

/// The texts at the left with as many columns as there is room for, then with the next ones.
fn in_parts(rows: &[Vec<String>], left: usize, most: usize, columns: &[Column]) -> String {
    let width = |i: &usize| columns[*i].least + PADDING;
    let texts: usize = (0..left).map(|i| width(&i)).sum();
    let mut parts: Vec<Vec<usize>> = Vec::new();
    let mut room = 0;
    for i in left..columns.len() {
        if parts.is_empty() || width(&i) > room {
            parts.push((0..left).collect());
            room = most.saturating_sub(texts);
        }
        parts.iter_mut().last().into_iter().for_each(|part| part.push(i));
        room = room.saturating_sub(width(&i));
    }
    if parts.len() < 2 {
        return drawn(rows, left);
    }
    let cut = |part: &Vec<usize>| -> Vec<Vec<String>> {
        let take = |row: &Vec<String>| part.iter().filter_map(|i| row.get(*i).cloned()).collect();
        rows.iter().map(take).collect()
    };
    // A part of one number that is wider still stays as it is.
    let one = |part: &Vec<usize>| match part.len() > left + 1 || texts + width(&part[left]) <= most
    {
        true => fitted(&cut(part), left, most),
        false => drawn(&cut(part), left),
    };
    parts.iter().map(one).collect::<Vec<_>>().join("\n\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<Vec<String>> {
        let row = |cells: [&str; 6]| cells.map(String::from).to_vec();
        vec![
            row(["cause", "parameter", "value", "90 % low", "high", "why"]),
            row(["payload, the whole arm", "payload_mass, kg", "2.805", "2.721", "2.889", ""]),
            row(["coulomb", "static", "0.1 +-0.2", "0.1", "0.3", "it is told by very few samples"]),
        ]
    }

    fn widest(text: &str) -> usize {
        text.lines().map(|l| l.chars().count()).max().unwrap_or(0)
    }

    #[test]
    fn a_table_is_no_wider_than_the_terminal_and_tells_all() {
        for most in [40, 50, 60, 72, 80, 100] {
            let text = fitted(&rows(), 2, most);
            assert!(widest(&text) <= most, "{most}:\n{text}");
            for word in rows().iter().flatten().flat_map(|cell| cell.split_whitespace()) {
                assert!(text.contains(word), "no {word} at {most}:\n{text}");
            }
        }
    }

    #[test]
    fn numbers_stay_whole_and_texts_are_repeated_beside_them() {
        let text = fitted(&rows(), 2, 45);
        assert!(text.contains("0.1 +-0.2"), "{text}");
        assert!(text.matches("payload_mass").count() > 1, "{text}");
        assert_eq!(fitted(&rows(), 2, 200), drawn(&rows(), 2));
    }
}
