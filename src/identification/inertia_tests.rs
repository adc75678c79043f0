//! Links that are not the model's, in torque made by hand.

use super::*;
use crate::identification::payload_beside_links;
use crate::identification::{BoundsByName, Method, Settings, assemble, identify};
use crate::rigid_body::is_possible;
use crate::signals::testing::{noisy, samples};

const NOISE: f64 = 0.1;

/// A UR5 with friction and rotors, to be fitted.
fn model() -> (Twin, Terms) {
    (Twin::default(), Terms::named(["coulomb", "viscous", "rotor_inertia"]).unwrap())
}

/// What `arm` shows while all joints from `first` on swing.
fn recorded(arm: &Twin, first: usize) -> Samples {
    let mut arm = arm.clone();
    arm.values.insert("coulomb".into(), vec![5.0, 6.0, 4.0, 1.5, 1.2, 1.0]);
    arm.values.insert("viscous".into(), vec![9.0, 10.0, 7.0, 2.0, 1.5, 1.0]);
    arm.drive.rotor_inertia = vec![1.1, 1.1, 1.1, 0.14, 0.14, 0.14];
    let swing = |j: usize, t: f64| {
        let w = 1.3 + 0.37 * j as f64;
        if j < first { 0.3 } else { 0.8 * (w * t).sin() + 0.5 * (0.41 * w * t + j as f64).cos() }
    };
    let mut made = samples(6, 6000, swing);
    made.torque = arm.torque(&arm.motion(&made));
    noisy(&mut made, NOISE);
    made
}

/// Links 30 % heavier and lighter in turn, with the shape they have.
fn other_links(twin: &Twin) -> Twin {
    let mut other = twin.clone();
    for (i, body) in other.robot.bodies.iter_mut().enumerate() {
        let factor = if i % 2 == 0 { 1.3 } else { 0.7 };
        body.inertia.mass *= factor;
        body.inertia.about_com *= factor;
    }
    other
}

struct Fit {
    inertial: Inertial,
    arm: ArmProblem,
    result: MethodResult,
}

fn fit(twin: &Twin, terms: &Terms, samples: &Samples) -> Fit {
    let mut arm = assemble(samples, twin, terms, &BoundsByName::new()).unwrap();
    let mut inertial = Inertial::of(twin, terms);
    inertial.attach(&mut arm, samples, twin).unwrap();
    let settings = Settings { methods: vec![Method::Nlse], ..Settings::default() };
    let result = identify(&arm, None, &settings).unwrap().remove(0);
    Fit { inertial, arm, result }
}

#[test]
fn intervals_hold_the_arms_base_parameters() {
    let (twin, terms) = model();
    let truth = other_links(&twin);
    let Fit { inertial, arm, mut result } = fit(&twin, &terms, &recorded(&truth, 0));
    let values = inertial.base.values(&parameters::of(&truth.robot));
    let rows = inertial.take(&arm, &mut result);
    assert!(result.arm.is_empty(), "the rows are taken");
    let told: Vec<_> = rows.iter().zip(&values).filter(|(row, _)| row.identifiable).collect();
    let held = told.iter().filter(|(row, truth)| row.low <= **truth && **truth <= row.high);
    assert!(told.len() >= 24, "{} are told", told.len());
    // Of 99 % intervals.
    assert!(held.count() >= told.len() - 2);
    // Gravity tells the arms' first moments well.
    let of = |name: &str| rows.iter().zip(&values).find(|(row, _)| row.name == name).unwrap();
    for name in ["mcx_2", "mcx_3"] {
        let (row, truth) = of(name);
        assert!((row.value / truth - 1.0).abs() < 0.01, "{name}: {} of {truth}", row.value);
    }
}

