//! The catalogue of physical effects: one file each, used to inject and to explain.
//!
//! Sign convention: an effect's torque is what the drive must supply in addition to rigid-body
//! inverse dynamics, tau_motor = ID(q, qd, qdd) + sum of effects.
//!
//! To add an effect copy a neighbour and put one line into [`CATALOGUE`] (ARCHITECTURE.md).

mod backlash;
mod base_tilt;
mod cable_spring;
mod catalogue;
mod channels;
mod controller_mismatch;
mod coulomb;
mod coulomb_asymmetry;
mod current_offset;
mod encoder_offset;
mod external_contact;
mod flange;
mod hysteresis;
mod joint_coupling;
mod joint_flexibility;
mod link_inertia;
mod load_friction;
mod lugre;
mod maxwell_slip;
mod mechanism;
mod motion;
mod payload;
mod presliding;
mod quantisation;
mod rigid;
mod rotor_inertia;
mod round_trip;
mod servo_damping;
mod servo_dead_band;
mod servo_delay;
mod servo_friction;
mod servo_gain;
mod servo_max_torque;
mod servo_offset;
mod size;
mod spring_steps;
mod starts;
mod state;
mod stribeck;
mod temperature_friction;
mod time_delay;
mod torque_constant;
mod torque_ripple;
mod torque_saturation;
mod velocity_lag;
mod viscous;
mod viscous_cubic;
mod viscous_quadratic;
mod wind_up;
mod worked;

#[cfg(test)]
mod tests;

pub use catalogue::{CATALOGUE, find, names, of_drive, order};
pub use channels::Channels;
pub use mechanism::{ControlChange, Mechanism, ServoChange, Transmission};
pub use motion::Motion;
pub use rigid::{Rigid, Slopes};
pub use round_trip::RoundTrip;
pub use size::Size;
pub use state::{ArmState, JointLoad, JointState};
pub use worked::{Shown, Worked};

use crate::robot::{Drive, DrivePart, Robot};
use crate::series::JointSeries;

/// The values of all parameters of an effect, each from `given` by name; references that are not
/// given follow from the others.
///
/// # Errors
/// The first parameter that is missing.
pub fn complete(
    effect: &dyn Effect,
    given: impl Fn(&'static str) -> Option<f64>,
) -> Result<Vec<f64>, &'static Parameter> {
    let parameters = effect.about().parameters;
    let value = |p: &'static Parameter| given(p.name).or(p.left_out()).ok_or(p);
    let mut values = parameters.iter().map(value).collect::<Result<Vec<f64>, _>>()?;
    let linear = parameters.iter().filter(|p| p.role == Role::Linear).count();
    let (linear, nonlinear) = values.split_at_mut(linear);
    effect.settle(linear, nonlinear);
    for (value, p) in values.iter_mut().zip(parameters) {
        *value = given(p.name).unwrap_or(*value);
    }
    Ok(values)
}

/// How large a linear parameter that the whole arm has can be expected to be, in its unit; `None` where nothing is
/// known beforehand.
pub fn expected_of_arm(robot: &Robot, parameter: &str) -> Option<f64> {
    let place = |e: &&dyn Effect| e.about().parameters.iter().position(|p| p.name == parameter);
    let of_arm = CATALOGUE.iter().copied().filter(|e| e.about().scope == Scope::Arm);
    let (effect, i) = of_arm.into_iter().find_map(|e| Some((e, place(&e)?)))?;
    effect.expected(robot, 0, &[]).get(i).copied().filter(|size| size.is_finite())
}

/// What a parameter is; data, so that command line, docs, scenario keys and tests follow from it.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Parameter {
    /// Key in scenario files and JSON, for example `coulomb`.
    pub name: &'static str,
    pub symbol: &'static str,
    pub unit: &'static str,
    /// Physical bounds on an arm of the UR5's size, both attainable; on another they grow with it as the unit
    /// says ([`Parameter::on`]).
    pub min: f64,
    pub max: f64,
    /// Typical value of a joint of a UR5.
    pub typical: f64,
    /// The value at which the effect vanishes.
    pub null: f64,
    pub role: Role,
}

