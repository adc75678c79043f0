//! From the search to the answer.

use std::collections::BTreeMap;

use super::answer::{Replaced, Unexplained};
use super::beyond::with_what_is_beyond;
use super::blind::Blind;
use super::called::{Called, called};
use super::candidate::{Candidate, Place, Term};
use super::criteria::Criteria;
use super::episodes::{Episode, episodes};
use super::findings::Findings;
use super::fit::Fit;
use super::held_out::{self, HeldOut};
use super::hypotheses::{Hypotheses, Standing};
use super::judge::Judge;
use super::kinematics::{self, Lagging};
use super::link_masses::Within;
use super::model::Model;
use super::observed::Observed;
use super::proved::{SURE, proved};
use super::ranking::{self, named};
use super::search::{Found, Round, Weighed};
use super::sizes::Sizes;
use super::smoothing;
use super::unexplained::{Left, unexplained};
use super::untestable::untestable;
use super::{
    By, Cause, Change, Checked, Diagnosis, DiagnosisError, Floor, Proof, Ranked, Rejected,
    RoundEvidence, Scored, Settings, Shrink, Value, Verdict, curve, experiment, gap, intervals,
    links, slow, torque_shrink, words,
};
use crate::effects::Role;

const SCHEMA: &str = "armtwin.diagnosis/1";

