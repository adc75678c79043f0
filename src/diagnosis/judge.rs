//! What a cause takes off the check recording, with values of the fit recording alone.
//!
//! Both are seen in the metric of the model, V = 1 + D R D': the values are not led astray by what is
//! left unexplained, and what they leave counts beside the discrepancy. Of a residual b without the
//! cause and a with it b' V^-1 b - a' V^-1 a is taken off. Where a ~ N(0, s^2 V), its standard deviation
//! is 2 s sqrt(d' V^-1 d), d = b - a. On an exact twin, where there is no discrepancy, these are plain
//! squares.

use super::Checked;
use super::candidate::Candidate;
use super::criteria::Criteria;
use super::data::Data;
use super::fit::Fit;
use super::independent::LEVEL;
use crate::regression::Column;
use crate::statistics::normal_quantile;

/// Values from one recording alone, held against another.
pub struct Judge<'a> {
    pub fit: &'a Data<'a>,
    pub check: &'a Data<'a>,
    pub criteria: Criteria,
}

/// What a cause takes off the check recording.
#[derive(Debug, Clone, Copy)]
pub struct Gain {
    pub shrink: Checked,
    /// Share of what the others leave, at the joint where it is largest: of those where the model is
    /// exact, and of those where a discrepancy is beside it, or more than noise is left.
    pub where_exact: f64,
    pub where_inexact: f64,
    /// Does it act in the check recording at all?
    pub acts: bool,
}

impl Gain {
    /// Is it a law of the arm, seen where no law is exact? Not what acts in one recording alone.
    pub fn needs_replication(&self, candidate: Candidate, criteria: &Criteria) -> bool {
        candidate.recording.is_none() && self.acts && self.where_exact < criteria.least_gain
    }

    /// Has one recording alone something to say of it: what happens once, or a law whose joint moves in no other?
    pub fn is_untried(&self, candidate: Candidate) -> bool {
        candidate.recording.is_some() || !self.acts
    }

    pub fn largest(&self) -> f64 {
        self.where_exact.max(self.where_inexact)
    }
}

