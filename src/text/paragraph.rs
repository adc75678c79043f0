//! Text broken between words.

const WIDTH: usize = 96;

/// `label` (ending where the text shall begin) and a text broken between words, further lines
/// indented as far as the first.
pub fn paragraph(label: &str, text: &str) -> String {
    let indent = label.chars().count();
    let mut done = String::new();
    let mut line = label.to_string();
    for word in text.split_whitespace() {
        let length = line.chars().count() + 1 + word.chars().count();
        if length > WIDTH && line.trim() != label.trim() {
            done += line.trim_end();
            done.push('\n');
            line = " ".repeat(indent);
        }
        line += word;
        line.push(' ');
    }
    done + line.trim_end() + "\n"
}
