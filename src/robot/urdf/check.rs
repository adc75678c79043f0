//! Is a parsed URDF one tree of links with sound numbers?

use std::collections::{BTreeMap, BTreeSet};

use urdf_rs::{Joint, Link, Pose};

use crate::robot::RobotError;

/// Where messages point to.
#[derive(Debug, Clone, Copy)]
pub(super) struct File<'a>(pub &'a str);

impl File<'_> {
    pub fn link(&self, name: &str, problem: impl Into<String>) -> RobotError {
        self.element("link", name, problem.into())
    }

    pub fn joint(&self, name: &str, problem: impl Into<String>) -> RobotError {
        self.element("joint", name, problem.into())
    }

    pub fn structure(&self, problem: impl Into<String>) -> RobotError {
        RobotError::Structure { file: self.0.into(), problem: problem.into() }
    }

    fn element(&self, element: &'static str, name: &str, problem: String) -> RobotError {
        RobotError::Element { file: self.0.into(), element, name: name.into(), problem }
    }
}

/// Names are unique, joints join links that exist, and everything hangs on one root, which is
/// returned.
pub(super) fn tree<'a>(file: File, robot: &'a urdf_rs::Robot) -> Result<&'a str, RobotError> {
    let mut links = BTreeSet::new();
    for link in &robot.links {
        if !links.insert(link.name.as_str()) {
            return Err(file.link(&link.name, "is defined twice; rename or remove one"));
        }
    }
    let joint_of_child = joints_by_child(file, robot, &links)?;
    let roots: Vec<&str> =
        links.iter().copied().filter(|l| !joint_of_child.contains_key(l)).collect();
    match roots[..] {
        [] if links.is_empty() => Err(file.structure("has no links; add the arm's <link>s")),
        [] => Err(loop_error(file, robot, &joint_of_child)),
        [root] => match looped(robot, &joint_of_child) {
            Some(_) => Err(loop_error(file, robot, &joint_of_child)),
            None => Ok(root),
        },
        _ => Err(file.structure(format!(
            "has several root links ({}); join them to one tree with fixed joints or remove what \
             does not belong to the arm",
            roots.join(", ")
        ))),
    }
}

fn joints_by_child<'a>(
    file: File,
    robot: &'a urdf_rs::Robot,
    links: &BTreeSet<&str>,
) -> Result<BTreeMap<&'a str, &'a Joint>, RobotError> {
    let mut by_child: BTreeMap<&str, &Joint> = BTreeMap::new();
    let mut names = BTreeSet::new();
    for joint in &robot.joints {
        if !names.insert(&joint.name) {
            return Err(file.joint(&joint.name, "is defined twice; rename or remove one"));
        }
        for (role, link) in [("parent", &joint.parent.link), ("child", &joint.child.link)] {
            if !links.contains(link.as_str()) {
                return Err(file.joint(
                    &joint.name,
                    format!("its {role} link `{link}` does not exist; define the link or correct the name"),
                ));
            }
        }
        if let Some(other) = by_child.insert(&joint.child.link, joint) {
            return Err(file.link(
                &joint.child.link,
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

/// A link from which walking towards the base never ends.
fn looped<'a>(robot: &'a urdf_rs::Robot, up: &BTreeMap<&str, &'a Joint>) -> Option<&'a str> {
    let endless = |start: &str| {
        let mut link = start;
        for _ in 0..=robot.links.len() {
            match up.get(link) {
                Some(joint) => link = &joint.parent.link,
                None => return false,
            }
        }
        true
    };
    robot.joints.iter().map(|j| j.child.link.as_str()).find(|l| endless(l))
}

fn loop_error(file: File, robot: &urdf_rs::Robot, up: &BTreeMap<&str, &Joint>) -> RobotError {
    let link = looped(robot, up).unwrap_or_default();
    let joint = up.get(link).map_or("", |j| &j.name);
    file.link(
        link,
        format!(
            "is part of a closed loop (joint `{joint}` leads back to it); armtwin takes serial \
             arms, remove one joint of the loop"
        ),
    )
}

/// Numbers that XML can hold and an arm cannot.
pub(super) fn numbers(file: File, robot: &urdf_rs::Robot) -> Result<(), RobotError> {
    for link in &robot.links {
        link_numbers(file, link)?;
    }
    for joint in &robot.joints {
        if !finite_pose(&joint.origin) || !joint.axis.xyz.iter().all(|x| x.is_finite()) {
            return Err(file.joint(
                &joint.name,
                "its origin or axis holds a number that is not finite; correct it",
            ));
        }
    }
    Ok(())
}

fn link_numbers(file: File, link: &Link) -> Result<(), RobotError> {
    let i = &link.inertial;
    let t = &i.inertia;
    let tensor = [t.ixx, t.ixy, t.ixz, t.iyy, t.iyz, t.izz];
    if !finite_pose(&i.origin) || !i.mass.value.is_finite() || !tensor.iter().all(|x| x.is_finite())
    {
        return Err(
            file.link(&link.name, "its <inertial> holds a number that is not finite; correct it")
        );
    }
    if i.mass.value < 0.0 {
        let m = i.mass.value;
        return Err(file.link(&link.name, format!("its mass is {m} kg; give a positive mass")));
    }
    let eigenvalues = tensor_matrix(link).symmetric_eigenvalues();
    if eigenvalues.min() < -1e-9 * eigenvalues.amax() {
        return Err(file.link(&link.name, not_positive_definite(&eigenvalues)));
    }
    Ok(())
}

pub(super) fn not_positive_definite(eigenvalues: &nalgebra::Vector3<f64>) -> String {
    let mut e = [eigenvalues.x, eigenvalues.y, eigenvalues.z];
    e.sort_by(f64::total_cmp);
    format!(
        "its inertia tensor is not positive definite (eigenvalues {:.3e}, {:.3e}, {:.3e} kg.m2); \
         correct <inertia>, off-diagonal signs and units first",
        e[0], e[1], e[2]
    )
}

/// In the axes of the inertial origin.
pub(super) fn tensor_matrix(link: &Link) -> nalgebra::Matrix3<f64> {
    let t = &link.inertial.inertia;
    nalgebra::Matrix3::new(t.ixx, t.ixy, t.ixz, t.ixy, t.iyy, t.iyz, t.ixz, t.iyz, t.izz)
}

fn finite_pose(pose: &Pose) -> bool {
    pose.xyz.iter().chain(pose.rpy.iter()).all(|x| x.is_finite())
}
