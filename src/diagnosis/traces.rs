//! What a diagnosis rests on, sample by sample: the check recording, before and after the causes.

use super::candidate::Term;
use super::findings::Findings;
use super::fit::Fit;
use super::observed::Observed;
use super::regimes::{conditions, transmitted};
use super::{Diagnosis, Floor, mend};
use crate::effects::{Effect, Scope, find};
use crate::regression::Blocks;
use crate::series::JointSeries;
use crate::signals::Samples;
use crate::twin::Twin;

/// Signals at the rows that were judged: sliding, usable, decimated.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Traces {
    /// Time of the first sample in the recording, s.
    pub start: f64,
    /// Time between neighbouring rows, s; where rows are further apart a stretch is left out.
    pub step: f64,
    /// Joints from base to wrist.
    pub joints: Vec<JointTraces>,
}

/// One value per row. Torques in N.m, low-passed as the search has them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointTraces {
    /// From 1 at the base.
    pub joint: usize,
    /// Time in the recording, s.
    pub time: Vec<f64>,
    /// rad
    pub position: Vec<f64>,
    /// rad/s
    pub velocity: Vec<f64>,
    /// What the gear transmits according to the twin, N.m.
    pub load: Vec<f64>,
    /// Time since sliding began against the direction before, s; NaN before the first reversal.
    pub since_reversal: Vec<f64>,
    /// Recorded torque.
    pub torque: Vec<f64>,
    /// What it takes to move the masses the mended twin knows of.
    pub masses: Vec<f64>,
    /// Recorded less the twin's torque, without and with the causes.
    pub before: Vec<f64>,
    pub after: Vec<f64>,
    pub regimes: Vec<Held>,
    /// Where an accepted contact touches; empty without one.
    pub contact: Vec<bool>,
}

/// Where a regime holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Held {
    pub regime: &'static str,
    pub rows: Vec<bool>,
}

impl JointTraces {
    /// Recorded torque less what moves the masses: friction, and what is not modelled.
    pub fn friction(&self) -> Vec<f64> {
        self.torque.iter().zip(&self.masses).map(|(t, m)| t - m).collect()
    }

    /// Friction of a twin that leaves `residual`, N.m.
    pub fn friction_of(&self, residual: &[f64]) -> Vec<f64> {
        self.friction().iter().zip(residual).map(|(f, r)| f - r).collect()
    }

    /// The rows where a regime holds; none where the recording does not hold it.
    pub fn held(&self, regime: &str) -> Option<&[bool]> {
        self.regimes.iter().find(|h| h.regime == regime).map(|h| &*h.rows)
    }
}

impl Traces {
    /// `answer` is what the findings say.
    pub(super) fn new(findings: &Findings<'_>, answer: &Diagnosis) -> Self {
        let check: &Observed<'_> = findings.check;
        let (start, after) = (&findings.held.before, &findings.held.after);
        let mended = mend(check.twin, &answer.fitted, &answer.changes());
        let made = Made {
            check,
            load: transmitted(check.samples, check.twin),
            masses: masses(&mended).torque(&check.twin.motion(check.samples)),
            before: check.over_time(start),
            blocks: [start, after],
            contact: contact(check, &findings.last),
        };
        let samples = check.samples;
        Self {
            start: samples.start,
            step: samples.decimation() as f64 * samples.dt,
            joints: (0..check.joints()).map(|j| made.joint(j, &findings.floor[j])).collect(),
        }
    }
}

/// The twin without what acts in its joints, rotors excepted.
fn masses(twin: &Twin) -> Twin {
    let mut bare = twin.clone();
    let heavy = |e: &dyn Effect| e.stands_for().is_some() || e.about().scope != Scope::Joint;
    bare.effects.retain(|name| find(name).is_some_and(heavy));
    bare
}

/// True where a contact among the causes touches.
fn contact(check: &Observed<'_>, fit: &Fit<'_>) -> Vec<bool> {
    let mut touches = Vec::new();
    let causes = fit.model.causes.iter();
    let here = |t: &&Term| t.candidate.is_in(check.index);
    for term in causes.filter(|t| t.candidate.effect.lasts_a_while()).filter(here) {
        touches.resize(check.samples.len(), false);
        touches.iter_mut().zip(acts(check, term)).for_each(|(t, acts)| *t |= acts);
    }
    touches
}

