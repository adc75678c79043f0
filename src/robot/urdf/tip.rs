//! Where the arm ends if nobody says: at the end of the chain with the most joints, before the hand.

use std::collections::BTreeMap;

use super::elements::{Joint, Kind};
use super::notes::{Notes, listed};
use super::tree::Tree;
use crate::robot::RobotError;

/// A chain from the base by where it ends.
#[derive(Debug, Clone, Copy, PartialEq)]
struct End<'a> {
    /// How many of its joints turn.
    joints: usize,
    /// The last link they move.
    link: &'a str,
}

/// The tip of the longest chain below `base`.
///
/// # Errors
/// If several are equally long, names them.
pub(super) fn choose<'a>(
    tree: &Tree<'a>,
    base: &'a str,
    notes: &mut Notes,
) -> Result<&'a str, RobotError> {
    let ends = longest(tree, base);
    match ends[..] {
        [End { joints: 0, link }] => Ok(link),
        [End { joints, link }] => {
            let turning = below(tree, base).iter().filter(|j| j.kind != Kind::Fixed).count();
            if turning > joints {
                notes.say(format!(
                    "the arm is taken to be the longest chain, {joints} joints from `{base}` to \
                     `{link}`; --base LINK and --tip LINK choose another"
                ));
            }
            Ok(link)
        }
        _ => {
            let links: Vec<_> = ends.iter().map(|e| e.link).collect();
            let joints = match ends.first().map_or(0, |e| e.joints) {
                1 => "one joint".into(),
                more => format!("{more} joints"),
            };
            Err(tree.file.structure(format!(
                "has several chains of {joints}, they end at {}; say which is meant with \
                 --tip LINK (in a twin, tip = \"LINK\")",
                listed(&links)
            )))
        }
    }
}

/// All joints below `base`, parents first.
fn below<'t, 'a>(tree: &'t Tree<'a>, base: &str) -> Vec<&'t Joint<'a>> {
    let mut all: Vec<_> = tree.below(base).iter().collect();
    let mut next = 0;
    while next < all.len() {
        let joint = all[next];
        all.extend(tree.below(joint.child));
        next += 1;
    }
    all
}

/// The longest chains; more than one if they are equally long.
fn longest<'a>(tree: &Tree<'a>, base: &'a str) -> Vec<End<'a>> {
    let joints = below(tree, base);
    let mut reached = BTreeMap::from([(base, End { joints: 0, link: base })]);
    for joint in &joints {
        let before = reached[joint.parent];
        let after = End { joints: before.joints + 1, link: joint.child };
        reached.insert(joint.child, if joint.turns() { after } else { before });
    }
    // From the leaves up.
    let mut ends: BTreeMap<&str, Vec<End>> = BTreeMap::new();
    for link in joints.iter().rev().map(|j| j.child).chain([base]) {
        let here = reached[link];
        let branches = tree.below(link).iter().filter(|j| j.mimics.is_none());
        let branches =
            branches.filter_map(|joint| beyond(tree, joint, here, ends.get(joint.child)?));
        let found = merged(here, branches.collect());
        ends.insert(link, found);
    }
    ends.remove(base).unwrap_or_default()
}

/// Where chains through a joint end, if they get further than `here` and it does not drive a hand.
fn beyond<'e, 'a>(
    tree: &Tree<'a>,
    joint: &Joint<'a>,
    here: End<'a>,
    ends: &'e Vec<End<'a>>,
) -> Option<&'e Vec<End<'a>>> {
    let further = ends.first()?.joints - here.joints;
    // What others mimic, beyond most of the arm, closes a gripper.
    let leads = tree.joints().any(|j| j.mimics == Some(joint.name));
    (further > 0 && !(leads && here.joints > further)).then_some(ends)
}

/// The longest of what branches off at one link, or that link where fingers branch off.
fn merged<'a>(here: End<'a>, branches: Vec<&Vec<End<'a>>>) -> Vec<End<'a>> {
    let mut lengths: Vec<usize> =
        branches.iter().filter_map(|ends| Some(ends.first()?.joints - here.joints)).collect();
    lengths.sort_unstable_by(|a, b| b.cmp(a));
    match lengths.first() {
        Some(longest) if !are_fingers(here.joints, &lengths) => {
            let most = here.joints + longest;
            branches.into_iter().flatten().filter(|e| e.joints == most).copied().collect()
        }
        _ => vec![here],
    }
}

/// Several branches of like length, none longer than the arm before them; two as long as it may be
/// arms. `lengths` counts joints, longest first.
fn are_fingers(before: usize, lengths: &[usize]) -> bool {
    match lengths {
        [longest, second, rest @ ..] if 2 * second >= *longest => {
            before > *longest || (before == *longest && !rest.is_empty())
        }
        _ => false,
    }
}
