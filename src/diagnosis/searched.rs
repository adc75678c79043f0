//! Recordings with what a search of them finds, each row counted by what that leaves.
//!
//! What the twin leaves without its causes is alike from row to row, so that rows count little and only what is large
//! is found. Beside that they count more: they are counted again, and the search goes on.

use super::candidate::Candidate;
use super::criteria::Criteria;
use super::data::Data;
use super::fit::Fit;
use super::hypotheses::Hypotheses;
use super::independent::{are_near, counted};
use super::model::Model;
use super::revise::revised;
use super::search::{Found, Round, grown, tell};
use super::sizes::Sizes;

/// Recordings, and what a search of them finds.
pub struct Searched<'a> {
    pub data: Data<'a>,
    candidates: Vec<Candidate>,
    criteria: Criteria,
    pub model: Model,
    sizes: Sizes,
    rounds: Vec<Round>,
    screened: Vec<(Candidate, f64)>,
}

impl<'a> Searched<'a> {
    /// Of recordings all of whose rows count.
    pub fn new(all_rows: &Data<'a>, candidates: Vec<Candidate>, criteria: Criteria) -> Self {
        // A second search takes a round at least.
        let first = Self::nothing(all_rows, candidates, criteria).searched(1);
        let shares = first.data.shares.clone();
        let again = first.counted_again(all_rows);
        let last = match are_near(&again.data.shares, &shares) {
            true => again,
            false => again.searched(0).counted_again(all_rows),
        };
        tell(&last.hypotheses(), last.rounds.len(), 0);
        last
    }

    /// Each row counted by what is left now.
    fn counted_again(self, all_rows: &Data<'a>) -> Self {
        Self { data: counted(all_rows, &self.model), ..self }
    }

    /// The twin alone.
    fn nothing(all_rows: &Data<'a>, candidates: Vec<Candidate>, criteria: Criteria) -> Self {
        let model = Model::of(all_rows.twin);
        let (rounds, screened, sizes) = (Vec::new(), Vec::new(), all_rows.nothing());
        let data = counted(all_rows, &model);
        Self { data, candidates, criteria, model, sizes, rounds, screened }
    }

    /// Searched on from what is found; so many rounds are told to come after it.
    fn searched(self, after: usize) -> Self {
        let all = self.hypotheses();
        let mut found = self.found(&all);
        let causes = self.model.causes.iter().map(|t| t.candidate).collect();
        found.last = revised(&all, found.last, causes);
        let Found { last: Fit { model, sizes, .. }, rounds, screened, .. } =
            grown(&all, found, after);
        Self { model, sizes, rounds, screened, ..self }
    }

    /// Everything that may be a cause in these recordings.
    pub fn hypotheses(&self) -> Hypotheses<'_> {
        let (candidates, criteria) = (self.candidates.clone(), self.criteria);
        Hypotheses { data: &self.data, candidates, criteria }
    }

    /// What is found.
    pub fn found<'s>(&'s self, all: &Hypotheses<'s>) -> Found<'s> {
        let (rounds, screened) = (self.rounds.clone(), self.screened.clone());
        let none = Found { rounds, screened, ..Found::none(all) };
        if self.model.causes.is_empty() {
            return none;
        }
        let joints: Vec<usize> = (0..self.data.joints()).collect();
        let fit = Fit::new(&self.data, self.model.clone(), self.sizes.clone());
        Found { last: all.tuned(fit.settled(), &joints), ..none }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Settings;
    use crate::diagnosis::candidate::Place;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::observed::Observed;
    use crate::effects::find;
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    const OFFSET_NM: f64 = 0.06;

    /// Beside a load that nobody wrote down rows count little, and a small offset is not told: found, the load tells it.
    #[test]
    fn what_is_small_is_found_beside_what_is_large() {
        let twin = Twin::default();
        let mut arm = twin.clone();
        arm.effects.push("payload".into());
        for (name, value) in
            [("mass", 3.0), ("moment_x", 0.0), ("moment_y", 0.0), ("moment_z", 0.3)]
        {
            arm.values.insert(format!("payload_{name}"), vec![value]);
        }
        let mut made = samples(6, 6000, |j, t| {
            0.7 * ((0.9 + 0.2 * j as f64) * t).sin() + 0.4 * (0.6 * t + j as f64).cos()
        });
        made.torque = arm.torque(&arm.motion(&made));
        made.torque.joint_mut(0).iter_mut().for_each(|t| *t += OFFSET_NM);
        noisy(&mut made, 0.3);
        let floor = noise_floor(&made, &twin);
        let observed = Observed::new(0, &twin, &made, &floor).unwrap();
        let settings = Settings { mass_error: 0.0, ..Settings::default() };
        let all_rows = Data::new(vec![&observed], &settings);
        let payload = Candidate::new(find("payload").unwrap(), Place::Arm);
        let offset = Candidate::new(find("current_offset").unwrap(), Place::Joint(0));
        let of = || (vec![payload, offset], Criteria::default());
        let (candidates, criteria) = of();
        let first = Searched::nothing(&all_rows, candidates, criteria).searched(0);
        let (candidates, criteria) = of();
        let both = Searched::new(&all_rows, candidates, criteria);
        assert!(first.model.has(payload) && !first.model.has(offset));
        assert!(both.model.has(payload) && both.model.has(offset));
        assert!(both.data.shares[0][0] > first.data.shares[0][0]);
    }
}
