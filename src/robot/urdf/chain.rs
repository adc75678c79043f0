//! Which part of a robot is the arm: the joints between a base and a tip.

use serde::{Deserialize, Serialize};

use super::elements::{Joint, Kind};
use super::notes::{Notes, listed};
use super::tip;
use super::tree::Tree;
use crate::limits::ARM;
use crate::robot::RobotError;

/// What a user says about it, by the names of links. Left out, the base is the root and the tip the
/// end of the longest chain.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Chain {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub base: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tip: Option<String>,
    /// Link that loads are bolted to, where that is not the tip: a gripper's jaw moves beyond it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flange: Option<String>,
}

/// The joints from a base to a tip.
pub(super) struct Path<'t, 'a> {
    pub base: &'a str,
    pub joints: Vec<&'t Joint<'a>>,
}

impl Chain {
    pub(super) fn find<'t, 'a>(
        &self,
        tree: &'t Tree<'a>,
        notes: &mut Notes,
    ) -> Result<Path<'t, 'a>, RobotError> {
        let known = |role: &str, name: &Option<String>| -> Result<Option<&'a str>, RobotError> {
            let Some(name) = name else { return Ok(None) };
            let link = tree.link(name).ok_or_else(|| no_such(tree, role, name))?;
            Ok(Some(link.name))
        };
        let (base, tip) = (known("base", &self.base)?, known("tip", &self.tip)?);
        known("flange", &self.flange)?;
        let base = match (base, tip) {
            (Some(base), _) => base,
            (None, Some(tip)) => tree.way_to(tip).first().map_or(tip, |j| j.parent),
            (None, None) => tree.root()?,
        };
        let tip = match tip {
            Some(tip) => tip,
            None => tip::choose(tree, base, notes)?,
        };
        let joints = joints(tree, base, tip)?;
        joints.iter().try_for_each(|joint| refuse_stranger(joint, &joints))?;
        let turning = joints.iter().filter(|j| j.turns()).count();
        ARM.allow(turning as u64).map_err(|e| tree.file.structure(e.to_string()))?;
        if !joints.iter().any(|j| j.turns()) {
            let place = match tip == base {
                true => format!("below `{base}`"),
                false => format!("from `{base}` to `{tip}`"),
            };
            return Err(tree.file.structure(format!(
                "has no moving joint {place}; an arm needs joints of type revolute or continuous \
                 (--base and --tip choose the chain)"
            )));
        }
        Ok(Path { base, joints })
    }
}

fn joints<'t, 'a>(
    tree: &'t Tree<'a>,
    base: &str,
    tip: &str,
) -> Result<Vec<&'t Joint<'a>>, RobotError> {
    let way = tree.way_to(tip);
    if tip == base {
        return Ok(Vec::new());
    }
    match way.iter().position(|j| j.parent == base) {
        Some(first) => Ok(way[first..].to_vec()),
        None => {
            let links: Vec<_> = way.iter().map(|j| j.parent).collect();
            Err(tree.file.link(
                tip,
                format!(
                    "does not hang on the base `{base}`; choose a base above it ({})",
                    listed(&links)
                ),
            ))
        }
    }
}

/// Joints on the chain turn, each by itself.
fn refuse_stranger(joint: &Joint, chain: &[&Joint]) -> Result<(), RobotError> {
    if joint.turns() || joint.kind == Kind::Fixed {
        return Ok(());
    }
    let at = chain.iter().position(|j| j.name == joint.name).unwrap_or(0);
    let mut ways_out = Vec::new();
    if chain[..at].iter().any(|j| j.turns()) {
        ways_out.push(format!("end the chain before it (--tip {})", joint.parent));
    }
    if chain[at..].iter().any(|j| j.turns()) {
        ways_out.push(format!("start the chain beyond it (--base {})", joint.child));
    }
    let problem = match joint.mimics {
        Some(leader) => format!("mimics `{leader}`"),
        None => format!("is {}", joint.words()),
    };
    Err(joint.element.wrong(format!(
        "{problem} and on the chain; armtwin takes revolute, continuous and fixed joints: {}",
        if ways_out.is_empty() { "make it fixed".into() } else { ways_out.join(" or ") }
    )))
}

fn no_such(tree: &Tree, role: &str, name: &str) -> RobotError {
    let lower = name.to_lowercase();
    let like = |l: &&str| l.to_lowercase().contains(&lower) || lower.contains(&l.to_lowercase());
    let similar: Vec<_> = tree.names().filter(like).collect();
    let all: Vec<_> = tree.names().collect();
    let names = if similar.is_empty() { listed(&all) } else { listed(&similar) };
    tree.file.structure(format!("has no link `{name}` for {role}; it has {names}"))
}
