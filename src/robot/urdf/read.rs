//! URDF of a robot -> the [`Robot`] that is its arm: what is fixed to a body, or held, is merged into
//! it.

use std::path::Path as FilePath;

use nalgebra::{Unit, Vector3};

use super::carried::Carried;
use super::chain::{Chain, Path};
use super::elements::{self, Joint, Kind};
use super::file::File;
use super::notes::{Notes, listed};
use super::tree::Tree;
use super::{inertia, limits, xml};
use crate::limits::{DESCRIPTION, read_small};
use crate::robot::{Body, GRAVITY, Placement, Robot, RobotError};

/// Frames that users mean by the flange, best first.
const FLANGES: [&str; 3] = ["tool0", "flange", "ee_link"];

/// An arm and how it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    pub robot: Robot,
    /// The link it stands on and the one at its flange.
    pub base: String,
    pub tip: String,
    /// What was assumed, one sentence each.
    pub notes: Vec<String>,
}

impl Loaded {
    /// A built-in arm, from base to flange as its URDF calls them.
    pub fn whole(robot: Robot) -> Self {
        Self { robot, base: "base".into(), tip: "tool0".into(), notes: Vec::new() }
    }
}

/// Reads the arm in a URDF file. What stands still has no mass; missing limits are none.
///
/// # Errors
/// One message naming the file, and the link or joint that is wrong.
pub fn read_file(path: &FilePath, chain: &Chain) -> Result<Loaded, RobotError> {
    let bytes = read_small(path, &DESCRIPTION)
        .map_err(|cause| RobotError::Read { file: path.into(), cause })?;
    // Comments and names in old files are in Latin-1.
    read(&String::from_utf8_lossy(&bytes), &path.display().to_string(), chain)
}

/// Reads URDF text; `file` is its name in messages.
///
/// # Errors
/// As [`read_file`].
pub fn read(text: &str, file: &str, chain: &Chain) -> Result<Loaded, RobotError> {
    let file = File(file);
    let text = xml::repaired(text, file)?;
    let document = xml::parse(&text, file)?;
    let (links, joints) = elements::read(file, document.root_element())?;
    let tree = Tree::new(file, &links, &joints)?;
    let mut notes = Notes::default();
    xml::note_left_calls(&document, &mut notes);
    let path = chain.find(&tree, &mut notes)?;
    let mut reader = Reader {
        tree: &tree,
        notes,
        bodies: Vec::new(),
        carried: Carried::default(),
        bare: false,
        at: Placement::identity(),
        flange: chain.flange.as_deref(),
        found: None,
    };
    let gravity = reader.gravity(path.base)?;
    reader.follow(&path)?;
    let name = document.root_element().attribute("name").unwrap_or("arm");
    reader.finish(name, &path, chain, gravity)
}

/// Walks along the chain.
struct Reader<'t, 'a> {
    tree: &'t Tree<'a>,
    notes: Notes,
    bodies: Vec<Body>,
    /// What the body being read carries; before the first joint, what stands on the base.
    carried: Carried<'a>,
    /// Has the link that moves no mass of its own?
    bare: bool,
    /// The link being read, seen from that body (the base before the first joint).
    at: Placement,
    /// The link that is said to be the flange, and the body that carries it, once it is read.
    flange: Option<&'t str>,
    found: Option<(usize, Placement)>,
}

