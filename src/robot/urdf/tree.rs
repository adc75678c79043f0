//! The links of a URDF as a tree, or what keeps them from being one.

use std::collections::{BTreeMap, BTreeSet};

use super::elements::{Joint, Link};
use super::file::File;
use super::xml::children;
use crate::robot::RobotError;

pub(super) struct Tree<'a> {
    pub file: File<'a>,
    links: BTreeMap<&'a str, Link<'a>>,
    /// By child.
    above: BTreeMap<&'a str, Joint<'a>>,
    /// By parent, in the order of the file.
    below: BTreeMap<&'a str, Vec<Joint<'a>>>,
}

impl<'a> Tree<'a> {
    /// Names are unique, joints join links that exist, and no link hangs on itself.
    pub fn new(
        file: File<'a>,
        links: &[Link<'a>],
        joints: &[Joint<'a>],
    ) -> Result<Self, RobotError> {
        if links.is_empty() {
            return Err(file.structure("has no links; add the arm's <link>s"));
        }
        let mut by_name = BTreeMap::new();
        for link in links {
            if by_name.insert(link.name, *link).is_some() {
                return Err(link.element.wrong("is defined twice; rename or remove one"));
            }
        }
        let above = joints_by_child(joints, &by_name)?;
        let mut below: BTreeMap<&str, Vec<Joint>> = BTreeMap::new();
        joints.iter().for_each(|j| below.entry(j.parent).or_default().push(*j));
        let tree = Self { file, links: by_name, above, below };
        tree.refuse_loops()?;
        Ok(tree)
    }

    pub fn link(&self, name: &str) -> Option<&Link<'a>> {
        self.links.get(name)
    }

    pub fn names(&self) -> impl Iterator<Item = &'a str> {
        self.links.keys().copied()
    }

    pub fn joints(&self) -> impl Iterator<Item = &Joint<'a>> {
        self.above.values()
    }

    /// Does any link have an `<inertial>`?
    pub fn has_inertia(&self) -> bool {
        self.links.values().any(|l| children(l.element.node, "inertial").next().is_some())
    }

    /// The joint on which a link hangs.
    pub fn above(&self, link: &str) -> Option<&Joint<'a>> {
        self.above.get(link)
    }

    /// The joints that hang on a link.
    pub fn below(&self, link: &str) -> &[Joint<'a>] {
        self.below.get(link).map_or(&[], Vec::as_slice)
    }

    /// From the root down to `link`.
    pub fn way_to(&self, link: &str) -> Vec<&Joint<'a>> {
        let up = std::iter::successors(self.above(link), |joint| self.above(joint.parent));
        let mut way: Vec<_> = up.collect();
        way.reverse();
        way
    }

    /// The one link that hangs on no joint.
    pub fn root(&self) -> Result<&'a str, RobotError> {
        let roots: Vec<_> = self.names().filter(|l| self.above(l).is_none()).collect();
        match roots[..] {
            [root] => Ok(root),
            _ => Err(self.file.structure(format!(
                "has several root links ({}); join them to one tree with fixed joints, remove what \
                 does not belong to the arm, or say on which the arm stands (--base LINK)",
                roots.join(", ")
            ))),
        }
    }

    /// Every link has to be below some root.
    fn refuse_loops(&self) -> Result<(), RobotError> {
        let mut open: Vec<_> = self.names().filter(|l| self.above(l).is_none()).collect();
        let mut reached = BTreeSet::new();
        while let Some(link) = open.pop() {
            reached.insert(link);
            open.extend(self.below(link).iter().map(|j| j.child));
        }
        match self.above.values().find(|j| !reached.contains(j.child)) {
            None => Ok(()),
            Some(stray) => Err(self.in_loop(stray)),
        }
    }

    /// Walking up from a link without a root ends in the loop.
    fn in_loop(&self, stray: &Joint<'a>) -> RobotError {
        let (mut seen, mut joint) = (BTreeSet::new(), stray);
        while seen.insert(joint.name) {
            joint = self.above(joint.parent).unwrap_or(joint);
        }
        self.file.link(
            joint.child,
            format!(
                "is part of a closed loop (joint `{}` leads back to it); armtwin takes serial \
                 arms, remove one joint of the loop",
                joint.name
            ),
        )
    }
}

fn joints_by_child<'a>(
    joints: &[Joint<'a>],
    links: &BTreeMap<&'a str, Link<'a>>,
) -> Result<BTreeMap<&'a str, Joint<'a>>, RobotError> {
    let mut by_child: BTreeMap<&str, Joint> = BTreeMap::new();
    let mut names = BTreeSet::new();
    for joint in joints {
        if !names.insert(joint.name) {
            return Err(joint.element.wrong("is defined twice; rename or remove one"));
        }
        for (role, link) in [("parent", joint.parent), ("child", joint.child)] {
            if !links.contains_key(link) {
                return Err(joint.element.wrong(format!(
                    "its {role} link `{link}` does not exist; define the link or correct the name"
                )));
            }
        }
        if let Some(other) = by_child.insert(joint.child, *joint) {
            return Err(joint.element.file.link(
                joint.child,
                format!(
                    "is the child of two joints, `{}` and `{}`: a closed loop; armtwin takes \
                     serial arms, remove one of the joints",
                    other.name, joint.name
                ),
            ));
        }
    }
    Ok(by_child)
}
