//! What a diagnosis says: the shape of `diagnosis.json`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Episode;
use super::by::{By, Position};
use super::criteria::Criteria;
use crate::effects::{self, Ratio};

/// The effect that positions show beside velocities, not torque.
pub(super) const LAG: &str = "velocity_lag";

/// The answer in one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The twin's torque agrees with the recorded one as far as the noise lets one see.
    NoGap,
    /// The causes named leave nothing systematic behind.
    Explained,
    /// Causes are named, and something systematic is left.
    PartlyExplained,
    /// There is a gap, and nothing of the catalogue is its cause.
    Unexplained,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Diagnosis {
    /// `armtwin.diagnosis/1`
    pub schema: String,
    pub armtwin: String,
    pub verdict: Verdict,
    #[serde(default)]
    pub by: By,
    /// How the twin, led along the command, follows the check recording, where servos record no torque.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<Position>,
    /// Where the twin differs, before anything is added to it.
    pub gap: Gap,
    /// Accepted, what takes most off the gap first.
    pub causes: Vec<Cause>,
    /// In the mended twin and no causes: the intervals of their values hold that they are absent, or the fit recording
    /// alone does not show them, or they are laws of a curve that a cause is named after.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub adjustments: Vec<Cause>,
    pub shrink: Shrink,
    /// Every candidate, "none" and "unknown" among them; the probabilities sum to 1.
    pub ranking: Vec<Ranked>,
    pub untestable: Vec<Untestable>,
    /// Candidates that fit only with an unphysical sign or at a bound.
    pub rejected: Vec<Rejected>,
    /// What the causes leave of the check recording.
    pub unexplained: Unexplained,
    pub next_experiment: String,
    /// Stretches whose gap stands out against anything the other recording shows.
    #[serde(default)]
    pub episodes: Vec<Episode>,
    /// Values of what the twin lists without values, fitted with the causes: one per joint (one in
    /// all for the whole arm), by parameter name.
    pub fitted: BTreeMap<String, Vec<f64>>,
    /// Values of these parameters, fitted without the causes.
    pub fitted_before: BTreeMap<String, Vec<f64>>,
    /// The search, round by round: the evidence.
    #[serde(default)]
    pub rounds: Vec<RoundEvidence>,
    /// The constants that decided.
    #[serde(default)]
    pub criteria: Criteria,
    /// What was noticed on the way, for people.
    pub notes: Vec<String>,
}

impl Diagnosis {
    /// What the mended twin has more than the given one.
    pub fn changes(&self) -> Vec<Cause> {
        self.causes.iter().chain(&self.adjustments).cloned().collect()
    }
}

/// The torque gap, N.m: recorded torque less the twin's, its open parameters fitted.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Gap {
    /// Joints from base to wrist.
    pub joints: Vec<JointGap>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointGap {
    /// From 1 at the base.
    pub joint: usize,
    /// Root mean square on the check recording, N.m, while sliding.
    pub rms_nm: f64,
    /// What is left of the position, simulated along the command, where servos record no torque, and what
    /// the encoder's steps alone leave, rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rms_rad: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise_floor_rad: Option<f64>,
    /// 90 % block-bootstrap interval of `rms_nm`.
    pub low_nm: f64,
    pub high_nm: f64,
    /// What the sensors' noise alone would give, N.m.
    pub noise_floor_nm: f64,
    /// `repeats` (cycles of the recording) or `estimate` (its spectrum where nothing moves, taken for white).
    pub floor_from: String,
    /// This joint's share of the squared gaps of all joints above their floors.
    pub share: f64,
    pub regimes: Vec<Regime>,
}

/// The gap where a condition holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Regime {
    /// `reversal`, `slow`, `fast`, `driven`, `back_driven`, ...
    pub regime: String,
    pub rms_nm: f64,
    pub low_nm: f64,
    pub high_nm: f64,
    /// The joint's; of a band of frequencies what white noise has there, N.m.
    pub noise_floor_nm: f64,
    /// Share of the time the joint slides in which the condition holds.
    pub time_fraction: f64,
}