impl Judge<'_> {
    /// Gain by cause `i` of a fit to both recordings: what it takes off what the others leave.
    pub fn gain(&self, fit: &Fit<'_>, i: usize) -> Gain {
        let (check, metric) = (self.check, self.check.metric(&fit.sizes));
        let left =
            |fit: &Fit<'_>| Column::new(&check.raw(vec![fit.held_within(check.parts[0])]), &metric);
        let with = Fit::new(self.fit, fit.model.clone(), fit.sizes.clone());
        let without = with.with_tolerances_held(fit.model.without(i));
        let (before, after) = (left(&without), left(&with));
        let mut taken = before.clone();
        taken.add_scaled(-1.0, &after);
        let [b, a, d] = [&before, &after, &taken].map(Column::squares);
        let weights = check.weights(&a);
        let moving = (0..check.joints()).filter(|j| check.rows(*j) > 0);
        let (mut squares, mut off, mut variance) = (0.0, 0.0, 0.0);
        let mut share = [0.0f64; 2];
        for j in moving {
            let counted = check.shares[0][j];
            squares += b[j] / counted;
            off += (b[j] - a[j]) / counted;
            variance += 4.0 * d[j] / (weights[j] * counted.powi(2));
            // What leaves more than noise is not exact either, though nothing smooth is in it.
            let noise = self.check.parts[0].sigma[j].powi(2);
            let loud = a[j] / check.count(j) > self.criteria.above_noise * noise;
            let of = &mut share[usize::from(loud || !fit.is_exact(j))];
            *of = of.max(1.0 - a[j] / b[j].max(f64::MIN_POSITIVE));
        }
        let [where_exact, where_inexact] = share;
        let rows: usize = (0..check.joints()).map(|j| check.rows(j)).sum();
        let half = normal_quantile(1.0 - LEVEL) * variance.sqrt();
        let squares = squares.max(f64::MIN_POSITIVE);
        let rms = |sum: f64| (sum.max(0.0) / rows.max(1) as f64).sqrt();
        let shrink = Checked {
            check_before_nm: rms(squares),
            check_after_nm: rms(squares - off),
            fraction: off / squares,
            low: (off - half) / squares,
            high: ((off + half) / squares).min(1.0),
        };
        Gain { shrink, where_exact, where_inexact, acts: fit.acts_in(i, check.parts[0]) }
    }

    /// Does it, surely and enough? What does not act in the check recording has nothing to show there.
    pub fn agrees(&self, gain: &Gain, candidate: Candidate) -> bool {
        let criteria = &self.criteria;
        let enough = gain.where_exact >= criteria.least_gain
            || gain.where_inexact >= criteria.least_gain_inexact;
        let enough = enough && gain.shrink.low > 0.0;
        candidate.recording.is_some() || !gain.acts || enough
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Settings;
    use crate::diagnosis::candidate::{Place, Term};
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::model::Model;
    use crate::diagnosis::observed::Observed;
    use crate::diagnosis::sizes::Sizes;
    use crate::effects::find;
    use crate::regression::random_effects::STEPS;
    use crate::signals::Samples;
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    const JOINT: usize = 2;
    const OFFSET_NM: f64 = 1.0;
    const NOISE_NM: f64 = 0.5;
    const ROTOR_KG_M2: f64 = 1.0;

    /// An arm whose twin lacks an offset at one joint, and a rotor of so much at the first, kg.m2.
    fn recorded(speed: f64, rotor: f64) -> Samples {
        let twin = Twin::default();
        let mut made = samples(6, 4000, |j, t| 0.6 * ((speed + 0.1 * j as f64) * t).sin());
        made.torque = twin.torque(&twin.motion(&made));
        made.torque.joint_mut(JOINT).iter_mut().for_each(|t| *t += OFFSET_NM);
        let accelerations = made.qdd.joint(0).iter();
        made.torque.joint_mut(0).iter_mut().zip(accelerations).for_each(|(t, a)| *t += rotor * a);
        noisy(&mut made, NOISE_NM);
        made
    }

    /// What an offset at `joint` gains, from one motion to another.
    fn gained(joint: usize) -> Gain {
        gain_of(Candidate::new(find("current_offset").unwrap(), Place::Joint(joint)))
    }

    fn gain_of(offset: Candidate) -> Gain {
        gain_within(0, offset, 0.0)
    }

    /// What `cause` gains beside tolerances of this size, where the arm has a rotor of so much, kg.m2.
    fn gain_within(tolerances: u8, cause: Candidate, rotor: f64) -> Gain {
        let twin = Twin::default();
        let made = [0.9, 1.3].map(|speed| recorded(speed, rotor));
        let floors = made.each_ref().map(|s| noise_floor(s, &twin));
        let [fit, check] = [0, 1].map(|i| Observed::new(i, &twin, &made[i], &floors[i]).unwrap());
        let settings = Settings::default();
        let [alone, other, both] =
            [vec![&fit], vec![&check], vec![&fit, &check]].map(|parts| Data::new(parts, &settings));
        let model = Model::of(&twin).with(Term::new(cause, vec![]));
        let sizes = Sizes { tolerances, ..both.nothing() };
        let criteria = settings.criteria;
        Judge { fit: &alone, check: &other, criteria }.gain(&Fit::new(&both, model, sizes), 0)
    }

    #[test]
    fn what_is_there_takes_off_what_it_is() {
        let gain = gained(JOINT);
        let Checked { check_before_nm: before, check_after_nm: after, low, high, fraction } =
            gain.shrink;
        // Over all six joints, of which one has it.
        let taken = 6.0 * (before.powi(2) - after.powi(2));
        assert!((taken / OFFSET_NM.powi(2) - 1.0).abs() < 0.1, "{taken}");
        assert!(low > 0.0 && low < fraction && fraction < high, "{low} {fraction} {high}");
        assert!(gain.acts && gain.where_exact > 0.5, "{gain:?}");
    }

    /// The scale of the torque of a joint that carries nothing could stand for its rotor, were it not known.
    #[test]
    fn what_the_twin_states_within_limits_stands_for_no_cause() {
        let rotor = Candidate::new(find("rotor_inertia").unwrap(), Place::Joint(0));
        let gain = |tolerances| gain_within(tolerances, rotor, ROTOR_KG_M2).shrink.fraction;
        let [known, within] = [0, STEPS].map(gain);
        assert!(known > 0.1 && within > 0.9 * known, "{known} {within}");
    }

    #[test]
    fn what_acts_in_one_recording_alone_has_nothing_to_show_in_the_other() {
        let offset = Candidate::new(find("current_offset").unwrap(), Place::Joint(JOINT));
        let [own, other] =
            [0, 1].map(|only| gain_of(Candidate { recording: Some(only), ..offset }).acts);
        assert!(!own && other);
    }

    #[test]
    fn what_is_not_there_gains_nothing_sure() {
        for joint in (0..6).filter(|j| *j != JOINT) {
            let gain = gained(joint);
            assert!(gain.shrink.low <= 0.0, "joint {joint}: {gain:?}");
        }
    }
}
