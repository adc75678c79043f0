//! How far twin and recording are apart, joint by joint.

use serde::Serialize;

use crate::report::table;
use crate::series::JointSeries;
use crate::signals::Samples;
use crate::statistics::Goodness;
use crate::viewer::Comparison;

/// What `compare` prints and `--json` holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    pub schema: &'static str,
    pub version: &'static str,
    pub recording: String,
    pub robot: String,
    /// Effects that were fitted on this recording.
    pub fitted: Vec<&'static str>,
    /// The command that the simulated arm followed: `target_q` or `actual_q`.
    pub followed: &'static str,
    pub joints: Vec<Row>,
    /// Values of rotor inertia and of the twin's effects: one per joint, or one for the arm.
    pub values: Vec<Value>,
    pub controller: crate::simulation::ControllerSettings,
    pub conditioning: crate::signals::Conditioning,
}

/// One joint's gap between twin and recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// From 1 at the base.
    pub joint: usize,
    pub name: String,
    /// Sliding, usable samples that torque is judged on.
    pub samples: usize,
    /// Measured minus predicted torque, both low-passed, N.m; absent where the joint never slides.
    pub torque_rms_nm: Option<f64>,
    /// 1 - SSE/SST on the same samples.
    pub r2: Option<f64>,
    /// Recorded minus simulated position, rad.
    pub tracking_rms_rad: f64,
    /// Recorded minus commanded position, rad, where a command is recorded.
    pub following_rms_rad: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Value {
    pub parameter: &'static str,
    pub unit: &'static str,
    pub fitted: bool,
    pub values: Vec<f64>,
}

/// Torque on the sliding samples, positions on all usable ones.
pub fn rows(samples: &Samples, scene: &Comparison) -> Vec<Row> {
    let Comparison { robot, torque, simulated, target_q, .. } = scene;
    let gap =
        |other: &JointSeries, j| rms_where(&samples.usable, samples.q.joint(j), other.joint(j));
    let row = |j: usize| {
        let rows = samples.rows(j);
        let [y, fit] = [&torque.measured, &torque.predicted].map(|tau| rows.take(tau.joint(j)));
        let good = (!rows.is_empty()).then(|| Goodness::of(&y, &fit));
        Row {
            joint: j + 1,
            name: robot.bodies[j].joint.name.trim_end_matches("_joint").to_string(),
            samples: rows.len(),
            torque_rms_nm: good.map(|g| g.rmse),
            r2: good.map(|g| g.r2).filter(|r2| r2.is_finite()),
            tracking_rms_rad: gap(&simulated.q, j),
            following_rms_rad: target_q.as_ref().map(|q| gap(q, j)),
        }
    };
    (0..robot.dof()).map(row).collect()
}

/// Root mean square of `a - b` where `used`.
fn rms_where(used: &[bool], a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).zip(used).filter(|(_, u)| **u).map(|((a, b), _)| (a - b).powi(2));
    let (sum, count) = squares.fold((0.0, 0usize), |(sum, n), s| (sum + s, n + 1));
    (sum / count.max(1) as f64).sqrt()
}

pub const HEADER: [&str; 7] =
    ["joint", "name", "samples", "torque / N.m", "R2", "simulated / mrad", "command / mrad"];

/// What the columns of [`HEADER`] hold.
pub const LEGEND: [&str; 3] = [
    "torque, R2: rms of measured - predicted, both low-passed, where the joint slides",
    "simulated: rms of recorded - simulated position; the real arm's controller is not known, the \
     simulated one's stands in for it",
    "command: rms of recorded - commanded position",
];

impl Row {
    /// Cells of the row in the order of [`HEADER`].
    pub fn cells(&self) -> Vec<String> {
        let or_dash = |text: Option<String>| text.unwrap_or_else(|| "-".into());
        let mrad = |rad: f64| format!("{:.2}", 1e3 * rad);
        vec![
            self.joint.to_string(),
            self.name.clone(),
            self.samples.to_string(),
            or_dash(self.torque_rms_nm.map(|rms| format!("{rms:.3}"))),
            or_dash(self.r2.map(|r2| format!("{r2:.4}"))),
            mrad(self.tracking_rms_rad),
            or_dash(self.following_rms_rad.map(mrad)),
        ]
    }
}

impl Report {
    /// For a terminal.
    pub fn table(&self) -> String {
        let rows = table(&HEADER, 2, self.joints.iter().map(Row::cells));
        format!("{rows}\n\n{}", LEGEND.join("\n"))
    }
}
