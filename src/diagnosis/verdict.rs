//! From the search to the answer.

use std::collections::BTreeMap;

use super::account::Account;
use super::candidate::Place;
use super::colour::Colour;
use super::columns::Blocks;
use super::episodes::{Episode, episodes};
use super::evidence::Evidence;
use super::kinematics::{self, Lagging};
use super::leftover::{Remains, SYSTEMATIC, leftover};
use super::model::Fit;
use super::rank::{Hypothesis, State, acts_on};
use super::revise::Standing;
use super::rivals::{equivalents, named as name_of, ranked_with, share_of};
use super::select::{Round, Search};
use super::untestable::untestable;
use super::{
    BeforeAfter, Cause, Diagnosis, Floor, Rejected, RoundEvidence, Scored, Settings, Shrink,
    Verdict, experiment, gap, intervals, probability, torque_shrink,
};
use crate::effects::Role;
use crate::series::JointSeries;

/// Candidates of a round that are written down.
const SHOWN: usize = 12;
const SCHEMA: &str = "armtwin.diagnosis/1";
/// More than this for "unknown" and no cause is named.
pub const ABSTAIN: f64 = 0.5;

/// Causes at one joint from which on something unknown is likelier.
const MOST_AT_A_JOINT: usize = 3;
/// Of "unknown" where the causes rather stand in for something else.
const STANDS_IN: f64 = 0.8;
/// Of "unknown" where velocities lag and the catalogue may not say so.
const UNEXPLAINED_LAG: f64 = 0.8;

/// Everything an answer is made from.
pub struct Findings<'a, 'e> {
    pub search: &'a Search<'a, 'e>,
    pub account: Account<'a, 'e>,
    pub floor: Vec<Floor>,
    /// Of both recordings, where the arm moves.
    pub noise: Colour,
    /// Recorded velocities that lag.
    pub lagging: Option<Lagging>,
}

impl<'a, 'e> Findings<'a, 'e> {
    pub fn new(search: &'a Search<'a, 'e>, floor: &[Floor]) -> Self {
        let lagging = kinematics::lagging(search.fit, search.check, search.settings);
        let account = search.account();
        let left = &account.last;
        let noise = search.colours.of(&left.fit.system.residual, &left.residual);
        let floor = floor.iter().map(|f| f.with(noise)).collect();
        Self { search, account, floor, noise, lagging }
    }

    pub fn settings(&self) -> &Settings {
        self.search.settings
    }

    pub fn accepted(&self) -> Vec<&Hypothesis<'a, 'e>> {
        self.account.accepted()
    }

    /// The joints that any of the causes acts on.
    fn touched(&self) -> Vec<usize> {
        let acts = |j: &usize| self.accepted().iter().any(|h| acts_on(h.trial.candidate, *j));
        (0..self.search.fit.joints()).filter(acts).collect()
    }

    /// Do so many causes sit at one joint that they rather stand in for something unknown?
    fn is_crowded(&self) -> bool {
        let at = |j: usize| {
            let here = |h: &&Hypothesis| h.trial.candidate.place == Place::Joint(j);
            self.accepted().iter().filter(|h| here(h)).count()
        };
        (0..self.search.fit.joints()).any(|j| at(j) >= MOST_AT_A_JOINT)
    }

    /// The strongest cause and what does better in its place, yet cannot be named itself: at the end of
    /// its range, or not in all it says.
    pub fn outdone(&self) -> Option<[&Hypothesis<'a, 'e>; 2]> {
        let standing = self.account.standings.first()?;
        let (cause, best) = (standing.cause(), standing.ranked.first()?);
        (best.score > cause.score + standing.tolerance).then_some([cause, best])
    }

    /// What the gap comes to, and what a state leaves of it.
    fn remains(&self, state: &State) -> Remains {
        let residuals = [&self.account.start.residual, &state.residual];
        Remains::new(self.search.check, residuals, self.noise, state.fit.answered())
    }

