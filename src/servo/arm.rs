//! An arm of position servos as a twin has it, whatever state it is in.

use super::wound::Wound;
use super::{ServoError, Track};
use crate::effects::{ArmState, JointLoad, Mechanism};
use crate::resimulation::injections;
use crate::robot::{Robot, Servo};
use crate::series::at_place;
use crate::simulation::Injections;
use crate::twin::Twin;

/// Bodies, servos and effects of a twin.
#[derive(Clone)]
pub struct Arm {
    pub mechanism: Mechanism,
    /// The servos as they are.
    pub servo: Servo,
    effects: Injections,
    loads: Vec<JointLoad>,
    /// Of every joint, in the step ahead.
    heard: Vec<Heard>,
}

/// The command as it arrives at a servo, and how stiff the servo is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Heard {
    /// rad
    command: f64,
    /// N.m/rad; 0 while it is off.
    gain: f64,
}

/// What an arm is in where a step begins; one entry per joint of every list.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// s since the start of the recording.
    pub time: f64,
    /// Motors, rad and rad/s.
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    /// Through the gears in the last step without friction, N.m.
    pub transmitted: Vec<f64>,
    /// deg C
    pub temperature: Vec<f64>,
}

impl State {
    /// At zero and at rest, as warm as friction holds where no temperature is recorded.
    pub fn new(dof: usize) -> Self {
        let zeros = || vec![0.0; dof];
        let temperature = vec![USUAL_C; dof];
        Self { time: 0.0, q: zeros(), v: zeros(), transmitted: zeros(), temperature }
    }
}

/// deg C
const USUAL_C: f64 = 25.0;

/// What servo and effects ask of a joint in a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Asked {
    /// N.m against the motion, whatever the velocity of this step.
    pub torque: f64,
    /// N.m.s/rad, servo and friction.
    pub damping: f64,
    /// Level of dry friction, N.m, >= 0 of all that is asked together.
    pub dry: f64,
    /// Of the servo, N.m/rad.
    pub slope: f64,
}

impl Asked {
    /// N.m against a motion from one speed to another (rad/s) that slides that `way` (1 or -1).
    pub fn along(&self, [before, after]: [f64; 2], way: f64) -> f64 {
        self.torque + 0.5 * self.damping * (before + after) + way * self.dry
    }
}

impl Arm {
    /// # Errors
    /// If the twin has no servos.
    pub fn new(twin: &Twin, start_s: f64) -> Result<Self, ServoError> {
        let assumed = twin.drive.servo.as_ref().ok_or(ServoError::NoServo)?;
        let mechanism = twin.mechanism(|_| true);
        let dof = twin.robot.dof();
        Ok(Self {
            servo: mechanism.servos(assumed),
            effects: Injections::new(&injections(twin, start_s)),
            mechanism,
            loads: vec![JointLoad::default(); dof],
            heard: vec![Heard::default(); dof],
        })
    }

    pub fn robot(&self) -> &Robot {
        &self.mechanism.robot
    }

    /// With those of its effects only that are not the same in another.
    pub fn beyond(&self, other: &Self) -> Self {
        Self { effects: self.effects.beyond(&other.effects), ..self.clone() }
    }

    /// Does any effect act on it?
    pub fn acts(&self) -> bool {
        !self.effects.is_empty()
    }

    /// Joints that give way between motor and link.
    ///
    /// # Errors
    /// Names a motor without a rotor that drives one.
    pub fn wound(&self) -> Result<Vec<Wound>, ServoError> {
        Wound::all(&self.mechanism)
    }

    /// Does what acts depend on what happened before, other than by positions and velocities?
    pub fn remembers(&self) -> bool {
        self.effects.remember()
    }

    /// Does anything act at times, or in places, only?
    pub fn has_contacts(&self) -> bool {
        self.effects.any_lasts_a_while()
    }

    /// Does what is asked of one joint depend on where others are, or how they move?
    pub fn feels_other_joints(&self) -> bool {
        self.effects.any_feels_other_joints()
    }

    /// As before the first step.
    pub fn forget(&mut self) {
        self.effects.forget();
    }

    /// What the servos were told at sample `k`, and between it and the next at `place`, arrives.
    pub fn hear(&mut self, track: &Track, k: usize, place: f64) {
        for (j, heard) in self.heard.iter_mut().enumerate() {
            let late = (track.told.late + self.servo.delay[j]) / track.dt;
            heard.command = at_place(track.told.command.joint(j), place - late);
            heard.gain = track.factor.joint(j)[k] * self.servo.gain[j];
        }
    }

    /// These commands (rad) arrive at servos of these gains (N.m/rad; 0 while one is off), one per joint.
    pub fn tell(&mut self, command: &[f64], gain: &[f64]) {
        for (heard, (&command, &gain)) in self.heard.iter_mut().zip(command.iter().zip(gain)) {
            *heard = Heard { command, gain };
        }
    }

    /// What another arm has heard.
    pub fn hear_as(&mut self, other: &Self) {
        self.heard.copy_from_slice(&other.heard);
    }

    /// What is asked of every joint in the step of `h` s that begins there.
    pub fn ask(&mut self, at: &State, h: f64, asked: &mut [Asked]) {
        self.ask_effects(at, h, asked);
        for (j, asked) in asked.iter_mut().enumerate() {
            let Heard { command, gain } = self.heard[j];
            let on = if gain > 0.0 { 1.0 } else { 0.0 };
            let shown = at.q[j] + self.mechanism.encoder_zero[j];
            let [pull, slope] = self.servo.pull(j, gain, command - shown);
            asked.torque -= pull;
            asked.damping += on * self.servo.damping[j];
            asked.dry += self.servo.friction[j] * pull.abs();
            asked.slope = slope;
        }
    }

    /// The part of that which effects ask.
    pub fn ask_effects(&mut self, at: &State, h: f64, asked: &mut [Asked]) {
        let state = ArmState {
            robot: &self.mechanism.robot,
            time: at.time,
            dt: h,
            q: &at.q,
            qd: &at.v,
            transmitted: &at.transmitted,
            temperature: &at.temperature,
        };
        self.effects.loads(&state, &mut self.loads);
        for (asked, load) in asked.iter_mut().zip(&self.loads) {
            let JointLoad { torque, damping, dry, .. } = *load;
            *asked = Asked { torque, damping, dry, slope: 0.0 };
        }
    }
}
