//! Text broken between words.

use super::width::{PROSE, width, words_in_lines};

/// `label` (ending where the text shall begin) and a text broken between words, further lines
/// indented as far as the first.
pub fn paragraph(label: &str, text: &str) -> String {
    let most = width().unwrap_or(PROSE).min(PROSE);
    let indent = " ".repeat(label.chars().count().min(most / 2));
    let lines = words_in_lines(text, [label, &indent], most);
    let lines: Vec<&str> = lines.iter().map(|line| line.trim_end()).collect();
    lines.join("\n") + "\n"
}