impl<'a> Findings<'a> {
    /// First what a search of both recordings finds, then what one of the fit recording alone does.
    pub fn new(
        (both, found): (&'a Hypotheses<'a>, Found<'a>),
        (blind, alone): (&'a Hypotheses<'a>, Found<'a>),
        judge: Judge<'_>,
        [fit, check]: [&'a Observed<'a>; 2],
        floor: Vec<Floor>,
        settings: &'a Settings,
        proof: Option<&mut Proof<'_>>,
    ) -> Result<Self, DiagnosisError> {
        let lagging = kinematics::lagging(fit, check, settings);
        let freed = |(alone, found): (Found<'a>, Found<'a>)| {
            (with_what_is_beyond(blind, alone), with_what_is_beyond(both, found))
        };
        let seen = |searches: (Found<'a>, Found<'a>)| {
            let (alone, found) = freed(searches);
            let held = HeldOut::new(&alone.last, check);
            let called = called(both, &judge, &found, &Blind::new(blind, &alone));
            (found, held, called)
        };
        let (found, held, called) = match proof {
            Some(proof) => {
                let (alone, found) = freed((alone, found));
                let called = proved(both, &judge, [&found, &alone], proof)?;
                (found, HeldOut::new(&alone.last, check), called)
            }
            None => {
                // So many values are for both searches to ask for: where one does not, the other need not.
                let asked = links::with_links(both, &found);
                let asked = asked.and_then(|both| Some((links::with_links(blind, &alone)?, both)));
                // Links that do not stand on the check recording must not have driven out what would.
                let links = asked.map(seen).filter(|(_, _, c)| links::stand(&c.fit));
                links.unwrap_or_else(|| seen((alone, found)))
            }
        };
        let Called { fit: last, standings, gains, unconfirmed, equals } = called;
        let alone = Fit::plain(blind.data, Model::of(fit.twin));
        Ok(Self {
            search: both,
            found,
            last,
            standings,
            gains,
            unconfirmed,
            equals,
            held,
            fit,
            check,
            alone,
            floor,
            lagging,
            settings,
        })
    }

    fn criteria(&self) -> &Criteria {
        &self.search.criteria
    }

    pub fn answer(&self) -> Diagnosis {
        let [causes, mut adjustments] = self.causes();
        let within = Within::new(&self.last);
        let mut notes = self.notes(&adjustments);
        let [mut causes, laws] = match self.equals {
            Some(_) => [causes, Vec::new()],
            None => curve::one_of_each(causes),
        };
        notes.extend(laws.iter().map(words::law));
        adjustments.extend(laws);
        if let Some(within) = &within {
            notes.extend(within.says(&self.last, self.settings));
            adjustments.extend(within.adjustments());
        }
        let lag = self.lagging.as_ref().and_then(|l| l.cause(self.settings));
        let sensor_alone = lag.is_some() && causes.is_empty();
        causes.extend(lag);
        let unexplained = self.unexplained();
        let ranking = ranking::ranking(self);
        let verdict = self.verdict(&causes, &unexplained, &ranking);
        let ranking = ranking::with_sensor(&causes[..usize::from(sensor_alone)], ranking);
        Diagnosis {
            schema: SCHEMA.into(),
            armtwin: env!("CARGO_PKG_VERSION").into(),
            by: By::default(),
            position: None,
            verdict,
            fitted_before: fitted(&self.alone, vec![]),
            fitted: fitted(&self.last, within.map_or(vec![], |w| w.scales())),
            gap: self.gap(),
            shrink: Shrink { torque: self.shrink(), simulation: None },
            ranking,
            untestable: untestable(&self.last, &self.search.candidates),
            rejected: self.rejected(),
            unexplained,
            next_experiment: self.next_experiment(),
            episodes: self.episodes(),
            rounds: self.found.rounds.iter().map(round).collect(),
            criteria: *self.criteria(),
            notes,
            causes,
            adjustments,
        }
    }

    fn verdict(&self, causes: &[Cause], left: &Unexplained, ranking: &[Ranked]) -> Verdict {
        match Verdict::of(causes, left, ranking) {
            Verdict::NoGap if self.lagging.is_some() => Verdict::Unexplained,
            verdict => verdict,
        }
    }

    /// What is named, and what helps the twin and is not named: the intervals of its values hold that it is
    /// absent, or the fit recording alone does not show it.
    fn causes(&self) -> [Vec<Cause>; 2] {
        let values = slow::values(&self.last);
        // Slow torque may say that nothing is there.
        let inside = |i: &usize| values[*i].first().is_none_or(|v| !v.at_bound);
        let effect = |i: usize| self.last.model.causes[i].candidate.effect;
        let absent = |i: &usize| {
            let unconfirmed = self.unconfirmed.contains(&self.last.model.causes[*i].candidate);
            let none = || intervals::may_all_be_none(&self.last, *i);
            unconfirmed || intervals::may_be_absent(effect(*i), &values[*i]) && none()
        };
        let all = 0..self.standings.len();
        let (unsure, sure): (Vec<usize>, Vec<usize>) = match self.equals {
            Some(_) => (Vec::new(), all.collect()),
            None => all.filter(inside).partition(absent),
        };
        [sure, unsure].map(|some| {
            let mut all: Vec<Cause> = some.iter().map(|i| self.cause(*i, &values[*i])).collect();
            all.sort_by(|a, b| taken(&b.shrink).total_cmp(&taken(&a.shrink)));
            all
        })
    }

    fn cause(&self, i: usize, values: &[Value]) -> Cause {
        let standing = &self.standings[i];
        let candidate = self.last.model.causes[i].candidate;
        let about = candidate.effect.about();
        let twin = self.check.twin;
        let stated = candidate.stated(twin);
        let Change { joints, parameters, .. } = Change::of(candidate, values, twin);
        let replaces = stated
            .first()
            .map(|has| Replaced { parameter: about.parameters[0].name.into(), twin: *has });
        Cause {
            effect: about.name.into(),
            joints,
            probability: self.probability(i),
            equivalent: match &self.equals {
                Some(equals) => equals[i].iter().copied().map(named).collect(),
                None => ranking::equivalents(standing, &self.gains[i], self.criteria()),
            },
            parameters,
            shrink: self.gains[i].shrink,
            replaces,
            recording: candidate
                .recording
                .or((!self.gains[i].acts).then_some(0))
                .map(|r| ["fit", "check"][r.min(1)].into()),
            found_without_check: self.held.causes.contains(&candidate),
            cause: about.cause.into(),
            remedy: links::remedy(candidate).unwrap_or(about.remedy).into(),
        }
    }

    fn probability(&self, i: usize) -> f64 {
        let probability = match self.equals {
            Some(_) => SURE,
            None => ranking::probability(&self.standings[i], &self.gains[i], self.criteria()),
        };
        let candidate = self.last.model.causes[i].candidate;
        ranking::replicated(probability, candidate, &self.gains[i], self.criteria())
    }

    /// What a model leaves of both recordings within tolerances of this size, values from the fit recording, N.m.
    fn left(&self, model: &Model, tolerances: u8) -> [Left<'_>; 2] {
        let data = self.alone.data;
        let fit = Fit::new(data, model.clone(), Sizes { tolerances, ..data.nothing() });
        [self.fit, self.check]
            .map(|observed| Left { observed, residual: fit.held_within(observed) })
    }

    /// What the causes leave that both searches find, values from the fit recording.
    fn unexplained(&self) -> Unexplained {
        let is_open = |t: &Term| self.unconfirmed.contains(&t.candidate);
        let mut explained = self.last.clone();
        while let Some(i) = explained.model.causes.iter().position(is_open) {
            explained = self.search.without(&explained, i);
        }
        let of = |tolerances: u8| self.left(&explained.model, tolerances);
        let (left, within) = (of(0), of(explained.sizes.tolerances));
        // Links and scales that fit one recording and not the other hold nothing.
        let helps = within[1].mean_square() < left[1].mean_square();
        let before = Left { observed: self.check, residual: self.held.before.clone() };
        let within = helps.then_some(&within);
        unexplained(&left, within, &before, &self.floor, &explained, self.criteria())
    }

    fn rejected(&self) -> Vec<Rejected> {
        let first = self.found.rounds.first();
        let weighed = first.iter().flat_map(|r| &r.weighed);
        let bound = weighed.filter_map(|w| {
            let parameter = w.at_bound?;
            let why = format!("fits only with {parameter} at its bound");
            let (effect, joints) = (w.candidate.name().into(), w.candidate.place.joints());
            Some(Rejected { effect, joints, why })
        });
        bound.collect()
    }

    fn gap(&self) -> super::Gap {
        let check = self.check;
        let residual = check.over_time(&self.held.before);
        let masks = check.masks();
        gap(check.samples, check.twin, &residual, &masks, &self.floor, self.settings.seed)
    }

    fn shrink(&self) -> super::TorqueShrink {
        let floor: Vec<f64> = self.floor.iter().map(|f| f.noise_nm).collect();
        let HeldOut { before, after, .. } = &self.held;
        let seed = self.settings.seed;
        held_out::pair(self.check, before, after, |pair| torque_shrink(pair, &floor, seed))
    }

    fn episodes(&self) -> Vec<Episode> {
        let left = self.left(&self.last.model, 0);
        let [fit, check] = left.each_ref().map(|l| (l.observed, &l.residual));
        episodes(fit, check)
    }

    /// The next experiment, for the cause that is least told from its best rival.
    fn next_experiment(&self) -> String {
        let rival = |s: &'_ Standing<'a>| {
            let own = named(s.cause().candidate());
            let usable = |i: &usize| {
                let h = &s.ranked[*i];
                h.at_bound.is_none() && named(h.candidate()) != own
            };
            (0..s.ranked.len()).find(usable)
        };
        let lead = |s: &&Standing<'a>| {
            rival(s).map_or(f64::INFINITY, |r| s.cause().nats - s.ranked[r].nats)
        };
        let closest = self.standings.iter().min_by(|a, b| lead(a).total_cmp(&lead(b)));
        match closest.and_then(|s| Some([s.cause(), &s.ranked[rival(s)?]])) {
            Some(pair) if pair[1].nats > 0.0 => {
                experiment::next(self.check, &self.floor, pair, self.settings)
            }
            _ => String::new(),
        }
    }

    fn why_unnamed(&self, adjustment: &Cause) -> &'static str {
        let is_this =
            |c: &Candidate| c.name() == adjustment.effect && c.place.joints() == adjustment.joints;
        match self.unconfirmed.iter().any(is_this) {
            true => "both recordings together show it, the fit recording alone does not",
            false => "its interval holds that there is nothing",
        }
    }

