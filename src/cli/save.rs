//! Files that commands leave behind: whole or not at all, and named where they cannot be written.

use std::path::Path;

use anyhow::Context;
use serde::Serialize;

use crate::files::write_whole;

pub fn text(path: &Path, text: &str) -> anyhow::Result<()> {
    write_whole(path, |out| out.write_all(text.as_bytes()))
        .with_context(|| format!("cannot write {}", path.display()))
}

/// The text that is a command's result: into the file that was asked for, else to standard output.
pub fn page(path: Option<&Path>, page: &str) -> anyhow::Result<()> {
    match path {
        Some(path) => text(path, page),
        None => {
            print!("{page}");
            Ok(())
        }
    }
}

/// What `--json FILE` asks for: `content` under its schema and the program's version.
pub fn json(path: &Path, schema: &'static str, content: &impl Serialize) -> anyhow::Result<()> {
    document(path, &Document { schema, version: env!("CARGO_PKG_VERSION"), content })
}

/// Writes as JSON what names its schema itself.
pub fn document(path: &Path, document: &impl Serialize) -> anyhow::Result<()> {
    text(path, &(serde_json::to_string_pretty(document)? + "\n"))
}

#[derive(Serialize)]
struct Document<'a, T: Serialize> {
    schema: &'static str,
    version: &'static str,
    #[serde(flatten)]
    content: &'a T,
}