    pub fn answer(&self) -> Diagnosis {
        let accepted = self.accepted();
        let remains = self.remains(&self.account.last);
        let start = self.remains(&self.account.start);
        let quiet = start.were_quiet();
        let unknown = match accepted.is_empty() {
            true => probability::of_something(&remains),
            false if self.is_crowded() || self.outdone().is_some() => STANDS_IN,
            false => probability::of_unknown(&remains, &self.touched()),
        };
        let named = !accepted.is_empty() && unknown <= ABSTAIN;
        // What cannot be named where nothing stands out is no gap.
        let unknown = match !named && quiet {
            true => probability::of_something(&start),
            false => unknown,
        };
        let mut causes = if named { self.causes(unknown) } else { Vec::new() };
        let lag = self.lagging.as_ref().and_then(|l| l.cause(self.settings()));
        let unknown = match (&self.lagging, &lag) {
            (Some(_), None) if !named => unknown.max(UNEXPLAINED_LAG),
            _ => unknown,
        };
        let sensor_alone = lag.is_some() && accepted.is_empty();
        causes.extend(lag);
        let left = leftover(if named { &remains } else { &start });
        Diagnosis {
            schema: SCHEMA.into(),
            armtwin: env!("CARGO_PKG_VERSION").into(),
            verdict: self.verdict(named || sensor_alone, quiet, &remains),
            fitted_before: self.fitted(&self.account.start.fit),
            fitted: self.fitted(if named {
                &self.account.last.fit
            } else {
                &self.account.start.fit
            }),
            gap: self.gap(),
            shrink: Shrink { torque: self.shrink(named), simulation: None },
            ranking: ranked_with(
                &causes[..usize::from(sensor_alone)],
                self.ranking(unknown, named || !quiet),
            ),
            untestable: untestable(&self.account.last.fit, &self.search.candidates),
            rejected: self.rejected(),
            leftover: left,
            next_experiment: self.next_experiment(),
            episodes: self.episodes(named),
            rounds: self.evidence(),
            notes: self.notes(&remains, unknown),
            causes,
        }
    }

    fn episodes(&self, named: bool) -> Vec<Episode> {
        let state = if named { &self.account.last } else { &self.account.start };
        let (fit, check) = (&state.fit.system.residual, &state.residual);
        episodes((self.search.fit, fit), (self.search.check, check))
    }

    /// For the two that most need telling apart.
    fn next_experiment(&self) -> String {
        match self.rivals() {
            Some([a, b]) if a.score > 0.0 && b.score > 0.0 => {
                experiment::next(self.search.check, &self.floor, [a, b], self.settings())
            }
            _ => String::new(),
        }
    }

