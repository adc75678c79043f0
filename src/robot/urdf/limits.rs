//! The `<limit>` of a revolute or continuous joint. What is missing is no limit, and noted.

use roxmltree::Node;

use super::elements::{Joint, Kind};
use super::notes::Notes;
use crate::robot::{Limits, RobotError};

const FREE: Limits = Limits {
    lower: f64::NEG_INFINITY,
    upper: f64::INFINITY,
    velocity: f64::INFINITY,
    effort: f64::INFINITY,
};

pub(super) fn read(joint: &Joint, notes: &mut Notes) -> Result<Limits, RobotError> {
    let Some(limit) = joint.element.only(joint.element.node, "limit", notes) else {
        if joint.kind == Kind::Revolute {
            let text = "no <limit>; taken as free to turn, without limits of velocity and effort";
            notes.of("joint", joint.name, text);
        }
        return Ok(FREE);
    };
    let (lower, upper) = match joint.kind {
        Kind::Continuous => (FREE.lower, FREE.upper),
        _ => range(joint, limit, notes)?,
    };
    let velocity = most(joint, limit, ("velocity", "rad/s"), notes)?;
    let effort = most(joint, limit, ("effort", "N.m"), notes)?;
    Ok(Limits { lower, upper, velocity, effort })
}

/// Lower and upper limit, rad.
fn range(joint: &Joint, limit: Node, notes: &mut Notes) -> Result<(f64, f64), RobotError> {
    // What is left out is 0 (the URDF specification, joint, limit).
    let lower = number(joint, limit, "lower")?.unwrap_or(0.0);
    let upper = number(joint, limit, "upper")?.unwrap_or(0.0);
    if lower == 0.0 && upper == 0.0 {
        let text = "lower and upper limit are 0 or left out; taken as free to turn";
        notes.of("joint", joint.name, text);
        return Ok((FREE.lower, FREE.upper));
    }
    if lower >= upper {
        return Err(joint.element.wrong(format!(
            "its lower limit {lower} is not below its upper limit {upper} rad; swap or correct them"
        )));
    }
    Ok((lower, upper))
}

/// A limit of velocity or effort; none where it is not positive.
fn most(
    joint: &Joint,
    limit: Node,
    (name, unit): (&str, &str),
    notes: &mut Notes,
) -> Result<f64, RobotError> {
    let given = number(joint, limit, name)?;
    if let Some(value) = given.filter(|v| *v > 0.0) {
        return Ok(value);
    }
    let text = match given {
        Some(value) => format!("{name} limit of {value} {unit}; taken as unlimited"),
        None => format!("no {name} limit; taken as unlimited"),
    };
    notes.of("joint", joint.name, text);
    Ok(f64::INFINITY)
}

/// May be infinite.
fn number(joint: &Joint, limit: Node, name: &str) -> Result<Option<f64>, RobotError> {
    let Some(text) = limit.attribute(name) else { return Ok(None) };
    match text.trim().parse::<f64>() {
        Ok(value) if !value.is_nan() => Ok(Some(value)),
        _ => Err(joint.element.not_numbers("limit", name, text, "a number")),
    }
}
