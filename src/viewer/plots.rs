//! Scalar plots: one entity per joint and quantity, its curves logged column by column.

use std::borrow::Cow;

use rerun::{RecordingStream, Scalars, SeriesLines, TimeColumn};

use super::palette::{self, Rgb};
use super::{Comparison, Error, log_error};
use crate::series::JointSeries;

/// Name of the one timeline, s.
pub const TIMELINE: &str = "time";

/// What is plotted per joint: key in the entity path, label with unit for people.
pub struct Quantity {
    pub key: &'static str,
    pub label: &'static str,
    /// More than one curve, so the plot needs a legend.
    pub legend: bool,
    curves: fn(&Comparison, usize) -> Vec<Curve<'_>>,
}

/// One of the curves in a plot.
pub struct Curve<'a> {
    pub name: &'a str,
    pub color: Rgb,
    pub values: Cow<'a, [f64]>,
    /// On the screen, points.
    pub width: f32,
}

const WIDTH: f32 = 1.5;

pub static ANGLE: Quantity = Quantity {
    key: "angle",
    label: "angle / rad",
    legend: true,
    curves: |c, j| {
        let target = c.target_q.iter().map(|q| curve("target", palette::TARGET, q.joint(j)));
        target.chain(both(&c.recorded.q, &c.simulated.q, j)).collect()
    },
};
pub static TRACKING: Quantity = Quantity {
    key: "tracking",
    label: "angle, recorded - simulated / rad",
    legend: false,
    curves: |c, j| difference(&c.recorded.q, &c.simulated.q, j),
};
pub static VELOCITY: Quantity = Quantity {
    key: "velocity",
    label: "velocity / (rad/s)",
    legend: true,
    curves: |c, j| both(&c.recorded.qd, &c.simulated.qd, j).into(),
};
pub static TORQUE: Quantity = Quantity {
    key: "torque",
    label: "torque / N.m",
    legend: true,
    curves: |c, j| {
        let (measured, predicted) = (c.torque.measured.joint(j), c.torque.predicted.joint(j));
        vec![
            curve("measured", palette::RECORDED, measured),
            curve("predicted", palette::SIMULATED, predicted),
        ]
    },
};
pub static RESIDUAL: Quantity = Quantity {
    key: "residual",
    label: "torque, measured - predicted / N.m",
    legend: false,
    curves: |c, j| difference(&c.torque.measured, &c.torque.predicted, j),
};

/// In the order a joint's tab shows them.
pub static QUANTITIES: [&Quantity; 5] = [&TORQUE, &RESIDUAL, &ANGLE, &TRACKING, &VELOCITY];

/// Where a joint's quantity lives; joints count from 0 here and from 1 in the path.
pub fn entity(joint: usize, quantity: &Quantity) -> String {
    format!("joint_{}/{}", joint + 1, quantity.key)
}

/// Logs `quantities` of every joint.
pub fn log(
    stream: &RecordingStream,
    c: &Comparison,
    quantities: &[&Quantity],
) -> Result<(), Error> {
    log_styles(stream, c, quantities)?;
    log_stretch(stream, c, quantities)
}

/// How `quantities` are drawn.
pub fn log_styles(
    stream: &RecordingStream,
    c: &Comparison,
    quantities: &[&Quantity],
) -> Result<(), Error> {
    for joint in 0..c.robot.dof() {
        for quantity in quantities {
            log_style(stream, &entity(joint, quantity), &(quantity.curves)(c, joint))?;
        }
    }
    Ok(())
}

/// The values of `quantities`, which may be a stretch of what is logged in the end.
pub fn log_stretch(
    stream: &RecordingStream,
    c: &Comparison,
    quantities: &[&Quantity],
) -> Result<(), Error> {
    let time = TimeColumn::new_duration_secs(TIMELINE, c.time.iter().copied());
    for joint in 0..c.robot.dof() {
        for quantity in quantities {
            let curves = (quantity.curves)(c, joint);
            log_values(stream, &time, &entity(joint, quantity), &curves)?;
        }
    }
    Ok(())
}

/// Curves of one plot share an entity, so that time and row numbers are stored once for all.
pub fn log_curves(
    stream: &RecordingStream,
    time: &TimeColumn,
    entity: &str,
    curves: &[Curve<'_>],
) -> Result<(), Error> {
    log_style(stream, entity, curves)?;
    log_values(stream, time, entity, curves)
}

pub fn log_style(
    stream: &RecordingStream,
    entity: &str,
    curves: &[Curve<'_>],
) -> Result<(), Error> {
    let style = SeriesLines::new()
        .with_names(curves.iter().map(|c| c.name))
        .with_colors(curves.iter().map(|c| rerun::Color::from(c.color)))
        .with_widths(curves.iter().map(|c| c.width));
    stream.log_static(entity, &style).map_err(log_error)
}

pub fn log_values(
    stream: &RecordingStream,
    time: &TimeColumn,
    entity: &str,
    curves: &[Curve<'_>],
) -> Result<(), Error> {
    let samples = time.num_rows();
    let rows = (0..samples).flat_map(|k| curves.iter().map(move |c| c.values[k]));
    let columns = Scalars::new(rows)
        .columns(std::iter::repeat_n(curves.len(), samples))
        .map_err(log_error)?;
    stream.send_columns(entity, [time.clone()], columns).map_err(log_error)
}

pub fn curve<'a>(name: &'a str, color: Rgb, values: &'a [f64]) -> Curve<'a> {
    Curve { name, color, values: Cow::Borrowed(values), width: WIDTH }
}

fn both<'a>(recorded: &'a JointSeries, simulated: &'a JointSeries, j: usize) -> [Curve<'a>; 2] {
    [
        curve("recorded", palette::RECORDED, recorded.joint(j)),
        curve("simulated", palette::SIMULATED, simulated.joint(j)),
    ]
}

fn difference<'a>(recorded: &JointSeries, twin: &JointSeries, j: usize) -> Vec<Curve<'a>> {
    let values = recorded.joint(j).iter().zip(twin.joint(j)).map(|(r, t)| r - t).collect();
    vec![Curve { values: Cow::Owned(values), ..curve("difference", palette::DIFFERENCE, &[]) }]
}
