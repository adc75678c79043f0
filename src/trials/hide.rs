//! What is hidden in a case: drawn, brought to its strength along the planned motion, measured
//! along the simulated one.

use rand_chacha::ChaCha8Rng;

use super::arm::arm;
use super::asked::{Draw, Family};
use super::drawn::inject;
use super::nuisance::Nuisance;
use super::plan::Plan;
use super::shapes::{Ground, Shape, Size, shape};
use super::strength::{over_noise, own_torque, rms};
use super::{Strength, TrialError, third};
use crate::effects::{Mechanism, Motion, Needed};
use crate::motion::{Sampled, Trajectory};
use crate::recording::Recording;
use crate::robot::{Robot, inverse_dynamics_series};
use crate::series::JointSeries;
use crate::simulation::{Experiment, Injection, Run, Scenario};

/// A case before and after it is simulated.
pub struct Hiding {
    pub scenario: Scenario,
    pub made: Experiment,
    pub third: Trajectory,
    pub nuisance: Option<Nuisance>,
    pub effects: Vec<Effect>,
    /// The arm without the effects, with its links as they are.
    robot: Robot,
    friction: [Vec<f64>; 2],
}

/// One of the hidden effects.
pub struct Effect {
    shape: Shape,
    size: f64,
    pub injection: Injection,
    /// Strength as planned, then as measured.
    pub strength: Strength,
}

/// Motion along which something is worked out.
struct Along<'a> {
    dt: f64,
    q: &'a JointSeries,
    qd: &'a JointSeries,
    qdd: &'a JointSeries,
}

impl Hiding {
    /// # Errors
    /// If the arm's settings do not work out, or the plan names no known effect.
    pub fn draw(
        how: &Draw,
        plan: &Plan,
        rng: &mut ChaCha8Rng,
        case: &str,
    ) -> Result<Self, TrialError> {
        let scenario = arm(how.duration_s, rng);
        let made = scenario.work_out(case)?;
        let third = third::motion(&scenario.motion, how.duration_s, &made.setup.robot)
            .map_err(|e| TrialError::Usage(format!("{case}: {e}")))?;
        let friction = ["coulomb", "viscous"].map(|name| values(&made, name));
        let robot = made.setup.robot.clone();
        let mut hiding =
            Self { scenario, made, third, nuisance: None, effects: vec![], robot, friction };
        if how.family == Family::Nuisance {
            hiding.disturb(rng);
        }
        let planned = hiding.made.fit.sampled(1.0 / hiding.scenario.rate_hz);
        for (name, strength) in &plan.effects {
            hiding.hide(name, *strength, &planned, rng)?;
        }
        hiding.inject();
        Ok(hiding)
    }

    fn disturb(&mut self, rng: &mut ChaCha8Rng) {
        let nuisance = Nuisance::draw(&self.robot, rng);
        if let Some(links) = nuisance.injection() {
            let mut mechanism = Mechanism::new(self.robot.clone());
            for (row, joint) in links.values.iter().zip(&links.joints) {
                links.effect.build(row, *joint, &mut mechanism);
            }
            self.robot = mechanism.robot;
            self.made.setup.effects.push(links);
        }
        self.nuisance = Some(nuisance);
    }

    fn hide(
        &mut self,
        name: &str,
        strength: Option<f64>,
        planned: &Sampled,
        rng: &mut ChaCha8Rng,
    ) -> Result<(), TrialError> {
        let along = Along {
            dt: 1.0 / self.scenario.rate_hz,
            q: &planned.q,
            qd: &planned.qd,
            qdd: &planned.qdd,
        };
        let torque = self.baseline(&along);
        let ground = Ground {
            q: &planned.q,
            torque: &torque,
            coulomb: &self.friction[0],
            duration_s: self.scenario.motion.duration_s,
            scale: 1.0,
        };
        let dof = self.robot.dof();
        let local = self.effects.iter().map(|e| &e.injection.joints).filter(|j| j.len() < dof);
        let taken: Vec<usize> = local.flatten().copied().collect();
        let missing = || TrialError::Usage(format!("no effect `{name}` can be drawn"));
        let shape = shape(name, &ground, &taken, rng).ok_or_else(missing)?;
        let (size, reached) = match strength {
            Some(wanted) => self.size(&shape, wanted, &along, &torque),
            None => (1.0, Strength::default()),
        };
        let injection = shape.sized(size);
        let strength = Strength { drawn: strength, ..reached };
        self.effects.push(Effect { shape, size, injection, strength });
        Ok(())
    }

