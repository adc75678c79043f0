//! What acts on channels and limits alone: true motion stays, and the values can be read off.

use super::driven::Driven;
use super::*;
use crate::effects::find;

/// Without noise.
fn experiment() -> Experiment {
    let text = "
        [drive]
        rotor_inertia = [1.1, 1.1, 1.1, 0.14, 0.14, 0.14]
        [motion]
        kind = \"random_frequency\"
        duration_s = 5
        [effects.coulomb]
        coulomb = [6, 7, 5, 1.5, 1.2, 1]
        [effects.viscous]
        viscous = [8, 9, 7, 1.5, 1.2, 1]";
    Scenario::parse(text, "test").unwrap().work_out("test").unwrap()
}

/// With an effect at these values at every joint.
fn run(effect: Option<(&'static dyn Effect, Vec<f64>)>) -> Run {
    let mut made = experiment();
    let injection = |(effect, values): (&'static dyn Effect, Vec<f64>)| Injection {
        effect,
        joints: (0..6).collect(),
        values: vec![values; 6],
    };
    made.setup.effects.extend(effect.map(injection));
    Simulation::new(&made.setup).unwrap().run(&made.fit, 1, 0, &mut |_| true).unwrap()
}

/// What the current of a joint stands for, N.m.
fn recorded_torque(run: &Run, joint: usize) -> Vec<f64> {
    let ampere = experiment().setup.drive.torque_per_ampere(joint);
    run.shown.current.joint(joint).iter().map(|current| ampere * current).collect()
}

fn usual(effect: &'static dyn Effect) -> Vec<f64> {
    effect.about().parameters.iter().map(|p| p.typical).collect()
}

/// Sensors, limits and controllers move nothing by themselves: the same torque of the motors moves
/// the same arm, to the last bit.
#[test]
fn what_neither_loads_nor_weighs_nor_gives_way_moves_nothing() {
    let moved = |effect| {
        let mut arm = Driven::new(effect, 1e-3);
        for _ in 0..500 {
            arm.step();
        }
        arm.plant.q().to_vec()
    };
    let idle: Vec<_> = CATALOGUE.iter().copied().filter(|e| !acts(*e)).collect();
    assert!(idle.len() >= 7, "{}", idle.len());
    for effect in idle {
        assert_eq!(moved(Some(effect)), moved(None), "{}", effect.about().name);
    }
}

/// What changes nothing before the first step and nothing in any shows in the channels alone, also
/// where a controller closes the loop.
#[test]
fn effects_of_channels_change_the_recording_and_not_the_motion() {
    let of_channels =
        |e: &&'static dyn Effect| !loads_joints(*e, 20.0) && injected(Some(*e)).0 == arm();
    let clean = run(None);
    let effects: Vec<_> = CATALOGUE.iter().copied().filter(of_channels).collect();
    assert!(effects.len() >= 3, "{}", effects.len());
    for effect in effects {
        let (name, seen) = (effect.about().name, run(Some((effect, usual(effect)))));
        assert_eq!(seen.exact, clean.exact, "{name}");
        assert_ne!(seen.recording.channels, clean.recording.channels, "{name}");
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
}

/// Asked for more, a motor gives its limit and not less, truly and as recorded.
#[test]
fn the_largest_torque_is_the_limit() {
    let effect = find("torque_saturation").unwrap();
    let asked = largest(run(None).exact.tau.joint(0));
    for limit in [0.97 * asked, 0.9 * asked] {
        let held = run(Some((effect, vec![limit])));
        for torque in [held.exact.tau.joint(0), &recorded_torque(&held, 0)] {
            assert!((largest(torque) / limit - 1.0).abs() < 1e-12, "{limit}");
        }
    }
}

/// The smallest difference between values that differ.
fn step_of(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    let steps = values.windows(2).map(|w| w[1] - w[0]).filter(|step| *step > 1e-9);
    steps.fold(f64::INFINITY, f64::min)
}

#[test]
fn steps_of_rounded_channels_can_be_read_off() {
    let effect = find("quantisation").unwrap();
    let rounded = run(Some((effect, usual(effect))));
    let Shown { q, qd, .. } = &rounded.shown;
    for joint in 0..6 {
        let torque = recorded_torque(&rounded, joint);
        let found = [q.joint(joint), qd.joint(joint), &torque].map(step_of);
        for (found, step) in found.into_iter().zip(usual(effect)) {
            assert!((found / step - 1.0).abs() < 1e-6, "joint {joint}: {found}, not {step}");
        }
    }
}
