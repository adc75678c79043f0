//! What is said beside the answer: how it came about, and what stood in its way.

use super::Settings;
use super::colour::WHITE_NOISE;
use super::kinematics::Lagging;
use super::leftover::Remains;
use super::rank::describe;
use super::verdict::{ABSTAIN, Findings};

impl Findings<'_, '_> {
    /// `unknown` is its probability; `remains` what all causes leave.
    pub fn notes(&self, remains: &Remains, unknown: f64) -> Vec<String> {
        let mut notes: Vec<String> = self.lagging.iter().map(Lagging::says).collect();
        let Settings { mass_error, centre_error_m, .. } = self.settings();
        if self.account.uncertain {
            notes.push(format!(
                "link masses are fitted along, known to {:.0} %, their centres to {:.0} mm",
                100.0 * mass_error,
                1000.0 * centre_error_m
            ));
        }
        notes.extend(self.account.notes.iter().cloned());
        if let Some(why) = self.account.rounds.last().and_then(|r| r.declined.as_ref()) {
            notes.push(format!("the search ended because {why}"));
        }
        if self.noise != WHITE_NOISE {
            notes.push(format!(
                "noise is coloured: where the arm moves its power is {:.0} times that where nothing \
                 moves even at the quietest joint, and nothing of that can be predicted from the \
                 motion",
                self.noise.in_motion_band
            ));
        }
        if !remains.is_exact() {
            notes.push(format!(
                "no joint comes closer than {:.0} times to its noise: the twin is inexact \
                 throughout, causes are judged by the share they explain",
                remains.inexactness()
            ));
        }
        if let Some([cause, rival]) = self.outdone() {
            let only = rival.at_bound.map(|p| format!(", but only with {p} at its bound"));
            notes.push(format!(
                "{} fits better in the place of {}{}",
                describe(rival.trial.candidate),
                describe(cause.trial.candidate),
                only.unwrap_or_default()
            ));
        } else if unknown > ABSTAIN && !self.accepted().is_empty() {
            let names: Vec<String> =
                self.accepted().iter().map(|h| describe(h.trial.candidate)).collect();
            notes.push(format!(
                "{} fits best, but what it leaves is too systematic to name it",
                names.join(", ")
            ));
        }
        notes
    }
}