/// True where what lasts a while acts.
pub fn acts(on: &Observed<'_>, term: &Term) -> Vec<bool> {
    let motion = on.motion(&on.twin.robot);
    let mut acts = vec![false; on.samples.len()];
    for column in term.candidate.effect.reach(&motion, 0, &term.nonlinear) {
        for joint in 0..column.joints() {
            acts.iter_mut().zip(column.joint(joint)).for_each(|(t, c)| *t |= *c != 0.0);
        }
    }
    acts
}

/// Series over all samples, from which the rows are taken.
struct Made<'a, 'e> {
    check: &'a Observed<'e>,
    load: JointSeries,
    masses: JointSeries,
    before: JointSeries,
    blocks: [&'a Blocks; 2],
    contact: Vec<bool>,
}

impl Made<'_, '_> {
    fn joint(&self, j: usize, floor: &Floor) -> JointTraces {
        let (check, samples) = (self.check, self.check.samples);
        let rows = &check.rows[j];
        let at = |series: &[f64]| -> Vec<f64> { rows.iter().map(|&k| series[k]).collect() };
        let held = |mask: &[bool]| -> Vec<bool> { rows.iter().map(|&k| mask[k]).collect() };
        let mut mask = vec![false; samples.len()];
        rows.iter().for_each(|&k| mask[k] = true);
        let load = self.load.joint(j);
        let regimes = conditions(samples, j, &mask, load, self.before.joint(j), floor);
        JointTraces {
            joint: j + 1,
            time: rows.iter().map(|&k| samples.time(k)).collect(),
            position: at(samples.q.joint(j)),
            velocity: at(samples.qd.joint(j)),
            load: at(load),
            since_reversal: at(&since_reversal(samples, j)),
            torque: check.in_full(j, check.torque.joint(j)),
            masses: check.filtered(j, self.masses.joint(j)),
            before: check.in_full(j, self.blocks[0].joint(j)),
            after: check.in_full(j, self.blocks[1].joint(j)),
            regimes: regimes
                .iter()
                .filter(|c| c.part.is_none())
                .map(|c| Held { regime: c.regime, rows: held(&c.holds) })
                .filter(|h| h.rows.contains(&true))
                .collect(),
            contact: if self.contact.is_empty() { Vec::new() } else { held(&self.contact) },
        }
    }
}

/// Seconds since a joint began to slide against its direction before; NaN before that.
fn since_reversal(samples: &Samples, joint: usize) -> Vec<f64> {
    let threshold = samples.conditioning.standstill_rad_s.max(1e-6);
    let (mut direction, mut since) = (0.0, f64::NAN);
    let step = |qd: &f64| {
        since += samples.dt;
        if qd.abs() > threshold {
            if qd * direction < 0.0 {
                since = 0.0;
            }
            direction = qd.signum();
        }
        since
    };
    samples.qd.joint(joint).iter().map(step).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::signals::testing::samples;

    #[test]
    fn time_starts_at_every_reversal() {
        let made = samples(1, 4000, |_, t| (TAU * t / 4.0).sin());
        let since = since_reversal(&made, 0);
        let rate = made.rate_hz();
        let at = |t: f64| since[(t * rate).round() as usize];
        assert!(at(0.9).is_nan(), "no reversal yet");
        // The velocity changes sign at 1 s, 3 s, ...; sliding begins a little later.
        for (t, expected) in [(2.0, 1.0), (2.9, 1.9), (4.0, 1.0)] {
            assert!((at(t) - expected).abs() < 0.05, "{t}: {}", at(t));
        }
    }

    #[test]
    fn only_what_weighs_is_left() {
        let effects = ["coulomb", "payload", "rotor_inertia"].map(String::from).into();
        let twin = Twin { effects, ..Twin::default() };
        assert_eq!(masses(&twin).effects, ["payload", "rotor_inertia"]);
    }
}