#[test]
fn links_that_are_found_are_possible_and_have_the_arms_torque() {
    let (twin, terms) = model();
    let truth = other_links(&twin);
    let Fit { inertial, arm, result } = fit(&twin, &terms, &recorded(&truth, 0));
    let links = inertial.links(&arm, &result.found, &twin.robot, None).unwrap();
    assert!((0.07..=0.6).contains(&links.spread), "{}", links.spread);
    let robot = parameters::built_into(&twin.robot, &links.parameters);
    assert!(robot.bodies.iter().all(|b| is_possible(&b.inertia)));
    // On a motion of its own.
    let other = samples(6, 2000, |j, t| 0.9 * ((0.7 + 0.31 * j as f64) * t + j as f64).sin());
    let torque = |robot: &Robot| {
        crate::robot::inverse_dynamics_series(robot, &other.q, &other.qd, &other.qdd)
    };
    let (found, exact) = (torque(&robot), torque(&truth.robot));
    let wrong = torque(&twin.robot);
    // Rotors of joints 1 and 2 hold a part of what their links have.
    for joint in 2..6 {
        let off = |a: &JointSeries| -> f64 {
            let pairs = a.joint(joint).iter().zip(exact.joint(joint));
            (pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>() / other.len() as f64).sqrt()
        };
        assert!(off(&found) < 0.5 * NOISE, "joint {}: {}", joint + 1, off(&found));
        assert!(joint > 3 || off(&wrong) > 0.1, "joint {}: {}", joint + 1, off(&wrong));
    }
}

/// Torque without any noise is no obstacle.
#[test]
fn exact_torque_gives_the_links_of_the_arm() {
    let (twin, terms) = model();
    let mut made = recorded(&twin, 0);
    made.torque = twin.torque(&twin.motion(&made));
    let Fit { inertial, arm, result } = fit(&twin, &terms, &made);
    let links = inertial.links(&arm, &result.found, &twin.robot, None).unwrap();
    let off = (&links.parameters - parameters::of(&twin.robot))
        .component_div(&parameters::sizes(&twin.robot).map(|s| s.max(1e-12)));
    assert!(off.amax() < 0.02, "{off}");
}

/// A motion of the wrist alone says nothing of the arm's links, and that is said.
#[test]
fn what_a_motion_does_not_excite_is_not_told() {
    let (twin, terms) = model();
    let Fit { inertial, arm, mut result } = fit(&twin, &terms, &recorded(&twin, 4));
    let rows = inertial.take(&arm, &mut result);
    let row = rows.iter().find(|r| r.name == "Ixx_2").unwrap();
    let why = row.why_not.as_deref().unwrap_or_default();
    assert!(!row.identifiable && !why.is_empty(), "{row:?}");
    assert!(rows.iter().any(|r| r.identifiable && r.name == "mcx_6"));
    assert!(inertial.links(&arm, &result.found, &twin.robot, None).is_some());
}

/// A link that is heavier looks like a load: with links free to be, the load is as unsure as it is.
#[test]
fn a_payload_is_as_sure_as_the_links() {
    let (twin, _) = model();
    let names = ["coulomb", "viscous", "rotor_inertia", "payload"];
    let terms = Terms::named(names).unwrap();
    let mut truth = twin.clone();
    for (body, factor) in truth.robot.bodies.iter_mut().zip([1.0, 1.06, 0.93, 1.08, 1.05, 1.1]) {
        body.inertia.mass *= factor;
        body.inertia.about_com *= factor;
    }
    truth.effects.push("payload".into());
    let load = [("mass", 2.0), ("moment_x", 0.0), ("moment_y", 0.06), ("moment_z", 0.12)];
    for (name, value) in load {
        truth.values.insert(format!("payload_{name}"), vec![value]);
    }
    let made = recorded(&truth, 0);
    let arm = assemble(&made, &twin, &terms, &BoundsByName::new()).unwrap();
    let settings = Settings { methods: vec![Method::Nlse], ..Settings::default() };
    let mut results = identify(&arm, None, &settings).unwrap();
    let mass = |r: &[MethodResult]| {
        r[0].arm.iter().find(|p| p.name == "payload_mass").map(|p| (p.low, p.high)).unwrap()
    };
    let (low, high) = mass(&results);
    assert!(!(low <= 2.0 && 2.0 <= high), "{low} to {high}: nothing to mend");
    let spread = payload_beside_links(&arm, &made, &twin, &terms, &mut results).unwrap().unwrap();
    let (low, high) = mass(&results);
    assert!(low <= 2.0 && 2.0 <= high, "{low} to {high}, links {spread}");
    assert!(spread > 0.01, "{spread}");
}
