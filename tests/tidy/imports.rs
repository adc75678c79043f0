//! Who imports whom, read from the sources: circles between the modules of a room.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A module's place below the crate: `["diagnosis", "judge"]`.
type Place = Vec<String>;

/// One file as far as its imports matter.
struct Module {
    /// What `use` says, and paths in the code that begin at a module.
    uses: Vec<Place>,
    /// What is passed on by `pub use`, or renamed: name -> path.
    names: BTreeMap<String, Place>,
}

/// Rooms (folders with a `mod.rs`, and the crate) whose modules import each other in a circle, with one line
/// per circle: `identification: arm -> shared -> arm`. A room's `mod.rs` counts as one of its modules, by the
/// name of the room.
pub fn circles(sources: &[(&Path, &str)]) -> Vec<String> {
    let mut modules: BTreeMap<Place, Module> = BTreeMap::new();
    let places: BTreeSet<Place> = sources.iter().map(|(path, _)| place(path)).collect();
    for (path, text) in sources {
        let at = place(path);
        let module = read(&at, text, &places);
        modules.insert(at, module);
    }
    let mut rooms: BTreeMap<Place, BTreeMap<String, BTreeSet<String>>> = BTreeMap::new();
    for (from, module) in &modules {
        for path in &module.uses {
            let Some(to) = home(path, &modules, 0) else { continue };
            if let Some((room, a, b)) = step(from, &to) {
                rooms.entry(room).or_default().entry(a).or_default().insert(b);
            }
        }
    }
    let found = rooms.iter().flat_map(|(room, arrows)| {
        let name = if room.is_empty() { "the crate".into() } else { room.join("::") };
        knots(arrows).into_iter().map(move |knot| format!("{name}: {knot}"))
    });
    found.collect()
}

/// `src/a/mod.rs` and `src/a.rs` are `a`, `src/lib.rs` is the crate.
fn place(path: &Path) -> Place {
    let mut parts: Place = path.iter().map(|p| p.to_string_lossy().into_owned()).collect();
    let last = parts.pop().unwrap_or_default();
    match last.trim_end_matches(".rs") {
        "mod" | "lib" | "main" => {}
        name => parts.push(name.into()),
    }
    parts
}

/// The room in which an import leads from one module to another, and both by their names there.
fn step(from: &Place, to: &Place) -> Option<(Place, String, String)> {
    let shared = from.iter().zip(to).take_while(|(a, b)| a == b).count();
    let room = from[..shared].to_vec();
    let own = || room.last().cloned().unwrap_or_else(|| "crate".into());
    let name = |place: &Place| place.get(shared).cloned().unwrap_or_else(own);
    let (a, b) = (name(from), name(to));
    (from.len() > shared && to.len() > shared).then_some((room, a, b))
}

/// The module where what a path names is defined: passed-on names are followed.
fn home(path: &[String], modules: &BTreeMap<Place, Module>, depth: usize) -> Option<Place> {
    let known = (0..=path.len()).rev().find(|n| modules.contains_key(&path[..*n]))?;
    let (module, rest) = path.split_at(known);
    let passed = rest.first().and_then(|name| modules[module].names.get(name));
    match passed {
        Some(on) if depth < 8 && on != path => home(on, modules, depth + 1),
        _ => Some(module.to_vec()),
    }
}

fn read(at: &Place, text: &str, places: &BTreeSet<Place>) -> Module {
    let words = words(text);
    let (mut uses, mut names) = (Vec::new(), BTreeMap::new());
    let mut i = 0;
    while i < words.len() {
        let word = words[i].as_str();
        if word == "use" {
            let passed_on = i > 0 && (words[i - 1] == "pub" || words[i - 1] == ")");
            let end = i + words[i..].iter().position(|w| w == ";").unwrap_or(words.len() - i);
            let mut tree = Vec::new();
            spread(&words[i + 1..end], &[], &mut tree);
            for (path, name) in tree {
                let Some(path) = absolute(at, &path, places) else { continue };
                if passed_on {
                    names.insert(name, path);
                } else {
                    uses.push(path);
                }
            }
            i = end;
        } else if words.get(i + 1).is_some_and(|w| w == "::") && (i == 0 || words[i - 1] != "::") {
            let mut path = vec![words[i].clone()];
            while words.get(i + 1).is_some_and(|w| w == "::")
                && words.get(i + 2).is_some_and(|w| is_name(w))
            {
                path.push(words[i + 2].clone());
                i += 2;
            }
            uses.extend(absolute(at, &path, places));
        }
        i += 1;
    }
    Module { uses, names }
}

