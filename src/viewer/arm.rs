//! The arm in 3D, in the shapes its URDF has: hubs about the joint axes and tubes between them,
//! one nested entity per body whose pose relative to its parent changes over time.

use nalgebra::{Isometry3, Rotation3, Translation3, UnitQuaternion, Vector3};
use rerun::{
    Capsules3D, Color, Cylinders3D, FillMode, LineStrips3D, Quaternion, Radius, RecordingStream,
    TimeColumn, Transform3D,
};

use super::palette::{self, Rgb};
use super::{Error, log_error};
use crate::robot::urdf::visual::{self, Cylinder, Shape};
use crate::robot::{Placement, Robot, flange_placement};
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
    /// Factor on all radii, so that coinciding surfaces stay apart.
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

/// The twin as given, and mended.
pub const BEFORE: Look = Look {
    root: "arm/twin_as_given",
    link: palette::BEFORE,
    joint: palette::BEFORE,
    alpha: 60,
    swell: 1.12,
};
pub const AFTER: Look = Look {
    root: "arm/mended_twin",
    link: palette::AFTER,
    joint: palette::AFTER,
    alpha: 60,
    swell: 1.22,
};

/// While it is simulated: the arm, and the motion it is told to make.
pub const MOVED: Look = Look {
    root: "arm/simulated",
    link: palette::LINK,
    joint: palette::RECORDED,
    alpha: 255,
    swell: 1.0,
};
pub const COMMANDED: Look = Look {
    root: "arm/commanded",
    link: palette::TARGET,
    joint: palette::TARGET,
    alpha: 60,
    swell: 1.15,
};

/// Logs shapes, poses over time, and the path of the flange.
pub fn log(
    stream: &RecordingStream,
    robot: &Robot,
    look: &Look,
    time: &[f64],
    q: &JointSeries,
) -> Result<(), Error> {
    log_still(stream, robot, look)?;
    log_motion(stream, robot, look, time, q)?;
    log_path(stream, robot, look, q)
}

/// What does not change over time: the shapes.
pub fn log_still(stream: &RecordingStream, robot: &Robot, look: &Look) -> Result<(), Error> {
    for (body, entity) in entities(robot, look.root).iter().enumerate() {
        log_shapes(stream, robot, look, body, entity)?;
    }
    log_base(stream, robot, look)
}

