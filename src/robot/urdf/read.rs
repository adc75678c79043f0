//! URDF of a serial arm -> [`Robot`]: fixed joints are merged into the body that carries them.

use std::path::Path;

use nalgebra::{Rotation3, Unit, Vector3};
use urdf_rs::{JointType, Link, Pose};

use super::check::{self, File};
use super::locate;
use crate::robot::{Body, Inertia, Joint, Limits, Placement, Robot, RobotError};

/// Frames that users mean by the flange, best first.
const FLANGES: [&str; 3] = ["tool0", "flange", "ee_link"];

/// Reads a URDF file. The root link is the base; its mass plays no role. An effort limit of 0 or
/// none counts as unlimited.
///
/// # Errors
/// One message naming the file, and the link or joint that is wrong.
pub fn read_file(path: &Path) -> Result<Robot, RobotError> {
    let text = std::fs::read_to_string(path)
        .map_err(|cause| RobotError::Read { file: path.into(), cause })?;
    read(&text, &path.display().to_string())
}

/// Reads URDF text; `file` is its name in messages.
///
/// # Errors
/// As [`read_file`].
pub fn read(text: &str, file: &str) -> Result<Robot, RobotError> {
    let urdf = urdf_rs::read_from_string(text).map_err(|e| malformed(text, file, &e))?;
    let file = File(file);
    let root = check::tree(file, &urdf)?;
    check::numbers(file, &urdf)?;
    let mut reader = Reader { file, urdf: &urdf, bodies: Vec::new(), frames: Vec::new() };
    reader.descend(root, None, &Placement::identity())?;
    reader.finish()
}

fn malformed(text: &str, file: &str, error: &urdf_rs::UrdfError) -> RobotError {
    let message = error.to_string();
    let reason = message.lines().next().unwrap_or_default().trim_start_matches("custom: ");
    match locate::refused_element(text) {
        Some((element, name)) => RobotError::Element {
            file: file.into(),
            element,
            name: name.into(),
            problem: format!("{reason}; add or correct it"),
        },
        None => RobotError::Malformed { file: file.into(), reason: reason.into() },
    }
}

struct Reader<'a> {
    file: File<'a>,
    urdf: &'a urdf_rs::Robot,
    bodies: Vec<Body>,
    /// Links fixed to the last body, seen from it, and whether they are leaves.
    frames: Vec<(&'a str, Placement, bool)>,
}

impl<'a> Reader<'a> {
    /// Visits all links below `link`, whose frame is seen from `body` (the base if `None`) at
    /// `placement`.
    fn descend(
        &mut self,
        link: &'a str,
        body: Option<usize>,
        placement: &Placement,
    ) -> Result<(), RobotError> {
        for joint in self.urdf.joints.iter().filter(|j| j.parent.link == link) {
            let at = placement.compose(&pose(&joint.origin));
            let child = self.link(&joint.child.link);
            if joint.joint_type == JointType::Fixed {
                self.fix(child, body, &at);
                self.descend(&child.name, body, &at)?;
            } else {
                let moving = self.move_with(joint, child, body, at)?;
                self.descend(&child.name, Some(moving), &Placement::identity())?;
            }
        }
        Ok(())
    }

    fn fix(&mut self, link: &'a Link, body: Option<usize>, at: &Placement) {
        let leaf = !self.urdf.joints.iter().any(|j| j.parent.link == link.name);
        self.frames.retain(|(name, ..)| *name != link.name);
        if let Some(i) = body {
            let joined = self.bodies[i].inertia.joined_with(&inertia(link).seen_from(at));
            self.bodies[i].inertia = joined;
            self.frames.push((&link.name, *at, leaf));
        }
    }

    fn move_with(
        &mut self,
        joint: &'a urdf_rs::Joint,
        child: &Link,
        parent: Option<usize>,
        placement: Placement,
    ) -> Result<usize, RobotError> {
        self.refuse_branch(joint, parent)?;
        let axis = Vector3::from(joint.axis.xyz.0);
        let axis = Unit::try_new(axis, 1e-9)
            .ok_or_else(|| self.file.joint(&joint.name, "its axis is zero; give a direction"))?;
        let limits = limits(self.file, joint)?;
        let joint = Joint { name: joint.name.clone(), placement, axis, limits };
        let name = child.name.clone();
        self.frames.clear();
        self.bodies.push(Body { name, parent, joint, inertia: inertia(child) });
        Ok(self.bodies.len() - 1)
    }

    fn refuse_branch(
        &self,
        joint: &urdf_rs::Joint,
        parent: Option<usize>,
    ) -> Result<(), RobotError> {
        match self.bodies.iter().find(|b| b.parent == parent) {
            Some(other) => Err(self.file.joint(
                &joint.name,
                format!(
                    "and `{}` move on the same body; armtwin takes serial arms: make the joints \
                     of the side branch (a gripper, say) fixed",
                    other.joint.name
                ),
            )),
            None => Ok(()),
        }
    }

