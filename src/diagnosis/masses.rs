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
    /// Of a state against another, nats, where `share` of the samples count, joint by joint.
    pub fn evidence(&self, from: &State, state: &State, share: &[f64]) -> f64 {
        let gained: f64 = self.gains(from, &state.fit, &state.residual, share).iter().sum();
        let causes = 0..state.fit.model.causes.len();
        let prices: f64 = causes.map(|i| price(&state.fit, i)).sum();
        gained - prices - state.fit.system.cost_of_known(&state.fit.model.priors())
    }

    /// Could masses within what is known of them be an account of the gap that does better?
    pub fn may_be_masses(&self, exact: &Account<'a, 'e>) -> bool {
        if exact.worst(self) >= SYSTEMATIC {
            return true;
        }
        let causes = &exact.last.fit.model.causes;
        let share = effective_shares(&exact.last.fit.system.residual);
        let evidence = |state: &State| self.evidence(&exact.start, state, &share);
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
            [&exact, &free].map(|a| self.evidence(&exact.start, &a.last, &share));
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