fn is_name(word: &str) -> bool {
    word.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// From the crate on, for paths that stay within it.
fn absolute(at: &Place, path: &[String], places: &BTreeSet<Place>) -> Option<Place> {
    let (mut base, mut rest) = match path.first()?.as_str() {
        "crate" => (Vec::new(), &path[1..]),
        "self" => (at.clone(), &path[1..]),
        "super" => (at[..at.len().checked_sub(1)?].to_vec(), &path[1..]),
        child => {
            let below = [at.clone(), vec![child.to_string()]].concat();
            return places.contains(&below).then(|| [at.clone(), path.to_vec()].concat());
        }
    };
    while rest.first().is_some_and(|w| w == "super") {
        base.pop()?;
        rest = &rest[1..];
    }
    base.extend(rest.iter().filter(|w| *w != "self").cloned());
    Some(base)
}

/// `a::{b, c::d as e}` -> (`a::b`, b), (`a::c::d`, e).
fn spread(words: &[String], before: &[String], out: &mut Vec<(Place, String)>) {
    let mut path = before.to_vec();
    let mut i = 0;
    while i < words.len() {
        match words[i].as_str() {
            "::" => {}
            "{" => {
                let mut depth = 0;
                let mut start = i + 1;
                for j in i..words.len() {
                    match words[j].as_str() {
                        "{" => depth += 1,
                        "}" => depth -= 1,
                        _ => {}
                    }
                    if (words[j] == "," && depth == 1) || depth == 0 {
                        if start < j {
                            spread(&words[start..j], &path, out);
                        }
                        start = j + 1;
                    }
                    if depth == 0 {
                        return;
                    }
                }
                return;
            }
            "as" => {
                out.push((path, words.get(i + 1).cloned().unwrap_or_default()));
                return;
            }
            name => path.push(name.to_string()),
        }
        i += 1;
    }
    let name = path.last().cloned().unwrap_or_default();
    out.push((path, name));
}

/// Names and marks of the code, without comments, texts and tests within the file.
fn words(text: &str) -> Vec<String> {
    let tested = text.find("#[cfg(test)]\nmod ").unwrap_or(text.len());
    let mut out = Vec::new();
    for line in text[..tested].lines() {
        let line = super::code(line);
        for (i, part) in line.split('"').enumerate() {
            if i % 2 == 0 {
                marks(part, &mut out);
            }
        }
    }
    out
}

fn marks(text: &str, out: &mut Vec<String>) {
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let named = |c: char| c.is_alphanumeric() || c == '_';
        let length = match first {
            c if named(c) => rest.find(|c| !named(c)).unwrap_or(rest.len()),
            ':' if rest.starts_with("::") => 2,
            c => c.len_utf8(),
        };
        out.push(rest[..length].to_string());
        rest = rest[length..].trim_start();
    }
}

/// Sets of modules each of which reaches all others, with the arrows between them.
fn knots(arrows: &BTreeMap<String, BTreeSet<String>>) -> Vec<String> {
    let reach = |from: &String| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(next) = open.pop() {
            for to in arrows.get(next).into_iter().flatten() {
                if seen.insert(to) {
                    open.push(to);
                }
            }
        }
        seen
    };
    let reached: BTreeMap<_, _> = arrows.keys().map(|name| (name, reach(name))).collect();
    let mut told = BTreeSet::new();
    let mut found = Vec::new();
    for (name, reach) in &reached {
        if !reach.contains(name) || told.contains(name) {
            continue;
        }
        let knot: Vec<&String> = reach
            .iter()
            .copied()
            .filter(|other| reached.get(other).is_some_and(|back| back.contains(name)))
            .collect();
        let inside = knot.iter().map(|from| {
            let to = arrows[*from].iter().filter(|to| knot.contains(to)).cloned();
            format!("{from} -> {}", to.collect::<Vec<_>>().join(", "))
        });
        found.push(inside.collect::<Vec<_>>().join("; "));
        told.extend(knot);
    }
    found
}

#[test]
fn circles_are_seen_through_names_that_are_passed_on() {
    let a =
        (Path::new("room/a.rs"), "use super::{Passed, plain::{self, x}};\nuse crate::other::Y;");
    let b =
        (Path::new("room/b.rs"), "// use super::c;\npub struct Passed; fn f() { super::a::f() }");
    let plain = (Path::new("room/plain.rs"), "#[cfg(test)]\nmod tests { use super::super::a; }");
    let other = (Path::new("other.rs"), "use std::fs;");
    let mut all = vec![a, b, plain, other];
    all.push((Path::new("room/mod.rs"), "mod a;\nmod b;\nmod plain;\npub use b::Passed;"));
    assert_eq!(circles(&all), ["room: a -> b; b -> a"]);
    all.retain(|(path, _)| !path.ends_with("b.rs"));
    all.push((Path::new("room/b.rs"), "pub struct Passed;"));
    assert_eq!(circles(&all), [""; 0]);
}