    fn finish(self) -> Result<Robot, RobotError> {
        if self.bodies.is_empty() {
            return Err(self.file.structure(
                "has no moving joint; an arm needs joints of type revolute or continuous",
            ));
        }
        for body in &self.bodies {
            check_body(self.file, body)?;
        }
        let name = self.urdf.name.clone();
        let gravity = Vector3::new(0.0, 0.0, -crate::robot::GRAVITY);
        Ok(Robot { name, flange: self.flange(), bodies: self.bodies, gravity })
    }

    /// tool0 or a frame of similar name on the last body, else its only fixed leaf, else itself.
    fn flange(&self) -> Placement {
        let named = |wanted: &str| self.frames.iter().find(|(name, ..)| *name == wanted);
        let mut leaves = self.frames.iter().filter(|(_, _, leaf)| *leaf);
        let only_leaf = leaves.next().filter(|_| leaves.next().is_none());
        let best = FLANGES.into_iter().find_map(named).or(only_leaf);
        best.map_or(Placement::identity(), |(_, placement, _)| *placement)
    }

    /// `check::tree` made sure that it exists.
    fn link(&self, name: &str) -> &'a Link {
        let found = self.urdf.links.iter().find(|l| l.name == name);
        found.unwrap_or(&self.urdf.links[0])
    }
}

fn limits(file: File, joint: &urdf_rs::Joint) -> Result<Limits, RobotError> {
    let refuse = |problem: String| Err(file.joint(&joint.name, problem));
    if joint.mimic.is_some() {
        return refuse("mimics another joint, which armtwin cannot; make it fixed".into());
    }
    let (lower, upper) = range(joint).map_err(|problem| file.joint(&joint.name, problem))?;
    if joint.joint_type == JointType::Continuous && has_no_limit(joint) {
        return Ok(Limits { lower, upper, velocity: f64::INFINITY, effort: f64::INFINITY });
    }
    let velocity = joint.limit.velocity;
    let effort = if joint.limit.effort == 0.0 { f64::INFINITY } else { joint.limit.effort };
    if velocity.is_nan() || velocity <= 0.0 {
        return refuse(format!("its velocity limit is {velocity} rad/s; give a positive one"));
    }
    if effort.is_nan() || effort < 0.0 {
        return refuse(format!("its effort limit is {effort} N.m; give a positive one"));
    }
    Ok(Limits { lower, upper, velocity, effort })
}

/// A joint without `<limit>` comes as all zeros.
fn has_no_limit(joint: &urdf_rs::Joint) -> bool {
    let l = &joint.limit;
    [l.lower, l.upper, l.velocity, l.effort] == [0.0; 4]
}

/// Lower and upper limit, rad, or what is wrong with them.
fn range(joint: &urdf_rs::Joint) -> Result<(f64, f64), String> {
    let (lower, upper) = (joint.limit.lower, joint.limit.upper);
    match &joint.joint_type {
        JointType::Continuous => Ok((f64::NEG_INFINITY, f64::INFINITY)),
        JointType::Revolute if has_no_limit(joint) => {
            Err("has no limits; give <limit lower upper \
             (rad) velocity (rad/s) effort (N.m)/>, or make it continuous"
                .into())
        }
        JointType::Revolute if lower < upper => Ok((lower, upper)),
        JointType::Revolute => Err(format!(
            "its lower limit {lower} is not below its upper limit {upper} rad; swap or correct them"
        )),
        other => Err(format!(
            "is {}; armtwin takes revolute, continuous and fixed joints: make it fixed if it does \
             not move (a gripper's finger, say)",
            format!("{other:?}").to_lowercase()
        )),
    }
}

fn check_body(file: File, body: &Body) -> Result<(), RobotError> {
    if body.inertia.mass <= 0.0 {
        return Err(file.link(
            &body.name,
            format!(
                "moves with joint `{}` but has no mass; give its <inertial> a positive mass, or \
                 make the joint fixed",
                body.joint.name
            ),
        ));
    }
    if body.inertia.about_com.cholesky().is_none() {
        let eigenvalues = body.inertia.about_com.symmetric_eigenvalues();
        return Err(file.link(&body.name, check::not_positive_definite(&eigenvalues)));
    }
    Ok(())
}

/// In the link's frame.
fn inertia(link: &Link) -> Inertia {
    let own = Inertia {
        mass: link.inertial.mass.value,
        com: Vector3::zeros(),
        about_com: check::tensor_matrix(link),
    };
    own.seen_from(&pose(&link.inertial.origin))
}

fn pose(pose: &Pose) -> Placement {
    let [roll, pitch, yaw] = pose.rpy.0;
    Placement {
        rotation: *Rotation3::from_euler_angles(roll, pitch, yaw).matrix(),
        translation: pose.xyz.0.into(),
    }
}
