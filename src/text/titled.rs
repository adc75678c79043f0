//! A body of text under its title.

/// Nothing where there is no body.
pub fn titled(title: &str, body: &str) -> String {
    if body.trim().is_empty() { String::new() } else { format!("{title}\n{}\n\n", body.trim_end()) }
}
