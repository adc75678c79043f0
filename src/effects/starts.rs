//! Where searches for nonlinear parameters begin.

use super::{Motion, Parameter, Role, Size};

/// Values per parameter.
const POINTS: usize = 7;

/// The first nonlinear parameter spread over its range, the others at their typical values; one row where
/// there is none to search for: references follow by themselves.
pub(super) fn spread(parameters: &[Parameter]) -> Vec<Vec<f64>> {
    let searched = parameters.iter().find(|p| p.role == Role::Nonlinear && !p.is_reference());
    let axis = searched.map(|p| (p.name, between(p.min, p.max, POINTS)));
    grid(parameters, axis.as_slice())
}

/// [`spread`] from `min` to `max` instead of over the whole range.
pub(super) fn spread_over(parameters: &[Parameter], min: f64, max: f64) -> Vec<Vec<f64>> {
    let first = parameters.iter().find(|p| p.role == Role::Nonlinear);
    let axis = first.map(|p| (p.name, between(min, max, POINTS)));
    grid(parameters, axis.as_slice())
}

/// [`grid`] for a UR5, on the arm of `motion`: by their units values grow with it.
pub(super) fn grid_on(
    motion: &Motion<'_>,
    parameters: &[Parameter],
    axes: &[(&str, Vec<f64>)],
) -> Vec<Vec<f64>> {
    let size = Size::of(motion.robot);
    let units = parameters.iter().filter(|p| p.role == Role::Nonlinear).map(|p| p.unit);
    let factors: Vec<f64> = units.map(|unit| size.factor(unit)).collect();
    let mut rows = grid(parameters, axes);
    rows.iter_mut().for_each(|row| row.iter_mut().zip(&factors).for_each(|(v, f)| *v *= f));
    rows
}

/// Every combination of the `axes` (parameter and its values), the other nonlinear parameters at
/// their typical values.
pub(super) fn grid(parameters: &[Parameter], axes: &[(&str, Vec<f64>)]) -> Vec<Vec<f64>> {
    let nonlinear = || parameters.iter().filter(|p| p.role == Role::Nonlinear);
    let mut rows = vec![nonlinear().map(|p| p.typical).collect::<Vec<f64>>()];
    for (name, values) in axes {
        let Some(place) = nonlinear().position(|p| p.name == *name) else { continue };
        let varied = |row: &Vec<f64>| {
            let with = |&value: &f64| {
                let mut row = row.clone();
                row[place] = value;
                row
            };
            values.iter().map(with).collect::<Vec<_>>()
        };
        rows = rows.iter().flat_map(varied).collect();
    }
    rows
}

/// `points` values inside `min` .. `max`, neither of them, by equal ratios where both are positive.
pub(super) fn between(min: f64, max: f64, points: usize) -> Vec<f64> {
    let share = |i: usize| (i as f64 + 0.5) / points as f64;
    let value = |i: usize| match min > 0.0 {
        true => min * (max / min).powf(share(i)),
        false => min + (max - min) * share(i),
    };
    (0..points).map(value).collect()
}

/// Smallest and largest angle of a joint, rad.
pub(super) fn range(motion: &Motion<'_>, joint: usize) -> [f64; 2] {
    let wider = |[low, high]: [f64; 2], q: &f64| [low.min(*q), high.max(*q)];
    let range = motion.q.joint(joint).iter().fold([f64::INFINITY, f64::NEG_INFINITY], wider);
    if range[0] <= range[1] { range } else { [0.0, 0.0] }
}