impl<'a> Reader<'_, 'a> {
    /// Gravity is along -z of the root link, here in the axes of `base`; joints above it are at zero.
    fn gravity(&mut self, base: &'a str) -> Result<Vector3<f64>, RobotError> {
        let level = Vector3::new(0.0, 0.0, -GRAVITY);
        let way = self.tree.way_to(base);
        let Some(top) = way.first() else { return Ok(level) };
        let mut stands = Placement::identity();
        for joint in &way {
            let origin = joint.element.origin(joint.element.node, &mut self.notes)?;
            stands = stands.compose(&origin);
        }
        let root = top.parent;
        let held: Vec<_> = way.iter().filter(|j| j.kind != Kind::Fixed).map(|j| j.name).collect();
        self.notes.say(match held.is_empty() {
            true => {
                format!("`{base}` is the base; what lies above it, up to `{root}`, is left out")
            }
            false => format!(
                "`{base}` is the base, where it is with {} at zero; what lies above it, up to \
                 `{root}`, is left out",
                listed(&held)
            ),
        });
        let gravity = stands.rotation.tr_mul(&level);
        if (gravity - level).amax() > 1e-9 {
            let words = format!("{:.4}, {:.4}, {:.4}", gravity.x, gravity.y, gravity.z);
            self.notes.say(format!(
                "gravity is along -z of `{root}`: in the axes of `{base}` ({words}) m/s2"
            ));
        }
        Ok(gravity)
    }

    fn follow(&mut self, path: &Path<'_, 'a>) -> Result<(), RobotError> {
        let mut link = path.base;
        for joint in &path.joints {
            self.carry(link, Some(joint))?;
            let origin = joint.element.origin(joint.element.node, &mut self.notes)?;
            self.at = self.at.compose(&origin);
            if joint.kind == Kind::Fixed {
                self.add_link(joint.child)?;
            } else {
                self.close()?;
                self.open(joint)?;
            }
            link = joint.child;
        }
        self.carry(link, None)
    }

    /// A link of the chain, fixed to the body being read.
    fn add_link(&mut self, name: &'a str) -> Result<(), RobotError> {
        let Some(link) = self.tree.link(name) else { return Ok(()) };
        let leaf = !self.tree.below(name).iter().any(|j| j.kind == Kind::Fixed);
        self.carried.frames.push((link.name, self.at, leaf));
        if let Some(body) = self.bodies.last_mut() {
            let own = inertia::read(link, true, &mut self.notes)?.seen_from(&self.at);
            body.inertia = body.inertia.joined_with(&own);
        }
        Ok(())
    }

    /// What hangs on a link of the chain, but for the `next` joint of it.
    fn carry(&mut self, link: &'a str, next: Option<&Joint<'a>>) -> Result<(), RobotError> {
        let moving = !self.bodies.is_empty();
        let is_next = |joint: &&Joint| next.is_some_and(|n| n.name == joint.name);
        for joint in self.tree.below(link).iter().filter(|j| !is_next(j)) {
            self.carried.add(self.tree, joint, &self.at, moving, &mut self.notes)?;
        }
        Ok(())
    }

    /// All that the body being read carries is known.
    fn close(&mut self) -> Result<(), RobotError> {
        self.look_for_flange();
        match self.bodies.last_mut() {
            None => self.carried.say_left_out(&mut self.notes),
            Some(body) => {
                self.carried.say_joined(&body.name, &mut self.notes);
                body.inertia = body.inertia.joined_with(&self.carried.inertia);
                check_mass(self.tree, body)?;
                if self.bare {
                    let text = "no mass of its own; it has that of what is fixed to it";
                    self.notes.of("link", &body.name, text);
                }
                body.inertia =
                    inertia::with_positive_moments(&body.name, body.inertia, &mut self.notes);
            }
        }
        Ok(())
    }

    /// Is the link that is said to be the flange the body being read, or fixed to it?
    fn look_for_flange(&mut self) {
        let Some(body) = self.bodies.last() else { return };
        let frames = self.carried.frames.iter().map(|(name, at, _)| (*name, *at));
        let mut links = frames.chain([(body.name.as_str(), Placement::identity())]);
        let here = links.find(|(name, _)| Some(*name) == self.flange);
        self.found = self.found.or(here.map(|(_, at)| (self.bodies.len() - 1, at)));
    }

    /// The next body, which moves with `joint`.
    fn open(&mut self, joint: &Joint<'a>) -> Result<(), RobotError> {
        let Some(link) = self.tree.link(joint.child) else { return Ok(()) };
        let axis = axis(joint, &mut self.notes)?;
        let limits = limits::read(joint, &mut self.notes)?;
        let inertia = inertia::read(link, true, &mut self.notes)?;
        let moved =
            crate::robot::Joint { name: joint.name.into(), placement: self.at, axis, limits };
        self.bare = inertia.mass == 0.0;
        let parent = self.bodies.len().checked_sub(1);
        self.bodies.push(Body { name: link.name.into(), parent, joint: moved, inertia });
        self.carried = Carried::default();
        self.at = Placement::identity();
        Ok(())
    }

    fn finish(
        mut self,
        name: &str,
        path: &Path,
        chain: &Chain,
        gravity: Vector3<f64>,
    ) -> Result<Loaded, RobotError> {
        self.close()?;
        let last = self.bodies.last().map_or(path.base, |b| &b.name);
        let (tip, flange) = match &chain.tip {
            Some(tip) => (tip.as_str(), self.at),
            None => self.flange().unwrap_or((last, Placement::identity())),
        };
        let (base, tip) = (path.base.to_string(), tip.to_string());
        let (flange_on, flange) = match (self.flange, self.found) {
            (None, _) => (None, flange),
            (Some(_), Some((body, flange))) => {
                (Some(body).filter(|body| body + 1 < self.bodies.len()), flange)
            }
            (Some(link), None) => {
                let problem = "is no flange: it is fixed to no link that moves with the arm; \
                               leave `flange` out, or name a link of the arm or one fixed to it";
                return Err(self.tree.file.link(link, problem.to_string()));
            }
        };
        let robot = Robot { name: name.into(), bodies: self.bodies, gravity, flange, flange_on };
        Ok(Loaded { robot, base, tip, notes: self.notes.into_words() })
    }

    /// tool0 or a frame of similar name on the last body, else the only frame at the end of what is
    /// fixed to it.
    fn flange(&self) -> Option<(&'a str, Placement)> {
        let frames = &self.carried.frames;
        let named = |wanted: &str| frames.iter().find(|(name, ..)| *name == wanted);
        let mut leaves = frames.iter().filter(|(_, _, leaf)| *leaf);
        let only_leaf = leaves.next().filter(|_| leaves.next().is_none());
        let best = FLANGES.into_iter().find_map(named).or(only_leaf);
        best.map(|(name, placement, _)| (*name, *placement))
    }
}

