//! Accounts of a gap: each a search from its first cause to its last, every cause given the others.
//!
//! A twin that is inexact throughout leaves room for more than one. The search takes the best cause
//! first and then what that leaves; where something systematic remains it is repeated with the
//! first load's rival in its place, and with link masses and centres free within what is known.

use super::candidate::{Candidate, Extent};
use super::leftover::SYSTEMATIC;
use super::model::Model;
use super::rank::{Hypothesis, LEAST_NATS, State, beyond, describe, effective_shares};
use super::revise::Standing;
use super::select::{Round, Search};

/// Of the better account's evidence: how much less another one may have and still compete.
const COMPETES: f64 = 0.05;
/// Rounds of giving every cause the name that fits best among the others.
const RENAMINGS: usize = 3;

pub struct Account<'a, 'e> {
    pub start: State<'a, 'e>,
    /// The search, one cause after the other.
    pub rounds: Vec<Round<'a, 'e>>,
    /// The accepted causes, each given the others, what takes most off the gap first; found for the
    /// account that is the answer.
    pub standings: Vec<Standing<'a, 'e>>,
    /// The twin with all of them.
    pub last: State<'a, 'e>,
    /// Are link masses and centres fitted along?
    pub uncertain: bool,
    /// What else was found, for people.
    pub notes: Vec<String>,
}

impl<'a, 'e> Account<'a, 'e> {
    pub fn accepted(&self) -> Vec<&Hypothesis<'a, 'e>> {
        self.standings.iter().map(Standing::cause).collect()
    }

    pub fn names(&self) -> String {
        let causes = self.last.fit.model.causes.iter();
        let names: Vec<String> = causes.map(|t| describe(t.candidate)).collect();
        if names.is_empty() { "nothing".into() } else { names.join(", ") }
    }

    /// What is left on the check recording where the arm moves, at the worst joint.
    pub fn worst(&self, search: &Search<'a, 'e>) -> f64 {
        let levels = search.in_motion_band(&self.last.fit, &self.last.residual);
        levels.into_iter().fold(1.0, f64::max)
    }
}

/// The model with the best of its place for a cause that is not, where there is one.
fn renamed(standings: &[Standing]) -> Option<Model> {
    standings.iter().find_map(|s| {
        let cause = s.cause();
        let best = s.ranked.iter().find(|h| h.at_bound.is_none())?;
        let extent = cause.trial.candidate.extent();
        let here = best.trial.candidate.extent() == extent
            && beyond(&s.without.fit, &best.fit, extent).is_none();
        let other = best.trial.candidate != cause.trial.candidate;
        (here && other && best.score > cause.score).then(|| best.fit.model.clone())
    })
}

impl<'a, 'e> Search<'a, 'e> {
    /// The best account of the gap.
    pub fn account(&self) -> Account<'a, 'e> {
        let mut account = self.chosen();
        account.standings = self.ordered(&account.rounds, &account.last.fit.model);
        for _ in 0..RENAMINGS {
            let Some(model) = renamed(&account.standings) else { break };
            account.last = self.state(model);
            account.standings = self.ordered(&account.rounds, &account.last.fit.model);
        }
        // What is told is what a mended twin can hold.
        while let Some(model) = account.last.fit.without_pushing() {
            account.last = self.state(model);
        }
        account
    }

    fn chosen(&self) -> Account<'a, 'e> {
        let (twin, settings) = (self.fit.twin, self.settings);
        let mut best = self.searched(Model::of(twin), false);
        if best.worst(self) >= SYSTEMATIC
            && let Some(other) = self.otherwise(&best)
        {
            best = self.better(best, other);
        }
        match settings.mass_error > 0.0 && self.may_be_masses(&best) {
            true => {
                self.with_masses(best, self.searched(Model::of_uncertain(twin, settings), true))
            }
            false => best,
        }
    }

    fn searched(&self, model: Model, uncertain: bool) -> Account<'a, 'e> {
        let start = self.state(model.clone());
        let (rounds, model) = self.run(model);
        let last = self.state(model);
        Account { start, rounds, standings: vec![], last, uncertain, notes: vec![] }
    }

    /// The search without the first cause that acts on several joints, from its best rival: a load
    /// for a gain of all currents, say.
    fn otherwise(&self, account: &Account<'a, 'e>) -> Option<Account<'a, 'e>> {
        let several = |c: Candidate| c.extent() == Extent::Several;
        let found = |r: &Round<'a, 'e>| r.accepted.map(|i| r.ranked[i].trial.candidate);
        let round = account.rounds.iter().find(|r| found(r).is_some_and(several))?;
        let mine = found(round)?;
        let rival = round.ranked.iter().find(|h| {
            let candidate = h.trial.candidate;
            let usable = h.at_bound.is_none() && h.gain_check >= LEAST_NATS;
            several(candidate) && candidate.name() != mine.name() && usable
        })?;
        let mut aside = self.clone();
        aside.candidates.retain(|c| *c != mine);
        let model = account.start.fit.model.clone();
        let mut other = aside.searched(model.with(rival.trial.term()), account.uncertain);
        other.start = self.state(model);
        other.rounds.splice(0..0, account.rounds.first().cloned());
        Some(other)
    }

    /// The one with the higher score; what the other says is noted.
    fn better(&self, one: Account<'a, 'e>, other: Account<'a, 'e>) -> Account<'a, 'e> {
        let share = effective_shares(&one.last.fit.system.residual);
        let scores = [&one, &other].map(|a| self.log_evidence(&a.start, &a.last, &share));
        let (mut best, next, lead) = match scores[0] >= scores[1] {
            true => (one, other, scores[0] - scores[1]),
            false => (other, one, scores[1] - scores[0]),
        };
        let as_well = lead < LEAST_NATS.max(COMPETES * scores[0].max(scores[1]));
        let verdict = if as_well { "as well: these data do not decide" } else { "less well" };
        best.notes.push(format!(
            "another account, {}, does {verdict} ({lead:.0} nats less)",
            next.names()
        ));
        best
    }

    /// Every cause of the model among its rivals, what takes most off the gap first. A single one
    /// stands as it was found.
    fn ordered(&self, rounds: &[Round<'a, 'e>], model: &Model) -> Vec<Standing<'a, 'e>> {
        let first = rounds.first().and_then(|r| r.accepted.map(|i| (r, i)));
        if let (Some((round, index)), [only]) = (first, &model.causes[..])
            && round.ranked[index].fit.model.causes[0] == *only
        {
            let (ranked, tolerance) = (round.ranked.clone(), round.tolerance);
            let without = self.state(model.without(&[0]));
            return vec![Standing { ranked, index, tolerance, without }];
        }
        let mut standings = self.standings(model);
        standings.sort_by(|a, b| b.shrinks().total_cmp(&a.shrinks()));
        standings
    }
}
