//! Is a recording what its column names say, and of the arm it is held against? Physics tells: velocity
//! is what position changes by, a drive carries the weight of its arm, and friction takes power.
//!
//! Nothing is called wrong for being large. A recording is doubted where another reading of the same
//! columns (another unit, sign or order, from a short list) explains what this one does not
//! (`readings`), or where a factor is beyond anything that a load, a gain or another build makes
//! (`FACTOR`). So friction, loads, counterbalances, delays and offsets, whatever their size, raise no doubt: finding
//! them is what the rest of the program is for.

mod clock;
mod fit;
mod motion;
mod readings;
mod speed;
#[cfg(test)]
mod tests;
mod weight;

use crate::recording::Recording;
use crate::twin::Twin;

pub use weight::Slope;

/// Beyond this and its inverse a factor is an error of units. The heaviest load that an arm is built for
/// multiplies the weight on a joint by up to 3, the least that a wrong unit does is 9 (N.m taken for A at
/// the wrist of a UR5): 5 lies between, in decades.
const FACTOR: f64 = 5.0;

/// What a recording is held against.
pub struct Arm<'a> {
    pub twin: &'a Twin,
    /// Nobody said which arm it is.
    pub assumed: bool,
    /// Whether the drive's torque constants are known; to find them a recording is no contradiction.
    pub scaled: bool,
}

/// A contradiction: what, where, and what to do. No full stop at its end.
#[derive(Debug, Clone, PartialEq)]
pub struct Doubt {
    pub what: String,
    pub remedy: String,
}

/// One sentence without its full stop.
impl std::fmt::Display for Doubt {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { what, remedy } = self;
        if remedy.is_empty() { f.write_str(what) } else { write!(f, "{what}; {remedy}") }
    }
}

/// What the data say of themselves and of the arm.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Judgement {
    /// The worst first; empty where nothing contradicts.
    pub doubts: Vec<Doubt>,
    /// Recorded over predicted torque, one per joint; `None` where its weight does not tell, or without
    /// torque.
    pub slopes: Vec<Option<Slope>>,
}

/// Holds `recording` against `arm`, whose joints it must have.
pub fn judge(recording: &Recording, arm: &Arm<'_>) -> Judgement {
    let clock = clock::guess(recording);
    let scale = clock.as_ref().map_or(1.0, |c| c.scale);
    let mut doubts: Vec<Doubt> = clock.into_iter().map(|c| c.doubt).collect();
    doubts.extend(speed::doubts(recording, scale));
    let torque = motion::torque(recording, &arm.twin.drive, arm.twin.robot.dof());
    let moved = motion::Motion::new(recording, scale, arm.twin.robot.dof());
    // An arm that stands tells one pose, which any reading explains.
    let Some((torque, motion)) = torque.zip(moved.filter(motion::Motion::slides)) else {
        return Judgement { doubts, slopes: vec![None; arm.twin.robot.dof()] };
    };
    let (of_weight, slopes) = weight::judge(recording, arm, &motion, &torque);
    doubts.extend(of_weight);
    Judgement { doubts, slopes }
}

/// What the columns say of each other, where no arm is known.
pub fn judge_alone(recording: &Recording) -> Vec<Doubt> {
    let clock = clock::guess(recording);
    let scale = clock.as_ref().map_or(1.0, |c| c.scale);
    clock.into_iter().map(|c| c.doubt).chain(speed::doubts(recording, scale)).collect()
}

/// Built-in arms whose weight a recorded torque (not current) carries, the likeliest first, with the slope
/// at the joint that carries most.
pub fn likely_arms(recording: &Recording) -> Vec<(&'static str, f64)> {
    weight::likely(recording)
}

/// "joint 3", "joints 1, 3"; counted from 0 in `joints`.
fn named(joints: &[usize]) -> String {
    let names: Vec<String> = joints.iter().map(|j| (j + 1).to_string()).collect();
    format!("joint{} {}", if joints.len() == 1 { "" } else { "s" }, names.join(", "))
}

/// Whether a factor is that of a unit, as far as loads and gains leave it (a third more or less).
fn near(factor: f64, unit: f64) -> bool {
    (factor / unit).ln().abs() < 0.3
}
