//! Which element of a URDF does the parser not accept? It does not say.

/// The first `<link>` or `<joint>` that is refused on its own too: kind and name.
pub(super) fn refused_element(text: &str) -> Option<(&'static str, &str)> {
    ["link", "joint"].into_iter().find_map(|kind| {
        let refused = elements(text, kind).into_iter().find(|e| is_refused(e))?;
        Some((kind, attribute(refused, "name").unwrap_or("without a name")))
    })
}

fn is_refused(element: &str) -> bool {
    urdf_rs::read_from_string(&format!("<robot name=\"x\">{element}</robot>")).is_err()
}

/// All `<kind ...>...</kind>` and `<kind .../>`. Joints that a transmission refers to have no
/// type; they are left out.
fn elements<'a>(text: &'a str, kind: &str) -> Vec<&'a str> {
    let (open, close) = (format!("<{kind} "), format!("</{kind}>"));
    let starts = text.match_indices(&open).map(|(at, _)| &text[at..]);
    starts
        .filter_map(|rest| {
            let head = rest.find('>')? + 1;
            let alone = rest[..head].ends_with("/>");
            let end = if alone { head } else { rest.find(&close)? + close.len() };
            (kind == "link" || attribute(&rest[..head], "type").is_some()).then_some(&rest[..end])
        })
        .collect()
}

fn attribute<'a>(element: &'a str, name: &str) -> Option<&'a str> {
    let head = &element[..element.find('>')?];
    let value = head.split_once(&format!(" {name}="))?.1;
    let quote = value.chars().next()?;
    value[1..].split(quote).next()
}
