//! Whether the gap of any joint changed: every joint's features, whitened, in two-sided charts.

use super::Stretch;
use super::blocks::{BLOCK_S, Block, FEATURES};
use super::cusum::{Cusum, threshold};
use super::self_starting::SelfStarting;

/// Something changed.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Alarm {
    /// From 0.
    pub joint: usize,
    /// Which of [`FEATURES`].
    pub feature: usize,
    /// Whether it grew.
    pub more: bool,
    /// When it began, as far as the chart can say, and when it was noticed, s in the clock of the rows.
    pub since: f64,
    pub noticed: f64,
}

/// What is stated of false alarms.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Expected {
    /// One-sided charts in all.
    pub charts: usize,
    /// The limit of each, standard deviations.
    pub limit: f64,
    /// Mean time between false alarms of all together, s of sliding motion of every joint.
    pub every_s: f64,
}

#[derive(Debug, Clone)]
pub struct Detector {
    joints: Vec<Joint>,
    expected: Expected,
}

#[derive(Debug, Clone, Default)]
struct Joint {
    block: Block,
    charts: [Chart; FEATURES.len()],
}

/// Both sides of one feature.
#[derive(Debug, Clone, Copy, Default)]
struct Chart {
    whitened: SelfStarting,
    more: Cusum,
    less: Cusum,
}

impl Detector {
    /// With one false alarm in `every_s` on average: every chart runs as many times longer as there are charts.
    pub fn new(joints: usize, every_s: f64) -> Self {
        let charts = 2 * joints * FEATURES.len();
        let limit = threshold(charts as f64 * every_s / BLOCK_S);
        let expected = Expected { charts, limit, every_s };
        Self { joints: vec![Joint::default(); joints], expected }
    }

    pub fn expected(&self) -> Expected {
        self.expected
    }

    /// Joints, from 0, that slid too little so far to tell a change.
    pub fn learns(&self) -> Vec<usize> {
        let knows = |j: usize| self.joints[j].charts.iter().all(|chart| chart.whitened.knows());
        (0..self.joints.len()).filter(|&j| !knows(j)).collect()
    }

    /// What is usual, where a recording says it: a change is then noticed from the first block on.
    pub fn learn(&mut self, stretch: &Stretch) {
        for (j, joint) in self.joints.iter_mut().enumerate() {
            joint.add(stretch, j, f64::INFINITY);
            joint.block = Block::default();
            for chart in &mut joint.charts {
                (chart.more, chart.less) = (Cusum::default(), Cusum::default());
            }
        }
    }

    /// Takes what is seen. After an alarm the charts begin anew: what is, is the usual from then on.
    pub fn add(&mut self, stretch: &Stretch) -> Option<Alarm> {
        let mut first: Option<Alarm> = None;
        for (j, joint) in self.joints.iter_mut().enumerate() {
            let alarm = joint.add(stretch, j, self.expected.limit);
            first = match (first, alarm) {
                (Some(a), Some(b)) if b.since < a.since => Some(b),
                (first, alarm) => first.or(alarm),
            };
        }
        if first.is_some() {
            self.joints.fill(Joint::default());
        }
        first
    }
}

impl Joint {
    fn add(&mut self, stretch: &Stretch, j: usize, limit: f64) -> Option<Alarm> {
        let qd = stretch.qd.joint(j);
        let mut alarm = None;
        for k in (0..stretch.len()).filter(|&k| stretch.counts[j][k]) {
            let (time, left) = (stretch.time[k], stretch.left(j, k));
            let whole = self.block.add(time, left, qd[k].signum(), stretch.dt);
            let Some((begins, features)) = whole else { continue };
            for (feature, (chart, x)) in self.charts.iter_mut().zip(features).enumerate() {
                let Some(z) = chart.whitened.add(x) else { continue };
                let sides = [(&mut chart.more, z, true), (&mut chart.less, -z, false)];
                for (side, z, more) in sides {
                    if side.add(z, begins, limit) && alarm.is_none() {
                        let since = side.since;
                        alarm = Some(Alarm { joint: j, feature, more, since, noticed: time });
                    }
                }
            }
        }
        alarm
    }
}
