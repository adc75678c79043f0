//! What the rigid arm's torque is along a motion, and how it changes with the motion of one joint.

use std::sync::{Arc, OnceLock};

use super::flange::Flange;
use crate::kernels::axpy;
use crate::robot::{Robot, body_regressor_series, inverse_dynamics_series};
use crate::series::JointSeries;

/// Steps of the central differences. Torque is at most quadratic in speed and linear in acceleration,
/// so that only the angle's has to be small.
const STEP_RAD: f64 = 1e-5;
const STEP_RAD_S: f64 = 1.0;
const STEP_RAD_S2: f64 = 1.0;

/// Rigid torque of one robot along one motion and its slopes, worked out when first asked for. Whoever
/// tries many values of an elastic joint's parameters keeps one beside the motion ([`super::Motion::rigid`]).
#[derive(Debug)]
pub struct Rigid {
    torque: OnceLock<JointSeries>,
    slopes: Vec<OnceLock<Slopes>>,
    shared: Arc<Shared>,
}

/// What robots share that differ in what their links weigh alone.
#[derive(Debug)]
struct Shared {
    /// The robot that was asked about first, and its torque.
    first: OnceLock<(Robot, JointSeries)>,
    /// Regressors of every link.
    regressors: Vec<OnceLock<Regressor>>,
    flange: OnceLock<Flange>,
}

/// Torque of every joint per unit of a link's ten inertial parameters ([`crate::robot::Inertia::parameters`]): N.m per kg,
/// kg.m and kg.m2 (Atkeson, An, Hollerbach, Int. J. Robotics Research 5(3), 1986).
pub type Regressor = [JointSeries; 10];

/// Torque that a change of the ten parameters of `link` (kg, kg.m, kg.m2) asks for, N.m: the joints that carry it feel it,
/// no other.
pub(super) fn torque_of_change(
    per_unit: &Regressor,
    change: &[f64; 10],
    link: usize,
) -> JointSeries {
    let mut torque = JointSeries::zeros(per_unit[0].joints(), per_unit[0].samples());
    for j in 0..=link {
        let mut asked = asked(per_unit, change, j);
        let own = torque.joint_mut(j);
        // Memory that was never written to is slow to read.
        if let Some((change, column)) = asked.next() {
            own.iter_mut().zip(column).for_each(|(t, c)| *t = change * c);
        }
        asked.for_each(|(change, column)| axpy(change, column, own));
    }
    torque
}

/// Every change with the torque of joint `j` per unit of it.
fn asked<'a>(
    per_unit: &'a Regressor,
    change: &'a [f64; 10],
    j: usize,
) -> impl Iterator<Item = (f64, &'a [f64])> {
    let all = change.iter().zip(per_unit).filter(|(change, _)| **change != 0.0);
    all.map(move |(change, column)| (*change, column.joint(j)))
}

fn add_torque_of_change(
    torque: &mut JointSeries,
    per_unit: &Regressor,
    change: &[f64; 10],
    link: usize,
) {
    for j in 0..=link {
        let own = torque.joint_mut(j);
        asked(per_unit, change, j).for_each(|(change, column)| axpy(change, column, own));
    }
}

/// d tau / d (q, qd, qdd) of one joint: N.m at every joint per rad, rad/s and rad/s2.
#[derive(Debug, Clone)]
pub struct Slopes(pub [JointSeries; 3]);

impl Rigid {
    pub fn new(joints: usize) -> Self {
        let regressors = (0..joints).map(|_| OnceLock::new()).collect();
        let (first, flange) = Default::default();
        Self::beside(Arc::new(Shared { first, regressors, flange }))
    }

    /// Values for a robot that differs in what its links weigh alone, along the same motion.
    pub fn of_other_load(&self) -> Self {
        Self::beside(self.shared.clone())
    }

    fn beside(shared: Arc<Shared>) -> Self {
        let slopes = shared.regressors.iter().map(|_| OnceLock::new()).collect();
        Self { torque: OnceLock::new(), slopes, shared }
    }

    pub(super) fn regressor(
        &self,
        robot: &Robot,
        motion: [&JointSeries; 3],
        link: usize,
    ) -> &Regressor {
        self.shared.regressor(robot, motion, link)
    }

    pub(super) fn flange(&self, robot: &Robot, q: &JointSeries) -> &Flange {
        kept(&self.shared.flange, || Flange::along(robot, q))
    }

    pub(super) fn torque(&self, robot: &Robot, motion: [&JointSeries; 3]) -> &JointSeries {
        kept(&self.torque, || self.shared.torque(robot, motion))
    }

    pub(super) fn slopes(&self, robot: &Robot, motion: [&JointSeries; 3], joint: usize) -> &Slopes {
        kept(&self.slopes[joint], || Slopes::new(robot, motion, joint))
    }
}

impl Shared {
    fn regressor(&self, robot: &Robot, motion: [&JointSeries; 3], link: usize) -> &Regressor {
        kept(&self.regressors[link], || regressor(robot, motion, link))
    }