impl Parameter {
    /// A reference of either sign, in `unit` and no larger than `max`; a search begins at none. Its name ends with
    /// `_reference`.
    pub const fn reference(
        name: &'static str,
        symbol: &'static str,
        unit: &'static str,
        max: f64,
    ) -> Self {
        let (role, null) = (Role::Nonlinear, f64::NAN);
        Self { name, symbol, unit, min: -max, max, typical: 0.0, null, role }
    }

    /// Does it say where columns are worked out, not what the arm is like? It then follows from the linear
    /// parameters ([`Effect::settle`]).
    pub fn is_reference(&self) -> bool {
        self.name.ends_with("_reference")
    }

    /// Is it the shape of a curve? The ends of its range are laws of their own.
    pub fn is_shape(&self) -> bool {
        self.name.ends_with("_exponent")
    }

    /// The value where a file leaves it out: references, the shapes of curves and how a load is spread may be.
    pub fn left_out(&self) -> Option<f64> {
        let usual = self.is_reference() || self.is_shape();
        usual.then_some(self.typical).or(self.is_detail().then_some(self.null))
    }

    /// Does it refine an effect, so that it is only spoken of where data show it?
    pub fn is_detail(&self) -> bool {
        self.name.contains("_inertia_")
    }

    /// Is it beyond anything that a fit or a slip of units can give: a thousand times the bounds?
    pub fn is_absurd(&self, value: f64) -> bool {
        value.is_nan() || value.abs() > ABSURD * self.min.abs().max(self.max.abs())
    }

    /// The nearest value within the bounds.
    pub fn clamp(&self, value: f64) -> f64 {
        value.clamp(self.min, self.max)
    }
}

/// What people read in place of a linear parameter: it, over another one. A load's centre is its first
/// moment over its mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ratio {
    pub name: &'static str,
    pub unit: &'static str,
    /// Names of the linear parameters.
    pub of: &'static str,
    pub over: &'static str,
}

impl Ratio {
    /// The ratio that is read in place of the parameter of this name.
    pub fn replacing(parameter: &str) -> Option<Self> {
        let mut all = CATALOGUE.iter().flat_map(|e| e.readable());
        all.find(|r| r.of == parameter).copied()
    }
}

/// Times the bounds of a parameter.
const ABSURD: f64 = 1e3;

/// How a parameter enters the torque.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    Linear,
    Nonlinear,
}

/// How an effect shows where the recorded motion goes through inverse dynamics.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Seen {
    /// As torque: columns in its linear parameters.
    Columns,
    /// As channels that do not belong together: corrected for given values.
    Channels,
    /// Not at all: recorded torque and motion agree. Only a simulation of the recorded command
    /// shows it.
    Simulation,
}

/// Which drives can have an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DriveKind {
    Any,
    /// Those whose current is recorded: it is about that record.
    Current,
    /// Position servos.
    Servo,
}

/// What not every recording has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Needed {
    /// The speed of the motors, beside their positions.
    Velocity,
    /// The temperature of the joints.
    Temperature,
}

/// Does every joint have its own parameters or does the arm share one set?
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Scope {
    Joint,
    /// Every joint has its own parameters, and they act on the torque of all joints.
    Link,
    Arm,
}

#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct About {
    pub name: &'static str,
    /// What the drive must supply, N.m, in the symbols of the parameters.
    pub law: &'static str,
    pub scope: Scope,
    /// Linear parameters first, in the order of the columns.
    pub parameters: &'static [Parameter],
    /// How many numbers [`Effect::act`] remembers per joint from step to step.
    pub memory: usize,
    /// Never gives energy to the arm, for any values within the bounds: tau qd >= 0.
    pub dissipates: bool,
    /// One line each, for people.
    pub cause: &'static str,
    pub remedy: &'static str,
    /// Paper, section, equation.
    pub source: &'static str,
}

/// What several effects of the catalogue are laws of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Curve {
    /// How viscous friction bends over velocity.
    Viscous,
    /// How friction builds up over the way since a reversal.
    Reversal,
}

