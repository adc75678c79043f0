//! The twin led along a command by computed torque.

use super::{ResimulationError, arm};
use crate::motion::Spline;
use crate::series::JointSeries;
use crate::signals::Samples;
use crate::simulation::{
    Clock, ControllerSettings, Glimpse, Noise, Quantisation, Setup, Simulation,
};
use crate::twin::Twin;

/// rapier's step, s, and how often the simulated motion is kept, Hz.
const STEP_S: f64 = 0.001;
const KEPT_HZ: f64 = 250.0;

/// What the simulated arm did, at the samples' instants.
#[derive(Debug, Clone, PartialEq)]
pub struct Replayed {
    /// rad, rad/s; where the joints are.
    pub q: JointSeries,
    pub qd: JointSeries,
    /// rad, as the encoders show it.
    pub shown_q: JointSeries,
    /// Torque of the drive at the joint, as the current shows it, N.m.
    pub torque: JointSeries,
}

/// What the arm does when it should follow `q` (rad, at the samples' instants) in the simulation:
/// the twin with all it knows, starting at rest. `watch` sees it
/// [`KEPT_HZ`] times a second and returns false to stop.
///
/// # Errors
/// If the command cannot be followed or the simulation leaves the finite numbers.
pub fn closed_loop(
    twin: &Twin,
    q: &JointSeries,
    samples: &Samples,
    controller: &ControllerSettings,
    watch: &mut dyn FnMut(&Glimpse) -> bool,
) -> Result<Replayed, ResimulationError> {
    let time: Vec<f64> = (0..samples.len()).map(|k| k as f64 * samples.dt).collect();
    let along = Spline::through(&time, q).ok_or(ResimulationError::Motion("recorded"))?;
    let drive = twin.whole_drive();
    let mut simulation = Simulation::new(&Setup {
        robot: twin.robot.clone(),
        drive: drive.clone(),
        effects: arm::injections(twin, samples.start),
        controller: controller.clone(),
        noise: Noise::default(),
        quantisation: Quantisation::default(),
        thermal: arm::thermal(samples),
        clock: Clock::new(STEP_S, controller.rate_hz, KEPT_HZ)?,
    })?;
    let run = simulation.run(&along, 0, 0, watch)?;
    let kept = &run.recording.time;
    let shown = |stem: &str| {
        let missing = || JointSeries::zeros(twin.robot.dof(), kept.len());
        run.recording.joints(stem).unwrap_or_else(missing)
    };
    let [q, qd] = smooth(kept, &run.exact.q, &time)?;
    let torque = shown("actual_current")
        .map_joints(|j, i| i.iter().map(|i| i * drive.torque_per_ampere(j)).collect());
    Ok(Replayed {
        q,
        qd,
        shown_q: linear(kept, &shown("actual_q"), &time),
        torque: linear(kept, &torque, &time),
    })
}

/// Position and velocity at `instants` of a motion kept at `time`; the last kept one beyond it.
fn smooth(
    time: &[f64],
    q: &JointSeries,
    instants: &[f64],
) -> Result<[JointSeries; 2], ResimulationError> {
    let spline = Spline::through(time, q).ok_or(ResimulationError::Motion("simulated"))?;
    let mut motion = [(); 2].map(|()| JointSeries::zeros(q.joints(), instants.len()));
    let [mut now, mut rate, mut acceleration] = [(); 3].map(|()| vec![0.0; q.joints()]);
    for (k, &t) in instants.iter().enumerate() {
        spline.at(t, &mut now, &mut rate, &mut acceleration);
        motion[0].set_sample(k, &now);
        motion[1].set_sample(k, &rate);
    }
    Ok(motion)
}

/// Straight lines between the kept values, which lie 1 / [`KEPT_HZ`] apart.
fn linear(time: &[f64], series: &JointSeries, instants: &[f64]) -> JointSeries {
    let last = time.len().saturating_sub(1);
    series.map_joints(|_, x| {
        let at = |t: &f64| {
            let place = (t * KEPT_HZ).clamp(0.0, last as f64);
            let (k, next) = (place as usize, (place as usize + 1).min(last));
            x[k] + (place - k as f64) * (x[next] - x[k])
        };
        instants.iter().map(at).collect()
    })
}