/// An effect the twin lacks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cause {
    pub effect: String,
    /// From 1 at the base; empty: the whole arm.
    pub joints: Vec<usize>,
    /// Probability that this effect is there, beside its rivals, nothing, and a discrepancy of any shape.
    pub probability: f64,
    /// What would look the same in these data, the more plausible first.
    pub equivalent: Vec<Named>,
    pub parameters: Vec<Value>,
    /// Shrink on the check recording beside the discrepancy, when this cause is added to all the others;
    /// values from the fit recording alone.
    pub shrink: Checked,
    /// Is a value changed that the twin states?
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub replaces: Option<Replaced>,
    /// The recording that shows it (`fit`, `check`) where one alone does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recording: Option<String>,
    /// Does a search of the fit recording alone find it too?
    #[serde(default)]
    pub found_without_check: bool,
    /// One line each, from the catalogue.
    pub cause: String,
    pub remedy: String,
}

impl Cause {
    /// The values as people read them: a ratio stands in place of the parameter that it is made from (a load's
    /// centre of mass), and what refines an effect is left out where its interval holds that it is not there.
    pub fn read(&self) -> Vec<&Value> {
        let own = |name: &str| self.parameters.iter().find(|v| v.name == name);
        let effect = effects::find(&self.effect);
        let given: Vec<&Ratio> = self.ratios().collect();
        let of_effect = effect.map_or(&[][..], |e| e.about().parameters);
        let faint = |v: &Value| {
            let detail = of_effect.iter().find(|p| p.name == v.name).filter(|p| p.is_detail());
            detail.is_some_and(|p| v.low <= p.null && p.null <= v.high)
        };
        let listed = self.parameters.iter().filter(|v| given.iter().all(|r| r.name != v.name));
        let in_place =
            |v: &'_ Value| given.iter().find(|r| r.of == v.name).and_then(|r| own(r.name));
        listed.filter(|v| !faint(v)).map(|v| in_place(v).unwrap_or(v)).collect()
    }

    /// Does torque show it? What a recorded velocity lags by, the positions show.
    pub fn shows_in_torque(&self) -> bool {
        self.effect != LAG
    }

    /// Are some of its values read as ratios?
    pub fn has_ratios(&self) -> bool {
        self.ratios().next().is_some()
    }

    fn ratios(&self) -> impl Iterator<Item = &'static Ratio> {
        let all = effects::find(&self.effect).map_or(&[][..], |e| e.readable());
        all.iter().filter(|r| self.parameters.iter().any(|v| v.name == r.name))
    }
}

/// A value that the twin states and that is another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Replaced {
    pub parameter: String,
    /// What the twin states, in the parameter's unit.
    pub twin: f64,
}

/// An effect and where it acts.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Named {
    pub effect: String,
    pub joints: Vec<usize>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Value {
    pub name: String,
    /// From 1 at the base, where a cause has values of their own for several joints.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<usize>,
    pub unit: String,
    pub value: f64,
    /// 90 % interval.
    pub low: f64,
    pub high: f64,
    pub at_bound: bool,
}

/// Root mean square of the gap on the check recording over all joints, N.m; rows beside a kink of the motion by as much
/// as they count.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Checked {
    pub check_before_nm: f64,
    pub check_after_nm: f64,
    /// Share of the mean square that is taken off: 1 - after^2 / before^2.
    pub fraction: f64,
    /// 90 % block-bootstrap interval of `fraction`.
    pub low: f64,
    pub high: f64,
}

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Shrink {
    pub torque: TorqueShrink,
    /// Filled in where the twin was simulated again along the recorded command.
    pub simulation: Option<SimulationShrink>,
}

