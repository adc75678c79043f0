//! A row of a simulated recording against the law that is meant to explain it.

use crate::effects::Motion;
use crate::motion::Trajectory;
use crate::series::JointSeries;
use crate::simulation::{Exact, Setup, Simulation, SimulationError};
use crate::twin::Twin;

/// Root mean squares per joint over the sliding samples, N.m.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Consistency {
    pub step_s: f64,
    /// Motor torque minus what a twin with the true values says.
    pub residual_nm: Vec<f64>,
    /// Motor torque.
    pub torque_nm: Vec<f64>,
}

/// Slower samples may be sticking, where friction is whatever holds the joint.
const SLIDING_RAD_S: f64 = 0.02;

/// Consistency of a run of `setup` along `command` without any sensor in between.
pub fn consistency(setup: &Setup, command: &Trajectory) -> Result<Consistency, SimulationError> {
    let exact = Simulation::new(setup)?.run(command, 0, 0, &mut |_| true)?.exact;
    let interval = setup.clock.step_s * setup.clock.steps_per_sample as f64;
    let said = knowing(setup).torque(&Motion::new(
        &setup.robot,
        interval,
        &exact.q,
        &exact.qd,
        &exact.qdd,
    ));
    let mut residual = exact.tau.clone();
    for j in 0..residual.joints() {
        residual.joint_mut(j).iter_mut().zip(said.joint(j)).for_each(|(r, s)| *r -= s);
    }
    Ok(Consistency {
        step_s: setup.clock.step_s,
        residual_nm: sliding_rms(&residual, &exact),
        torque_nm: sliding_rms(&exact.tau, &exact),
    })
}

/// A twin that knows every injected value; effects of the whole arm are not among them.
fn knowing(setup: &Setup) -> Twin {
    let mut twin = Twin {
        source: setup.robot.name.clone(),
        robot: setup.robot.clone(),
        drive: setup.drive.clone(),
        effects: Vec::new(),
        ..Twin::default()
    };
    for injection in &setup.effects {
        let about = injection.effect.about();
        twin.effects.push(about.name.into());
        for (i, parameter) in about.parameters.iter().enumerate() {
            let values = injection.values.iter().map(|row| row[i]).collect();
            twin.values.insert(parameter.name.into(), values);
        }
    }
    twin
}

fn sliding_rms(series: &JointSeries, exact: &Exact) -> Vec<f64> {
    let rms = |j: usize| {
        let sliding = series.joint(j).iter().zip(exact.qd.joint(j));
        let sliding = sliding.filter(|(_, qd)| qd.abs() > SLIDING_RAD_S).map(|(x, _)| x * x);
        let (sum, n) = sliding.fold((0.0, 0), |(sum, n), x| (sum + x, n + 1));
        (sum / n as f64).sqrt()
    };
    (0..series.joints()).map(rms).collect()
}