    /// A cause and what looks the same, else the cause that takes most off and its best rival; where
    /// nothing was accepted the best two of the search.
    fn rivals(&self) -> Option<[&Hypothesis<'a, 'e>; 2]> {
        let other = |standing: &'_ Standing<'a, 'e>| {
            let mine = standing.cause().trial.candidate;
            let usable = |h: &Hypothesis| {
                let other = h.trial.candidate;
                other != mine && other.extent().meets(mine.extent()) && h.at_bound.is_none()
            };
            standing.ranked.iter().position(usable)
        };
        let pair = |s: &'_ Standing<'a, 'e>| other(s).map(|i| (i, equivalents(s).is_empty()));
        let standings = &self.account.standings;
        let open = standings.iter().find(|s| pair(s).is_some_and(|(_, decided)| !decided));
        if let Some(standing) = open.or(standings.first()) {
            return Some([standing.cause(), &standing.ranked[other(standing)?]]);
        }
        let ranked = &self.account.rounds.first()?.ranked;
        let mut best = ranked.iter().filter(|h| h.at_bound.is_none());
        Some([best.next()?, best.next()?])
    }

    fn verdict(&self, named: bool, quiet: bool, remains: &Remains) -> Verdict {
        let systematic = remains.after.iter().any(|r| *r > SYSTEMATIC);
        let left = systematic || remains.loud(&remains.chi2_per_sample).next().is_some();
        match (named, left) {
            (true, false) => Verdict::Explained,
            (true, true) => Verdict::PartlyExplained,
            (false, _) if quiet && self.lagging.is_none() => Verdict::NoGap,
            _ => Verdict::Unexplained,
        }
    }

    fn causes(&self, unknown: f64) -> Vec<Cause> {
        let values = intervals::values(
            &self.account.last.fit,
            self.search.check,
            &self.account.last.residual,
        );
        let of = |h: &Hypothesis| {
            let causes = &self.account.last.fit.model.causes;
            let place = causes.iter().position(|t| t.candidate == h.trial.candidate);
            place.map_or_else(Vec::new, |i| values[i].clone())
        };
        let cause = |standing: &Standing<'a, 'e>| {
            let h = standing.cause();
            let about = h.trial.candidate.effect.about();
            let before = &standing.without.residual;
            Cause {
                effect: about.name.into(),
                joints: h.trial.candidate.place.joints(),
                probability: (1.0 - unknown) * share_of(standing),
                equivalent: equivalents(standing),
                parameters: of(h),
                shrink: self.pair(before, &h.residual, |pair| pair.checked(self.settings().seed)),
                cause: about.cause.into(),
                remedy: about.remedy.into(),
            }
        };
        self.account.standings.iter().map(cause).collect()
    }

    fn rejected(&self) -> Vec<Rejected> {
        let first = self.account.rounds.iter().take(1).flat_map(|r| r.ranked.iter());
        let bound = first.filter_map(|h| {
            let parameter = h.at_bound?;
            Some(Rejected {
                effect: h.trial.candidate.name().into(),
                joints: h.trial.candidate.place.joints(),
                why: format!("fits only with {parameter} at its bound"),
            })
        });
        bound.collect()
    }

    /// Values of the twin's open effects, and of link masses that were fitted along, one per joint.
    fn fitted(&self, fit: &Fit<'a, 'e>) -> BTreeMap<String, Vec<f64>> {
        let mut values: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        let known = &fit.evidence.twin.values;
        let mut next = 0;
        for term in &fit.model.open {
            let mut nonlinear = term.nonlinear.iter();
            let at = if let Place::Joint(j) = term.candidate.place { j } else { 0 };
            let parameters = term.candidate.effect.about().parameters.iter();
            for p in parameters.filter(|p| !p.is_reference()) {
                let count = match term.candidate.place {
                    Place::Joint(_) => fit.evidence.joints(),
                    Place::Arm => 1,
                };
                let row = values.entry(p.name.into()).or_insert_with(|| vec![p.null; count]);
                row[at] = match p.role {
                    Role::Linear => {
                        next += 1;
                        // What is fitted along corrects what is known.
                        let before = known.get(p.name).and_then(|v| v.get(at)).unwrap_or(&0.0);
                        before + fit.system.x[next - 1]
                    }
                    Role::Nonlinear => nonlinear.next().copied().unwrap_or(p.typical),
                };
            }
        }
        values
    }

    fn gap(&self) -> super::Gap {
        let check = self.search.check;
        let residual = check.over_time(&self.account.start.residual);
        let masks = check.masks();
        gap(check.samples, check.twin, &residual, &masks, &self.floor, self.settings().seed)
    }

    fn shrink(&self, named: bool) -> super::TorqueShrink {
        let after = if named { &self.account.last.residual } else { &self.account.start.residual };
        let floor: Vec<f64> = self.floor.iter().map(|f| f.noise_nm).collect();
        let seed = self.settings().seed;
        self.pair(&self.account.start.residual, after, |pair| torque_shrink(pair, &floor, seed))
    }

    fn pair<T>(&self, before: &Blocks, after: &Blocks, with: impl Fn(&BeforeAfter) -> T) -> T {
        let check: &Evidence = self.search.check;
        let series: [JointSeries; 2] = [check.over_time(before), check.over_time(after)];
        let masks = check.masks();
        let [before, after] = &series;
        with(&BeforeAfter { samples: check.samples, before, after, masks: &masks })
    }

    fn evidence(&self) -> Vec<RoundEvidence> {
        let scored = |h: &Hypothesis| Scored {
            effect: h.trial.candidate.name().into(),
            joints: h.trial.candidate.place.joints(),
            score: h.score,
            gain_fit: h.gain_fit,
            gain_check: h.gain_check,
            at_bound: h.at_bound.map(Into::into),
            values: h.fit.values(h.fit.model.causes.len() - 1),
        };
        let round = |r: &Round| RoundEvidence {
            p: r.p,
            in_motion_band: r.in_motion_band.clone(),
            accepted: r.accepted.map(|i| name_of(&r.ranked[i])),
            declined: r.declined.clone(),
            ranked: r.ranked.iter().take(SHOWN).map(scored).collect(),
        };
        self.account.rounds.iter().map(round).collect()
    }
}
