//! The `[lerobot]` table of a column map: what a data set does not say of its numbers.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::scale::Scale;

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LerobotMap {
    /// Which episode, from 0.
    pub episode: usize,
    /// Names of the data set from base to wrist, with or without their `.pos`; all of them if left out.
    pub joints: Option<Vec<String>>,
    /// Unit of angles.
    pub unit: Option<Unit>,
    /// Angles of joints in percent, rad, at the lower and at the upper end of their range.
    pub ends: BTreeMap<String, [f64; 2]>,
    /// Per joint, -1 where it counts backwards.
    pub scale: Scale,
    /// Per joint: its angle in the arm's description where the data set says zero, rad.
    pub offset: Vec<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    Degrees,
    Radians,
    /// -100 to 100 of a joint's range, 0 to 100 of a gripper's.
    Percent,
}

/// rad = offset + slope x number of the data set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Angle {
    pub slope: f64,
    pub offset: f64,
}

impl LerobotMap {
    /// How the numbers of each of these joints become angles; says what is missing.
    pub fn angles(&self, joints: &[String]) -> Result<Vec<Angle>, String> {
        let unit = self.unit.ok_or(
            "the data set does not say what its numbers are; say it in a column map: [lerobot] unit = \
             \"degrees\", \"radians\" or \"percent\" (an example is scenarios/columns/lerobot_so101.toml)",
        )?;
        let scales = self.scale.expand(joints.len()).map_err(|e| format!("lerobot.scale: {e}"))?;
        if !(self.offset.is_empty() || self.offset.len() == joints.len()) {
            let (given, wanted) = (self.offset.len(), joints.len());
            return Err(format!("lerobot.offset: {given} offsets for {wanted} joints"));
        }
        if let Some(name) = self.ends.keys().find(|name| !joints.iter().any(|j| j == *name)) {
            return Err(format!(
                "lerobot.ends.{name}: no such joint; there are {}",
                joints.join(", ")
            ));
        }
        let of = |(j, name): (usize, &String)| {
            let offset = self.offset.get(j).copied().unwrap_or(0.0);
            let ends = self.ends.get(name);
            let Angle { slope, offset: zero } = match (unit, ends) {
                (_, Some(ends)) => within(name, *ends)?,
                (Unit::Percent, None) => {
                    return Err(format!(
                        "lerobot.ends.{name} is missing: angles, rad, at the lower and the upper end of \
                         its range, for example ends.{name} = [-1.7, 1.7]"
                    ));
                }
                (Unit::Degrees, None) => Angle { slope: 1f64.to_radians(), offset: 0.0 },
                (Unit::Radians, None) => Angle { slope: 1.0, offset: 0.0 },
            };
            Ok(Angle { slope: scales[j] * slope, offset: offset + scales[j] * zero })
        };
        joints.iter().enumerate().map(of).collect()
    }
}

/// From percent of the range between two angles.
fn within(name: &str, [lower, upper]: [f64; 2]) -> Result<Angle, String> {
    if !(lower.is_finite() && upper.is_finite() && lower != upper) {
        return Err(format!("lerobot.ends.{name}: give two different angles in rad"));
    }
    Ok(match name.contains("gripper") {
        true => Angle { slope: 0.01 * (upper - lower), offset: lower },
        false => Angle { slope: 0.005 * (upper - lower), offset: 0.5 * (lower + upper) },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(all: &[&str]) -> Vec<String> {
        all.iter().map(|n| n.to_string()).collect()
    }

    #[test]
    fn numbers_become_angles_as_the_map_says() {
        let map: LerobotMap = toml::from_str(
            "unit = \"degrees\"\nscale = [1, -1, 1]\noffset = [0, 0.5, 0]\nends.gripper = [0.0, 2.0]",
        )
        .unwrap();
        let angles = map.angles(&names(&["pan", "lift", "gripper"])).unwrap();
        let at = |j: usize, x: f64| angles[j].offset + angles[j].slope * x;
        assert!((at(0, 180.0) - std::f64::consts::PI).abs() < 1e-12);
        assert!((at(1, 90.0) - (0.5 - std::f64::consts::FRAC_PI_2)).abs() < 1e-12);
        assert!((at(2, 50.0) - 1.0).abs() < 1e-12, "a gripper counts from 0 to 100");
    }

    #[test]
    fn what_is_not_said_is_asked_for() {
        let ask = |text: &str| {
            let map: LerobotMap = toml::from_str(text).unwrap();
            map.angles(&names(&["pan"])).unwrap_err()
        };
        assert!(ask("").contains("unit = \"degrees\""));
        assert!(ask("unit = \"percent\"").contains("ends.pan"));
        assert!(ask("unit = \"percent\"\nends.tilt = [0, 1]").contains("ends.tilt"));
        assert!(ask("unit = \"radians\"\noffset = [1, 2]").contains("2 offsets for 1 joints"));
    }
}
