//! The loop: commanded motion -> controller -> arm in rapier -> recording.
//!
//! How the samples belong together: the controller holds its torque for one period, and every
//! recorded sample lies in the middle of a hold. In rapier's scheme v_k is the velocity half a step
//! before q_k (q_{k+1} - q_k = h v_{k+1}), so the velocity at q_k is (v_k + v_{k+1})/2: that one
//! is recorded, and friction acts according to it (extrapolated by the last acceleration). Position,
//! velocity, acceleration and torque of a row are thus centred on one instant: nothing lags.

use super::sensors::{self, Stream, stream};
use super::setup::{Clock, Setup};
use super::{
    Command, ComputedTorque, Feedback, Injections, Noise, Plant, PlantError, Quantisation, Target,
};
use crate::effects::{JointLoad, JointState, Mechanism};
use crate::recording::{Channel, Provenance, Recording};
use crate::robot::{Drive, Robot, Workspace, inverse_dynamics};
use crate::series::JointSeries;

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulationError {
    #[error(transparent)]
    Plant(#[from] PlantError),
    #[error(
        "joint {joint} left the finite numbers {time_s:.3} s into the motion: take a smaller \
         step_s, a lower controller.bandwidth_rad_s, or check rotor_inertia (a wrist without any \
         is hardly controllable)"
    )]
    Diverged { joint: usize, time_s: f64 },
    #[error("stopped {time_s:.1} s into the motion")]
    Stopped { time_s: f64 },
}

/// An arm ready to be moved; reusable, and no run leaves anything behind for the next.
pub struct Simulation {
    drive: Drive,
    noise: Noise,
    quantisation: Quantisation,
    clock: Clock,
    plant: Plant,
    controller: ComputedTorque,
    /// The arm as it is, with everything the effects changed.
    robot: Robot,
    workspace: Workspace,
    effects: Injections,
    /// The same effects, as the controller's friction feed-forward evaluates them.
    foreseen: Injections,
    now: Buffers,
}

/// One instant, all joints.
struct Buffers {
    states: Vec<JointState>,
    loads: Vec<JointLoad>,
    foreseen_states: Vec<JointState>,
    foreseen_loads: Vec<JointLoad>,
    target: Target,
    seen_q: Vec<f64>,
    seen_qd: Vec<f64>,
    tau: Vec<f64>,
    transmitted: Vec<f64>,
}

/// What one run yields.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// As the sensors show it.
    pub recording: Recording,
    pub exact: Exact,
    /// Standard deviation of the noise on each joint's current, A.
    pub current_noise_a: Vec<f64>,
}

/// The true signals at the recorded instants. Each row satisfies the equation of motion:
/// tau = M(q) qdd + c(q, qd) + g(q) + rotor inertia qdd + effects.
#[derive(Debug, Clone, PartialEq)]
pub struct Exact {
    /// rad, rad/s, rad/s^2
    pub q: JointSeries,
    pub qd: JointSeries,
    pub qdd: JointSeries,
    /// Motor torque at the joint, N.m.
    pub tau: JointSeries,
}

impl Simulation {
    /// # Errors
    /// If rapier cannot represent the arm.
    pub fn new(setup: &Setup) -> Result<Self, SimulationError> {
        let nominal =
            Mechanism { robot: setup.robot.clone(), armature: setup.drive.rotor_inertia.clone() };
        let effects = Injections::new(&setup.effects);
        let mut mechanism = nominal.clone();
        effects.build(&mut mechanism);
        Ok(Self {
            drive: setup.drive.clone(),
            noise: setup.noise,
            quantisation: setup.quantisation,
            clock: setup.clock,
            plant: Plant::new(&mechanism, setup.clock.step_s)?,
            controller: ComputedTorque::new(&nominal, setup.controller.clone()),
            workspace: Workspace::new(&mechanism.robot),
            foreseen: effects.clone(),
            effects,
            now: Buffers::new(mechanism.robot.dof()),
            robot: mechanism.robot,
        })
    }

