//! What hangs on a body of the arm and is not of its chain: tools, grippers, cameras, another arm.
//! Its joints are held at zero.

use super::elements::{Joint, Kind};
use super::inertia;
use super::notes::{Notes, listed, shortened};
use super::tree::Tree;
use crate::robot::{Inertia, Placement, RobotError};

#[derive(Debug)]
pub(super) struct Carried<'a> {
    /// Inertia of all that is carried, in the body's frame.
    pub inertia: Inertia,
    /// Links fixed to the body, seen from it, and whether nothing is fixed to them in turn.
    pub frames: Vec<(&'a str, Placement, bool)>,
    /// Links with mass.
    heavy: Vec<&'a str>,
    /// Joints that could move, with their type.
    held: Vec<String>,
}

impl Default for Carried<'_> {
    fn default() -> Self {
        let inertia = Inertia::zero();
        Self { inertia, frames: Vec::new(), heavy: Vec::new(), held: Vec::new() }
    }
}

impl<'a> Carried<'a> {
    /// Adds `joint`, which sits on a link at `at`, and everything below it. On a base that does not
    /// move (`moving` is false) masses play no role and are not read.
    pub fn add(
        &mut self,
        tree: &Tree<'a>,
        joint: &Joint<'a>,
        at: &Placement,
        moving: bool,
        notes: &mut Notes,
    ) -> Result<(), RobotError> {
        let mut open = vec![(*joint, *at, true)];
        while let Some((joint, at, rigid)) = open.pop() {
            let rigid = rigid && joint.kind == Kind::Fixed;
            if joint.kind != Kind::Fixed {
                self.held.push(format!("`{}` ({})", joint.name, joint.words()));
            }
            let mut at = at;
            if moving {
                at = at.compose(&joint.element.origin(joint.element.node, notes)?);
                self.add_link(tree, joint.child, &at, rigid, notes)?;
            }
            open.extend(tree.below(joint.child).iter().rev().map(|j| (*j, at, rigid)));
        }
        Ok(())
    }

    fn add_link(
        &mut self,
        tree: &Tree<'a>,
        name: &'a str,
        at: &Placement,
        rigid: bool,
        notes: &mut Notes,
    ) -> Result<(), RobotError> {
        let Some(link) = tree.link(name) else { return Ok(()) };
        let own = inertia::read(link, false, notes)?.seen_from(at);
        self.inertia = self.inertia.joined_with(&own);
        if own.mass > 0.0 {
            self.heavy.push(name);
        }
        if rigid {
            let leaf = !tree.below(name).iter().any(|j| j.kind == Kind::Fixed);
            self.frames.push((name, *at, leaf));
        }
        Ok(())
    }

    /// Notes what hangs on the base and is left out.
    pub fn say_left_out(&self, notes: &mut Notes) {
        if !self.held.is_empty() {
            let joints = shortened(&self.held);
            notes.say(format!(
                "left out is what hangs on the base, which stands still, with the joints {joints}"
            ));
        }
    }

    /// Notes which links a body carries and which joints are held at zero.
    pub fn say_joined(&self, body: &str, notes: &mut Notes) {
        if self.heavy.is_empty() && self.held.is_empty() {
            return;
        }
        let mut text = match self.heavy.len() {
            0 => "carries links without mass".to_string(),
            _ => format!("carries {} ({})", listed(&self.heavy), kilograms(self.inertia.mass)),
        };
        if !self.held.is_empty() {
            text += &format!("; held at zero: {}", shortened(&self.held));
        }
        notes.of("link", body, text);
    }
}

fn kilograms(mass: f64) -> String {
    if mass < 0.001 { format!("{mass:.1e} kg") } else { format!("{mass:.3} kg") }
}
