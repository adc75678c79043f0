//! Does an arm stand still when friction should hold it, and go when it should not?

use super::{AccuracyError, Bench};
use crate::effects::JointLoad;
use crate::robot::{Workspace, gravity_torque};
use crate::simulation::Plant;

/// Largest displacement of any joint, rad, after `duration_s` in the pose `q`: every motor carries
/// gravity and pushes with `share` of the breakaway torque on top.
pub fn creep(
    bench: &Bench,
    q: &[f64],
    share: f64,
    duration_s: f64,
    step_s: f64,
) -> Result<f64, AccuracyError> {
    let robot = &bench.mechanism.robot;
    let mut arm = Plant::new(&bench.mechanism, step_s)?;
    arm.set_state(q, &vec![0.0; q.len()]);
    let mut tau = vec![0.0; q.len()];
    gravity_torque(robot, &mut Workspace::new(robot), q, &mut tau);
    for (j, tau) in tau.iter_mut().enumerate() {
        *tau += share * bench.load(j, 0.0).dry;
    }
    let mut loads = vec![JointLoad::default(); q.len()];
    for _ in 0..(duration_s / step_s) as usize {
        bench.loads(arm.v(), &mut loads);
        arm.step(&tau, &loads);
    }
    Ok(arm.q().iter().zip(q).map(|(now, then)| (now - then).abs()).fold(0.0, f64::max))
}
