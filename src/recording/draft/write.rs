//! The draft as TOML with its guesses commented.

use std::path::Path;

use super::Block;
use super::source::Columns;
use super::units::Clock;

pub fn map(path: &Path, columns: &Columns, time: usize, clock: &Clock, blocks: &[Block]) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let mut text = format!(
        "# Column map of {name}, drafted by armtwin {}: look through the guesses.\n\
         # Then: armtwin inspect {name} --columns THIS.toml\n\
         # All keys are explained in scenarios/columns/ur10e_shamilmamedov.toml.\n",
        env!("CARGO_PKG_VERSION")
    );
    columns.notes.iter().for_each(|note| text += &format!("# While reading: {note}\n"));
    text.push('\n');
    columns.layout.iter().for_each(|line| text += &format!("{line}\n"));
    text += &format!("time = {}    # the column that rises\n", column(columns, time));
    let scale = match clock.scale {
        1.0 => "1.0".to_string(),
        other => format!("{other:e}"),
    };
    text += &format!("time_scale = {scale}    # {}\n\n[channels]\n", clock.why);
    blocks.iter().for_each(|block| text += &line(block, columns));
    text + &left_out(columns, time, blocks)
}

/// By its name where it has one that stands once, else by its number from 1.
fn column(columns: &Columns, at: usize) -> String {
    match columns.name(at).filter(|n| !n.is_empty() && once(columns)) {
        Some(name) => quoted(name),
        None => (at + 1).to_string(),
    }
}

/// Names are read where all of them stand once.
fn once(columns: &Columns) -> bool {
    let names = columns.names.as_deref().unwrap_or_default();
    let mut sorted: Vec<&String> = names.iter().collect();
    sorted.sort_unstable();
    sorted.windows(2).all(|w| w[0] != w[1])
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.into()).to_string()
}

fn line(block: &Block, columns: &Columns) -> String {
    let names: Vec<String> = block.columns.iter().map(|c| column(columns, *c)).collect();
    let in_a_row = block.columns.windows(2).all(|w| w[1] == w[0] + 1);
    let numbers = names.iter().all(|n| n.parse::<usize>().is_ok());
    let which = match in_a_row && numbers {
        true => format!("first = {}, count = {}", block.columns[0] + 1, block.columns.len()),
        false => format!("columns = [{}]", names.join(", ")),
    };
    let scale = match block.scale {
        1.0 => String::new(),
        scale => format!(", scale = {scale}"),
    };
    format!("# {}\n{} = {{ {which}{scale} }}\n", block.why, block.stem)
}

fn left_out(columns: &Columns, time: usize, blocks: &[Block]) -> String {
    let used = |c: &usize| *c == time || blocks.iter().any(|b| b.columns.contains(c));
    let rest: Vec<String> =
        (0..columns.values.len()).filter(|c| !used(c)).map(|c| column(columns, c)).collect();
    match rest.is_empty() {
        true => String::new(),
        false => format!("\n# Left out, name them if they are wanted: {}\n", rest.join(", ")),
    }
}