/// Poses of all or of a stretch of the time.
pub fn log_motion(
    stream: &RecordingStream,
    robot: &Robot,
    look: &Look,
    time: &[f64],
    q: &JointSeries,
) -> Result<(), Error> {
    let shown = thin(time, POSE_RATE_HZ);
    for (body, entity) in entities(robot, look.root).iter().enumerate() {
        log_poses(stream, robot, body, entity, time, &shown, q)?;
    }
    Ok(())
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

pub fn log_path(
    stream: &RecordingStream,
    robot: &Robot,
    look: &Look,
    q: &JointSeries,
) -> Result<(), Error> {
    let points: Vec<_> = flange_path(robot, q).iter().map(xyz).collect();
    let strip = LineStrips3D::new([points])
        .with_colors([Color::from(look.joint)])
        .with_radii([Radius::new_ui_points(0.8)]);
    stream.log_static(format!("{}/flange_path", look.root), &strip).map_err(log_error)
}

/// Flange positions in the base frame, m, where all joint angles are known.
fn flange_path(robot: &Robot, q: &JointSeries) -> Vec<Vector3<f64>> {
    let stride = q.samples().div_ceil(PATH_POINTS).max(1);
    let mut sample = vec![0.0; q.joints()];
    let mut path = Vec::new();
    for k in (0..q.samples()).step_by(stride) {
        q.sample_into(k, &mut sample);
        if sample.iter().all(|x| x.is_finite()) {
            path.push(flange_placement(robot, &sample).translation);
        }
    }
    path
}

fn log_shapes(
    stream: &RecordingStream,
    robot: &Robot,
    look: &Look,
    body: usize,
    entity: &str,
) -> Result<(), Error> {
    let Shape { hub, tubes } = visual::body(robot, body);
    log_tubes(stream, &format!("{entity}/link"), &tubes, look)?;
    match hub {
        Some(hub) => log_hub(stream, &format!("{entity}/joint"), &hub, look),
        None => Ok(()),
    }
}

/// A foot about the first joint's axis, and what stands between it and that joint.
fn log_base(stream: &RecordingStream, robot: &Robot, look: &Look) -> Result<(), Error> {
    log_tubes(stream, &format!("{}/base", look.root), &visual::base(robot), look)?;
    let Some(Cylinder { radius, .. }) = visual::body(robot, 0).hub else { return Ok(()) };
    let height = 0.5 * radius;
    let placement =
        Placement { translation: Vector3::new(0.0, 0.0, 0.5 * height), ..Placement::identity() };
    let foot = Cylinder { placement, radius: 1.2 * radius, length: height };
    log_hub(stream, &format!("{}/foot", look.root), &foot, look)
}

fn log_hub(
    stream: &RecordingStream,
    entity: &str,
    hub: &Cylinder,
    look: &Look,
) -> Result<(), Error> {
    let length = hub.length + 2.0 * (look.swell - 1.0) * hub.radius;
    let cylinder =
        Cylinders3D::from_lengths_and_radii([length as f32], [(look.swell * hub.radius) as f32])
            .with_centers([xyz(&hub.placement.translation)])
            .with_quaternions([quaternion(&isometry(&hub.placement).rotation)])
            .with_colors([look.joint.translucent(look.alpha)])
            .with_fill_mode(FillMode::Solid);
    stream.log_static(entity, &cylinder).map_err(log_error)
}

/// Tubes have round ends, which close the corners between them.
fn log_tubes(
    stream: &RecordingStream,
    entity: &str,
    tubes: &[Cylinder],
    look: &Look,
) -> Result<(), Error> {
    let start = |c: &Cylinder| {
        let Placement { rotation, translation } = c.placement;
        translation - rotation * Vector3::new(0.0, 0.0, c.length / 2.0)
    };
    let capsules = Capsules3D::from_lengths_and_radii(
        tubes.iter().map(|c| c.length as f32),
        tubes.iter().map(|c| (look.swell * c.radius) as f32),
    )
    .with_translations(tubes.iter().map(|c| xyz(&start(c))))
    .with_quaternions(tubes.iter().map(|c| quaternion(&isometry(&c.placement).rotation)))
    .with_colors([look.link.translucent(look.alpha)])
    .with_fill_mode(FillMode::Solid);
    stream.log_static(entity, &capsules).map_err(log_error)
}

/// Where the arm works, for the camera: the box around its base and the path of its flange.
pub struct Frame {
    /// m
    pub centre: Vector3<f64>,
    /// Horizontal unit vector from the base towards the centre.
    pub ahead: Vector3<f64>,
    /// Diagonal of the box or reach of the arm, whichever is larger, m.
    pub size: f64,
}

pub fn frame(robot: &Robot, q: &JointSeries) -> Frame {
    let base = Vector3::zeros();
    let path = flange_path(robot, q);
    let low = path.iter().fold(base, |low, p| low.inf(p));
    let high = path.iter().fold(base, |high, p| high.sup(p));
    let centre = (low + high) / 2.0;
    let ahead = Vector3::new(centre.x, centre.y, 0.0).try_normalize(1e-6);
    let size = reach(robot).max((high - low).norm());
    Frame { centre, ahead: ahead.unwrap_or(Vector3::x()), size }
}

/// Wherever the arm may go, where that is not known yet: all that is within its reach.
pub fn around(robot: &Robot) -> Frame {
    let base = robot.bodies.first().map_or(Vector3::zeros(), |b| b.joint.placement.translation);
    Frame { centre: base, ahead: Vector3::x(), size: 2.0 * reach(robot) }
}

/// m
fn reach(robot: &Robot) -> f64 {
    let links: f64 = robot.bodies.iter().map(|b| b.joint.placement.translation.norm()).sum();
    links + robot.flange.translation.norm()
}

pub fn xyz(v: &Vector3<f64>) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

fn quaternion(r: &UnitQuaternion<f64>) -> Quaternion {
    Quaternion::from_xyzw([r.i as f32, r.j as f32, r.k as f32, r.w as f32])
}
