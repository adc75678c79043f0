//! Parameters at the end of their range: what fits only there is no explanation.

use super::candidate::Candidate;
use super::fit::Fit;
use super::trial::{Trial, evaluate};
use crate::effects::{Mechanism, Parameter, Role};
use crate::twin::Twin;

/// A trial made a cause of the model it was tried on.
pub struct Adopted<'f, 'a> {
    pub trial: Trial,
    pub fit: Fit<'a>,
    /// A parameter at a bound that is not its null value.
    pub at_bound: Option<&'static str>,
    before: &'f Fit<'a>,
}

impl<'f, 'a> Adopted<'f, 'a> {
    /// The trial fitted as a cause, beside a discrepancy of the sizes that `before` has.
    pub fn new(before: &'f Fit<'a>, trial: Trial) -> Self {
        let fit = Fit::new(before.data, before.model.with(trial.term()), before.sizes.clone());
        let at_bound = at_bound(&fit, &trial);
        Self { trial, fit, at_bound, before }
    }

    /// The trial without a parameter at a bound, where that costs less than `tolerance` nats: a search
    /// wanders to the end of what the data do not tell.
    pub fn inside(self, tolerance: f64) -> Self {
        let Some(name) = self.at_bound else { return self };
        let mut parameters = self.trial.candidate.parameters();
        let Some(i) = parameters.position(|(p, _)| p.name == name) else { return self };
        let best = self.fit.ln_evidence();
        let costs = |other: &Self| best - other.fit.ln_evidence();
        let others = self.moved(i).into_iter().map(|trial| Self::new(self.before, trial));
        let inside = others.filter(|other| other.at_bound.is_none() && costs(other) < tolerance);
        inside.min_by(|a, b| costs(a).total_cmp(&costs(b))).unwrap_or(self)
    }

    /// Trials with parameter `i` elsewhere: a linear one at its null value, a nonlinear one at its starts.
    fn moved(&self, i: usize) -> Vec<Trial> {
        let trial = &self.trial;
        let Some(k) = i.checked_sub(trial.candidate.linear()) else {
            let mut without = trial.clone();
            without.linear[i] = 0.0;
            return vec![without];
        };
        let mut values: Vec<f64> = trial.starts.iter().map(|s| s[k]).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        let at = |value: f64| {
            let mut nonlinear = trial.nonlinear.clone();
            nonlinear[k] = value;
            evaluate(self.before, trial, nonlinear)
        };
        values.into_iter().map(at).collect()
    }
}

/// Does nonlinear parameter `k` bend the first column? One that bends others alone (how a cable's
/// hysteresis slips) is arbitrary where there is little of those.
fn shapes_the_effect(fit: &Fit<'_>, trial: &Trial, k: usize) -> bool {
    let start = trial.starts.iter().find(|s| s[k] != trial.nonlinear[k]);
    let (Some(start), false) = (start, trial.candidate.senses()) else { return true };
    let mut moved = trial.nonlinear.clone();
    moved[k] = start[k];
    let first = |nonlinear: &[f64]| fit.raw(trial.candidate, nonlinear).into_iter().next();
    let [a, b] = [first(&moved), first(&trial.nonlinear)].map(|c| c.map(|c| c.rows));
    a != b
}

/// Is cause `i` what cannot be: a linear value beyond its range, none of them what makes the effect, or an arm that
/// cannot exist?
pub fn is_impossible(fit: &Fit<'_>, i: usize) -> bool {
    let candidate = fit.model.causes[i].candidate;
    let values = fit.values(i);
    let linear = &values[..candidate.linear()];
    let beyond = |(k, v): (usize, &f64)| {
        let [min, max] = candidate.range(k, fit.data.twin);
        let slack = 1e-6 * (max - min);
        *v < min - slack || *v > max + slack
    };
    linear.iter().enumerate().any(beyond)
        || !(linear.is_empty() || candidate.is_itself(linear))
        || (candidate.is_load() && has_centre_out_of_reach(candidate, &values, fit.data.twin))
}

/// With these values of a load, does a link have its centre of mass farther off than the arm reaches?
fn has_centre_out_of_reach(candidate: Candidate, values: &[f64], twin: &Twin) -> bool {
    let mut mechanism = Mechanism::new(twin.laden());
    candidate.build(values, &mut mechanism);
    let reach = twin.robot.reach();
    mechanism.robot.bodies.iter().any(|b| b.inertia.com.norm() > reach)
}

