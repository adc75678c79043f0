//! The arm in 3D: links as capsules between joint origins, joints as cylinders on their axes,
//! one nested entity per body whose pose relative to its parent changes over time.

use nalgebra::{Isometry3, Rotation3, Translation3, UnitQuaternion, Vector3};
use rerun::{
    Capsules3D, Color, Cylinders3D, FillMode, LineStrips3D, Quaternion, Radius, RecordingStream,
    TimeColumn, Transform3D,
};

use super::palette::{self, Rgb};
use super::{Error, log_error};
use crate::robot::{Placement, Robot};
use crate::series::JointSeries;

/// Poses per second in 3D; the plots keep every sample.
const POSE_RATE_HZ: f64 = 30.0;
/// Points of a flange path at most.
const PATH_POINTS: usize = 3000;

/// How one of the two arms is drawn.
pub struct Look {
    /// Entity path of its base.
    pub root: &'static str,
    link: Rgb,
    joint: Rgb,
    /// 255 is solid.
    alpha: u8,
    /// Of all radii, so that coinciding surfaces stay apart.
    swell: f64,
}

pub const RECORDED: Look = Look {
    root: "arm/recorded",
    link: palette::LINK,
    joint: palette::RECORDED,
    alpha: 255,
    swell: 1.0,
};
pub const SIMULATED: Look = Look {
    root: "arm/simulated",
    link: palette::SIMULATED,
    joint: palette::SIMULATED,
    alpha: 70,
    swell: 1.15,
};

/// Logs shapes once, poses over time, and the path of the flange.
pub fn log(
    stream: &RecordingStream,
    robot: &Robot,
    look: &Look,
    time: &[f64],
    q: &JointSeries,
) -> Result<(), Error> {
    let entities = entities(robot, look.root);
    let shown = thin(time, POSE_RATE_HZ);
    for (body, entity) in entities.iter().enumerate() {
        log_shapes(stream, robot, look, body, entity)?;
        log_poses(stream, robot, body, entity, time, &shown, q)?;
    }
    log_base(stream, robot, look)?;
    log_path(stream, robot, look, q)
}

/// Entity path of every body, nested as the bodies are.
fn entities(robot: &Robot, root: &str) -> Vec<String> {
    let mut paths: Vec<String> = Vec::with_capacity(robot.dof());
    for body in &robot.bodies {
        let parent = body.parent.map_or(root, |p| &paths[p]);
        paths
            .push(format!("{parent}/{}", rerun::EntityPathPart::new(&*body.name).escaped_string()));
    }
    paths
}

/// Indices of samples at most `rate_hz` apart, the first and the last among them.
fn thin(time: &[f64], rate_hz: f64) -> Vec<usize> {
    let mut kept = Vec::new();
    let mut next = f64::NEG_INFINITY;
    for (k, &t) in time.iter().enumerate() {
        if t >= next || k + 1 == time.len() {
            kept.push(k);
            next = t + (1.0 - 1e-9) / rate_hz;
        }
    }
    kept
}

fn log_poses(
    stream: &RecordingStream,
    robot: &Robot,
    body: usize,
    entity: &str,
    time: &[f64],
    shown: &[usize],
    q: &JointSeries,
) -> Result<(), Error> {
    let poses = shown.iter().map(|&k| pose_in_parent(robot, body, q.joint(body)[k]));
    let (translations, rotations): (Vec<_>, Vec<_>) =
        poses.map(|p| (xyz(&p.translation.vector), quaternion(&p.rotation))).unzip();
    let times =
        TimeColumn::new_duration_secs(super::plots::TIMELINE, shown.iter().map(|&k| time[k]));
    let columns = Transform3D::new()
        .with_many_translation(translations)
        .with_many_quaternion(rotations)
        .columns_of_unit_batches()
        .map_err(log_error)?;
    stream.send_columns(entity, [times], columns).map_err(log_error)
}

/// A body's frame seen from its parent at joint angle `q`; at rest where `q` is unknown (NaN).
fn pose_in_parent(robot: &Robot, body: usize, q: f64) -> Isometry3<f64> {
    let joint = &robot.bodies[body].joint;
    let turn = UnitQuaternion::from_axis_angle(&joint.axis, if q.is_finite() { q } else { 0.0 });
    isometry(&joint.placement) * turn
}

fn isometry(placement: &Placement) -> Isometry3<f64> {
    let rotation = Rotation3::from_matrix_unchecked(placement.rotation);
    let translation = Translation3::from(placement.translation);
    Isometry3::from_parts(translation, UnitQuaternion::from_rotation_matrix(&rotation))
}

