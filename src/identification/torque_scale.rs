//! Absolute torque constants from two runs of one arm, the second with a load that is known.
//!
//! Everything an arm shows in torque may be larger by a factor: links, friction, rotors. A known mass
//! may not (Gautier, Briot, *Global identification of joint drive gains and dynamic parameters of
//! robots*, J. Dynamic Systems, Measurement, and Control 136(5), 2014). Recorded torque of joint j is
//! s_j times the true one,
//!
//! tau_j = s_j (Y_j pi + Y_j,load pi_load) + friction,
//!
//! bilinear in s and pi. In every round the torque is scaled by what was found, and s is linear about 1
//! with the rigid body's torque as its column; links are near the model's as in
//! [`crate::rigid_body`]. Where the paper takes total least squares over one common vector, this keeps
//! the noise where it is, in the torque, and friction of each run to itself.

use serde::Serialize;

use super::Found;
use super::arm_problem::{ArmProblem, BoundsByName, searched};
use super::assemble::assemble;
use super::error::IdentificationError;
use super::inertia::{Inertial, share};
use super::judge::LEVEL;
use super::problem::Parameter;
use super::terms::Terms;
use crate::effects::{self, Effect, Role, Size};
use crate::rigid_body::{Estimate, Information, estimate, estimate_within, parameters, possible};
use crate::robot::{Robot, inverse_dynamics_series};
use crate::series::JointSeries;
use crate::signals::Samples;
use crate::statistics::normal_quantile;
use crate::twin::Twin;

/// What is bolted to the flange in the second run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Load {
    pub mass_kg: f64,
    /// Centre of mass in the flange's frame, m; found along where it is not known.
    pub centre_m: Option<[f64; 3]>,
}

/// Gain of one joint's drive: true torque per ampere over the twin's.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Gain {
    /// From 1 at the base.
    pub joint: usize,
    pub value: f64,
    /// 99 % interval.
    pub low: f64,
    pub high: f64,
    /// N.m/A on the joint's side, with this gain.
    pub torque_per_ampere: f64,
    /// False where these runs say little more than that drives are about what their makers say.
    pub identifiable: bool,
}

#[derive(Debug, Clone, Serialize)]
pub struct TorqueScale {
    pub joints: Vec<Gain>,
    pub load: Load,
    /// Centre of mass of the load as given, or as found, m.
    pub centre_m: [f64; 3],
    pub rounds: usize,
    /// How far links are from the model's, as a share of a mass, that the data call for.
    pub spread: f64,
    #[serde(skip)]
    pub robot: Robot,
}

/// A torque constant is right to this share before anything is recorded (one standard deviation).
const BEFORE: f64 = 0.5;
/// What is told leaves at most half of it.
const TOLD: f64 = 0.5 * BEFORE;
const MOST_ROUNDS: usize = 30;
const SETTLED: f64 = 1e-4;
/// Rounds after which gains are near enough for the spread of links.
const FREE_ROUNDS: usize = 3;

/// The drives' gains from a run without and a run with a load; `terms` are fitted to each by itself.
///
/// # Errors
/// As [`assemble`], and where a link of the model has no mass.
pub fn torque_scale(
    twin: &Twin,
    terms: &Terms,
    runs: [&Samples; 2],
    load: Load,
) -> Result<TorqueScale, IdentificationError> {
    let (model, _) = possible(&twin.robot);
    let mut state = State {
        rounds: 0,
        spread: None,
        gains: vec![1.0; twin.robot.dof()],
        robot: model.clone(),
        moment: load.centre_m.unwrap_or_default().map(|c| c * load.mass_kg),
    };
    let scale = Scale { twin, terms, runs, load, model };
    loop {
        let (found, change) = scale.round(&mut state)?;
        if change < SETTLED || state.rounds == MOST_ROUNDS {
            return Ok(scale.finish(&state, &found));
        }
    }
}

/// What stays the same in every round.
struct Scale<'a> {
    twin: &'a Twin,
    terms: &'a Terms,
    runs: [&'a Samples; 2],
    load: Load,
    model: Robot,
}

struct State {
    rounds: usize,
    /// Spread of links, once it has been found: it moves in steps, which rounds could go to and fro between.
    spread: Option<f64>,
    gains: Vec<f64>,
    robot: Robot,
    /// m c of the load.
    moment: [f64; 3],
}

