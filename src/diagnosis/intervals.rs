//! Intervals of the causes' parameters.
//!
//! From the information matrix of all linear parameters and of the nonlinear ones that were
//! searched (their columns by central differences), in the metric of the discrepancy, rows counted by
//! what is independent in what it leaves. Links and times of channels are as unsure there as they are said to be, and so is
//! the scale of all torque, a parameter beside the others: what weighs is as uncertain as the scale it is
//! weighed with, and so is what follows the load. The ends of a window of time are told otherwise (`windows`).

use nalgebra::{Cholesky, DVector};
use statrs::function::gamma::gamma_lr;

use super::candidate::{Candidate, Extent, Term};
use super::fit::Fit;
use super::independent::{LEVEL, independent};
use super::{Value, built, tolerances, windows};
use crate::effects::{Effect, Parameter, Ratio, Role, Scope};
use crate::regression::{Normal, Raw, System};
use crate::statistics::{normal_quantile, student_quantile};

/// Relative step of a nonlinear parameter for its slope; a hundredth of its range for zero.
const DIFFERENCE: f64 = 1e-3;
/// Relative step where columns follow a reference and may jump: what they do over a small step says nothing
/// of what they do over a wide one.
const WIDE_DIFFERENCE: f64 = 0.2;

/// Values of every cause with intervals, of a fit as it is.
pub(super) fn of_fit(fit: &Fit<'_>) -> Vec<Vec<Value>> {
    let (systems, places) = information(fit, |_| true);
    let cause = |i: usize| {
        let values = fit.values(i);
        let candidate = fit.model.causes[i].candidate;
        let parameters = candidate.parameters().zip(values).enumerate();
        let windows = windows::intervals(fit, i);
        let window = |k: usize| {
            let at = |(end, _): &&(usize, [f64; 2])| candidate.linear() + end == k;
            windows.as_ref()?.iter().find(at).map(|(_, ends)| *ends)
        };
        let value = |(k, ((p, joint), value)): (usize, ((&Parameter, Option<usize>), f64))| {
            let half = places[i][k].map_or(0.0, |column| half_width(&systems, &[(column, 1.0)]));
            let [low, high] = window(k).unwrap_or([value - half, value + half]);
            let [min, max] = candidate.range(k, fit.data.twin);
            let near = 1e-3 * (max - min).min(1e6);
            Value {
                name: p.name.into(),
                joint: joint.map(|j| j + 1),
                unit: p.unit.into(),
                value,
                low: low.max(min),
                high: high.min(max),
                at_bound: places[i][k].is_some()
                    && value != p.null
                    && (value <= min || value >= max - near),
            }
        };
        let own = parameters.filter(|(_, ((p, _), _))| !p.is_reference());
        let mut all: Vec<Value> = own.map(value).collect();
        let stated = candidate.stated(fit.data.twin);
        all.extend(ratios(candidate, &all, &stated, &places[i], &systems));
        all
    };
    (0..fit.model.causes.len()).map(cause).collect()
}

/// What is read in place of linear parameters: quotients h / m, with intervals by their slopes 1 / m over h and
/// -h / m^2 over m. `stated`: what the twin has of the values, which are changes of it.
fn ratios(
    candidate: Candidate,
    values: &[Value],
    stated: &[f64],
    places: &[Option<usize>],
    systems: &Systems,
) -> Vec<Value> {
    let known = |name: &str| {
        let k = candidate.parameters().position(|(p, _)| p.name == name)?;
        Some((values.get(k)?.value + stated.get(k).unwrap_or(&0.0), places[k]?))
    };
    let ratio = |r: &Ratio| {
        let ((h, of), (m, over)) = (known(r.of)?, known(r.over)?);
        if m == 0.0 || candidate.sets() > 1 {
            return None;
        }
        let value = h / m;
        let half = half_width(systems, &[(of, 1.0 / m), (over, -value / m)]);
        let (name, unit) = (r.name.into(), r.unit.into());
        let [low, high] = [value - half, value + half];
        Some(Value { name, joint: None, unit, value, low, high, at_bound: false })
    };
    candidate.effect.readable().iter().filter_map(ratio).collect()
}