fn axis(joint: &Joint, notes: &mut Notes) -> Result<Unit<Vector3<f64>>, RobotError> {
    let element = &joint.element;
    let axis = element.only(element.node, "axis", notes).and_then(|a| a.attribute("xyz"));
    let Some(axis) = axis else {
        notes.of("joint", joint.name, "no <axis>; x is taken, as URDF says");
        return Ok(Vector3::x_axis());
    };
    let axis = element.vector("axis", "xyz", axis, notes)?;
    Unit::try_new(axis, 1e-9).ok_or_else(|| element.wrong("its axis is zero; give a direction"))
}

fn check_mass(tree: &Tree, body: &Body) -> Result<(), RobotError> {
    if body.inertia.mass > 0.0 {
        return Ok(());
    }
    if !tree.has_inertia() {
        return Err(tree.file.structure(
            "has no <inertial> in any link: it says how the robot moves, not what it weighs; give \
             a URDF with masses, or add them",
        ));
    }
    let before = tree.above(&body.name).filter(|_| body.parent.is_some());
    let tip = before.map_or(String::new(), |joint| {
        format!(", or end the chain before it (--tip {})", joint.parent)
    });
    Err(tree.file.link(
        &body.name,
        format!(
            "moves with joint `{}` but has no mass; give its <inertial> a positive mass or make the \
             joint fixed{tip}",
            body.joint.name
        ),
    ))
}
