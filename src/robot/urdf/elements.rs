//! Links and joints as they stand in the XML. Their numbers are read only where they are asked for:
//! what is wrong in a part of a robot that does not matter does no harm.

use nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3};
use roxmltree::Node;

use super::file::File;
use super::notes::Notes;
use super::xml::children;
use crate::limits::LINKS;
use crate::robot::{Placement, RobotError, plausible};

/// The squares of what is not larger can be computed with.
const LARGEST: f64 = 1e15;

#[derive(Debug, Clone, Copy)]
pub(super) struct Link<'a> {
    pub name: &'a str,
    pub element: Element<'a>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Joint<'a> {
    pub name: &'a str,
    pub kind: Kind<'a>,
    pub parent: &'a str,
    pub child: &'a str,
    /// The joint it follows.
    pub mimics: Option<&'a str>,
    pub element: Element<'a>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind<'a> {
    Revolute,
    Continuous,
    Fixed,
    /// Prismatic, floating, planar or unknown: it has a place off the chain only.
    Other(&'a str),
}

impl<'a> Joint<'a> {
    /// Does an arm's chain move by it?
    pub fn turns(&self) -> bool {
        matches!(self.kind, Kind::Revolute | Kind::Continuous) && self.mimics.is_none()
    }

    /// `revolute`, or what sets it apart.
    pub fn words(&self) -> &'a str {
        match self.kind {
            _ if self.mimics.is_some() => "mimic",
            Kind::Revolute => "revolute",
            Kind::Continuous => "continuous",
            Kind::Fixed => "fixed",
            Kind::Other(kind) => kind,
        }
    }
}

/// Where something is read from, for its messages and notes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Element<'a> {
    pub file: File<'a>,
    /// `link` or `joint`.
    pub kind: &'static str,
    pub name: &'a str,
    pub node: Node<'a, 'a>,
}

/// All links and joints of a `<robot>`.
pub(super) fn read<'a>(
    file: File<'a>,
    robot: Node<'a, 'a>,
) -> Result<(Vec<Link<'a>>, Vec<Joint<'a>>), RobotError> {
    let count = children(robot, "link").chain(children(robot, "joint")).count();
    LINKS.allow(count as u64).map_err(|e| file.structure(e.to_string()))?;
    let links = children(robot, "link")
        .map(|node| named(file, "link", node).map(|element| Link { name: element.name, element }));
    let joints =
        children(robot, "joint").map(|node| named(file, "joint", node).and_then(Element::joint));
    let (mut links, joints): (Vec<Link>, Vec<Joint>) =
        (links.collect::<Result<_, _>>()?, joints.collect::<Result<_, _>>()?);
    let hangs_on_world = joints.iter().any(|j| j.parent == WORLD);
    if hangs_on_world && links.iter().all(|l| l.name != WORLD) {
        let element = Element { file, kind: "link", name: WORLD, node: robot };
        links.push(Link { name: WORLD, element });
    }
    Ok((links, joints))
}

/// Exists without being defined, as in Drake.
const WORLD: &str = "world";

fn named<'a>(
    file: File<'a>,
    kind: &'static str,
    node: Node<'a, 'a>,
) -> Result<Element<'a>, RobotError> {
    match node.attribute("name") {
        Some(name) => Ok(Element { file, kind, name, node }),
        None => {
            let line = node.document().text_pos_at(node.range().start).row;
            Err(file.structure(format!("the <{kind}> in line {line} has no name; give it one")))
        }
    }
}