/// Do the intervals of an effect's values (changes, where the twin states them) hold its absence? All of its
/// linear values may then be none at all; of an effect without linear values, its first.
pub fn may_be_absent(effect: &dyn Effect, values: &[Value]) -> bool {
    let of = |v: &'_ Value| effect.about().parameters.iter().find(|p| p.name == v.name);
    let own = values.iter().filter_map(|v| Some((of(v)?, v)));
    let all: Vec<(&Parameter, &Value)> = own.filter(|(p, _)| !p.is_reference()).collect();
    let holds = |(p, v): &(&Parameter, &Value)| v.low <= p.null && p.null <= v.high;
    let mut linear = all.iter().filter(|(p, _)| p.role == Role::Linear).peekable();
    match linear.peek() {
        Some(_) => linear.all(holds),
        None => all.first().is_some_and(holds),
    }
}

/// May all linear values of cause `i` be none at once? Of values that stand in for each other every interval may hold
/// none, and yet one of them is there (Scheffe, "The analysis of variance", 1959, section 3.5). Were there none, its
/// shape would be of nothing: it is held where it was found, and that it was looked for is a matter of the evidence (Davies,
/// "Hypothesis testing when a nuisance parameter is present only under the alternative", Biometrika 64, 1977).
pub fn may_all_be_none(fit: &Fit<'_>, i: usize) -> bool {
    let (systems, places) = information(fit, |cause| cause != i);
    let columns: Vec<usize> =
        places[i][..fit.model.causes[i].candidate.linear()].iter().flatten().copied().collect();
    let n = columns.len();
    if n == 0 {
        return true;
    }
    let covariance = systems.all.covariance(&columns);
    let values = DVector::from_column_slice(&fit.values(i)[..n]);
    let Some(along) = Cholesky::new(covariance).map(|c| c.solve(&values)) else { return true };
    let direction: Vec<(usize, f64)> = columns.into_iter().zip(along.iter().copied()).collect();
    // How far off none they are, in the deviations of what tells that best: chi-square with n degrees of freedom.
    let deviation = half_width(&systems, &direction) / normal_quantile(1.0 - LEVEL);
    let far = along.dot(&values) / deviation.max(f64::MIN_POSITIVE);
    gamma_lr(0.5 * n as f64, 0.5 * far.powi(2)) <= LEVEL
}

/// Column of each parameter, cause by cause; `None` where it was not searched.
type Places = Vec<Vec<Option<usize>>>;

/// Information on all parameters, and their columns; of causes that are `shaped` on those that were searched, too. What a
/// bound holds at zero is as uncertain as the rest, and makes the rest as uncertain.
fn information(fit: &Fit<'_>, shaped: impl Fn(usize) -> bool) -> (Systems, Places) {
    let mut columns = fit.free_columns();
    let mut places = Vec::new();
    for (i, term) in fit.model.causes.iter().enumerate() {
        let linear: Vec<usize> = fit.model.range(i).collect();
        let mut of_cause = Vec::new();
        for (k, (p, _)) in term.candidate.parameters().enumerate() {
            of_cause.push(match p.role {
                Role::Linear => Some(linear[k]),
                Role::Nonlinear if shaped(i) && term.searched.contains(&(k - linear.len())) => {
                    columns.push(slope(fit, i, k - linear.len(), p));
                    Some(columns.len() - 1)
                }
                Role::Nonlinear => None,
            });
        }
        places.push(of_cause);
    }
    let shares = independent(fit);
    let weights: Vec<f64> = fit.system.weights.iter().zip(shares).map(|(w, s)| w * s).collect();
    let terms = fit.terms();
    let mut priors = fit.system.priors[..terms].to_vec();
    priors.resize(columns.len(), f64::INFINITY);
    let own = columns.len();
    columns.extend(fit.data.within_tolerances(built::scales(&fit.model), |p| fit.carried(p)));
    columns.extend(of_load(fit));
    let (tolerances, all) = (fit.sizes.tolerances, columns.len());
    let within = |step: u8| {
        let mut priors = priors.clone();
        priors.resize(if step == 0 { own } else { all }, tolerances::size(step));
        priors
    };
    let normal = Normal::new(columns, fit.predicted(&fit.model));
    let solve = |without: Option<usize>| {
        let here = |(j, w): (usize, &f64)| if without == Some(j) { 0.0 } else { *w };
        let weights = weights.iter().enumerate().map(here).collect();
        System::solve(&normal, &fit.metric, weights, within(tolerances))
    };
    let several = fit.model.causes.iter().any(|t| t.candidate.extent() == Extent::Several);
    let joints = if several { fit.data.joints() } else { 0 };
    let moving = (0..joints).filter(|j| fit.data.rows(*j) > 0);
    let without = moving.map(|j| solve(Some(j))).collect();
    let all = solve(None);
    // As unsure as twin and channels are said to be, whatever is most likely.
    let limits = fit.data.at_limits(&fit.sizes);
    let unsure = fit.data.metric(&limits);
    let unsure = System::solve(&normal, &unsure, weights.clone(), within(limits.tolerances));
    (Systems { all, unsure, without }, places)
}