    /// The size at which the planned gap is `wanted` times the noise, and what is reached there.
    fn size(
        &self,
        shape: &Shape,
        wanted: f64,
        along: &Along<'_>,
        torque: &JointSeries,
    ) -> (f64, Strength) {
        let unit = self.own(&shape.sized(1.0), shape.replaces_coulomb, along, torque);
        let at = |x: f64| match &shape.size {
            Size::Knob { .. } => self.own(&shape.sized(x), shape.replaces_coulomb, along, torque),
            _ => unit.map_joints(|_, own| own.iter().map(|t| x * t).collect()),
        };
        let strength = |x: f64| {
            let own = at(x);
            over_noise(&own, along.qd, &self.planned_noise(shape, torque, &own))
        };
        let (mut low, mut high) = match &shape.size {
            Size::Knob { low, high, .. } => (*low, *high),
            Size::Factor { parameters, limit } => {
                let first = shape.injection.values[0][parameters[0]].abs().max(1e-12);
                (1e-5, limit / first)
            }
            Size::Fixed => return (1.0, strength(1.0)),
        };
        for _ in 0..30 {
            let middle = (low * high).sqrt();
            let enough = strength(middle).reached() >= wanted;
            *(if enough { &mut high } else { &mut low }) = middle;
        }
        (high, strength(high))
    }

    fn own(
        &self,
        injection: &Injection,
        replaces: bool,
        along: &Along<'_>,
        torque: &JointSeries,
    ) -> JointSeries {
        if lags(injection) {
            return self.lag(injection, along);
        }
        let temperature = self.temperature(along);
        let motion = Motion {
            temperature: Some(&temperature),
            ..Motion::new(&self.robot, along.dt, along.q, along.qd, along.qdd)
        };
        let mut own = own_torque(injection, &motion, torque);
        for &joint in injection.joints.iter().filter(|_| replaces) {
            let dry = self.friction[0][joint];
            let both = own.joint_mut(joint).iter_mut().zip(along.qd.joint(joint));
            both.for_each(|(own, qd)| *own -= dry * qd.signum());
        }
        own
    }

    /// What a lag adds to the recorded velocity, rad/s.
    fn lag(&self, injection: &Injection, along: &Along<'_>) -> JointSeries {
        let mut error = JointSeries::zeros(along.qd.joints(), along.qd.samples());
        for (row, &joint) in injection.values.iter().zip(&injection.joints) {
            let mut channels = crate::effects::Channels {
                dt: along.dt,
                q: along.q.joint(joint).to_vec(),
                qd: along.qd.joint(joint).to_vec(),
                qdd: along.qdd.joint(joint).to_vec(),
                torque: vec![0.0; along.qd.samples()],
                velocity_is_recorded: true,
            };
            injection.effect.measure(row, &mut channels);
            let both = channels.qd.iter().zip(along.qd.joint(joint));
            let late: Vec<f64> = both.map(|(late, qd)| late - qd).collect();
            error.joint_mut(joint).copy_from_slice(&late);
        }
        error
    }

    fn planned_noise(&self, shape: &Shape, torque: &JointSeries, own: &JointSeries) -> Vec<f64> {
        let noise = self.scenario.noise;
        if lags(&shape.injection) {
            return vec![noise.velocity_rad_s; own.joints()];
        }
        let ratio = noise.snr_db.map_or(0.0, |db| 10f64.powf(-db / 20.0));
        let sum = |j: usize| -> Vec<f64> {
            torque.joint(j).iter().zip(own.joint(j)).map(|(a, b)| a + b).collect()
        };
        (0..own.joints()).map(|j| ratio * rms(&sum(j))).collect()
    }

    /// Torque of the arm without what is hidden, N.m.
    fn baseline(&self, along: &Along<'_>) -> JointSeries {
        let rigid = inverse_dynamics_series(&self.robot, along.q, along.qd, along.qdd);
        let rotor = &self.made.setup.drive.rotor_inertia;
        let [dry, viscous] = &self.friction;
        rigid.map_joints(|j, rigid| {
            let (qd, qdd) = (along.qd.joint(j), along.qdd.joint(j));
            let all = rigid.iter().zip(qd).zip(qdd);
            let sign = |v: f64| if v == 0.0 { 0.0 } else { v.signum() };
            all.map(|((t, v), a)| t + rotor[j] * a + dry[j] * sign(*v) + viscous[j] * v).collect()
        })
    }

