//! How errors change with values: the tangent beside differences between simulations.

use super::*;
use crate::regression::bounds::Bounds;
use crate::servo::parameters::FINE;

/// Columns beside differences between simulations, of friction and load, servos, bodies, rotors and encoders: to the
/// steps of the differences. The first joint and the last stand at times with all the friction that can hold
/// them; there a difference has the one side, and a tangent the other.
#[test]
fn a_tangent_is_what_differences_between_simulations_have() {
    let (twin, track) = by_rapier(SERVOS);
    let effects = [
        ("coulomb", 1e-4),
        ("stribeck", 1e-3),
        ("load_friction", 1e-3),
        ("payload", 2e-2),
        ("rotor_inertia", 1e-3),
        ("joint_coupling", 1e-3),
        ("servo_gain", 1e-4),
        ("servo_delay", 1e-3),
        ("servo_damping", 1e-2),
        ("servo_friction", 1e-4),
        ("external_contact", 2e-2),
    ];
    let names = effects.map(|(name, _)| name.to_string());
    let mut free = free_parameters(&twin, &names).unwrap();
    free.retain(|f| f.joint.is_none_or(|j| (1..5).contains(&j)));
    let tracks = [&track];
    let mut problem = Problem::new(&twin, &tracks, &free, 2.0);
    // Errors that count partly by their size.
    (problem.is_robust, problem.with_priors) = (true, false);
    problem.weights.fill(1e4);
    let x: Vec<f64> = free.iter().map(|f| f.start).collect();
    let bounds = Bounds::unbounded(x.len());
    let steps = problem.steps(&x, &bounds, FINE);
    let mut r = vec![0.0; problem.count()];
    problem.residuals(&x, &mut r);
    assert!(problem.tangents(&x, &steps).is_some());
    let tangents = problem.jacobian(&x, &r, &bounds);
    let differences = problem.differences(&x, &r, &steps);
    let size = |column: &[f64]| column.iter().map(|d| d * d).sum::<f64>().sqrt();
    for ((f, tangent), difference) in free.iter().zip(tangents).zip(differences) {
        let apart: Vec<f64> = tangent.iter().zip(&difference).map(|(t, d)| t - d).collect();
        let off = size(&apart) / size(&difference);
        let (name, joint) = (f.parameter.name, f.joint);
        let (_, most) = effects.iter().find(|(name, _)| *name == f.effect.about().name).unwrap();
        assert!(off < *most || size(&difference) < 1e-12, "{name} {joint:?}: {off}");
    }
}

#[test]
fn what_remembers_or_gives_way_has_no_tangent() {
    let (twin, track) = by_rapier(SERVOS);
    for (effect, has_one) in [("coulomb", true), ("backlash", false), ("presliding", false)] {
        let free = free_parameters(&twin, &[effect.to_string()]).unwrap();
        let tracks = [&track];
        let problem = Problem::new(&twin, &tracks, &free, 2.0);
        let x: Vec<f64> = free.iter().map(|f| f.parameter.typical).collect();
        let steps = problem.steps(&x, &Bounds::unbounded(x.len()), FINE);
        assert_eq!(problem.tangents(&x, &steps).is_some(), has_one, "{effect}");
    }
}
