//! Are the twin's link masses as it says, or off by what is known of them?
//!
//! Free masses and centres explain much of any gap, so likelihood alone would always prefer them.
//! What is compared is evidence: the log-likelihood gained on both recordings, less Schwarz's price
//! of the causes, less what it costs that masses could have been anything within what is known of
//! them (MacKay, "Information Theory, Inference, and Learning Algorithms", 2003, section 28.1).

use super::account::Account;
use super::leftover::SYSTEMATIC;
use super::model::Model;
use super::rank::{State, effective_shares, price};
use super::select::Search;

/// Standard deviations, root mean square, by which masses may be off and still be within what is
/// known of them.
const CREDIBLE: f64 = 2.0;

impl<'a, 'e> Search<'a, 'e> {
    /// Log marginal likelihood of a state against another, nats, where `share` of the samples count, joint by joint.
    pub fn log_evidence(&self, from: &State, state: &State, share: &[f64]) -> f64 {
        let gained: f64 = self.gains(from, &state.fit, &state.residual, share).iter().sum();
        let causes = 0..state.fit.model.causes.len();
        let prices: f64 = causes.map(|i| price(&state.fit, i)).sum();
        gained - prices - state.fit.system.occam_penalty(&state.fit.model.priors())
    }

    /// Could masses within what is known of them be an account of the gap that does better?
    pub fn may_be_masses(&self, exact: &Account<'a, 'e>) -> bool {
        if exact.worst(self) >= SYSTEMATIC {
            return true;
        }
        let causes = &exact.last.fit.model.causes;
        let share = effective_shares(&exact.last.fit.system.residual);
        let evidence = |state: &State| self.log_evidence(&exact.start, state, &share);
        let to_beat = evidence(&exact.last);
        let mut model = Model::of_uncertain(self.fit.twin, self.settings);
        model.causes.clone_from(causes);
        let mut best = evidence(&self.state(model.clone()));
        while best <= to_beat && !model.causes.is_empty() {
            let fewer = (0..model.causes.len()).map(|i| {
                let model = model.without(&[i]);
                (evidence(&self.state(model.clone())), model)
            });
            let Some(next) = fewer.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            (best, model) = next;
        }
        !causes.is_empty() && best > to_beat
    }

    /// The account with more evidence, if the masses it needs are credible.
    pub fn with_masses(&self, exact: Account<'a, 'e>, free: Account<'a, 'e>) -> Account<'a, 'e> {
        let share = effective_shares(&free.last.fit.system.residual);
        let [of_exact, of_free] =
            [&exact, &free].map(|a| self.log_evidence(&exact.start, &a.last, &share));
        let off = off_by(&free);
        let [taken, names] = [&exact, &free].map(Account::names);
        let (mut best, other) = match off <= CREDIBLE && of_free > of_exact {
            true => (free, format!("taken as they are the search finds {taken}")),
            false => (exact, format!("fitted along the search finds {names}")),
        };
        if off > CREDIBLE {
            best.notes.push(format!(
                "with link masses free they come out {off:.0} standard deviations off (root mean \
                 square): that is no uncertainty of masses but something missing"
            ));
        } else if taken != names {
            best.notes.push(format!(
                "with link masses {other}: the verdict depends on how well they are known"
            ));
        }
        best
    }
}

/// By how many of its standard deviations a mass or moment is off, root mean square.
fn off_by(account: &Account<'_, '_>) -> f64 {
    let fit = &account.last.fit;
    let known = fit.model.priors().into_iter().zip(fit.system.x.iter());
    let squares: Vec<f64> =
        known.filter(|(s, _)| s.is_finite()).map(|(s, x)| (x / s).powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::diagnosis::Settings;
    use crate::diagnosis::candidate::candidates;
    use crate::diagnosis::colour::Colours;
    use crate::diagnosis::evidence::Evidence;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::testing::samples;
    use crate::signals::Samples;
    use crate::twin::Twin;

    const TRIED: [&str; 3] = ["link_inertia", "payload", "current_offset"];
    const NOISE_NM: f64 = 0.3;

    /// What an arm with these links (and what it carries) records, as seen by the default twin.
    fn recorded(arm: &Twin, seed: u64) -> Samples {
        let rate = 0.9 + 0.1 * seed as f64;
        let mut made = samples(6, 3000, |j, t| {
            0.7 * (rate * t + j as f64).sin() + 0.3 * ((1.7 + 0.3 * j as f64) * rate * t).sin()
        });
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let torque = arm.torque(&arm.motion(&made));
        made.torque = torque.map_joints(|_, torque| {
            let noisy = torque.iter().map(|t| {
                let noise: f64 = StandardNormal.sample(&mut rng);
                t + NOISE_NM * noise
            });
            noisy.collect()
        });
        made
    }

    /// Names of the causes that are found for an arm, and whether masses are fitted along.
    fn found(arm: &Twin) -> (Vec<String>, bool) {
        let twin = Twin::default();
        let made = [recorded(arm, 1), recorded(arm, 2)];
        let floors = [0, 1].map(|i| noise_floor(&made[i], &twin));
        let [fit, check] = [0, 1].map(|i| Evidence::new(&twin, &made[i], &floors[i]).unwrap());
        let settings = Settings { surrogates: 9, ..Settings::default() };
        let mut candidates = candidates(&twin, &[]);
        candidates.retain(|c| TRIED.contains(&c.name()));
        let colours = Colours::new(&fit, &check);
        let (fit, check) = (&fit, &check);
        let search = Search { fit, check, settings: &settings, candidates, colours: &colours };
        let account = search.account();
        let causes = account.last.fit.model.causes.iter();
        (causes.map(|t| t.candidate.name().to_string()).collect(), account.uncertain)
    }

    fn with_friction(mut arm: Twin) -> Twin {
        arm.values.insert("coulomb".into(), vec![4.0; 6]);
        arm.values.insert("viscous".into(), vec![3.0; 6]);
        arm
    }

    #[test]
    fn masses_all_a_little_off_are_no_cause() {
        let mut arm = with_friction(Twin::default());
        for (j, body) in arm.robot.bodies.iter_mut().enumerate() {
            body.inertia.mass *= 1.0 + if j % 2 == 0 { 0.05 } else { -0.04 };
        }
        let (causes, free) = found(&arm);
        assert!(causes.is_empty() && free, "{causes:?} {free}");
    }

    #[test]
    fn one_link_that_is_off_and_a_load_are_causes_where_all_else_is_exact() {
        let mut arm = with_friction(Twin::default());
        arm.robot.bodies[2].inertia.mass *= 1.3;
        let (causes, free) = found(&arm);
        assert!(causes == ["link_inertia"] && !free, "{causes:?} {free}");
        let mut arm = with_friction(Twin::default());
        arm.effects.push("payload".into());
        for (name, value) in
            [("mass", 1.5), ("moment_x", 0.0), ("moment_y", 0.0), ("moment_z", 0.1)]
        {
            arm.values.insert(format!("payload_{name}"), vec![value]);
        }
        let (causes, _) = found(&arm);
        assert_eq!(causes, ["payload"]);
    }
}