/// All causes together: fitted on the first recording, frozen, held against the second.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct TorqueShrink {
    pub before_nm: f64,
    pub after_nm: f64,
    /// Share of the mean square that is taken off: 1 - after^2 / before^2.
    pub fraction: f64,
    /// 90 % block-bootstrap interval.
    pub low: f64,
    pub high: f64,
    /// Noise floor of the same rows, root mean square.
    #[serde(default)]
    pub noise_floor_nm: f64,
    /// `fraction` above the noise floor: 1 - (after^2 - floor^2) / (before^2 - floor^2).
    pub reducible: f64,
    pub joints: Vec<JointShrink>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointShrink {
    pub joint: usize,
    pub before_nm: f64,
    pub after_nm: f64,
    pub fraction: f64,
}

/// The twin simulated along the recorded command, before and after the causes were added.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SimulationShrink {
    /// Root mean square of simulated less recorded position, closed loop, rad.
    pub before_rad: f64,
    pub after_rad: f64,
    pub fraction: f64,
    /// Root mean square of simulated less recorded drive torque, closed loop, N.m.
    pub torque_before_nm: f64,
    pub torque_after_nm: f64,
    /// Driven by the recorded torque over short windows from recorded states, rad at their end.
    pub open_loop_before_rad: f64,
    pub open_loop_after_rad: f64,
    pub window_s: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Ranked {
    pub effect: String,
    pub joints: Vec<usize>,
    pub probability: f64,
    /// Evidence over what else is there, beside the discrepancy, nats.
    pub nats: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Untestable {
    pub effect: String,
    pub joints: Vec<usize>,
    pub why: String,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rejected {
    pub effect: String,
    pub joints: Vec<usize>,
    pub why: String,
}

/// What the causes leave of the check recording.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Unexplained {
    /// Root mean square over all joints, N.m; rows beside a kink of the motion by as much as they count.
    pub rms_nm: f64,
    /// Share of the mean square before the causes that is left.
    pub fraction: f64,
    /// Is it more than noise?
    pub above_noise: bool,
    /// What is left of `rms_nm` where links' masses and scales of torque may be off as far as the twin's are known,
    /// N.m; absent where the twin is taken for exact, or the data do so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beyond_tolerances_nm: Option<f64>,
    /// Mean square of the noise over that of the joints' floors, which hold no slow noise; 1 where it is not told.
    #[serde(default = "one")]
    pub noise_over_floor: f64,
    pub joints: Vec<UnexplainedJoint>,
}

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct UnexplainedJoint {
    /// From 1 at the base.
    pub joint: usize,
    /// N.m, counted as that of all joints.
    pub rms_nm: f64,
    /// What of `rms_nm` would stay if links and scales of torque were as the mended twin has them, N.m; absent as that of
    /// all joints is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beyond_tolerances_nm: Option<f64>,
    /// Root mean square of the noise alone, N.m.
    pub noise_floor_nm: f64,
    /// The discrepancy the evidence asks for beside the causes, N.m; 0: none.
    pub discrepancy_nm: f64,
    /// What it goes along with beyond the tolerances, most first.
    pub depends_on: Vec<Dependence>,
}

/// A variable that what is left depends on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Dependence {
    /// `q_2`, `qd_2`, `load_2` (a joint's angle, speed, load, from 1), `temperature_2`, `time`.
    pub variable: String,
    /// Share of the mean square of what is left that a curve over the variable, learned from the fit
    /// recording, predicts on the check recording.
    pub share: f64,
}

/// One round of the search: causes were added, or none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RoundEvidence {
    pub added: Vec<Named>,
    /// Candidates that were weighed, best first.
    pub ranked: Vec<Scored>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scored {
    pub effect: String,
    pub joints: Vec<usize>,
    /// Evidence over the state before, its prior odds included, nats.
    pub nats: f64,
    pub at_bound: Option<String>,
    /// Values in the order of the effect's parameters.
    pub values: Vec<f64>,
}

fn one() -> f64 {
    1.0
}
