//! As wide as the reader's terminal.

use terminal_size::{Width, terminal_size_of};

/// Narrower than this nothing is made.
const LEAST: usize = 40;
/// Longer lines of text are hard to read.
pub const PROSE: usize = 96;

/// Letters on a line of the terminal that standard output goes to, else of `COLUMNS`; `None` for a file or
/// a pipe, where a line may be as long as it needs to be.
pub fn width() -> Option<usize> {
    let terminal = terminal_size_of(std::io::stdout()).map(|(Width(n), _)| usize::from(n));
    let said = || std::env::var("COLUMNS").ok()?.trim().parse::<usize>().ok();
    terminal.or_else(said).filter(|n| *n > 0).map(|n| n.max(LEAST))
}

/// `text` with every line that is longer than `most` letters broken between words, further lines indented
/// by two more than the first. A word that is longer stays whole.
pub fn broken(text: &str, most: usize) -> String {
    text.split_inclusive('\n').map(|line| broken_line(line, most)).collect()
}

fn broken_line(line: &str, most: usize) -> String {
    let body = line.trim_end_matches('\n');
    if body.chars().count() <= most {
        return line.into();
    }
    let indent = body.len() - body.trim_start().len();
    let (first, further) = (" ".repeat(indent), " ".repeat((indent + 2).min(most / 2)));
    let lines = words_in_lines(body.trim_start(), [&first, &further], most);
    lines.join("\n") + &line[body.len()..]
}

/// Words in lines of at most `most` letters, the first and further ones begun so.
pub fn words_in_lines(text: &str, begun: [&str; 2], most: usize) -> Vec<String> {
    let mut lines = vec![begun[0].to_string()];
    let mut is_begun = true;
    for word in text.split_whitespace() {
        let line = lines.last().map_or(0, |l| l.chars().count());
        if !is_begun && line + 1 + word.chars().count() > most {
            lines.push(begun[1].to_string());
            is_begun = true;
        }
        if let Some(line) = lines.last_mut() {
            *line += if is_begun { "" } else { " " };
            *line += word;
        }
        is_begun = false;
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_break_between_words_and_short_ones_stay() {
        let text = "title\n  one two three four\nshort\n";
        assert_eq!(broken(text, 12), "title\n  one two\n    three\n    four\nshort\n");
        assert_eq!(broken("averyveryverylongword b\n", 10), "averyveryverylongword\n  b\n");
    }
}
