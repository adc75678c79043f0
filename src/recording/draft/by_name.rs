//! Which columns are which, by their names.

use super::Block;
use super::source::Columns;
use super::words::words;

/// Words for what is commanded.
const TARGET: [&str; 12] = [
    "target",
    "desired",
    "des",
    "cmd",
    "command",
    "commanded",
    "setpoint",
    "ref",
    "reference",
    "goal",
    "set",
    "d",
];

/// Words for a quantity; stems of what is measured and of what is commanded. The first that fits counts.
type Quantity = (&'static [&'static str], &'static str, &'static str);
const QUANTITIES: [Quantity; 6] = [
    (&["temp", "temperature", "temperatures"], "joint_temperatures", ""),
    (&["torque", "torques", "tau", "trq", "moment", "effort"], "joint_torque", "target_moment"),
    (
        &["current", "currents", "curr", "cur", "i", "iq", "amp", "amps", "ma"],
        "actual_current",
        "target_current",
    ),
    (&["qdd", "ddq", "acc", "accel", "acceleration", "qddot"], "actual_qdd", "target_qdd"),
    (
        &["qd", "dq", "vel", "velocity", "velocities", "speed", "qdot", "omega"],
        "actual_qd",
        "target_qd",
    ),
    (
        &["q", "pos", "position", "positions", "angle", "angles", "theta", "joint", "deg", "rad"],
        "actual_q",
        "target_q",
    ),
];

/// Names of the joints of a common arm.
const JOINTS: [(&str, usize); 5] =
    [("pan", 0), ("base", 0), ("lift", 1), ("shoulder", 1), ("elbow", 2)];

/// What a name says: stem and joint, as it counts.
fn read(name: &str) -> Option<(&'static str, usize)> {
    let words = words(name);
    let number = words.iter().rev().find_map(|w| w.parse::<usize>().ok());
    let is = |list: &[&str]| words.iter().any(|w| list.contains(&w.as_str()));
    let joint = match (number, is(&["wrist"])) {
        (Some(n), true) => n + 2,
        (Some(n), false) => n,
        (None, _) => JOINTS.iter().find(|(word, _)| is(&[word])).map(|(_, j)| *j)?,
    };
    let (_, measured, commanded) = QUANTITIES.iter().find(|(list, ..)| is(list))?;
    let stem = if is(&TARGET) { commanded } else { measured };
    (!stem.is_empty()).then_some((stem, joint))
}

/// Signals whose names count the joints up from 0 or 1 without a gap.
pub fn blocks(columns: &Columns, time: usize) -> Vec<Block> {
    let Some(names) = &columns.names else { return Vec::new() };
    let mut found: Vec<(&'static str, Vec<(usize, usize)>)> = Vec::new();
    for (column, name) in names.iter().enumerate() {
        if column == time || columns.values[column].is_empty() {
            continue;
        }
        let Some((stem, joint)) = read(name) else { continue };
        match found.iter_mut().find(|(s, _)| *s == stem) {
            Some((_, joints)) => joints.push((joint, column)),
            None => found.push((stem, vec![(joint, column)])),
        }
    }
    found.into_iter().filter_map(|(stem, joints)| block(stem, joints, names)).collect()
}

fn block(stem: &'static str, mut joints: Vec<(usize, usize)>, names: &[String]) -> Option<Block> {
    joints.sort_unstable();
    let first = joints.first()?.0;
    // Where a signal comes twice under other names, its first columns are taken.
    joints.dedup_by_key(|(joint, _)| *joint);
    let counts = joints.iter().enumerate().all(|(k, (joint, _))| *joint == first + k);
    let columns: Vec<usize> = joints.into_iter().map(|(_, column)| column).collect();
    let why = match stem {
        "joint_torque" if names[columns[0]].to_lowercase().contains("effort") => {
            "effort: torque or current, look which"
        }
        _ => "by name",
    };
    (counts && first <= 1).then(|| Block { stem, columns, scale: 1.0, why: why.into() })
}
