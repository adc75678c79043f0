//! The gap by joint and by regime.

use crate::diagnosis::{Gap, JointGap};
use crate::report::diagnosis as rows;
use crate::report::table;
use crate::text::titled;

pub fn section(gap: &Gap) -> String {
    let joints = table(&rows::GAP, 1, gap.joints.iter().map(rows::gap));
    let regimes = regimes(gap);
    let legend = "+: more than the joint's gap as a whole. -: not in this recording";
    titled("Where: recorded torque less the twin's", &format!("{joints}\n\n{regimes}\n{legend}"))
}

/// Regimes of all joints; what only some have stands after what they have before it.
fn names(gap: &Gap) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for joint in &gap.joints {
        let mut next = 0;
        for regime in &joint.regimes {
            let at = names.iter().position(|n| *n == regime.regime).unwrap_or_else(|| {
                names.insert(next, &regime.regime);
                next
            });
            next = at + 1;
        }
    }
    names
}

/// One row per regime, one column per joint, N.m.
fn regimes(gap: &Gap) -> String {
    let names = names(gap);
    let cell = |joint: &JointGap, name: &str| {
        let Some(r) = joint.regimes.iter().find(|r| r.regime == name) else { return "-".into() };
        let more = if r.low_nm > joint.high_nm { "+" } else { " " };
        format!("{:.3}{more}", r.rms_nm)
    };
    let row = |name: &&str| {
        let cells = gap.joints.iter().map(|j| cell(j, name));
        std::iter::once(name.replace('_', " ")).chain(cells).collect()
    };
    let joints: Vec<String> = gap.joints.iter().map(|j| format!("joint {} ", j.joint)).collect();
    let header: Vec<&str> =
        std::iter::once("motion, N.m").chain(joints.iter().map(String::as_str)).collect();
    table(&header, 1, names.iter().map(row))
}