/// Torque by which effects that follow the load change where all that the arm weighs is one tolerance heavier, N.m: they
/// are known no better than that load. `None` where there are none, or the twin is exact.
fn of_load(fit: &Fit<'_>) -> Option<Raw> {
    let at_joint = |c: Candidate| c.effect.about().scope == Scope::Joint;
    let follows = |t: &Term| at_joint(t.candidate) && t.candidate.effect.depends_on_load();
    let tolerance = fit.data.tolerances.of_scale();
    let heavier = |by: f64| {
        let mut model = fit.model.clone();
        let bodies = model.laden.bodies.iter_mut();
        bodies.for_each(|b| b.inertia = b.inertia.scaled(1.0 + by));
        fit.predicted(&model)
    };
    let some = tolerance > 0.0 && fit.model.terms().any(follows);
    some.then(|| heavier(tolerance).less(&heavier(-tolerance), 0.5))
}

/// Steps of all parameters from all joints, the same where all that the twin states within limits may be that far
/// off, and from all joints but one.
struct Systems {
    all: System,
    unsure: System,
    without: Vec<System>,
}

/// Half-width of a 90 % interval: what the information gives, or what it comes to when one joint after the
/// other is left out, where that is more: the parameters of a load are wrong by what any joint's scale and
/// links are (the jackknife with Student's t: Efron, "The jackknife, the bootstrap and other resampling
/// plans", 1982, section 3).
fn half_width(systems: &Systems, direction: &[(usize, f64)]) -> f64 {
    let Systems { all, unsure, without } = systems;
    let variance = |s: &System| s.variance_along(direction);
    let value = |s: &System| direction.iter().map(|(i, factor)| factor * s.x[*i]).sum::<f64>();
    let own = variance(all);
    let by_rows = normal_quantile(1.0 - LEVEL) * variance(unsure).sqrt();
    let n = without.len() as f64;
    let told = without.iter().filter(|s| variance(s) < UNTOLD * own);
    let moved = told.map(|s| (value(s) - value(all)).powi(2));
    let by_joints = ((n - 1.0) / n.max(1.0) * moved.sum::<f64>()).max(0.0).sqrt();
    match n > 1.0 {
        true => by_rows.max(student_quantile(1.0 - LEVEL, n - 1.0) * by_joints),
        false => by_rows,
    }
}

/// Multiple of the variance from all joints from which on the others do not tell a parameter.
const UNTOLD: f64 = 100.0;

