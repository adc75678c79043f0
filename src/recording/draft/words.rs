//! The words of a column name.

/// Lower-case words and numbers of a name: "shoulderPan_pos2" is shoulder, pan, pos, 2.
pub fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut last = ' ';
    for c in name.chars() {
        let kind = |c: char| (c.is_alphabetic(), c.is_ascii_digit());
        let begins = kind(c) != kind(last) || (c.is_uppercase() && last.is_lowercase());
        if c.is_alphanumeric() {
            match words.last_mut().filter(|_| !begins) {
                Some(word) => word.extend(c.to_lowercase()),
                None => words.push(c.to_lowercase().collect()),
            }
        }
        last = c;
    }
    words
}