    fn notes(&self, adjustments: &[Cause]) -> Vec<String> {
        let mut notes: Vec<String> = self.lagging.iter().map(Lagging::says).collect();
        notes.extend(adjustments.iter().map(|a| words::adjustment(a, self.why_unnamed(a))));
        let sureness = [&self.fit.sureness, &self.check.sureness];
        let cutoff_hz = self.fit.samples.conditioning.motion_cutoff_hz;
        notes.extend(words::kinks(&smoothing::kinked(&sureness), cutoff_hz));
        let is_equal = |c: &Candidate| self.equals.iter().flatten().flatten().any(|e| e == c);
        let causes = self.found.last.model.causes.iter();
        let dropped =
            causes.filter(|t| !self.last.model.has(t.candidate) && !is_equal(&t.candidate));
        for term in dropped {
            let name = super::candidate::describe(term.candidate);
            notes.push(format!("{name} fits too, but takes nothing sure off the check recording"));
        }
        let blind: Vec<String> = self
            .held
            .causes
            .iter()
            .filter(|c| !self.last.model.has(**c))
            .map(|c| super::candidate::describe(*c))
            .collect();
        if !blind.is_empty() {
            notes.push(format!(
                "a search of the fit recording alone also finds {}",
                blind.join(", ")
            ));
        }
        notes
    }
}