    /// Torque is linear in what links weigh: that of the first robot, and what links of other weight ask for.
    fn torque(&self, robot: &Robot, motion: [&JointSeries; 3]) -> JointSeries {
        let (first, known) = kept(&self.first, || (robot.clone(), torque(robot, motion)));
        let mut sum = known.clone();
        let links = first.bodies.iter().zip(&robot.bodies).map(|(a, b)| (a.inertia, b.inertia));
        for (link, (was, is)) in links.enumerate().filter(|(_, (was, is))| was != is) {
            let (was, is) = (was.parameters(), is.parameters());
            let change = std::array::from_fn(|i| is[i] - was[i]);
            add_torque_of_change(&mut sum, self.regressor(robot, motion, link), &change, link);
        }
        sum
    }
}

/// Worked out before the cell is locked: it runs in parallel, and a thread that waits for its parts
/// may meet the same cell again. Two threads may do the same work; the first result stays.
fn kept<T>(cell: &OnceLock<T>, work_out: impl FnOnce() -> T) -> &T {
    match cell.get() {
        Some(value) => value,
        None => {
            let value = work_out();
            cell.get_or_init(|| value)
        }
    }
}

pub(super) fn regressor(robot: &Robot, [q, qd, qdd]: [&JointSeries; 3], link: usize) -> Regressor {
    body_regressor_series(robot, q, qd, qdd, link)
}

/// N.m
pub(super) fn torque(robot: &Robot, [q, qd, qdd]: [&JointSeries; 3]) -> JointSeries {
    inverse_dynamics_series(robot, q, qd, qdd)
}

impl Slopes {
    pub(super) fn new(robot: &Robot, motion: [&JointSeries; 3], joint: usize) -> Self {
        let slope = |which: usize, step: f64| {
            let moved = |by: f64| {
                let mut series = motion[which].clone();
                series.joint_mut(joint).iter_mut().for_each(|x| *x += by);
                let mut at = motion;
                at[which] = &series;
                torque(robot, at)
            };
            let (more, less) = (moved(step), moved(-step));
            let each = |(m, l): (&f64, &f64)| (m - l) / (2.0 * step);
            more.map_joints(|j, more| more.iter().zip(less.joint(j)).map(each).collect())
        };
        Self([slope(0, STEP_RAD), slope(1, STEP_RAD_S), slope(2, STEP_RAD_S2)])
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;
    use crate::robot::{Workspace, builtin, mass_matrix};

    /// Five samples of six joints' angles, speeds and accelerations.
    fn motion() -> [JointSeries; 3] {
        [0.7, 1.9, 2.3].map(|s| {
            let joint = |j: usize| (0..5).map(|k| (s * (k * 5 + j * 2 + 1) as f64).sin()).collect();
            JointSeries::from_joints(&(0..6).map(joint).collect::<Vec<Vec<f64>>>())
        })
    }

    /// How torque grows with a joint's acceleration is a column of the mass matrix, worked out by
    /// the composite-rigid-body algorithm.
    #[test]
    fn a_slope_over_acceleration_is_a_column_of_the_mass_matrix() {
        let robot = builtin("ur5").unwrap();
        let [q, qd, qdd] = motion();
        let mut workspace = Workspace::new(&robot);
        for joint in 0..6 {
            let Slopes([_, _, slope]) = Slopes::new(&robot, [&q, &qd, &qdd], joint);
            for k in 0..5 {
                let at: Vec<f64> = (0..6).map(|j| q.joint(j)[k]).collect();
                let m = mass_matrix(&robot, &mut workspace, &at);
                for j in 0..6 {
                    assert!((slope.joint(j)[k] - m[(j, joint)]).abs() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn torque_of_other_loads_is_that_of_the_first_and_what_they_ask_for() {
        let robot = builtin("ur5").unwrap();
        let [q, qd, qdd] = motion();
        let motion = [&q, &qd, &qdd];
        let mut other = robot.with_payload(2.5, [0.1, -0.2, 0.3].into(), Matrix3::identity());
        other.bodies[1].inertia.mass += 0.5;
        let kept = Rigid::new(6);
        kept.torque(&robot, motion);
        let kept = kept.of_other_load();
        let (found, plain) = (kept.torque(&other, motion), torque(&other, motion));
        let differ = |j: usize| found.joint(j).iter().zip(plain.joint(j)).map(|(a, b)| a - b);
        assert!((0..6).flat_map(differ).all(|d| d.abs() < 1e-10));
    }

    #[test]
    fn what_is_kept_is_what_is_worked_out() {
        let robot = builtin("ur5").unwrap();
        let still = JointSeries::zeros(6, 3);
        let motion = [&still, &still, &still];
        let kept = Rigid::new(6);
        assert_eq!(kept.torque(&robot, motion), &torque(&robot, motion));
        assert!(std::ptr::eq(kept.torque(&robot, motion), kept.torque(&robot, motion)));
        let slopes = kept.slopes(&robot, motion, 2);
        assert_eq!(slopes.0, Slopes::new(&robot, motion, 2).0);
    }
}
