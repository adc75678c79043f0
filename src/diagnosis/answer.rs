//! What a diagnosis says: the shape of `diagnosis.json`.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Episode;

/// In one word.
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
    /// Where the twin differs, before anything is added to it.
    pub gap: Gap,
    /// Accepted, what takes most off the gap first.
    pub causes: Vec<Cause>,
    pub shrink: Shrink,
    /// Every candidate, "none" and "unknown" among them; the probabilities sum to 1.
    pub ranking: Vec<Ranked>,
    pub untestable: Vec<Untestable>,
    /// Candidates that fit only with an unphysical sign or at a bound.
    pub rejected: Vec<Rejected>,
    /// What is left when all causes are taken off.
    pub leftover: Leftover,
    pub next_experiment: String,
    /// Stretches whose gap stands out against anything the other recording shows.
    #[serde(default)]
    pub episodes: Vec<Episode>,
    /// Values of what the twin lists without values, fitted with the causes: one per joint (one in
    /// all for the whole arm), by parameter name.
    pub fitted: BTreeMap<String, Vec<f64>>,
    /// The same, fitted without the causes.
    pub fitted_before: BTreeMap<String, Vec<f64>>,
    /// The search, round by round: the evidence.
    #[serde(default)]
    pub rounds: Vec<RoundEvidence>,
    /// What was noticed on the way, for people.
    pub notes: Vec<String>,
}

/// The torque gap, N.m: recorded torque less the twin's, its open parameters fitted.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Gap {
    /// Base to wrist.
    pub joints: Vec<JointGap>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointGap {
    /// From 1 at the base.
    pub joint: usize,
    /// Root mean square on the check recording, N.m, while sliding.
    pub rms_nm: f64,
    /// 90 % block-bootstrap interval of `rms_nm`.
    pub low_nm: f64,
    pub high_nm: f64,
    /// What the sensors' noise alone would give, N.m.
    pub noise_floor_nm: f64,
    /// `repeats` (cycles of the recording), `estimate` (its spectrum where nothing moves, taken for
    /// white) or `estimate with colour` (and slower noise, as much as the quietest joint shows).
    pub floor_from: String,
    /// Of the squared gaps of all joints above their floors.
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
    /// Of the time the joint slides.
    pub time_fraction: f64,
}

/// An effect the twin lacks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cause {
    pub effect: String,
    /// From 1 at the base; empty: the whole arm.
    pub joints: Vec<usize>,
    pub probability: f64,
    /// What would look the same in these data.
    pub equivalent: Vec<Named>,
    pub parameters: Vec<Value>,
    /// On the check recording, when this cause is added to all the others.
    pub shrink: Checked,
    /// One line each, from the catalogue.
    pub cause: String,
    pub remedy: String,
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
    pub unit: String,
    pub value: f64,
    /// 90 % interval.
    pub low: f64,
    pub high: f64,
    pub at_bound: bool,
}

/// Root mean square of the gap on the check recording over all joints, N.m.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Checked {
    pub check_before_nm: f64,
    pub check_after_nm: f64,
    /// Of the mean square: 1 - after^2 / before^2.
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
    /// Of the mean square: 1 - after^2 / before^2.
    pub fraction: f64,
    /// 90 % block-bootstrap interval.
    pub low: f64,
    pub high: f64,
    /// The same above the noise floor: 1 - (after^2 - floor^2) / (before^2 - floor^2).
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
    /// Of simulated less recorded drive torque, closed loop, N.m.
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
    /// Gain in log-likelihood over the twin on the recording it was fitted on, and on the check.
    pub gain_fit: f64,
    pub gain_check: f64,
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

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Leftover {
    /// Per joint: mean square of what is left over that of the noise; 1 where nothing is.
    pub chi2_per_sample: Vec<f64>,
    /// Per joint: power below 4 Hz over that where nothing moves (over what noise with a colour has
    /// there, where it has one); 1 for noise.
    #[serde(default)]
    pub in_motion_band: Vec<f64>,
    pub systematic: bool,
    /// What it goes along with, for people.
    pub says: String,
}

/// One round of the search: a cause was added, or none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RoundEvidence {
    /// Share of surrogate gaps that a search explains as well as the real one.
    pub p: f64,
    /// Power in the motion's band over the noise, per joint, before this round.
    pub in_motion_band: Vec<f64>,
    pub accepted: Option<Named>,
    /// Why nothing was added.
    pub declined: Option<String>,
    /// The best, by score.
    pub ranked: Vec<Scored>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scored {
    pub effect: String,
    pub joints: Vec<usize>,
    /// `gain_fit` + `gain_check` less the price of the parameters, nats.
    pub score: f64,
    pub gain_fit: f64,
    pub gain_check: f64,
    pub at_bound: Option<String>,
    /// In the order of the effect's parameters.
    pub values: Vec<f64>,
}