/// d torque / d nonlinear parameter `k` of cause `i`, N.m per unit.
fn slope(fit: &Fit<'_>, i: usize, k: usize, p: &Parameter) -> Raw {
    let term = &fit.model.causes[i];
    let value = term.nonlinear[k];
    let follows = term.candidate.effect.about().parameters.iter().any(|p| p.is_reference());
    let share = if follows { WIDE_DIFFERENCE } else { DIFFERENCE };
    let step = if value != 0.0 { share * value.abs() } else { 0.01 * (p.max - p.min) };
    let at = |value: f64| {
        let mut model = fit.model.clone();
        model.causes[i].nonlinear[k] = value;
        fit.predicted(&model)
    };
    at(value + step).less(&at(value - step), 1.0 / (2.0 * step))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Settings;
    use crate::diagnosis::candidate::Place;
    use crate::diagnosis::data::Data;
    use crate::diagnosis::discrepancy::SIMULTANEOUS;
    use crate::diagnosis::floor::noise_floor;
    use crate::diagnosis::model::Model;
    use crate::diagnosis::observed::Observed;
    use crate::effects::find;
    use crate::signals::testing::{noisy, samples};
    use crate::twin::Twin;

    /// A spring without hysteresis: that it is held at zero does not make it known.
    #[test]
    fn what_a_bound_holds_has_an_interval_too() {
        let twin = Twin::default();
        let mut made = samples(6, 3000, |j, t| 0.6 * ((0.9 + 0.1 * j as f64) * t).sin());
        made.torque = twin.torque(&twin.motion(&made));
        noisy(&mut made, 0.3);
        let floor = noise_floor(&made, &twin);
        let observed = Observed::new(0, &twin, &made, &floor).unwrap();
        let data = Data::plain(vec![&observed]);
        let effect = find("maxwell_slip").unwrap();
        let candidate = Candidate::new(effect, Place::Joint(1));
        let held = vec![true, false, false];
        let term = Term { held, ..Term::new(candidate, vec![0.01]) };
        let fit = Fit::plain(&data, Model::of(&twin).with(term));
        let values = of_fit(&fit);
        let held = &values[0][0];
        assert!(held.value == 0.0 && held.low == 0.0 && held.high > 0.01, "{held:?}");
    }

    /// An amplitude is there where its sine or its cosine is.
    #[test]
    fn a_cause_is_there_if_one_of_its_values_is() {
        let ripple = find("torque_ripple").unwrap();
        let value = |name: &str, [low, high]: [f64; 2]| {
            let (name, unit) = (name.to_string(), String::new());
            Value { name, joint: None, unit, value: 0.5 * (low + high), low, high, at_bound: false }
        };
        let order = value("ripple_order", [10.0, 12.0]);
        let absent = |sine, cosine| {
            let amplitude = [value("ripple_sine", sine), value("ripple_cosine", cosine)];
            may_be_absent(ripple, &[&amplitude[..], std::slice::from_ref(&order)].concat())
        };
        assert!(absent([-0.1, 0.1], [-0.2, 0.3]));
        assert!(!absent([-0.1, 0.1], [0.2, 0.3]));
        let delay = find("time_delay").unwrap();
        assert!(!may_be_absent(delay, &[value("time_delay", [1e-3, 2e-3])]));
        assert!(may_be_absent(delay, &[value("time_delay", [0.0, 2e-3])]));
    }

    /// What is told of a cause at joint 2 whose column number `at` makes so much torque there.
    fn at_joint_2<T>(term: Term, at: usize, level_nm: f64, told: impl Fn(&Fit<'_>) -> T) -> T {
        let twin = Twin { effects: vec!["viscous".into()], ..Twin::default() };
        let mut made = samples(6, 3000, |j, t| 0.6 * ((0.9 + 0.1 * j as f64) * t).sin());
        let Candidate { effect, .. } = term.candidate;
        let column = effect.columns(&twin.motion(&made), 1, &term.nonlinear).swap_remove(at);
        made.torque = twin.torque(&twin.motion(&made));
        let torque = made.torque.joint_mut(1).iter_mut();
        torque.zip(column).for_each(|(t, z)| *t += level_nm * z);
        noisy(&mut made, 0.3);
        let floor = noise_floor(&made, &twin);
        let observed = Observed::new(0, &twin, &made, &floor).unwrap();
        let data = Data::plain(vec![&observed]);
        told(&Fit::plain(&data, Model::of(&twin).with(term)))
    }

    /// Springs so stiff that the motion does not tell them from each other: but it tells them from nothing.
    fn springs<T>(level_nm: f64, told: impl Fn(&Fit<'_>) -> T) -> T {
        let candidate = Candidate::new(find("maxwell_slip").unwrap(), Place::Joint(1));
        at_joint_2(Term::new(candidate, vec![2e-5]), 1, level_nm, told)
    }

    /// Is absence within the intervals, and is it for all values at once?
    fn none(fit: &Fit<'_>) -> [bool; 2] {
        let effect = fit.model.causes[0].candidate.effect;
        [may_be_absent(effect, &of_fit(fit)[0]), may_all_be_none(fit, 0)]
    }

    #[test]
    fn of_values_that_stand_in_for_each_other_one_is_there() {
        assert_eq!(springs(0.5, none), [true, false]);
        assert_eq!(springs(0.0, none), [true, true]);
    }

    /// The motion is hardly slow enough for the law: how high and how wide it is stand in for each other, and yet it
    /// is there.
    #[test]
    fn an_effect_is_there_whose_shape_is_not_told() {
        let candidate = Candidate::new(find("stribeck").unwrap(), Place::Joint(1));
        let shape = vec![0.03, 1.0];
        let term = || Term { searched: vec![0], ..Term::new(candidate, shape.clone()) };
        assert_eq!(at_joint_2(term(), 0, 2.5, none), [true, false]);
        assert_eq!(at_joint_2(term(), 0, 0.0, none), [true, true]);
    }

    /// Friction in proportion to a load that is known to a twentieth.
    #[test]
    fn what_follows_the_load_is_known_no_better_than_the_load() {
        let known_to = 0.05;
        let twin = Twin::default();
        let candidate = Candidate::new(find("load_friction").unwrap(), Place::Joint(1));
        let mut made = samples(6, 3000, |j, t| 0.6 * ((0.9 + 0.1 * j as f64) * t).sin());
        let column = candidate.effect.columns(&twin.motion(&made), 1, &[]).swap_remove(0);
        made.torque = twin.torque(&twin.motion(&made));
        made.torque.joint_mut(1).iter_mut().zip(column).for_each(|(t, z)| *t += 0.1 * z);
        noisy(&mut made, 0.3);
        let floor = noise_floor(&made, &twin);
        let observed = Observed::new(0, &twin, &made, &floor).unwrap();
        let wide = |mass_error: f64| {
            let settings = Settings { mass_error, ..Settings::default() };
            let data = Data::new(vec![&observed], &settings);
            let fit = Fit::plain(&data, Model::of(&twin).with(Term::new(candidate, vec![])));
            let value = of_fit(&fit)[0].swap_remove(0);
            assert!(value.low < 0.1 && 0.1 < value.high, "{value:?}");
            (value.high - value.low) / (2.0 * value.value)
        };
        let least = normal_quantile(1.0 - LEVEL) * known_to;
        assert!(wide(0.0) < 0.5 * least && wide(known_to) > least);
    }

    /// Torque of one joint that is two samples late.
    #[test]
    fn a_delay_is_known_no_better_than_the_times_of_channels() {
        const LATE_S: f64 = 0.016;
        let twin = Twin::default();
        let mut made = samples(6, 3000, |j, t| 0.6 * ((0.9 + 0.1 * j as f64) * t).sin());
        let known_to = SIMULTANEOUS * made.dt;
        let late = (LATE_S / made.dt).round() as usize;
        made.torque = twin.torque(&twin.motion(&made)).map_joints(|j, t| {
            let late = if j == 1 { late } else { 0 };
            (0..t.len()).map(|k| t[k.saturating_sub(late)]).collect()
        });
        noisy(&mut made, 0.05);
        let floor = noise_floor(&made, &twin);
        let observed = Observed::new(0, &twin, &made, &floor).unwrap();
        let settings = Settings { mass_error: 0.0, ..Settings::default() };
        let data = Data::new(vec![&observed], &settings);
        let candidate = Candidate::new(find("time_delay").unwrap(), Place::Joint(1));
        let term = Term { searched: vec![0], ..Term::new(candidate, vec![LATE_S]) };
        let fit = Fit::plain(&data, Model::of(&twin).with(term));
        let value = of_fit(&fit)[0].swap_remove(0);
        let deviation = 0.5 * (value.high - value.low) / normal_quantile(1.0 - LEVEL);
        // Sizes are known to a factor of two.
        assert!((0.5..1.5).contains(&(deviation / known_to)), "{deviation} s");
    }

    #[test]
    fn a_variance_is_what_the_covariance_gives_along_a_direction() {
        let [form, variance] = springs(0.5, |fit| {
            let along = [0.5, -2.0, 1.0];
            let columns: Vec<usize> = fit.model.range(0).collect();
            let direction: Vec<(usize, f64)> = columns.iter().copied().zip(along).collect();
            let along = DVector::from_column_slice(&along);
            let form = along.dot(&(fit.system.covariance(&columns) * &along));
            [form, fit.system.variance_along(&direction)]
        });
        assert!(variance > 0.0 && (form / variance - 1.0).abs() < 1e-6, "{form} {variance}");
    }
}