    /// Follows `command` from rest at its start. Noise is drawn from `seed`; recordings with
    /// different `number`s share nothing but that seed. `watch` is told the simulated time (s) at
    /// every sample and returns false to stop.
    pub fn run(
        &mut self,
        command: &dyn Command,
        seed: u64,
        number: u64,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Run, SimulationError> {
        let Clock { step_s, steps_per_sample, .. } = self.clock;
        let interval = step_s * steps_per_sample as f64;
        let samples = (command.duration() / interval + 1e-9) as usize + 1;
        let mut exact = Exact::zeros(self.plant.dof(), samples);
        let mut feedback_noise = stream(seed, number, Stream::Feedback);
        self.start(command);
        for k in 0..=(samples - 1) * steps_per_sample {
            let time = k as f64 * step_s;
            if self.clock.controls(k) {
                self.now.target.aim(command, time);
                self.control(time, &mut feedback_noise);
            }
            let sample = self.clock.samples(k).then_some(k / steps_per_sample);
            if let Some(i) = sample {
                self.check_finite(time)?;
                if !watch(time) {
                    return Err(SimulationError::Stopped { time_s: time });
                }
                exact.q.set_sample(i, self.plant.q());
                exact.tau.set_sample(i, &self.now.tau);
            }
            self.step(time);
            if let Some(i) = sample {
                exact.qdd.set_sample(i, self.plant.a());
                exact.qd.set_sample(i, self.plant.v_mid());
            }
        }
        Ok(self.record(command, exact, seed, number))
    }

    fn start(&mut self, command: &dyn Command) {
        self.now.target.aim(command, 0.0);
        let still = vec![0.0; self.plant.dof()];
        self.plant.set_state(&self.now.target.q, &still);
        self.now.transmitted.fill(0.0);
        self.effects.forget();
        self.foreseen.forget();
    }

    /// A new motor torque for the target of now.
    fn control(&mut self, time: f64, noise: &mut rand_chacha::ChaCha8Rng) {
        let now = &mut self.now;
        let hold_s = self.clock.step_s * self.clock.steps_per_hold as f64;
        for (j, state) in now.foreseen_states.iter_mut().enumerate() {
            let (q, qd, transmitted) = (now.target.q[j], now.target.qd[j], now.transmitted[j]);
            *state = JointState { time, dt: hold_s, q, qd, transmitted };
        }
        self.foreseen.loads(&now.foreseen_states, &mut now.foreseen_loads);
        now.seen_q.copy_from_slice(self.plant.q());
        now.seen_qd.copy_from_slice(self.plant.v());
        if self.controller.settings().feedback == Feedback::Sensors {
            let (n, step) = (&self.noise, &self.quantisation);
            for (q, qd) in now.seen_q.iter_mut().zip(&mut now.seen_qd) {
                *q = sensors::measured(*q, n.position_rad, step.position_rad, noise);
                *qd = sensors::measured(*qd, n.velocity_rad_s, step.velocity_rad_s, noise);
            }
        }
        let Buffers { target, seen_q, seen_qd, foreseen_loads, tau, .. } = now;
        self.controller.torque(target, seen_q, seen_qd, foreseen_loads, tau);
        for (j, tau) in tau.iter_mut().enumerate() {
            *tau = self.drive.limited(j, *tau);
        }
    }

    /// One step of the arm under the torque that is held.
    fn step(&mut self, time: f64) {
        let now = &mut self.now;
        let half_step = 0.5 * self.clock.step_s;
        for (j, state) in now.states.iter_mut().enumerate() {
            *state = JointState {
                time,
                dt: self.clock.step_s,
                q: self.plant.q()[j],
                qd: self.plant.v()[j] + half_step * self.plant.a()[j],
                transmitted: now.transmitted[j],
            };
        }
        self.effects.loads(&now.states, &mut now.loads);
        self.plant.step(&now.tau, &now.loads);
        let (q, v, a) = (self.plant.q(), self.plant.v(), self.plant.a());
        inverse_dynamics(&self.robot, &mut self.workspace, q, v, a, &mut now.transmitted);
    }

    fn check_finite(&self, time_s: f64) -> Result<(), SimulationError> {
        let states = self.plant.q().iter().zip(self.plant.v());
        match states.map(|(q, v)| q + v).position(|x| !x.is_finite()) {
            Some(j) => Err(SimulationError::Diverged { joint: j + 1, time_s }),
            None => Ok(()),
        }
    }

    /// The recording that the sensors make of the true signals.
    fn record(&mut self, command: &dyn Command, exact: Exact, seed: u64, number: u64) -> Run {
        let interval = self.clock.step_s * self.clock.steps_per_sample as f64;
        let samples = exact.q.samples();
        let time: Vec<f64> = (0..samples).map(|i| i as f64 * interval).collect();
        let mut recording = Recording {
            time,
            channels: Vec::new(),
            provenance: Provenance {
                source: format!("simulation, seed {seed}, recording {number}"),
                format: "armtwin simulate".into(),
                notes: Vec::new(),
            },
        };
        self.record_target(command, &mut recording);
        let current = sensors::current(&self.drive, &exact.tau);
        let current_noise_a = sensors::sigma_of_snr(&current, self.noise.snr_db);
        let everywhere = |sigma: f64| vec![sigma; self.plant.dof()];
        let (noise, step) = (&self.noise, &self.quantisation);
        for (name, which, series, sigma, step) in [
            ("q", Stream::Position, &exact.q, &everywhere(noise.position_rad), step.position_rad),
            (
                "qd",
                Stream::Velocity,
                &exact.qd,
                &everywhere(noise.velocity_rad_s),
                step.velocity_rad_s,
            ),
            ("current", Stream::Current, &current, &current_noise_a, step.current_a),
        ] {
            let mut rng = stream(seed, number, which);
            let seen = sensors::measured_series(series, sigma, step, &mut rng);
            put(&mut recording, &format!("actual_{name}"), &seen);
        }
        Run { recording, exact, current_noise_a }
    }

    fn record_target(&mut self, command: &dyn Command, recording: &mut Recording) {
        let (dof, samples) = (self.plant.dof(), recording.time.len());
        let mut series = [(); 4].map(|()| JointSeries::zeros(dof, samples));
        for (i, &t) in recording.time.iter().enumerate() {
            let target = &mut self.now.target;
            target.aim(command, t);
            self.controller.target_moment(target, &mut self.now.tau);
            for (series, now) in
                series.iter_mut().zip([&target.q, &target.qd, &target.qdd, &self.now.tau])
            {
                series.set_sample(i, now);
            }
        }
        let [q, qd, qdd, moment] = series;
        let current = sensors::current(&self.drive, &moment);
        for (name, series) in
            [("q", &q), ("qd", &qd), ("qdd", &qdd), ("current", &current), ("moment", &moment)]
        {
            put(recording, &format!("target_{name}"), series);
        }
    }
}

fn put(recording: &mut Recording, stem: &str, series: &JointSeries) {
    for j in 0..series.joints() {
        let values = series.joint(j).to_vec();
        recording.channels.push(Channel { name: format!("{stem}_{j}"), values });
    }
}

impl Exact {
    fn zeros(dof: usize, samples: usize) -> Self {
        let zeros = JointSeries::zeros(dof, samples);
        Self { q: zeros.clone(), qd: zeros.clone(), qdd: zeros.clone(), tau: zeros }
    }
}

impl Buffers {
    fn new(dof: usize) -> Self {
        let zeros = vec![0.0; dof];
        Self {
            states: vec![JointState::default(); dof],
            loads: vec![JointLoad::default(); dof],
            foreseen_states: vec![JointState::default(); dof],
            foreseen_loads: vec![JointLoad::default(); dof],
            target: Target::still(dof),
            seen_q: zeros.clone(),
            seen_qd: zeros.clone(),
            tau: zeros.clone(),
            transmitted: zeros,
        }
    }
}
