//! The loop: commanded motion -> controller -> arm in rapier -> recording.
//!
//! How the samples belong together: the controller holds its torque for one period, and every
//! recorded sample lies in the middle of a hold. In rapier's scheme v_k is the velocity half a step
//! before q_k (q_{k+1} - q_k = h v_{k+1}), so the velocity at q_k is (v_k + v_{k+1})/2: that one
//! is recorded, and friction acts according to it (extrapolated by the last acceleration). Position,
//! velocity, acceleration and torque of a row are thus centred on one instant: nothing lags.

use std::collections::VecDeque;

use super::sensors::{self, Stream, stream};
use super::setup::{Clock, Setup};
use super::{
    Command, ComputedTorque, Feedback, Injections, Noise, Plant, PlantError, Quantisation, Target,
    Thermal,
};
use crate::effects::{ArmState, Channels, JointLoad, Mechanism};
use crate::recording::{Channel, Provenance, Recording};
use crate::robot::{Drive, Servo, Workspace, inverse_dynamics};
use crate::series::JointSeries;

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulationError {
    #[error(transparent)]
    Plant(#[from] PlantError),
    #[error(
        "joint {joint} runs away {time_s:.3} s into the motion: take a smaller \
         step_s, a lower controller.bandwidth_rad_s, or check rotor_inertia (a wrist without any \
         is hardly controllable) and effects that drive instead of brake"
    )]
    Diverged { joint: usize, time_s: f64 },
    #[error("stopped {time_s:.1} s into the motion")]
    Stopped { time_s: f64 },
}

/// No arm is as fast; beyond, torques leave the finite numbers before states do.
const RUNAWAY_RAD_S: f64 = 1e3;

/// An arm ready to be moved; reusable, and no run leaves anything behind for the next.
pub struct Simulation {
    drive: Drive,
    noise: Noise,
    quantisation: Quantisation,
    thermal: Thermal,
    clock: Clock,
    plant: Plant,
    controller: ComputedTorque,
    /// In place of the controller, as they are.
    servo: Option<Servo>,
    /// The arm as it is, with everything the effects changed.
    mechanism: Mechanism,
    workspace: Workspace,
    effects: Injections,
    /// Those effects as the controller's friction feed-forward evaluates them.
    foreseen: Injections,
    now: Buffers,
}

/// One instant, all joints.
struct Buffers {
    loads: Vec<JointLoad>,
    foreseen_loads: Vec<JointLoad>,
    /// Velocity at the instant of the position.
    qd: Vec<f64>,
    temperature: Vec<f64>,
    target: Target,
    seen_q: Vec<f64>,
    seen_qd: Vec<f64>,
    /// Asked for by the controller, not yet given; the oldest first.
    waiting: VecDeque<Vec<f64>>,
    tau: Vec<f64>,
    transmitted: Vec<f64>,
}

/// The arm while it moves, at an instant that is recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Glimpse<'a> {
    /// Time since the start of the motion, s.
    pub time_s: f64,
    /// Positions of the joints, rad.
    pub q: &'a [f64],
    /// Motor torque at the joint, N.m.
    pub tau: &'a [f64],
}

/// What one run yields.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Recording of the motion as the sensors show it.
    pub recording: Recording,
    pub exact: Exact,
    pub shown: Shown,
    /// Standard deviation of the noise on each joint's current, A.
    pub current_noise_a: Vec<f64>,
}

/// What the recording would show without the sensors' noise and rounding: rad, rad/s, A.
#[derive(Debug, Clone, PartialEq)]
pub struct Shown {
    pub q: JointSeries,
    pub qd: JointSeries,
    pub current: JointSeries,
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
    /// deg C
    pub temperature: JointSeries,
}

/// Longest step that keeps an elastic transmission accurate, s (docs/accuracy.md).
const ELASTIC_STEP_S: f64 = 1e-4;