    /// How the joints warm up by their own friction, as the simulation has it.
    fn temperature(&self, along: &Along<'_>) -> JointSeries {
        let thermal = &self.scenario.thermal;
        let [dry, viscous] = &self.friction;
        along.qd.map_joints(|j, qd| {
            let mut t = thermal.start_c;
            let mut next = |v: &f64| {
                let power = dry[j] * v.abs() + viscous[j] * v * v;
                let steady = thermal.ambient_c + thermal.rise_k_per_w * power;
                t += along.dt / thermal.time_constant_s * (steady - t);
                t
            };
            qd.iter().map(&mut next).collect()
        })
    }

    /// Puts the effects into the arm, in place of what they replace.
    fn inject(&mut self) {
        let names: Vec<_> = self.effects.iter().map(|e| e.injection.effect.about().name).collect();
        let setup = &mut self.made.setup;
        setup.effects.retain(|i| !names.contains(&i.effect.about().name) || nuisance(i));
        for effect in &self.effects {
            inject(setup, &effect.injection, effect.shape.replaces_coulomb);
        }
    }

    /// Is every effect planned at a fair part of its strength?
    pub fn shows(&self) -> bool {
        let fair = |e: &Effect| e.strength.drawn.is_none_or(|d| e.strength.reached() > 0.8 * d);
        self.effects.iter().all(fair)
    }

    /// Standard deviation of the torque's noise, N.m.
    pub fn noise(&self, run: &Run) -> Vec<f64> {
        let drive = &self.made.setup.drive;
        let each = run.current_noise_a.iter().enumerate();
        each.map(|(j, sigma)| sigma * drive.torque_per_ampere(j)).collect()
    }

    /// Strengths along the simulated motion: of one effect what it does to the recording, of two
    /// each by its own law.
    pub fn measure(&mut self, run: &Run) {
        let along = Along {
            dt: 1.0 / self.scenario.rate_hz,
            q: &run.shown.q,
            qd: &run.exact.qd,
            qdd: &run.exact.qdd,
        };
        let base = self.baseline(&along);
        let torque = self.torque(run);
        let noise = self.noise(run);
        let alone = self.effects.len() == 1;
        let strengths: Vec<Strength> = self
            .effects
            .iter()
            .map(|e| {
                let lags = lags(&e.injection);
                let noise = if lags {
                    vec![self.scenario.noise.velocity_rad_s; noise.len()]
                } else {
                    noise.clone()
                };
                let own = match alone && !lags {
                    true => torque.map_joints(|j, t| {
                        t.iter().zip(base.joint(j)).map(|(t, b)| t - b).collect()
                    }),
                    false => self.own(&e.injection, e.shape.replaces_coulomb, &along, &base),
                };
                Strength { drawn: e.strength.drawn, ..over_noise(&own, along.qd, &noise) }
            })
            .collect();
        self.effects.iter_mut().zip(strengths).for_each(|(e, s)| e.strength = s);
    }

    /// Resizes effects that came out more than a third off; false where none did.
    pub fn correct(&mut self) -> bool {
        let mut changed = false;
        for e in &mut self.effects {
            let Some(drawn) = e.strength.drawn else { continue };
            let ratio = drawn / e.strength.reached().max(1e-6);
            let adjustable = matches!(e.shape.size, Size::Factor { .. });
            if adjustable && !(0.75..1.33).contains(&ratio) {
                e.size *= ratio.clamp(0.2, 5.0);
                let before = e.injection.values.clone();
                e.injection = e.shape.sized(e.size);
                changed |= e.injection.values != before;
            }
        }
        if changed {
            self.inject();
        }
        changed
    }

    /// Torque as the sensors would show it without noise, N.m.
    fn torque(&self, run: &Run) -> JointSeries {
        let drive = &self.made.setup.drive;
        let ampere = |j: usize| drive.torque_per_ampere(j);
        run.shown.current.map_joints(|j, i| i.iter().map(|i| i * ampere(j)).collect())
    }

    pub fn third_recording(&self, run: &Run) -> Recording {
        let torque = self.torque(run);
        let (shown, exact) = (&run.shown, &run.exact);
        third::by_torque(
            &run.recording.time,
            [&shown.q, &exact.qd, &exact.qdd, &torque, &exact.temperature],
        )
    }
}

/// Shows in the recorded velocity and leaves the torque alone.
fn lags(injection: &Injection) -> bool {
    injection.effect.needs() == Some(Needed::Velocity)
}

/// The links' own errors, injected for all joints; a hidden one has its own entry.
fn nuisance(injection: &Injection) -> bool {
    injection.effect.about().name == "link_inertia" && injection.joints.len() > 1
}

fn values(made: &Experiment, name: &str) -> Vec<f64> {
    let found = made.setup.effects.iter().find(|i| i.effect.about().name == name);
    found.map_or(Vec::new(), |i| i.values.iter().map(|row| row[0]).collect())
}