impl Scale<'_> {
    /// Moves `state`; the largest change of a gain.
    fn round(&self, state: &mut State) -> Result<(Estimate, f64), IdentificationError> {
        let mut inertial = Inertial::of(&self.at(state, false), self.terms);
        let (arm, unloaded) = self.run(state, false, &mut inertial)?;
        let (_, loaded) = self.run(state, true, &mut inertial)?;
        let both = inertial.with_ranges(&arm, unloaded + loaded);
        let found = match state.spread {
            None => estimate(&self.model, &inertial.base, &both, None),
            Some(spread) => estimate_within(&self.model, &inertial.base, &both, spread),
        };
        let found = found.ok_or(IdentificationError::NoMass)?;
        let dof = state.gains.len();
        for (gain, share) in state.gains.iter_mut().zip(&found.others) {
            *gain /= 1.0 + share;
        }
        state.robot = parameters::built_into(&self.model, &found.parameters);
        for (moment, more) in state.moment.iter_mut().zip(found.others.iter().skip(dof)) {
            *moment += more;
        }
        state.rounds += 1;
        if state.rounds == FREE_ROUNDS {
            state.spread = Some(found.spread);
        }
        let change = found.others.rows(0, dof).amax();
        Ok((found, change))
    }

    /// The problem of one run in scaled torque, and what it says.
    fn run(
        &self,
        state: &State,
        loaded: bool,
        inertial: &mut Inertial,
    ) -> Result<(ArmProblem, Information), IdentificationError> {
        let twin = self.at(state, loaded);
        let samples = &scaled(self.runs[usize::from(loaded)], &state.gains);
        let mut arm = assemble(samples, &twin, self.terms, &BoundsByName::new())?;
        let corrected = &twin.correct(samples);
        let (names, columns) = self.more_columns(state, &twin, corrected, loaded);
        share(&mut arm, corrected, names, &columns)?;
        inertial.attach(&mut arm, samples, &twin)?;
        let found = Found::of(&arm)?;
        let information = inertial.information(&arm, &found);
        Ok((arm, information))
    }

    /// The twin with what was found so far.
    fn at(&self, state: &State, loaded: bool) -> Twin {
        let mut twin = Twin { robot: state.robot.clone(), ..self.twin.clone() };
        let Some(payload) = effects::find("payload").filter(|_| loaded) else { return twin };
        let mass = self.load.mass_kg;
        let values = std::iter::once(mass).chain(state.moment);
        for (p, value) in payload.about().parameters.iter().zip(values) {
            twin.values.insert(p.name.into(), vec![value]);
        }
        if !twin.effects.iter().any(|name| name == "payload") {
            twin.effects.push("payload".into());
        }
        twin
    }

    /// Gains about 1, and the load's first moments where they are not known.
    fn more_columns(
        &self,
        state: &State,
        twin: &Twin,
        samples: &Samples,
        loaded: bool,
    ) -> (Vec<Parameter>, Vec<JointSeries>) {
        let (dof, laden) = (twin.robot.dof(), twin.laden());
        let rigid = inverse_dynamics_series(&laden, &samples.q, &samples.qd, &samples.qdd);
        let nothing = || JointSeries::zeros(dof, samples.len());
        let mut names = Vec::new();
        let mut columns = Vec::new();
        for joint in 0..dof {
            let mut column = nothing();
            column.joint_mut(joint).copy_from_slice(rigid.joint(joint));
            columns.push(column);
            // So that the gain itself, and not its last change, is about 1.
            let middle = state.gains[joint] - 1.0;
            let (lower, upper) = (middle - BEFORE, middle + BEFORE);
            names.push(Parameter {
                name: format!("gain_{}", joint + 1),
                unit: "-".into(),
                lower,
                upper,
            });
        }
        if let (None, Some(payload)) = (self.load.centre_m, effects::find("payload")) {
            let size = Size::of(&self.twin.robot);
            let moments = payload.about().parameters[1..4].iter();
            let about = moments.map(|p| searched(p, &size));
            names.extend(about.zip(state.moment).map(|(p, now)| Parameter {
                lower: p.lower - now,
                upper: p.upper - now,
                ..p
            }));
            match loaded {
                true => columns.extend(moment_columns(payload, twin, samples)),
                false => columns.extend((0..3).map(|_| nothing())),
            }
        }
        (names, columns)
    }

    fn finish(&self, state: &State, found: &Estimate) -> TorqueScale {
        let z = normal_quantile(1.0 - LEVEL);
        let links = found.parameters.len();
        let gain = |(j, &value): (usize, &f64)| {
            let deviation = found.covariance[(links + j, links + j)].sqrt();
            Gain {
                joint: j + 1,
                value,
                low: value * (1.0 - z * deviation),
                high: value * (1.0 + z * deviation),
                torque_per_ampere: value * self.twin.drive.torque_per_ampere(j),
                identifiable: deviation < TOLD,
            }
        };
        TorqueScale {
            joints: state.gains.iter().enumerate().map(gain).collect(),
            load: self.load,
            centre_m: state.moment.map(|h| h / self.load.mass_kg),
            rounds: state.rounds,
            spread: found.spread,
            robot: state.robot.clone(),
        }
    }
}

/// Torque per unit of the load's first moments where its centre is now.
fn moment_columns(payload: &dyn Effect, twin: &Twin, samples: &Samples) -> Vec<JointSeries> {
    let values = twin.values_at(payload, 0).unwrap_or_default();
    let linear = payload.about().parameters.iter().filter(|p| p.role == Role::Linear).count();
    let reference = values.get(linear..).unwrap_or_default();
    payload.reach(&twin.motion(samples), 0, reference).drain(1..4).collect()
}

fn scaled(samples: &Samples, gains: &[f64]) -> Samples {
    let torque = samples.torque.map_joints(|j, x| x.iter().map(|t| gains[j] * t).collect());
    Samples { torque, ..samples.clone() }
}

#[cfg(test)]
#[path = "torque_scale_tests.rs"]
mod tests;
