//! Where searches for nonlinear parameters begin.

use super::{Parameter, Role};

/// Values per parameter.
const POINTS: usize = 7;

/// The first nonlinear parameter spread over its range, the others at their typical values; one
/// empty row where all parameters are linear.
pub(super) fn spread(parameters: &[Parameter]) -> Vec<Vec<f64>> {
    let nonlinear: Vec<_> = parameters.iter().filter(|p| p.role == Role::Nonlinear).collect();
    let typical: Vec<f64> = nonlinear.iter().map(|p| p.typical).collect();
    let Some(first) = nonlinear.first() else { return vec![typical] };
    let with_first = |value| {
        let mut row = typical.clone();
        row[0] = value;
        row
    };
    between(first.min, first.max, POINTS).map(with_first).collect()
}

/// `points` values inside `min` .. `max`, neither of them, by equal ratios where both are positive.
pub(super) fn between(min: f64, max: f64, points: usize) -> impl Iterator<Item = f64> {
    let share = move |i: usize| (i as f64 + 0.5) / points as f64;
    let value = move |i: usize| match min > 0.0 {
        true => min * (max / min).powf(share(i)),
        false => min + (max - min) * share(i),
    };
    (0..points).map(value)
}