impl Verdict {
    /// What is named, what it leaves, and how probable a discrepancy of any shape is, in one word.
    pub fn of(causes: &[Cause], left: &Unexplained, ranking: &[Ranked]) -> Self {
        match (causes.is_empty(), left.above_noise) {
            (false, false) => Self::Explained,
            (false, true) => Self::PartlyExplained,
            (true, false) if ranking::unknown(ranking) < 0.5 => Self::NoGap,
            (true, _) => Self::Unexplained,
        }
    }
}

/// What a cause takes off the check recording's mean square, (N.m)^2.
fn taken(shrink: &Checked) -> f64 {
    shrink.check_before_nm.powi(2) - shrink.check_after_nm.powi(2)
}

/// Values of the twin's open effects, one per joint, where its torque was recorded times what `scales` says.
fn fitted(fit: &Fit<'_>, scales: Vec<f64>) -> BTreeMap<String, Vec<f64>> {
    let mut values: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    let mut next = 0;
    for term in &fit.model.open {
        let mut nonlinear = term.nonlinear.iter();
        let (at, count) = match term.candidate.place {
            Place::Joint(j) => (j, fit.data.joints()),
            Place::Arm | Place::Links(_) => (0, 1),
        };
        let parameters = term.candidate.effect.about().parameters.iter();
        for p in parameters.filter(|p| !p.is_reference()) {
            let row = values.entry(p.name.into()).or_insert_with(|| vec![p.null; count]);
            row[at] = match p.role {
                Role::Linear => {
                    next += 1;
                    fit.system.x[next - 1] / scales.get(at).unwrap_or(&1.0)
                }
                Role::Nonlinear => nonlinear.next().copied().unwrap_or(p.typical),
            };
        }
    }
    values
}

fn round(round: &Round) -> RoundEvidence {
    let scored = |w: &Weighed| Scored {
        effect: w.candidate.name().into(),
        joints: w.candidate.place.joints(),
        nats: w.nats,
        at_bound: w.at_bound.map(Into::into),
        values: w.values.clone(),
    };
    RoundEvidence {
        added: round.added.iter().map(|c| named(*c)).collect(),
        ranked: round.weighed.iter().map(scored).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_cause_there_is_no_gap_only_where_nothing_is_left() {
        let left = |above_noise| Unexplained {
            rms_nm: 0.1,
            fraction: 1.0,
            above_noise,
            ..Unexplained::default()
        };
        let unknown = |probability| {
            vec![Ranked { effect: "unknown".into(), joints: vec![], probability, nats: 0.0 }]
        };
        assert_eq!(Verdict::of(&[], &left(false), &unknown(0.1)), Verdict::NoGap);
        assert_eq!(Verdict::of(&[], &left(true), &unknown(0.1)), Verdict::Unexplained);
        assert_eq!(Verdict::of(&[], &left(false), &unknown(0.9)), Verdict::Unexplained);
    }
}