/// A physical effect: the contract a new file in this folder implements, plus one line in
/// [`CATALOGUE`]. Only `about` has no default; an effect implements the hooks where it acts.
///
/// Inject, at one of three places:
/// * in the mechanism before the first step (inertia, payload, tilt, encoder zero, limits,
///   elastic or slack transmission, controller): [`build`](Effect::build); what it changes is a
///   field of [`Mechanism`];
/// * in every step (friction, ripple, spring): [`act`](Effect::act); what it reads is a field of
///   [`JointState`], what it remembers is its memory;
/// * in the recorded channels (delay, lag, rounding): [`measure`](Effect::measure).
///
/// Explain the same physics from conditioned signals, as [`seen`](Effect::seen) declares: by
/// [`columns`](Effect::columns) (and [`reach`](Effect::reach) where one joint's parameters act on
/// other joints), or by [`correct`](Effect::correct), or not at all.
pub trait Effect: Sync {
    fn about(&self) -> &'static About;

    /// How the effect shows where the recorded motion goes through inverse dynamics.
    fn seen(&self) -> Seen {
        Seen::Columns
    }

    /// Which drives can have it.
    fn of_drive(&self) -> DriveKind {
        DriveKind::Any
    }

    /// Explain: what has to be recorded beside motion and torque, or it cannot be seen.
    fn needs(&self) -> Option<Needed> {
        None
    }

    /// Explain: N.m at `joint` per unit of each linear parameter, one column of
    /// `motion.samples()` values per linear parameter, for given nonlinear parameters.
    /// An effect of [`Scope::Link`] or [`Scope::Arm`] implements [`reach`](Effect::reach) instead:
    /// its columns are what of that falls on one joint.
    fn columns(&self, motion: &Motion<'_>, joint: usize, nonlinear: &[f64]) -> Vec<Vec<f64>> {
        if self.about().scope == Scope::Joint || self.seen() != Seen::Columns {
            return Vec::new();
        }
        let all = self.reach(motion, joint, nonlinear);
        all.iter().map(|series| series.joint(joint).to_vec()).collect()
    }

    /// Explain: N.m at every joint per unit of each linear parameter of joint `from`, or of the
    /// whole arm's. Effects of [`Scope::Joint`] reach no further than their own joint.
    fn reach(&self, motion: &Motion<'_>, from: usize, nonlinear: &[f64]) -> Vec<JointSeries> {
        let alone = |column: Vec<f64>| {
            let mut series = JointSeries::zeros(motion.robot.dof(), motion.samples());
            series.joint_mut(from).copy_from_slice(&column);
            series
        };
        self.columns(motion, from, nonlinear).into_iter().map(alone).collect()
    }

    /// Explain: where a search for the nonlinear parameters at `joint` begins, one row of all of
    /// them per start; one of them should lie in the basin of the truth. What differs between
    /// rows is then refined within its bounds, what is the same in all stays.
    fn starts(&self, _motion: &Motion<'_>, _joint: usize) -> Vec<Vec<f64>> {
        starts::spread(self.about().parameters)
    }

    /// Explain: do the columns follow from what the drive supplies, all other effects included
    /// ([`Motion::drive_torque`])?
    fn follows_drive(&self) -> bool {
        false
    }

    /// Ends between which nonlinear parameter `i` is searched around these values, where a fit may
    /// have several optima between them; `None`: between the neighbouring starts.
    fn bracket(&self, _nonlinear: &[f64], _i: usize) -> Option<[f64; 2]> {
        None
    }

    /// Explain: where columns hold only near a reference that follows from the linear parameters
    /// (a gap, a compliance), sets that reference. The columns are then worked out again. Each reference
    /// takes the linear parameter of its place.
    fn settle(&self, linear: &[f64], nonlinear: &mut [f64]) {
        let own = self.about().parameters.iter().filter(|p| p.role == Role::Nonlinear);
        let references = own.zip(nonlinear).filter(|(p, _)| p.is_reference());
        references.zip(linear).for_each(|((p, r), value)| *r = value.max(p.min));
    }

    /// Explain: is it still this effect with these linear parameters, some of which a sign constraint
    /// holds at zero? A load without mass is none.
    fn is_itself(&self, linear: &[f64]) -> bool {
        linear.first().is_some_and(|first| *first != 0.0)
    }

