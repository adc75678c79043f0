//! Does the recorded torque carry the arm? Joint by joint: weight and inertia by the twin, and friction,
//! which takes power, against what was recorded.

use nalgebra::{Matrix3, Vector3};

use super::fit::{Fit, Joint};
use super::motion::{Motion, Torque, torque};
use super::readings::{Reading, alternatives};
use super::{Arm, Doubt, FACTOR, named, near};
use crate::recording::Recording;
use crate::robot::{
    BUILT_IN, Drive, GRAVITY, Robot, Workspace, gravity_torque, inverse_dynamics_series,
};
use crate::series::JointSeries;

/// A column of which weight and friction explain this share needs no other reading.
const UNDERSTOOD: f64 = 0.95;
/// A joint's slope says something where weight explains this share of what friction leaves.
const TOLD: f64 = 0.5;
/// Another reading has to explain this share of a column, ...
const GOOD: f64 = 0.8;
/// ... and leave this much of what is left of it as it stands, at most, ...
const LEAVES: f64 = 0.1;
/// ... of a column that is read otherwise no more than as it stands and this share of it, and of any other one no more than
/// this times as much.
const LOSS: f64 = 0.02;
const TIMES: f64 = 1.5;
/// Readings explain alike whose logarithms of what is left, summed over columns, differ by less.
const ALIKE: f64 = 0.5;
/// Share of a column that signs which cannot be have to explain for it to be contradicted.
const CONTRADICTED: f64 = 0.03;
/// The heaviest load that an arm is built for, as a share of its moving mass (UR arms: 0.25 to 0.38).
const LOAD: f64 = 0.25;
/// A joint's weight is sure where it varies by this share of what that load would add ...
const SURE: f64 = 0.5;
/// ... and by this share of the largest weight that the arm can put on a joint.
const VARIES: f64 = 0.05;
/// Without a word which arm it is, its weight is that of the one assumed within this factor: a real UR5 with
/// a tool nobody wrote down carries up to 1.9 times the table's, a UR3e 0.3 times, a UR10 2.8 times.
const SAME_ARM: f64 = 2.3;

/// No joint gives more than this times its largest torque, whatever its gain.
const BEYOND: f64 = 10.0;

/// Recorded over predicted torque of one joint.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Slope {
    pub value: f64,
    /// Share of the torque, friction left aside, that weight and inertia explain.
    pub explained: f64,
}

/// The rigid body, and the inertia of rotors at the joints.
pub struct Body {
    pub robot: Robot,
    pub armature: Vec<f64>,
}

/// How far a column of torque is understood.
#[derive(Debug, Clone, Copy)]
struct Quality {
    /// Share of its variance.
    explained: f64,
    /// Friction that gives power, or weight that pulls the other way, would explain most of the rest.
    contradicted: bool,
}

impl Quality {
    fn doubtful(self) -> bool {
        self.explained < UNDERSTOOD || self.contradicted
    }

    fn good(self) -> bool {
        self.explained >= GOOD && !self.contradicted
    }

    /// Whether `other` is the better reading of the column by far.
    fn mended_by(self, other: Self) -> bool {
        let shrinks = 1.0 - other.explained <= LEAVES * (1.0 - self.explained);
        self.doubtful() && other.good() && (shrinks || self.contradicted)
    }

    fn harmed_by(self, other: Self, otherwise: bool) -> bool {
        let times = if otherwise { 1.0 } else { TIMES };
        1.0 - other.explained > times * (1.0 - self.explained) + LOSS
            || (other.contradicted && !self.contradicted)
    }
}

/// What one reading of the columns makes of them, joint by joint.
struct Explained {
    fits: Vec<Fit>,
    heavy: Vec<bool>,
}