/// The first parameter of the last cause that sits at a bound: the first of all where its linear
/// ones do not make the effect that it is, a linear one at the end of its range, a nonlinear one at
/// the end of its range unless a search starts there.
pub fn at_bound(fit: &Fit<'_>, trial: &Trial) -> Option<&'static str> {
    let last = fit.model.causes.len() - 1;
    let candidate = fit.model.causes[last].candidate;
    let values = fit.values(last);
    let held = &fit.model.causes[last].held;
    let linear = &values[..held.len()];
    if held.iter().any(|h| !h) && !candidate.is_itself(linear) {
        return candidate.effect.about().parameters.first().map(|p| p.name);
    }
    let reached = |(i, ((p, _), v)): (usize, ((&'static Parameter, Option<usize>), &f64))| {
        let [min, max] = candidate.range(i, fit.data.twin);
        let near = 1e-3 * (max - min);
        let at_end = *v <= min + 1e-3 * min.abs() || *v >= max - near;
        let at = match p.role {
            Role::Linear => !held[i] && at_end && *v != p.null,
            Role::Nonlinear => {
                let k = i - candidate.linear();
                trial.searched().contains(&k)
                    && at_end
                    && trial.starts.iter().all(|s| s[k] != *v)
                    && shapes_the_effect(fit, trial, k)
            }
        };
        at.then_some(p.name)
    };
    candidate.parameters().zip(&values).enumerate().find_map(reached)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::candidate::Place;
    use crate::diagnosis::data::Data;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::model::Model;
    use crate::diagnosis::observed::Observed;
    use crate::diagnosis::screen::screen;
    use crate::effects::find;
    use crate::signals::testing::{noisy, samples};

    const JOINT: usize = 2;
    const LEVEL_NM: f64 = 6.0;
    const NOISE_NM: f64 = 0.2;

    /// LuGre friction of these nonlinear values, adopted at others: is it at a bound, and still when
    /// taken inside?
    fn wandered(truth: [f64; 3], to: [f64; 3]) -> [Option<&'static str>; 2] {
        let twin = Twin::default();
        let mut made = samples(6, 4000, |j, t| 0.6 * ((0.9 + 0.1 * j as f64) * t).sin());
        let lugre = find("lugre").unwrap();
        let motion = twin.motion(&made);
        let bristle = lugre.columns(&motion, JOINT, &truth).swap_remove(0);
        let mut torque = twin.torque(&motion);
        torque.joint_mut(JOINT).iter_mut().zip(bristle).for_each(|(t, z)| *t += LEVEL_NM * z);
        made.torque = torque;
        noisy(&mut made, NOISE_NM);
        let floor = noise_floor(&made, &twin);
        let evidence = Observed::new(0, &twin, &made, &floor).unwrap();
        let data = Data::plain(vec![&evidence]);
        let fit = Fit::plain(&data, Model::of(&twin));
        let candidate = Candidate::new(lugre, Place::Joint(JOINT));
        let start = screen(&fit, &[candidate]).remove(0).trial;
        let there = Adopted::new(&fit, evaluate(&fit, &start, to.to_vec()));
        [there.at_bound, there.inside(6.0).at_bound]
    }

    /// The upper arm of a UR5 (8.4 kg) three kilograms lighter: its centre a hand's breadth aside, or six metres.
    #[test]
    fn no_link_has_its_centre_farther_off_than_the_arm_reaches() {
        let twin = Twin::default();
        let candidate = Candidate::new(find("link_inertia").unwrap(), Place::Joint(1));
        let out_of_reach = |moment: f64| {
            let values = [-3.0, moment, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            has_centre_out_of_reach(candidate, &values, &twin)
        };
        assert!(!out_of_reach(0.5) && out_of_reach(-35.0));
    }

    /// Beside Coulomb friction, which is open, only level times excess shows.
    #[test]
    fn a_bound_that_the_data_do_not_press_against_is_none() {
        let [there, inside] = wandered([1e-3, 0.5, 0.1], [1e-3, 2.0, 0.1]);
        assert_eq!((there, inside), (Some("lugre_excess"), None));
    }

    #[test]
    fn a_bound_that_they_do_press_against_stays() {
        let [there, inside] = wandered([1e-3, 1.5, 3.0], [1e-3, 0.5, 0.5]);
        assert_eq!((there, inside), (Some("lugre_velocity"), Some("lugre_velocity")));
    }
}
