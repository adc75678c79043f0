//! The twin driven along a recorded command.

use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};

use crate::effects::Scope;
use crate::motion::Spline;
use crate::recording::Recording;
use crate::series::JointSeries;
use crate::signals::{LowPass, Samples, UniformGrid};
use crate::simulation::{
    Clock, ControllerSettings, Injection, Noise, Quantisation, Setup, Simulation, Thermal,
};
use crate::twin::Twin;
use crate::viewer::Motion;

/// rapier's step, s, and how often the simulated motion is kept, Hz.
const STEP_S: f64 = 0.001;
const KEPT_HZ: f64 = 250.0;

/// The recorded command on the samples' grid, low-passed as the recorded position is; `None`
/// where no command of all joints is recorded.
pub fn command(recording: &Recording, samples: &Samples) -> anyhow::Result<Option<JointSeries>> {
    let how = &samples.conditioning;
    let Some(target) = recording.joints("target_q").filter(|q| q.joints() >= samples.joints())
    else {
        return Ok(None);
    };
    let grid = UniformGrid::new(&recording.time, how.rate_hz, how.interpolation, how.gap_periods);
    let filter = LowPass::if_wanted(how.motion_cutoff_hz, samples.rate_hz(), how.filter_order)?;
    let mut rows: Vec<Vec<f64>> =
        (0..samples.joints()).map(|j| grid.resample(target.joint(j))).collect();
    if let Some(filter) = filter {
        filter.apply_many(&mut rows);
    }
    Ok(Some(JointSeries::from_joints(&rows)))
}

/// What the arm does when it should follow `q` (rad, at the samples' instants) in the simulation:
/// the twin with all it knows, starting at rest.
pub fn replay(
    twin: &Twin,
    q: &JointSeries,
    samples: &Samples,
    controller: &ControllerSettings,
) -> anyhow::Result<Motion> {
    let time: Vec<f64> = (0..samples.len()).map(|k| k as f64 * samples.dt).collect();
    let along = Spline::through(&time, q).context("the recorded command cannot be followed")?;
    let mut simulation = Simulation::new(&Setup {
        robot: twin.robot.clone(),
        drive: twin.drive.clone(),
        effects: injections(twin),
        controller: controller.clone(),
        noise: Noise::default(),
        quantisation: Quantisation::default(),
        thermal: Thermal::default(),
        clock: Clock::new(STEP_S, controller.rate_hz, KEPT_HZ)?,
    })?;
    let bar = progress(along.end());
    let run = simulation.run(&along, 0, 0, &mut |t| {
        bar.set_position((1000.0 * t) as u64);
        true
    })?;
    bar.finish_and_clear();
    at_instants(&run.recording.time, &run.exact.q, &time)
}

/// The twin's known effects, to be put into the simulated arm.
fn injections(twin: &Twin) -> Vec<Injection> {
    let all: Vec<usize> = (0..twin.robot.dof()).collect();
    let injection = |effect: &'static dyn crate::effects::Effect| {
        let rows = if effect.about().scope == Scope::Arm { &all[..1] } else { &all[..] };
        let values = rows.iter().filter_map(|&j| twin.values_at(effect, j)).collect();
        Injection { effect, joints: all.clone(), values }
    };
    twin.known().map(injection).collect()
}

/// Position and velocity at `instants` of a motion kept at `time`; the last kept one beyond it.
fn at_instants(time: &[f64], q: &JointSeries, instants: &[f64]) -> anyhow::Result<Motion> {
    let spline = Spline::through(time, q).context("the simulated motion is not finite")?;
    let zeros = || JointSeries::zeros(q.joints(), instants.len());
    let mut motion = Motion { q: zeros(), qd: zeros() };
    let [mut now, mut rate, mut acceleration] = [(); 3].map(|()| vec![0.0; q.joints()]);
    for (k, &t) in instants.iter().enumerate() {
        spline.at(t, &mut now, &mut rate, &mut acceleration);
        motion.q.set_sample(k, &now);
        motion.qd.set_sample(k, &rate);
    }
    Ok(motion)
}

/// In simulated time; hides itself where standard error is not a terminal.
fn progress(seconds: f64) -> ProgressBar {
    let style = ProgressStyle::with_template("simulating {wide_bar} {percent} %, {eta} left");
    ProgressBar::new((1000.0 * seconds) as u64)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
