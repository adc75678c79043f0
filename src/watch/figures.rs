//! How large the gap is, joint by joint and regime by regime: exponentially weighted, beside the level that
//! the twin left when it was fitted, or in the first minutes.

use super::{Settings, Stretch};

/// When a joint's gap is looked at: whenever it slides, shortly after it turned round, slowly, fast, and with
/// its load driven or driving. The words of a diagnosis, with limits that do not wait for the end of the
/// recording: speeds are shares of the fastest seen so far.
pub const REGIMES: [&str; 6] = ["sliding", "reversal", "slow", "fast", "driven", "back_driven"];

/// Length of a reversal after sliding has begun in the other direction, s.
const REVERSAL_S: f64 = 0.2;
const SLOW: f64 = 0.2;
const FAST: f64 = 0.6;

/// Root mean square and mean along the motion (what is needed more where positive), N.m.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct Figure {
    pub rms_nm: f64,
    pub along_nm: f64,
}

/// Sums that forget with a time constant, or never.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    weight: f64,
    squares: f64,
    along: f64,
}

impl Sums {
    fn add(&mut self, left: f64, along: f64, keep: f64) {
        self.weight = keep * self.weight + 1.0;
        self.squares = keep * self.squares + left * left;
        self.along = keep * self.along + along;
    }

    fn figure(&self) -> Option<Figure> {
        (self.weight > 0.0).then(|| Figure {
            rms_nm: (self.squares / self.weight).sqrt(),
            along_nm: self.along / self.weight,
        })
    }
}

/// What the twin left where nothing had changed, joint by joint and regime by regime.
#[derive(Debug, Clone, PartialEq)]
pub struct Level(pub Vec<[Option<Figure>; REGIMES.len()]>);

#[derive(Debug, Clone)]
pub struct Figures {
    joints: Vec<Joint>,
    learn_s: f64,
    keeps_s: f64,
}

#[derive(Debug, Clone, Default)]
struct Joint {
    now: [Sums; REGIMES.len()],
    level: [Sums; REGIMES.len()],
    learned_s: f64,
    fastest: f64,
    /// Direction of the motion before, and how long the present one lasts, s.
    direction: f64,
    since_s: f64,
    turned: bool,
}

impl Figures {
    pub fn new(joints: usize, settings: &Settings) -> Self {
        let joints = vec![Joint::default(); joints];
        Self { joints, learn_s: settings.learn_s, keeps_s: settings.figures_s }
    }

    /// Takes what a twin left of a recording it was fitted on for the level.
    pub fn learn(&mut self, stretch: &Stretch) {
        for (j, joint) in self.joints.iter_mut().enumerate() {
            joint.take(stretch, j, f64::INFINITY, f64::INFINITY);
            joint.learned_s = f64::INFINITY;
            joint.now = Default::default();
        }
    }

    /// Takes what is seen; it counts for the level until that is learned.
    pub fn add(&mut self, stretch: &Stretch) {
        for (j, joint) in self.joints.iter_mut().enumerate() {
            joint.take(stretch, j, self.keeps_s, self.learn_s);
        }
    }

    /// Something changed: what comes is no part of the level.
    pub fn settle(&mut self) {
        self.joints.iter_mut().for_each(|joint| joint.learned_s = f64::INFINITY);
    }

    /// Whether the level of all joints that move is known.
    pub fn knows_level(&self) -> bool {
        let moved = |j: &&Joint| j.learned_s > 0.0;
        let mut moving = self.joints.iter().filter(moved).peekable();
        moving.peek().is_some() && moving.all(|j| j.learned_s >= self.learn_s)
    }

    pub fn now(&self, joint: usize) -> [Option<Figure>; REGIMES.len()] {
        self.joints[joint].now.map(|sums| sums.figure())
    }

    pub fn level(&self) -> Level {
        Level(self.joints.iter().map(|j| j.level.map(|sums| sums.figure())).collect())
    }

    pub fn joints(&self) -> usize {
        self.joints.len()
    }
}

impl Joint {
    fn take(&mut self, stretch: &Stretch, j: usize, keeps_s: f64, learn_s: f64) {
        let keep = (-stretch.dt / keeps_s).exp();
        let (qd, load) = (stretch.qd.joint(j), stretch.load.joint(j));
        for k in (0..stretch.len()).filter(|&k| stretch.counts[j][k]) {
            let (speed, left) = (qd[k].abs(), stretch.left(j, k));
            let along = left * qd[k].signum();
            self.turn(qd[k].signum(), stretch.dt);
            self.fastest = self.fastest.max(speed);
            let driven = load[k] * qd[k];
            let holds = [
                true,
                self.turned && self.since_s <= REVERSAL_S,
                speed < SLOW * self.fastest,
                speed > FAST * self.fastest,
                driven > 0.0,
                driven < 0.0,
            ];
            let learns = self.learned_s < learn_s;
            self.learned_s += stretch.dt;
            for (regime, _) in holds.iter().enumerate().filter(|(_, holds)| **holds) {
                self.now[regime].add(left, along, keep);
                if learns {
                    self.level[regime].add(left, along, 1.0);
                }
            }
        }
    }

    fn turn(&mut self, direction: f64, dt: f64) {
        if direction == self.direction {
            self.since_s += dt;
        } else {
            self.turned = self.direction != 0.0;
            self.direction = direction;
            self.since_s = 0.0;
        }
    }
}