/// Flange position in the base frame, m.
pub(super) fn flange_position(robot: &Robot, q: &[f64]) -> Vector3<f64> {
    let mut poses: Vec<Isometry3<f64>> = Vec::with_capacity(robot.dof());
    for (body, &angle) in q.iter().enumerate() {
        let local = pose_in_parent(robot, body, angle);
        poses.push(robot.bodies[body].parent.map_or(local, |p| poses[p] * local));
    }
    let last = poses.last().copied().unwrap_or_else(Isometry3::identity);
    (last * isometry(&robot.flange)).translation.vector
}

fn log_path(
    stream: &RecordingStream,
    robot: &Robot,
    look: &Look,
    q: &JointSeries,
) -> Result<(), Error> {
    let stride = q.samples().div_ceil(PATH_POINTS);
    let mut sample = vec![0.0; q.joints()];
    let points: Vec<[f32; 3]> = (0..q.samples())
        .step_by(stride.max(1))
        .map(|k| {
            q.sample_into(k, &mut sample);
            xyz(&flange_position(robot, &sample))
        })
        .collect();
    let strip = LineStrips3D::new([points])
        .with_colors([Color::from(look.joint)])
        .with_radii([Radius::new_ui_points(0.8)]);
    stream.log_static(format!("{}/flange_path", look.root), &strip).map_err(log_error)
}

fn log_shapes(
    stream: &RecordingStream,
    robot: &Robot,
    look: &Look,
    body: usize,
    entity: &str,
) -> Result<(), Error> {
    let radius = look.swell * tube_radius(robot, body);
    let ends = ends(robot, body);
    let capsules = Capsules3D::from_lengths_and_radii(
        ends.iter().map(|e| e.norm() as f32),
        ends.iter().map(|_| radius as f32),
    )
    .with_quaternions(ends.iter().map(|e| quaternion(&z_onto(e))))
    .with_colors([look.link.translucent(look.alpha)])
    .with_fill_mode(FillMode::Solid);
    stream.log_static(format!("{entity}/link"), &capsules).map_err(log_error)?;
    let along = z_onto(&robot.bodies[body].joint.axis);
    let housing = (2.6 * radius, 1.2 * radius);
    log_cylinder(stream, &format!("{entity}/joint"), housing, 0.0, &along, look)
}

/// Where the links of a body end, in its frame: its children's joints, or the flange.
fn ends(robot: &Robot, body: usize) -> Vec<Vector3<f64>> {
    let children = robot.bodies.iter().filter(|b| b.parent == Some(body));
    let mut ends: Vec<_> = children.map(|b| b.joint.placement.translation).collect();
    if body + 1 == robot.dof() {
        ends.push(robot.flange.translation);
    }
    ends
}

fn log_base(stream: &RecordingStream, robot: &Robot, look: &Look) -> Result<(), Error> {
    let radius = look.swell * 1.5 * tube_radius(robot, 0);
    let foot = (0.6 * radius, radius);
    let upright = UnitQuaternion::identity();
    log_cylinder(stream, &format!("{}/foot", look.root), foot, 0.3 * radius, &upright, look)
}

/// A cylinder of `(length, radius)`, m, centred `height` up the z axis and turned by `along`.
fn log_cylinder(
    stream: &RecordingStream,
    entity: &str,
    (length, radius): (f64, f64),
    height: f64,
    along: &UnitQuaternion<f64>,
    look: &Look,
) -> Result<(), Error> {
    let cylinder = Cylinders3D::from_lengths_and_radii([length as f32], [radius as f32])
        .with_centers([[0.0, 0.0, height as f32]])
        .with_quaternions([quaternion(along)])
        .with_colors([look.joint.translucent(look.alpha)])
        .with_fill_mode(FillMode::Solid);
    stream.log_static(entity, &cylinder).map_err(log_error)
}

/// Thick at the base, slender at the wrist, in proportion to the arm.
fn tube_radius(robot: &Robot, body: usize) -> f64 {
    let towards_wrist = body as f64 / (robot.dof().max(2) - 1) as f64;
    reach(robot) * (0.055 - 0.025 * towards_wrist)
}

/// Sum of the distances between consecutive joints, m: an upper bound of what the arm reaches.
pub(super) fn reach(robot: &Robot) -> f64 {
    let links: f64 = robot.bodies.iter().map(|b| b.joint.placement.translation.norm()).sum();
    links + robot.flange.translation.norm()
}

/// The rotation that takes z to `direction`; any of them where that is opposite, none for zero.
fn z_onto(direction: &Vector3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between(&Vector3::z(), direction).unwrap_or_else(|| {
        UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
    })
}

fn xyz(v: &Vector3<f64>) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

fn quaternion(r: &UnitQuaternion<f64>) -> Quaternion {
    Quaternion::from_xyzw([r.i as f32, r.j as f32, r.k as f32, r.w as f32])
}
