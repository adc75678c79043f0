//! What a case hides.

use serde::{Deserialize, Serialize};

use crate::diagnosis::Named;
use crate::effects::{self, Seen};

pub const SCHEMA: &str = "armtwin.trial/1";

/// What the right answer to a case is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Nothing is hidden: no gap.
    Clean,
    /// One effect of the catalogue.
    Single,
    /// Two effects of the catalogue on different joints.
    Pair,
    /// An effect of the catalogue that the answerer's catalogue lacks: unknown.
    Withheld,
    /// An effect no catalogue entry describes: unknown.
    Foreign,
    /// An effect that inverse dynamics cannot see: no gap in the torque.
    Unseen,
    /// Recordings of somebody's arm as they are: what they lack, nobody knows.
    Untouched,
    /// One effect of the catalogue on top of recordings of somebody's arm.
    Grafted,
    /// An effect no catalogue entry describes, on top of recordings of somebody's arm.
    GraftedForeign,
}

impl Kind {
    /// Kinds of cases that are simulated.
    pub const SIMULATED: [Self; 6] =
        [Self::Clean, Self::Single, Self::Pair, Self::Withheld, Self::Foreign, Self::Unseen];
    /// Kinds of cases on somebody's own recordings.
    pub const ON_RECORDINGS: [Self; 3] = [Self::Untouched, Self::Grafted, Self::GraftedForeign];

    pub fn name(self) -> &'static str {
        match self {
            Self::Clean => "clean",
            Self::Single => "single",
            Self::Pair => "pair",
            Self::Withheld => "withheld",
            Self::Foreign => "foreign",
            Self::Unseen => "unseen",
            Self::Untouched => "untouched",
            Self::Grafted => "grafted",
            Self::GraftedForeign => "grafted_foreign",
        }
    }
}

/// `sealed/case-0000.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    pub schema: String,
    pub armtwin: String,
    pub case: String,
    pub kind: Kind,
    /// Effects beyond what the twin knows of.
    pub effects: Vec<Hidden>,
    /// `standard` (exact link masses, white noise), `nuisance`, `servos` or `recordings`, or where the
    /// case came from.
    pub family: String,
    /// Standard deviation of the noise on each joint's torque, N.m; empty where not known or recorded.
    pub noise_nm: Vec<f64>,
    /// Is there a third recording, without noise, beside this file?
    pub third: bool,
    /// Somebody's own recordings the case is made of, to fit and to check.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub recordings: Vec<String>,
    /// The case that holds the same recordings untouched.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base: Option<String>,
    /// Everything else that made it: seeds, scenario, nuisance.
    pub made: serde_json::Value,
}

/// An effect the twin lacks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hidden {
    /// Name in the catalogue, or the foreign effect's own.
    pub effect: String,
    /// From 1 at the base; empty: the whole arm.
    pub joints: Vec<usize>,
    pub parameters: Vec<TrueValue>,
    pub strength: Strength,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrueValue {
    /// Name in the catalogue.
    pub name: String,
    /// One value per entry of `joints`, one in all for the whole arm.
    pub values: Vec<f64>,
}

/// Root mean squares of torque over that of the joint's noise, while sliding; of position servos those of
/// position over that of its noise and rounding.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Strength {
    /// What was asked for, of `gap` where it is largest.
    pub drawn: Option<f64>,
    /// The effect's own torque on each joint, measured along the fit recording.
    pub own: Vec<f64>,
    /// What of it Coulomb and viscous friction cannot take up: the gap an answerer can see.
    pub gap: Vec<f64>,
}

impl Strength {
    /// Gap at the joint where it is largest; 0 where nothing is known.
    pub fn reached(&self) -> f64 {
        self.gap.iter().fold(0.0, |most, g| most.max(*g))
    }
}

impl Hidden {
    pub fn named(&self) -> Named {
        Named { effect: self.effect.clone(), joints: self.joints.clone() }
    }
}

impl Truth {
    /// How strong the weakest of the hidden effects is.
    pub fn strength(&self) -> f64 {
        self.effects.iter().map(|e| e.strength.reached()).fold(f64::INFINITY, f64::min)
    }
}

/// Does inverse dynamics show this effect at all?
pub fn seen(effect: &str) -> bool {
    effects::find(effect).is_none_or(|e| e.seen() != Seen::Simulation)
}

/// A place written in one way: every joint of an arm of `dof` is the whole arm.
pub fn place(joints: &[usize], dof: usize) -> Vec<usize> {
    let mut joints: Vec<usize> = joints.iter().copied().filter(|j| *j > 0).collect();
    joints.sort_unstable();
    joints.dedup();
    if joints.len() == dof { Vec::new() } else { joints }
}
