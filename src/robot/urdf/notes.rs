//! What was assumed while a URDF was read, each said once for all elements it was assumed of.

/// Names beyond these are counted only.
const MOST_NAMES: usize = 8;

#[derive(Debug, Default)]
pub(super) struct Notes(Vec<Note>);

#[derive(Debug)]
struct Note {
    /// `link`, `joint`, or nothing of which the text is said.
    kind: &'static str,
    names: Vec<String>,
    text: String,
}

impl Notes {
    /// Adds a note on the robot as a whole.
    pub fn say(&mut self, text: impl Into<String>) {
        self.0.push(Note { kind: "", names: Vec::new(), text: text.into() });
    }

    /// Adds a note on a `link` or `joint`; the same text of several becomes one note.
    pub fn of(&mut self, kind: &'static str, name: &str, text: impl Into<String>) {
        let text = text.into();
        match self.0.iter_mut().find(|n| n.kind == kind && n.text == text) {
            Some(note) if note.names.iter().any(|n| n == name) => {}
            Some(note) => note.names.push(name.into()),
            None => self.0.push(Note { kind, names: vec![name.into()], text }),
        }
    }

    pub fn into_words(self) -> Vec<String> {
        self.0.into_iter().map(Note::into_words).collect()
    }
}

impl Note {
    fn into_words(self) -> String {
        let Self { kind, names, text } = self;
        match names.len() {
            0 => text,
            1 => format!("{kind} `{}`: {text}", names[0]),
            _ => format!("{kind}s {}: {text}", listed(&names)),
        }
    }
}

/// `a`, `b` and how many more.
pub(super) fn listed<S: AsRef<str>>(names: &[S]) -> String {
    let quoted: Vec<_> = names.iter().map(|n| format!("`{}`", n.as_ref())).collect();
    shortened(&quoted)
}

pub(super) fn shortened(words: &[String]) -> String {
    let shown = words[..words.len().min(MOST_NAMES)].join(", ");
    match words.len().saturating_sub(MOST_NAMES) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}
