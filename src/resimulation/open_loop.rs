//! The twin driven by the recorded torque from recorded states, for a moment each.

use rayon::prelude::*;

use super::{ResimulationError, arm};
use crate::effects::{ArmState, JointLoad, Mechanism};
use crate::robot::{Workspace, inverse_dynamics};
use crate::signals::Samples;
use crate::simulation::{Injections, Plant};
use crate::twin::Twin;

/// Long enough to tell a torque of 1 N.m from the encoder's noise, short enough that errors do
/// not yet grow by themselves, s.
pub const WINDOW_S: f64 = 0.2;
/// rapier's step, s; the shorter one where a transmission gives way.
const STEP_S: f64 = 0.001;
const ELASTIC_STEP_S: f64 = 1e-4;
/// Effects with memory are led along the recorded motion for as long before a window, s.
const LEAD_IN_S: f64 = 0.2;
/// Windows that one arm goes through, one after the other: of a minute there are some for each of many cores.
const AT_ONCE: usize = 16;

/// Root mean square over joints and windows of simulated less recorded position at the end of each
/// window, rad. Windows follow one another over all that is usable. `samples` are as recorded: the
/// twin's known effects on the channels are undone here.
///
/// # Errors
/// If no window is without a gap, or rapier cannot represent the arm.
pub fn open_loop(twin: &Twin, samples: &Samples) -> Result<f64, ResimulationError> {
    let samples = twin.correct(samples);
    let length = (WINDOW_S / samples.dt).round().max(1.0) as usize;
    let windows = windows(&samples, length);
    if windows.is_empty() {
        return Err(ResimulationError::NoWindow { seconds: WINDOW_S });
    }
    let some = |windows: &[usize]| -> Result<Vec<f64>, ResimulationError> {
        let mut arm = Arm::new(twin, &samples)?;
        Ok(windows.iter().map(|from| arm.window(*from, length)).collect())
    };
    let each = windows.par_chunks(AT_ONCE).map(some).collect::<Result<Vec<_>, _>>()?;
    let count = windows.len() * samples.joints();
    Ok((each.iter().flatten().sum::<f64>() / count as f64).sqrt())
}

/// First samples of windows that follow one another and are usable to their ends.
fn windows(samples: &Samples, length: usize) -> Vec<usize> {
    let (mut windows, mut from) = (Vec::new(), 0);
    while from + length < samples.len() {
        if samples.usable[from..=from + length].iter().all(|u| *u) {
            windows.push(from);
            from += length;
        } else {
            from += 1;
        }
    }
    windows
}

/// The simulated arm beside the samples.
struct Arm<'a> {
    samples: &'a Samples,
    mechanism: Mechanism,
    plant: Plant,
    effects: Injections,
    remembers: bool,
    steps_per_sample: usize,
    workspace: Workspace,
    loads: Vec<JointLoad>,
    transmitted: Vec<f64>,
    temperature: Vec<f64>,
}

/// Recorded, between two samples; one entry per joint.
struct Recorded {
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    /// N.m
    torque: Vec<f64>,
}

impl<'a> Arm<'a> {
    fn new(twin: &Twin, samples: &'a Samples) -> Result<Self, ResimulationError> {
        let injected = arm::injections(twin, samples.start);
        let effects = Injections::new(&injected);
        let drive = twin.whole_drive();
        let mut mechanism = Mechanism::with_armature(twin.robot.clone(), drive.rotor_inertia);
        effects.build(&mut mechanism);
        let rigid = mechanism.transmission.iter().all(Option::is_none);
        let longest = if rigid { STEP_S } else { ELASTIC_STEP_S };
        let steps_per_sample = (samples.dt / longest - 1e-9).ceil().max(1.0) as usize;
        let dof = twin.robot.dof();
        Ok(Self {
            samples,
            plant: Plant::new(&mechanism, samples.dt / steps_per_sample as f64)?,
            workspace: Workspace::new(&mechanism.robot),
            mechanism,
            effects,
            remembers: injected.iter().any(|i| i.effect.about().memory > 0),
            steps_per_sample,
            loads: vec![JointLoad::default(); dof],
            transmitted: vec![0.0; dof],
            temperature: vec![arm::thermal(samples).start_c; dof],
        })
    }

    /// Sum over the joints of the squared distance at the end, rad2.
    fn window(&mut self, from: usize, length: usize) -> f64 {
        self.lead_in(from);
        let start = self.recorded(from, 0.0);
        self.plant.set_state(&start.q, &start.qd);
        for k in from..from + length {
            for i in 0..self.steps_per_sample {
                let share = (i as f64 + 0.5) / self.steps_per_sample as f64;
                let torque = self.recorded(k, share).torque;
                let (q, v) = (self.plant.q().to_vec(), self.plant.v().to_vec());
                self.feel(k, share, &q, &v);
                self.plant.step(&torque, &self.loads);
                let [q, v, a] = self.plant.link_motion();
                let robot = &self.mechanism.robot;
                inverse_dynamics(robot, &mut self.workspace, q, v, a, &mut self.transmitted);
            }
        }
        let end = self.recorded(from + length, 0.0).q;
        self.plant.q().iter().zip(end).map(|(q, recorded)| (q - recorded).powi(2)).sum()
    }

    /// What effects remember of the motion before a window.
    fn lead_in(&mut self, from: usize) {
        self.effects.forget();
        let before = (LEAD_IN_S / self.samples.dt).round() as usize;
        let first = if self.remembers { from.saturating_sub(before) } else { from };
        for k in first..from {
            for i in 0..self.steps_per_sample {
                let share = i as f64 / self.steps_per_sample as f64;
                let now = self.recorded(k, share);
                self.carry(&now);
                self.feel(k, share, &now.q, &now.qd);
            }
        }
        let now = self.recorded(from, 0.0);
        self.carry(&now);
    }

    /// What the gears transmit in a recorded state.
    fn carry(&mut self, now: &Recorded) {
        let Recorded { q, qd, qdd, .. } = now;
        let robot = &self.mechanism.robot;
        inverse_dynamics(robot, &mut self.workspace, q, qd, qdd, &mut self.transmitted);
    }

    /// The effects' loads in a state; those with memory move on by a step.
    fn feel(&mut self, k: usize, share: f64, q: &[f64], qd: &[f64]) {
        let state = ArmState {
            robot: &self.mechanism.robot,
            time: (k as f64 + share) * self.samples.dt,
            dt: self.plant.step_s(),
            q,
            qd,
            transmitted: &self.transmitted,
            temperature: &self.temperature,
        };
        self.effects.loads(&state, &mut self.loads);
    }

    /// Straight lines between samples; where the joints are and what the motors give, not what
    /// encoder and current show of it.
    fn recorded(&self, k: usize, share: f64) -> Recorded {
        let s = self.samples;
        let next = (k + 1).min(s.len() - 1);
        let between = |x: &[f64]| x[k] + share * (x[next] - x[k]);
        let all = |series: &crate::series::JointSeries| -> Vec<f64> {
            (0..s.joints()).map(|j| between(series.joint(j))).collect()
        };
        let Mechanism { encoder_zero, torque_gain, torque_limit, .. } = &self.mechanism;
        let mut now =
            Recorded { q: all(&s.q), qd: all(&s.qd), qdd: all(&s.qdd), torque: all(&s.torque) };
        for j in 0..s.joints() {
            now.q[j] -= encoder_zero[j];
            now.torque[j] =
                (now.torque[j] / torque_gain[j]).clamp(-torque_limit[j], torque_limit[j]);
        }
        now
    }
}