pub fn judge(
    recording: &Recording,
    arm: &Arm<'_>,
    motion: &Motion,
    torque: &Torque,
) -> (Vec<Doubt>, Vec<Option<Slope>>) {
    let mechanism = arm.twin.mechanism(|_| true);
    let body = Body { robot: mechanism.robot, armature: mechanism.armature };
    let measured = motion.means(&torque.values);
    let usual = Reading::as_it_stands(body.robot.dof());
    let as_is = explain(&body, motion, &measured, &usual);
    let slopes = as_is.slopes();
    let doubts = match reading(&body, motion, &measured, &as_is) {
        Some(doubt) => vec![doubt],
        None => factor(arm, torque, &slopes)
            .or_else(|| beyond(arm, torque, &measured))
            .or_else(|| sign(&slopes))
            .or_else(|| other_arm(recording, arm, &slopes))
            .into_iter()
            .collect(),
    };
    (doubts, slopes)
}

impl Explained {
    fn slopes(&self) -> Vec<Option<Slope>> {
        let slope = |(fit, heavy): (&Fit, &bool)| {
            let told = *heavy && fit.by_weight >= TOLD;
            told.then_some(Slope { value: fit.slope, explained: fit.by_weight })
        };
        self.fits.iter().zip(&self.heavy).map(slope).collect()
    }

    /// By column of torque.
    fn quality(&self, reading: &Reading) -> Vec<Quality> {
        let mut quality = vec![Quality { explained: 0.0, contradicted: false }; self.fits.len()];
        for (fit, column) in self.fits.iter().zip(&reading.torque) {
            let cost = fit.total - fit.physical;
            let contradicted = cost > CONTRADICTED && cost > 0.5 * (1.0 - fit.physical);
            quality[*column] = Quality { explained: fit.physical, contradicted };
        }
        quality
    }
}

/// Another reading of the columns that explains what this one does not: the best of all such.
fn reading(body: &Body, motion: &Motion, torque: &JointSeries, as_is: &Explained) -> Option<Doubt> {
    use rayon::prelude::*;
    let before = as_is.quality(&Reading::as_it_stands(body.robot.dof()));
    if !before.iter().any(|q| q.doubtful()) {
        return None;
    }
    let better = |reading: Reading| -> Option<(f64, Reading)> {
        let after = explain(body, motion, torque, &reading).quality(&reading);
        let pairs = || before.iter().zip(&after);
        let mended = pairs().any(|(b, a)| b.mended_by(*a));
        let columns: Vec<usize> = reading.columns().collect();
        let harmed = pairs().enumerate().any(|(c, (b, a))| b.harmed_by(*a, columns.contains(&c)));
        let changed = columns.iter().all(|c| after[*c].good());
        let left = after.iter().map(|a| (1.0 - a.explained).max(1e-6).ln()).sum();
        (mended && !harmed && changed).then_some((left, reading))
    };
    let found: Vec<(f64, Reading)> =
        alternatives(body.robot.dof()).into_par_iter().filter_map(better).collect();
    let least = found.iter().map(|(left, _)| *left).fold(f64::INFINITY, f64::min);
    // The list begins with the simpler: of readings that explain alike, the first is said.
    found.into_iter().find(|(left, _)| *left <= least + ALIKE).map(|(_, reading)| reading.doubt)
}

fn explain(body: &Body, motion: &Motion, torque: &JointSeries, reading: &Reading) -> Explained {
    let [q, qd, qdd] = [&motion.q, &motion.qd, &motion.qdd].map(|s| reading.position(s));
    let robot = Robot { gravity: body.robot.gravity * reading.gravity, ..body.robot.clone() };
    let mut rigid = inverse_dynamics_series(&robot, &q, &qd, &qdd);
    for (j, inertia) in body.armature.iter().enumerate() {
        let acceleration = qdd.joint(j);
        rigid.joint_mut(j).iter_mut().zip(acceleration).for_each(|(t, a)| *t += inertia * a);
    }
    let heavy = heavy(&robot, &q);
    let most_inertia = robot.mass() * (largest_weight(&robot) / (GRAVITY * robot.mass())).powi(2);
    let fits = (0..robot.dof()).map(|j| {
        let torque = &reading.torque_of(torque, j);
        let (q, qd, qdd, rigid) = (q.joint(j), qd.joint(j), qdd.joint(j), rigid.joint(j));
        Joint { q, qd, qdd, rigid, torque, heavy: heavy[j], most_inertia }.fit()
    });
    Explained { fits: fits.collect(), heavy }
}