impl Simulation {
    /// # Errors
    /// If rapier cannot represent the arm.
    pub fn new(setup: &Setup) -> Result<Self, SimulationError> {
        let nominal =
            Mechanism::with_armature(setup.robot.clone(), setup.drive.rotor_inertia.clone());
        let effects = Injections::new(&setup.effects);
        let mut mechanism = nominal.clone();
        effects.build(&mut mechanism);
        let rigid = mechanism.transmission.iter().all(Option::is_none);
        let clock = setup.clock.refined(if rigid { f64::INFINITY } else { ELASTIC_STEP_S });
        let controller = setup.controller.changed(&mechanism.control);
        let servo = setup.drive.servo.as_ref().map(|assumed| mechanism.servos(assumed));
        Ok(Self {
            drive: setup.drive.clone(),
            noise: setup.noise,
            quantisation: setup.quantisation,
            thermal: setup.thermal,
            clock,
            plant: Plant::new(&mechanism, clock.step_s)?,
            controller: ComputedTorque::new(&nominal, controller),
            servo,
            workspace: Workspace::new(&mechanism.robot),
            foreseen: effects.clone(),
            effects,
            now: Buffers::new(mechanism.robot.dof()),
            mechanism,
        })
    }

    /// Follows `command` from rest at its start. Noise is drawn from `seed`; recordings with
    /// different `number`s share nothing but that seed. `watch` sees the arm at every sample and
    /// returns false to stop.
    pub fn run(
        &mut self,
        command: &dyn Command,
        seed: u64,
        number: u64,
        watch: &mut dyn FnMut(&Glimpse) -> bool,
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
                self.control(command, time, &mut feedback_noise);
            }
            let sample = self.clock.samples(k).then_some(k / steps_per_sample);
            if let Some(i) = sample {
                self.check_finite(time)?;
                let (q, tau) = (self.plant.q(), self.now.tau.as_slice());
                if !watch(&Glimpse { time_s: time, q, tau }) {
                    return Err(SimulationError::Stopped { time_s: time });
                }
                exact.q.set_sample(i, q);
                exact.tau.set_sample(i, tau);
                exact.temperature.set_sample(i, &self.now.temperature);
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
        let shown = self.now.target.q.iter().zip(&self.mechanism.encoder_zero);
        let q: Vec<f64> = shown.map(|(q, zero)| q - zero).collect();
        self.plant.set_state(&q, &still);
        self.now.transmitted.fill(0.0);
        self.now.temperature.fill(self.thermal.start_c);
        self.now.waiting.clear();
        self.effects.forget();
        self.foreseen.forget();
    }

    /// A new motor torque for the target of now.
    fn control(&mut self, command: &dyn Command, time: f64, noise: &mut rand_chacha::ChaCha8Rng) {
        if let Some(servo) = &self.servo {
            let (arm, plant) = (&self.mechanism, &self.plant);
            return position_loops(servo, arm, plant, command, time, &mut self.now);
        }
        let now = &mut self.now;
        let hold_s = self.clock.step_s * self.clock.steps_per_hold as f64;
        let foreseen = ArmState {
            robot: &self.mechanism.robot,
            time,
            dt: hold_s,
            q: &now.target.q,
            qd: &now.target.qd,
            transmitted: &now.transmitted,
            temperature: &now.temperature,
        };
        self.foreseen.loads(&foreseen, &mut now.foreseen_loads);
        for (j, seen) in now.seen_q.iter_mut().enumerate() {
            *seen = self.plant.q()[j] + self.mechanism.encoder_zero[j];
        }
        now.seen_qd.copy_from_slice(self.plant.v());
        if self.controller.settings().feedback == Feedback::Sensors {
            let (n, step) = (&self.noise, &self.quantisation);
            for (q, qd) in now.seen_q.iter_mut().zip(&mut now.seen_qd) {
                *q = sensors::measured(*q, n.position_rad, step.position_rad, noise);
                *qd = sensors::measured(*qd, n.velocity_rad_s, step.velocity_rad_s, noise);
            }
        }
        let Buffers { target, seen_q, seen_qd, foreseen_loads, waiting, tau, .. } = now;
        let mut asked = vec![0.0; tau.len()];
        self.controller.torque(target, seen_q, seen_qd, foreseen_loads, &mut asked);
        waiting.push_back(asked);
        let holds = (self.mechanism.control.delay / hold_s).round() as usize;
        let due =
            if waiting.len() > holds { waiting.pop_front() } else { waiting.front().cloned() };
        let Mechanism { torque_gain, torque_limit: limit, .. } = &self.mechanism;
        for (j, (tau, asked)) in tau.iter_mut().zip(due.unwrap_or_default()).enumerate() {
            *tau = (self.drive.limited(j, asked) / torque_gain[j]).clamp(-limit[j], limit[j]);
        }
    }

