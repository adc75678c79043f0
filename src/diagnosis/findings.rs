//! What was found, before it is put into an answer.

use super::candidate::Candidate;
use super::fit::Fit;
use super::held_out::HeldOut;
use super::hypotheses::{Hypotheses, Standing};
use super::judge::Gain;
use super::kinematics::Lagging;
use super::observed::Observed;
use super::search::Found;
use super::{Floor, Settings};

/// Everything an answer is made from.
pub struct Findings<'a> {
    /// The search of both recordings.
    pub search: &'a Hypotheses<'a>,
    pub found: Found<'a>,
    /// The fit with the causes that are called causes, and those that are `unconfirmed`.
    pub last: Fit<'a>,
    pub standings: Vec<Standing<'a>>,
    pub gains: Vec<Gain>,
    /// Causes that both recordings show together, and the fit recording alone does not.
    pub unconfirmed: Vec<Candidate>,
    /// Where a proof decided: what it cannot tell from each cause.
    pub equals: Option<Vec<Vec<Candidate>>>,
    /// What a search of the fit recording alone says of the check.
    pub held: HeldOut,
    pub fit: &'a Observed<'a>,
    pub check: &'a Observed<'a>,
    /// The twin alone, on the fit recording.
    pub alone: Fit<'a>,
    pub floor: Vec<Floor>,
    /// Recorded velocities that lag.
    pub lagging: Option<Lagging>,
    pub settings: &'a Settings,
}