/// Joints whose own weight varies more than a load could hide.
fn heavy(robot: &Robot, q: &JointSeries) -> Vec<bool> {
    let laden = robot.with_payload(LOAD * robot.mass(), Vector3::zeros(), Matrix3::zeros());
    let (own, all) = (weight(robot, q), weight(&laden, q));
    let largest = VARIES * largest_weight(robot);
    let sure = |j: usize| {
        let load: Vec<f64> = own.joint(j).iter().zip(all.joint(j)).map(|(a, b)| b - a).collect();
        let spread = deviation(own.joint(j));
        spread >= SURE * deviation(&load) && spread >= largest
    };
    (0..robot.dof()).map(sure).collect()
}

fn weight(robot: &Robot, q: &JointSeries) -> JointSeries {
    let mut workspace = Workspace::new(robot);
    let (mut pose, mut torque) = (vec![0.0; robot.dof()], vec![0.0; robot.dof()]);
    let mut weight = JointSeries::zeros(robot.dof(), q.samples());
    for k in 0..q.samples() {
        q.sample_into(k, &mut pose);
        gravity_torque(robot, &mut workspace, &pose, &mut torque);
        weight.set_sample(k, &torque);
    }
    weight
}

/// N.m, no joint's weight is larger: all mass as far away as the links before it reach.
fn largest_weight(robot: &Robot) -> f64 {
    let mut reach = 0.0;
    let moment = |body: &crate::robot::Body| {
        reach += body.joint.placement.translation.norm();
        body.inertia.mass * (reach + body.inertia.com.norm())
    };
    GRAVITY * robot.bodies.iter().map(moment).sum::<f64>()
}

fn deviation(values: &[f64]) -> f64 {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt()
}

/// Torque that is off by more than a load or a gain makes.
fn factor(arm: &Arm<'_>, torque: &Torque, slopes: &[Option<Slope>]) -> Option<Doubt> {
    let off = |s: f64| !(1.0 / FACTOR..FACTOR).contains(&s.abs());
    let all = slopes.iter().enumerate().filter_map(|(j, s)| Some((j, (*s)?.value)));
    let off: Vec<(usize, f64)> = all.filter(|(_, s)| off(*s)).collect();
    let &(j, slope) = off.first().filter(|_| arm.scaled)?;
    let per_ampere = arm.twin.drive.torque_per_ampere(j);
    let size = slope.abs();
    let ratio = arm.twin.drive.gear_ratio[j];
    let guess = match torque.stem == "actual_current" {
        true if near(size, 1000.0) => "it is in mA: scale = 0.001",
        false if near(size, 1000.0) => "it is in N.mm: scale = 0.001",
        true if near(size, per_ampere) => "actual_current holds torque: name it joint_torque",
        false if near(size, 1.0 / per_ampere) => {
            "joint_torque holds current: name it actual_current"
        }
        true if near(size, ratio) || near(size, 1.0 / ratio) => {
            "the gear counts twice or not at all: gear_ratio in the twin, or scale"
        }
        _ => "correct its unit (scale)",
    };
    let joints: Vec<usize> = off.iter().map(|(j, _)| *j).collect();
    Some(Doubt {
        what: format!(
            "{}: the torque of {}_* is {slope:.3} times what the weight of a {} asks for",
            named(&joints),
            torque.stem,
            arm.twin.robot.name,
        ),
        remedy: format!("{guess} in a column map (--columns), or give the twin its drive"),
    })
}

