//! A payload as sure as the links let it be: their errors look like a load's.

use nalgebra::{DMatrix, DVector};

use super::arm_problem::ArmProblem;
use super::error::IdentificationError;
use super::inertia::Inertial;
use super::terms::Terms;
use super::{Found, MethodResult, judge, shared};
use crate::effects::{self, Effect, Role};
use crate::signals::Samples;
use crate::twin::Twin;

/// The payload's rows in `results` become those of a fit with uncertain links, and its inertia one that a body
/// can have. Returns how uncertain the links are, as a share of a mass, by what these data call for; `None`
/// without a payload in `arm`, or where a link of the model is impossible.
///
/// # Errors
/// As [`super::assemble`].
pub fn payload_beside_links(
    arm: &ArmProblem,
    samples: &Samples,
    twin: &Twin,
    terms: &Terms,
    results: &mut [MethodResult],
) -> Result<Option<f64>, IdentificationError> {
    let Some((payload, places)) = places(arm) else { return Ok(None) };
    let (mut inertial, mut beside) = (Inertial::of(twin, terms), arm.clone());
    inertial.attach(&mut beside, samples, twin)?;
    let found = Found::of(&beside)?;
    let Some(links) = inertial.links(&beside, &found, &twin.robot, None) else { return Ok(None) };
    let first = links.parameters.len();
    let covariance = |a: usize, b: usize| links.covariance[(first + a, first + b)];
    let mut values = links.others.clone();
    let own =
        possible(payload, DVector::from_fn(places.len(), |i, _| values[places[i]]), |i, k| {
            covariance(places[i], places[k])
        });
    places.iter().zip(&own).for_each(|(place, value)| values[*place] = *value);
    if own[0] <= 0.0 {
        return Ok(None);
    }
    let ratios = shared::ratios(arm);
    let of_payload = |name: &str| name.starts_with("payload_");
    for row in results.iter_mut().flat_map(|r| &mut r.arm).filter(|row| of_payload(&row.name)) {
        if let Some(&(i, over, _)) = ratios.iter().find(|(_, _, ratio)| ratio.name == row.name) {
            // c = h / m, and its variance by its slopes over h and m.
            let (m, c) = (values[over], values[i] / values[over]);
            let variance = covariance(i, i) - 2.0 * c * covariance(i, over)
                + c.powi(2) * covariance(over, over);
            judge::set(row, c, variance.max(0.0).sqrt() / m);
        } else if let Some(i) = arm.shared.iter().position(|p| p.name == row.name) {
            judge::set(row, values[i], covariance(i, i).sqrt());
        }
    }
    Ok(Some(links.spread))
}

/// Where the linear parameters of a payload stand among those that the joints share.
fn places(arm: &ArmProblem) -> Option<(&'static dyn Effect, Vec<usize>)> {
    let payload = effects::find("payload")?;
    let linear = payload.about().parameters.iter().filter(|p| p.role == Role::Linear);
    let place = |name: &str| arm.shared.iter().position(|p| p.name == name);
    let places: Vec<usize> = linear.filter_map(|p| place(p.name)).collect();
    (!places.is_empty()).then_some((payload, places))
}

/// Values moved to what a body can have: those that have to move do so to the nearest, the others as they go with
/// them, to E[x_a | x_b] = x_a + C_ab C_bb^-1 d x_b.
fn possible(
    effect: &dyn Effect,
    values: DVector<f64>,
    covariance: impl Fn(usize, usize) -> f64,
) -> DVector<f64> {
    let mut nearest = values.clone();
    effect.keep_physical(nearest.as_mut_slice());
    let moved: Vec<usize> = (0..values.len()).filter(|i| nearest[*i] != values[*i]).collect();
    let rest: Vec<usize> = (0..values.len()).filter(|i| !moved.contains(i)).collect();
    let part = |rows: &[usize], columns: &[usize]| {
        DMatrix::from_fn(rows.len(), columns.len(), |i, k| covariance(rows[i], columns[k]))
    };
    let by = DVector::from_fn(moved.len(), |i, _| nearest[moved[i]] - values[moved[i]]);
    let Some(factor) = part(&moved, &moved).cholesky() else { return nearest };
    let along = part(&rest, &moved) * factor.solve(&by);
    rest.iter().zip(along.iter()).for_each(|(i, step)| nearest[*i] += step);
    nearest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A moment that is taken back to zero takes along what goes with it, and leaves what does not.
    #[test]
    fn what_goes_with_an_inertia_moves_with_it() {
        let payload = effects::find("payload").unwrap();
        let values = [2.0, 0.0, 0.0, 0.2, -0.01, 0.01, 0.01, 0.0, 0.0, 0.0];
        let covariance = |i: usize, k: usize| match (i.min(k), i.max(k)) {
            (i, k) if i == k => 1.0,
            (0, 4) => 0.5,
            _ => 0.0,
        };
        let moved = possible(payload, DVector::from_row_slice(&values), covariance);
        assert!(moved[4] > values[4], "{moved}");
        assert!((moved[0] - 2.0 - 0.5 * (moved[4] - values[4])).abs() < 1e-12, "{moved}");
        assert_eq!(moved[3], 0.2);
        let fine = DVector::from_row_slice(&[2.0, 0.0, 0.0, 0.2, 0.01, 0.01, 0.01, 0.0, 0.0, 0.0]);
        assert_eq!(possible(payload, fine.clone(), covariance), fine);
    }
}
