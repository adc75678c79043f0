//! A look at the markup of a text before an XML parser builds a tree of it: the parser compares every
//! attribute with every other, and hands the prefixes of an element to all inside it.

use crate::limits::{ATTRIBUTES, NESTING, PREFIXES};

/// # Errors
/// If elements are too deep in each other, or have too many attributes or prefixes, or if the text
/// defines words that stand for other text.
pub(super) fn refuse_excess(text: &str) -> Result<(), String> {
    let (mut rest, mut depth, mut prefixes) = (text, 0u64, 0u64);
    while let Some(start) = rest.find('<') {
        rest = &rest[start..];
        if rest.starts_with("<!DOCTYPE") {
            let end = rest.find(['>', '[']).unwrap_or(rest.len());
            if rest[end..].starts_with('[') {
                return Err("its <!DOCTYPE> defines entities or elements, which a URDF does not \
                            need; expand them first (xmllint --noent --dropdtd)"
                    .into());
            }
            rest = &rest[end..];
            continue;
        }
        let unlike_tags = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];
        if let Some((_, close)) = unlike_tags.iter().find(|(open, _)| rest.starts_with(open)) {
            rest = rest.find(close).map_or("", |end| &rest[end..]);
            continue;
        }
        let tag = Tag::at(rest);
        ATTRIBUTES.allow(tag.attributes).map_err(|e| e.to_string())?;
        prefixes += tag.prefixes;
        PREFIXES.allow(prefixes).map_err(|e| e.to_string())?;
        match () {
            () if rest.starts_with("</") => depth = depth.saturating_sub(1),
            () if tag.closed => {}
            () => depth += 1,
        }
        NESTING.allow(depth).map_err(|e| e.to_string())?;
        rest = &rest[tag.length..];
    }
    Ok(())
}

/// From `<` to `>`.
struct Tag {
    length: usize,
    attributes: u64,
    /// That it declares.
    prefixes: u64,
    /// By itself, `<a/>`.
    closed: bool,
}

impl Tag {
    fn at(text: &str) -> Self {
        let bytes = text.as_bytes();
        let (mut at, mut attributes) = (1, 0);
        while let Some(found) = bytes[at..].iter().position(|b| matches!(b, b'"' | b'\'' | b'>')) {
            at += found;
            if bytes[at] == b'>' {
                let prefixes = text[..at].matches("xmlns").count() as u64;
                return Self {
                    length: at + 1,
                    attributes,
                    prefixes,
                    closed: bytes[at - 1] == b'/',
                };
            }
            attributes += 1;
            let close = bytes[at + 1..].iter().position(|b| *b == bytes[at]);
            at = close.map_or(bytes.len(), |close| at + close + 2);
        }
        // No end: no XML.
        Self { length: text.len(), attributes, prefixes: 0, closed: true }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_attributes_and_prefixes_are_counted() {
        let deep = |n: usize| "<a b='x>y'>".repeat(n) + &"</a>".repeat(n);
        assert_eq!(refuse_excess(&deep(64)), Ok(()));
        assert!(refuse_excess(&deep(65)).unwrap_err().contains("64 levels of nesting"));
        assert_eq!(refuse_excess(&"<a><b/><!-- <c> --><![CDATA[<d>]]></a>".repeat(100)), Ok(()));
        let wide = |n: usize| format!("<a {}/>", "b='' ".repeat(n));
        assert_eq!(refuse_excess(&wide(64)), Ok(()));
        assert!(refuse_excess(&wide(65)).unwrap_err().contains("64 attributes"));
        let prefixed = |n: usize| "<a xmlns:b='c'/>".repeat(n);
        assert_eq!(refuse_excess(&prefixed(256)), Ok(()));
        assert!(refuse_excess(&prefixed(257)).unwrap_err().contains("256 prefixes"));
        let laughs = "<!DOCTYPE r [<!ENTITY a 'ha'>]><r>&a;</r>";
        assert!(refuse_excess(laughs).unwrap_err().contains("entities"));
        assert_eq!(refuse_excess("<!DOCTYPE robot><robot/>"), Ok(()));
        assert_eq!(refuse_excess("<a b='"), Ok(()));
        assert_eq!(refuse_excess("<"), Ok(()));
    }
}
