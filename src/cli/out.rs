//! Standard output: a reader that has seen enough is no error, colour is for terminals.

use std::fmt::Arguments;
use std::io::{ErrorKind, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};

use crate::report::{broken, width};

/// In place of the standard library's, which panics when the reader has gone (`armtwin .. | head`).
macro_rules! print {
    ($($text:tt)*) => { $crate::cli::out::write(format_args!($($text)*)) };
}
macro_rules! println {
    () => { $crate::cli::out::write(format_args!("\n")) };
    ($($text:tt)*) => { $crate::cli::out::write(format_args!("{}\n", format_args!($($text)*))) };
}

static CLOSED: AtomicBool = AtomicBool::new(false);

/// Standard output is a file of the result: no text goes there.
pub fn leave_to_the_file() {
    CLOSED.store(true, Ordering::Relaxed);
}

/// Text for a person: no line is longer than the terminal is wide.
pub fn write(text: Arguments<'_>) {
    match width() {
        Some(most) => put(format_args!("{}", broken(&text.to_string(), most))),
        None => put(text),
    }
}

/// A document for another program or file: its lines stay as they are.
pub fn document(text: &str) {
    put(format_args!("{text}"));
}

/// The work goes on when nobody reads: its files are still wanted.
fn put(text: Arguments<'_>) {
    if CLOSED.load(Ordering::Relaxed) {
        return;
    }
    match std::io::stdout().lock().write_fmt(text) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => {
            CLOSED.store(true, Ordering::Relaxed);
        }
        Err(error) => {
            eprintln!("error: cannot write to standard output: {error}");
            std::process::exit(1);
        }
        Ok(()) => {}
    }
}

/// What was assumed where the URDF of `robot` does not say, on standard error.
pub fn notes(robot: &str, notes: &[String]) {
    let path = std::path::Path::new(robot);
    let name = path.file_name().unwrap_or(path.as_os_str()).display();
    notes.iter().for_each(|note| eprintln!("note: {name}: {note}"));
}

/// Prints blocks that are parted by empty lines, on a terminal with the first block and the first
/// line of every other one in bold.
pub fn page(text: &str) {
    let text = &width().map_or_else(|| text.to_string(), |most| broken(text, most));
    if is_colourful() {
        put(format_args!("{}", emphasised(text)))
    } else {
        put(format_args!("{text}"))
    }
}

fn is_colourful() -> bool {
    let refused = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
    let dumb = std::env::var_os("TERM").is_some_and(|v| v == "dumb");
    !refused && !dumb && std::io::stdout().is_terminal()
}

fn emphasised(text: &str) -> String {
    let (mut first_block, mut begins) = (true, true);
    let mut out = String::new();
    for line in text.split_inclusive('\n') {
        let body = line.trim_end_matches('\n');
        let bold = (first_block || begins) && !body.is_empty();
        begins = body.is_empty();
        first_block &= !begins;
        match bold {
            true => out += &format!("\u{1b}[1m{body}\u{1b}[0m{}", &line[body.len()..]),
            false => out += line,
        }
    }
    out
}

#[cfg(test)]
mod tests {
    #[test]
    fn answer_and_titles_stand_out() {
        let text = "an answer\nof two lines\n\ntitle\nbody\n";
        let expected = "\u{1b}[1man answer\u{1b}[0m\n\u{1b}[1mof two lines\u{1b}[0m\n\n\
                        \u{1b}[1mtitle\u{1b}[0m\nbody\n";
        assert_eq!(super::emphasised(text), expected);
    }
}