    /// One step of the arm under the torque that is held.
    fn step(&mut self, time: f64) {
        let now = &mut self.now;
        let half_step = 0.5 * self.clock.step_s;
        for (j, qd) in now.qd.iter_mut().enumerate() {
            *qd = self.plant.v()[j] + half_step * self.plant.a()[j];
        }
        let robot = &self.mechanism.robot;
        let state = ArmState {
            robot,
            time,
            dt: self.clock.step_s,
            q: self.plant.q(),
            qd: &now.qd,
            transmitted: &now.transmitted,
            temperature: &now.temperature,
        };
        self.effects.loads(&state, &mut now.loads);
        // A motor's own voltage brakes at every instant, not once per hold.
        if let Some(servo) = &self.servo {
            for (j, load) in now.loads.iter_mut().enumerate() {
                load.damping += servo.damping[j];
                load.dry += servo.friction[j] * now.tau[j].abs();
            }
        }
        self.thermal.advance(&mut now.temperature, &now.loads, &now.qd, self.clock.step_s);
        self.plant.step(&now.tau, &now.loads);
        let [q, v, a] = self.plant.link_motion();
        inverse_dynamics(robot, &mut self.workspace, q, v, a, &mut now.transmitted);
    }

    fn check_finite(&self, time_s: f64) -> Result<(), SimulationError> {
        let mut states = self.plant.q().iter().zip(self.plant.v());
        match states.position(|(q, v)| !(q.is_finite() && v.abs() < RUNAWAY_RAD_S)) {
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
        let current_noise_a = self.sense(&exact, interval, (seed, number), None, &mut recording);
        if self.servo.is_none() {
            put(&mut recording, "joint_temperatures", &exact.temperature);
        }
        let clean = [self.shown_q(&exact.q), exact.qd.clone(), self.shown_current(&exact.tau)];
        let [q, qd, current] = self.effects_measure(interval, &exact, clean);
        let shown = Shown { q, qd, current };
        Run { recording, exact, shown, current_noise_a }
    }

    /// Takes a run's motion through the sensors once more, with the noise of another `seed`; what noise
    /// does through the controller is not repeated.
    pub fn sensed_again(&self, run: &Run, seed: u64, number: u64) -> Run {
        self.sensed_with(run, None, seed, number)
    }

    /// As [`Simulation::sensed_again`], with noise of the standard deviations `noise_a` on the currents, A,
    /// in place of what the scenario's signal-to-noise ratio makes of this motion.
    pub fn sensed_with(&self, run: &Run, noise_a: Option<&[f64]>, seed: u64, number: u64) -> Run {
        let interval = self.clock.step_s * self.clock.steps_per_sample as f64;
        let mut again = run.clone();
        let sensed = |name: &str| name.starts_with("actual_");
        again.recording.channels.retain(|c| !sensed(&c.name));
        again.recording.provenance.source = format!("simulation, seed {seed}, recording {number}");
        again.current_noise_a =
            self.sense(&run.exact, interval, (seed, number), noise_a, &mut again.recording);
        again
    }

    /// Puts what the sensors show into `recording`; returns the noise of the currents, A.
    fn sense(
        &self,
        exact: &Exact,
        interval: f64,
        (seed, number): (u64, u64),
        noise_a: Option<&[f64]>,
        recording: &mut Recording,
    ) -> Vec<f64> {
        let current = self.shown_current(&exact.tau);
        let usual = || sensors::sigma_of_snr(&current, self.noise.snr_db);
        let current_noise_a = noise_a.map_or_else(usual, <[f64]>::to_vec);
        let everywhere = |sigma: f64| vec![sigma; self.plant.dof()];
        let noisy = |which, series: &JointSeries, sigma: &[f64]| {
            sensors::noisy(series, sigma, &mut stream(seed, number, which))
        };
        let Noise { position_rad, velocity_rad_s, .. } = self.noise;
        let [q, qd, current] = self.effects_measure(
            interval,
            exact,
            [
                noisy(Stream::Position, &self.shown_q(&exact.q), &everywhere(position_rad)),
                noisy(Stream::Velocity, &exact.qd, &everywhere(velocity_rad_s)),
                noisy(Stream::Current, &current, &current_noise_a),
            ],
        );
        let step = &self.quantisation;
        for (name, series, step) in [
            ("q", q, step.position_rad),
            ("qd", qd, step.velocity_rad_s),
            ("current", current, step.current_a),
        ] {
            put(recording, &format!("actual_{name}"), &sensors::rounded(&series, step));
        }
        if self.servo.is_some() {
            recording.channels.retain(|c| is_told(&c.name));
        }
        current_noise_a
    }

    /// Positions (rad) as the encoders show them.
    fn shown_q(&self, q: &JointSeries) -> JointSeries {
        let zero = &self.mechanism.encoder_zero;
        q.map_joints(|j, q| q.iter().map(|q| q + zero[j]).collect())
    }

    /// Motor current (A) of the motor torque (N.m).
    fn shown_current(&self, tau: &JointSeries) -> JointSeries {
        let gain = &self.mechanism.torque_gain;
        let shown = tau.map_joints(|j, tau| tau.iter().map(|tau| gain[j] * tau).collect());
        sensors::current(&self.drive, &shown)
    }

    /// What effects make of the recorded q, qd and current.
    fn effects_measure(
        &self,
        dt: f64,
        exact: &Exact,
        recorded: [JointSeries; 3],
    ) -> [JointSeries; 3] {
        let [mut q, mut qd, mut current] = recorded;
        for j in 0..q.joints() {
            let ampere = self.drive.torque_per_ampere(j);
            let mut channels = Channels {
                dt,
                q: q.joint(j).to_vec(),
                qd: qd.joint(j).to_vec(),
                qdd: exact.qdd.joint(j).to_vec(),
                torque: current.joint(j).iter().map(|i| i * ampere).collect(),
                velocity_is_recorded: true,
            };
            let before = channels.torque.clone();
            self.effects.measure(j, &mut channels);
            q.joint_mut(j).copy_from_slice(&channels.q);
            qd.joint_mut(j).copy_from_slice(&channels.qd);
            if channels.torque != before {
                let out = current.joint_mut(j).iter_mut();
                out.zip(&channels.torque).for_each(|(i, torque)| *i = torque / ampere);
            }
        }
        [q, qd, current]
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
        Self {
            q: zeros.clone(),
            qd: zeros.clone(),
            qdd: zeros.clone(),
            tau: zeros.clone(),
            temperature: zeros,
        }
    }
}

impl Buffers {
    fn new(dof: usize) -> Self {
        let zeros = vec![0.0; dof];
        Self {
            loads: vec![JointLoad::default(); dof],
            foreseen_loads: vec![JointLoad::default(); dof],
            qd: zeros.clone(),
            temperature: zeros.clone(),
            target: Target::still(dof),
            seen_q: zeros.clone(),
            seen_qd: zeros.clone(),
            waiting: VecDeque::new(),
            tau: zeros.clone(),
            transmitted: zeros,
        }
    }
}

/// All that small servos tell: what they were told, and where they are.
fn is_told(name: &str) -> bool {
    name.starts_with("target_q_") || name.starts_with("actual_q_")
}

/// Torque of position loops towards what was commanded a while ago; damping acts at every step.
fn position_loops(
    servo: &Servo,
    mechanism: &Mechanism,
    plant: &Plant,
    command: &dyn Command,
    time: f64,
    now: &mut Buffers,
) {
    for j in 0..plant.dof() {
        now.target.aim(command, (time - servo.delay[j]).max(0.0));
        let shown = plant.q()[j] + mechanism.encoder_zero[j];
        let target = now.target.q[j];
        [now.tau[j], _] = servo.pull(j, servo.gain[j], target - shown);
    }
}