    /// Explain: what people read in place of linear parameters.
    fn readable(&self) -> &'static [Ratio] {
        &[]
    }

    /// Moves `values` to the nearest that a machine can have, where bounds of each do not say it.
    fn keep_physical(&self, _values: &mut [f64]) {}

    /// Explain: how large the linear parameters at `joint` can be expected to be, standard
    /// deviations, infinite for those of which nothing is known beforehand; empty where that is all. `nonlinear` may
    /// refer to what was fitted before; empty where there is nothing to refer to.
    fn expected(&self, _robot: &Robot, _joint: usize, _nonlinear: &[f64]) -> Vec<f64> {
        Vec::new()
    }

    /// Explain: does it shake the arm faster than its conditioned motion shows? Values are then taken
    /// from torque that is as slow.
    fn outruns_motion(&self) -> bool {
        false
    }

    /// Explain: parameters that no fit by simulation moves (they refine a law further than recordings tell, or have no
    /// slope to follow): they stay as a twin has them, or usual.
    fn kept(&self) -> &'static [&'static str] {
        &[]
    }

    /// Explain: the curve it is a law of. A joint has one such curve, however many laws it takes to come near it: they are one
    /// cause.
    fn law_of(&self) -> Option<Curve> {
        None
    }

    /// Does it put a spring or a gap between motor and link?
    fn gives_way(&self) -> bool {
        false
    }

    /// Explain: do the columns change with what the arm carries?
    fn depends_on_load(&self) -> bool {
        self.about().scope != Scope::Joint
    }

    /// Explain: does it act for a while, which may be in one recording alone?
    fn lasts_a_while(&self) -> bool {
        false
    }

    /// The part of a drive that its only parameter stands for. What the drive holds is then there without the
    /// effect, values of the effect stand in its place, and a cause is a change of them.
    fn stands_for(&self) -> Option<DrivePart> {
        None
    }

    /// Explain: how much of the first parameter, in its unit, the drive is known to have at `joint`
    /// (from 0); a cause may take it away.
    fn in_drive(&self, drive: &Drive, joint: usize) -> f64 {
        self.stands_for().map_or(0.0, |part| drive.part(part)[joint])
    }

    /// Explain: undoes on one joint's conditioned channels what [`measure`](Effect::measure) did
    /// to them, for given values of all parameters, so that motion and torque belong together.
    fn correct(&self, _values: &[f64], _channels: &mut Channels) {}

    /// Inject: what the effect adds to `load` at one joint in one step, for parameter values in
    /// the order of [`About::parameters`]. Sliding laws only fill in dry level and damping; the
    /// simulation's constraint solver makes them stick. `memory` holds [`About::memory`] numbers
    /// of this effect at this joint, zero before the first step, kept from step to step.
    fn act(
        &self,
        _values: &[f64],
        _state: &JointState<'_>,
        _memory: &mut [f64],
        _load: &mut JointLoad,
    ) {
    }

    /// Inject: does what it adds at one joint depend on where other joints are, or how they move?
    fn feels_other_joints(&self) -> bool {
        false
    }

    /// Inject, an effect of the whole arm without memory: [`act`](Effect::act) at every joint at once, for
    /// what all of them share; one entry of `loads` per joint.
    fn act_on_arm(&self, values: &[f64], arm: &ArmState<'_>, loads: &mut [JointLoad]) {
        for (j, load) in loads.iter_mut().enumerate() {
            self.act(values, &arm.joint(j), &mut [], load);
        }
    }

    /// Inject: what changes in the mechanism before the first step. Called once per joint that
    /// has the effect; for an effect on the whole arm once, with `joint` 0.
    fn build(&self, _values: &[f64], _joint: usize, _mechanism: &mut Mechanism) {}

    /// Inject: what one joint's channels show of the truth; noise is in them, the rounding of
    /// the scenario's sensors comes after. Effects measure in the order of the catalogue.
    fn measure(&self, _values: &[f64], _channels: &mut Channels) {}

    /// Proof: one number worked out by hand, apart from the code. Every effect of the catalogue has one.
    fn worked(&self) -> Option<Worked> {
        None
    }

    /// Proof: what comes back of the effect's scenario, simulated in rapier and explained. Every effect of the
    /// catalogue says so.
    fn round_trip(&self) -> Option<RoundTrip> {
        None
    }
}