/// Torque that no joint of the arm can give, where its weight does not tell.
fn beyond(arm: &Arm<'_>, torque: &Torque, measured: &JointSeries) -> Option<Doubt> {
    let times = |j: usize| {
        let largest = measured.joint(j).iter().fold(0.0, |most: f64, t| most.max(t.abs()));
        largest / arm.twin.robot.bodies[j].joint.limits.effort
    };
    let all = (0..measured.joints()).filter(|_| arm.scaled);
    let joints: Vec<usize> = all.filter(|j| times(*j) > BEYOND && times(*j).is_finite()).collect();
    let first = *joints.first()?;
    Some(Doubt {
        what: format!(
            "{}: the torque of {}_* is up to {:.0} times the most that the {} can give",
            named(&joints),
            torque.stem,
            times(first),
            arm.twin.robot.name
        ),
        remedy: "it may be in mA or N.mm: scale = 0.001 in a column map (--columns)".into(),
    })
}

/// Torque that hangs the arm up where it should carry it, and no reading says why.
fn sign(slopes: &[Option<Slope>]) -> Option<Doubt> {
    let against = |(j, s): (usize, &Option<Slope>)| {
        s.filter(|s| s.value < 0.0 && s.explained >= GOOD).map(|_| j)
    };
    let joints: Vec<usize> = slopes.iter().enumerate().filter_map(against).collect();
    (!joints.is_empty()).then(|| Doubt {
        what: format!("{}: the recorded torque pulls where the arm's weight pulls", named(&joints)),
        remedy:
            "turn the sign of the torque or of the positions in a column map (scale = [1, -1, ...])"
                .into(),
    })
}

/// An arm that nobody named, and whose weight is another's.
fn other_arm(recording: &Recording, arm: &Arm<'_>, slopes: &[Option<Slope>]) -> Option<Doubt> {
    let told = slopes.iter().enumerate().filter_map(|(j, s)| Some((j, (*s)?.value)));
    let (j, slope) = told.min_by(|(_, a), (_, b)| b.abs().total_cmp(&a.abs()))?;
    if !arm.assumed || (1.0 / SAME_ARM..SAME_ARM).contains(&slope) {
        return None;
    }
    let likely = likely(recording);
    let like = likely.iter().map(|(name, s)| format!("{name} ({s:.2})")).collect::<Vec<_>>();
    let name = &arm.twin.robot.name;
    Some(Doubt {
        what: format!(
            "joint {}: the torque is {slope:.2} times what the weight of a {name} asks for, which was \
             assumed because no arm was named",
            j + 1
        ),
        remedy: match like.is_empty() {
            true => "name the arm: --robot NAME or --twin FILE".into(),
            false => format!(
                "name the arm: --robot NAME or --twin FILE; by its weight it may be one of: {}",
                like.join(", ")
            ),
        },
    })
}

/// Arms whose weight the recorded torque carries within [`SAME_ARM`], the nearest to 1 first.
pub fn likely(recording: &Recording) -> Vec<(&'static str, f64)> {
    let slope = |robot: Robot| -> Option<f64> {
        let n = robot.dof();
        let unit = Drive::new(vec![1.0; n], vec![1.0; n]);
        let torque = torque(recording, &unit, n).filter(|t| t.stem == "joint_torque")?;
        let motion = Motion::new(recording, 1.0, n)?;
        let body = Body { armature: vec![0.0; n], robot };
        let measured = motion.means(&torque.values);
        let found = explain(&body, &motion, &measured, &Reading::as_it_stands(n)).slopes();
        found.into_iter().flatten().map(|s| s.value).max_by(f64::total_cmp)
    };
    let each = BUILT_IN.iter().filter_map(|t| Some((t.name, slope(t.robot())?)));
    let mut likely: Vec<(&str, f64)> =
        each.filter(|(_, s)| (1.0 / SAME_ARM..SAME_ARM).contains(s)).collect();
    likely.sort_by(|(_, a), (_, b)| a.ln().abs().total_cmp(&b.ln().abs()));
    likely.truncate(3);
    likely
}