impl<'a> Element<'a> {
    fn joint(self) -> Result<Joint<'a>, RobotError> {
        let kind = match self.node.attribute("type") {
            Some("revolute") => Kind::Revolute,
            Some("continuous") => Kind::Continuous,
            Some("fixed") => Kind::Fixed,
            Some(other) => Kind::Other(other),
            None => return Err(self.wrong("has no type; give type=\"revolute\", say")),
        };
        let link = |tag| {
            let found = children(self.node, tag).next().and_then(|n| n.attribute("link"));
            found.ok_or_else(|| self.wrong(format!("has no <{tag} link=\"...\"/>; add it")))
        };
        let mimics = children(self.node, "mimic").next();
        let mimics = mimics.map(|m| m.attribute("joint").unwrap_or("a joint without a name"));
        let (name, parent, child) = (self.name, link("parent")?, link("child")?);
        Ok(Joint { name, kind, parent, child, mimics, element: self })
    }

    pub fn wrong(&self, problem: impl Into<String>) -> RobotError {
        self.file.element(self.kind, self.name, problem.into())
    }

    /// The element of that name inside `node`; of several the first, as ROS takes it.
    pub fn only(
        &self,
        node: Node<'a, 'a>,
        tag: &'static str,
        notes: &mut Notes,
    ) -> Option<Node<'a, 'a>> {
        let mut all = children(node, tag);
        let first = all.next();
        match all.count() {
            0 => {}
            more => {
                let text = format!("{} <{tag}>; the first is taken", more + 1);
                notes.of(self.kind, self.name, text);
            }
        }
        first
    }

    /// The `<origin>` inside `node`; left out, the frame itself.
    pub fn origin(&self, node: Node<'a, 'a>, notes: &mut Notes) -> Result<Placement, RobotError> {
        let Some(origin) = self.only(node, "origin", notes) else {
            return Ok(Placement::identity());
        };
        let vector = |name, notes: &mut Notes| match origin.attribute(name) {
            Some(text) => self.vector("origin", name, text, notes),
            None => Ok(Vector3::zeros()),
        };
        let translation = vector("xyz", notes)?;
        let rotation = match origin.attribute("quat_xyzw") {
            // Of URDF 1.2, in place of `rpy`.
            Some(text) => {
                let [x, y, z, w] = self.numbers("origin", "quat_xyzw", text, notes)?;
                UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)).to_rotation_matrix()
            }
            None => {
                let rpy = vector("rpy", notes)?;
                Rotation3::from_euler_angles(rpy.x, rpy.y, rpy.z)
            }
        };
        plausible::offset(&translation).map_err(|e| self.wrong(format!("its <origin> {e}")))?;
        if !rotation.matrix().iter().all(|x| x.is_finite()) {
            return Err(self.wrong("its <origin> has a quaternion of zeros; correct it"));
        }
        Ok(Placement { rotation: rotation.into_inner(), translation })
    }

    pub fn vector(
        &self,
        tag: &str,
        attribute: &str,
        text: &str,
        notes: &mut Notes,
    ) -> Result<Vector3<f64>, RobotError> {
        self.numbers::<3>(tag, attribute, text, notes).map(Vector3::from)
    }

    /// Finite numbers, parted by blanks.
    pub fn numbers<const N: usize>(
        &self,
        tag: &str,
        attribute: &str,
        text: &str,
        notes: &mut Notes,
    ) -> Result<[f64; N], RobotError> {
        let parts = text.split(|c: char| c.is_whitespace() || c == ',').filter(|p| !p.is_empty());
        let numbers: Option<Vec<f64>> = parts.map(|p| p.parse().ok()).collect();
        let numbers = numbers.and_then(|n| <[f64; N]>::try_from(n).ok());
        match numbers.filter(|n| n.iter().all(|x| x.abs() <= LARGEST)) {
            Some(numbers) => {
                if text.contains(',') {
                    let text = format!("commas in {attribute} of <{tag}>; read as blanks");
                    notes.of(self.kind, self.name, text);
                }
                Ok(numbers)
            }
            None if tag == "mass" => {
                Err(self.not_numbers(tag, attribute, text, "a finite number of kilograms"))
            }
            None if N == 1 => Err(self.not_numbers(tag, attribute, text, "a finite number")),
            None => Err(self.not_numbers(tag, attribute, text, &format!("{N} finite numbers"))),
        }
    }

    /// `wanted` is what the attribute should hold.
    pub fn not_numbers(&self, tag: &str, attribute: &str, text: &str, wanted: &str) -> RobotError {
        let todo = if text.contains("${") || text.contains("$(") {
            "this is a template, run xacro first and give what that wrote".into()
        } else {
            format!("give {wanted}")
        };
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        self.wrong(format!("its <{tag}> has {attribute}=\"{text}\"; {todo}"))
    }
}
