//! Candidates that were set aside, grouped by the reason.

use super::words::place;

/// An effect and the joints it is listed for.
type Listed<'a> = (&'a str, Vec<usize>);

/// Every reason with the effects it holds for, in words; reasons that differ in numbers only are
/// one, `..` in place of those.
pub fn by_reason<'a>(
    all: impl Iterator<Item = (&'a str, &'a [usize], &'a str)>,
) -> Vec<[String; 2]> {
    let mut groups: Vec<(String, Vec<Listed<'_>>)> = Vec::new();
    for (effect, joints, why) in all {
        let shared = |g: &(String, _)| common(&g.0, why);
        let at = match groups.iter().position(|g| shared(g).is_some()) {
            Some(at) => at,
            None => {
                groups.push((why.into(), Vec::new()));
                groups.len() - 1
            }
        };
        groups[at].0 = shared(&groups[at]).unwrap_or_default();
        match groups[at].1.iter_mut().find(|e| e.0 == effect) {
            Some(found) => found.1.extend(joints),
            None => groups[at].1.push((effect, joints.to_vec())),
        }
    }
    let each = |(effect, joints): &Listed<'_>| match joints.is_empty() {
        true => (*effect).to_string(),
        false => {
            let mut joints = joints.clone();
            joints.sort_unstable();
            format!("{effect} ({})", place(&joints))
        }
    };
    let row = |(why, effects): (String, Vec<Listed<'_>>)| {
        [why, effects.iter().map(each).collect::<Vec<_>>().join(", ")]
    };
    groups.into_iter().map(row).collect()
}

/// What two reasons share that differ in numbers only; `None` for others.
fn common(a: &str, b: &str) -> Option<String> {
    let number = |word: &str| word == ".." || word.starts_with(|c: char| c.is_ascii_digit());
    let (a, b): (Vec<&str>, Vec<&str>) = (a.split(' ').collect(), b.split(' ').collect());
    let word = |(a, b): (&&str, &&str)| match (a == b, number(a) && number(b)) {
        (true, _) => Some(a.to_string()),
        (false, true) => Some("..".into()),
        (false, false) => None,
    };
    let words: Option<Vec<String>> = a.iter().zip(&b).map(word).collect();
    words.filter(|_| a.len() == b.len()).map(|words| words.join(" "))
}
