//! URDF text -> XML tree, forgiving what ROS forgives.

use roxmltree::{Document, Error, Node, ParsingOptions};

use super::file::File;
use super::markup;
use super::notes::{Notes, listed};
use crate::robot::RobotError;

/// More undeclared prefixes than any file has.
const MOST_PREFIXES: usize = 32;

/// The text as [`parse`] takes it: ROS's parser does not mind dashes in comments, something before
/// the XML declaration, and prefixes nobody declared.
///
/// # Errors
/// If reading it as XML would take more than it is worth.
pub(super) fn repaired(text: &str, file: File) -> Result<String, RobotError> {
    let text = text.trim_start_matches('\u{feff}');
    let mut text = blanked(&blanked(text, "<!--", "-->"), "<?xml ", "?>");
    markup::refuse_excess(&text).map_err(|what| file.structure(what))?;
    for _ in 0..MOST_PREFIXES {
        let Err(Error::UnknownNamespace(prefix, _)) = document(&text) else { break };
        let Some(at) = text.find("<robot") else { break };
        text.insert_str(at + "<robot".len(), &format!(" xmlns:{prefix}=\"{prefix}\""));
    }
    Ok(text)
}

/// Every stretch from `open` to `close` as blanks; lines stay where they are.
fn blanked(text: &str, open: &str, close: &str) -> String {
    let (mut out, mut rest) = (String::with_capacity(text.len()), text);
    while let Some(start) = rest.find(open) {
        let Some(length) = rest[start..].find(close) else { break };
        let end = start + length + close.len();
        out += &rest[..start];
        out.extend(rest[start..end].chars().map(|c| if c == '\n' { c } else { ' ' }));
        rest = &rest[end..];
    }
    out + rest
}

/// The tree of a [`repaired`] text.
///
/// # Errors
/// If it is no XML, no URDF, or a template that xacro was not run on.
pub(super) fn parse<'a>(text: &'a str, file: File) -> Result<Document<'a>, RobotError> {
    let document = document(text).map_err(|error| file.malformed(&error.to_string()))?;
    let root = document.root_element();
    if root.tag_name().name() != "robot" {
        let name = root.tag_name().name();
        return Err(file.structure(format!(
            "its outermost element is <{name}>, that of a URDF is <robot>; give a URDF"
        )));
    }
    if let Some(template) = document.descendants().find(is_template) {
        let line = document.text_pos_at(template.range().start).row;
        return Err(file.structure(format!(
            "has <xacro:{}> in line {line}: it is a template, not a URDF; run xacro first \
             (xacro {} > arm.urdf) and give what that wrote",
            template.tag_name().name(),
            file.0
        )));
    }
    Ok(document)
}

/// Calls of macros that were never defined are left in some files; what ROS reads is beside them.
pub(super) fn note_left_calls(document: &Document, notes: &mut Notes) {
    let calls = document.descendants().filter(is_xacro).map(|n| n.tag_name().name());
    let mut names: Vec<_> = calls.map(|name| format!("xacro:{name}")).collect();
    names.dedup();
    if !names.is_empty() {
        notes.say(format!("left out is what xacro did not expand: {}", listed(&names)));
    }
}

/// What xacro takes out of every file it expands.
fn is_template(node: &Node) -> bool {
    let name = node.tag_name().name();
    is_xacro(node) && ["include", "macro", "property", "arg", "if", "unless"].contains(&name)
}

fn document(text: &str) -> Result<Document<'_>, Error> {
    Document::parse_with_options(text, ParsingOptions { allow_dtd: true, ..Default::default() })
}

fn is_xacro(node: &Node) -> bool {
    node.is_element() && node.tag_name().namespace().is_some_and(|n| n.contains("xacro"))
}

/// The elements of that name directly below.
pub(super) fn children<'a>(
    node: Node<'a, 'a>,
    tag: &'static str,
) -> impl Iterator<Item = Node<'a, 'a>> {
    node.children().filter(move |n| n.tag_name().name() == tag)
}
