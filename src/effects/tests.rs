//! Properties over the whole catalogue.

mod by_hand;
mod samples;

use std::collections::HashSet;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use samples::{DT, Samples, pendulum};

/// Does it give the arm degrees of freedom of their own, or change its servos? What it injects is then tested
/// in the simulation.
fn is_structural(effect: &dyn Effect) -> bool {
    if effect.of_drive() == DriveKind::Servo {
        return true;
    }
    let typical: Vec<f64> = effect.about().parameters.iter().map(|p| p.typical).collect();
    let mut mechanism = Mechanism::new(pendulum());
    effect.build(&typical, 0, &mut mechanism);
    mechanism.transmission[0].is_some()
}

/// Effects that explain by columns.
fn columned() -> impl Iterator<Item = &'static dyn Effect> {
    CATALOGUE.iter().copied().filter(|e| e.seen() == Seen::Columns)
}

fn linear_count(effect: &dyn Effect) -> usize {
    effect.about().parameters.iter().filter(|p| p.role == Role::Linear).count()
}

/// Values within the bounds, the same draw for every effect; references where they belong.
fn draw(effect: &dyn Effect, rng: &mut ChaCha8Rng) -> Vec<f64> {
    // No link may weigh less than nothing.
    let least = |p: &Parameter| if p.unit == "kg" { p.min.max(0.0) } else { p.min };
    let inside = |p: &Parameter| least(p) + (p.max - least(p)) * rng.random_range(0.05..0.95);
    let mut drawn: Vec<f64> = effect.about().parameters.iter().map(inside).collect();
    effect.keep_physical(&mut drawn);
    let place = |name| effect.about().parameters.iter().position(|p| p.name == name);
    let own = |i: &usize| !effect.about().parameters[*i].is_reference();
    complete(effect, |name| place(name).filter(own).map(|i| drawn[i])).unwrap()
}

fn assert_close(name: &str, a: &JointSeries, b: &JointSeries, share: f64) {
    for joint in 0..a.joints() {
        let (a, b) = (a.joint(joint), b.joint(joint));
        let size = b.iter().fold(0.0, |m: f64, b| m.max(b.abs()));
        for (a, b) in a.iter().zip(b) {
            assert!((a - b).abs() <= share * size + 1e-11, "{name}, joint {joint}: {a} and {b}");
        }
    }
}

/// What an effect adds at a joint where others are, and move, elsewhere: the same unless the effect says that it feels them.
#[test]
fn an_effect_feels_other_joints_where_it_says_so() {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let robot = samples::random_arm(3, &mut rng);
    for effect in CATALOGUE.iter().copied() {
        let mut differs = false;
        for _ in 0..50 {
            let values = draw(effect, &mut rng);
            let mut three = |scale: f64| [(); 3].map(|()| scale * rng.random_range(-1.0..1.0));
            let [q, qd, transmitted] = [three(1.0), three(0.5), three(3.0)];
            let (others, moving) = (three(1.0), three(0.5));
            // What acts for a while may begin at any time within a day.
            let (time, temperature) = (rng.random_range(0.0..1e5), [30.0; 3]);
            let load = |q: &[f64; 3], qd: &[f64; 3]| {
                let (transmitted, temperature) = (&transmitted[..], &temperature[..]);
                let arm = ArmState { robot: &robot, time, dt: DT, q, qd, transmitted, temperature };
                let (mut load, mut memory) =
                    (JointLoad::default(), vec![0.0; effect.about().memory]);
                effect.act(&values, &arm.joint(1), &mut memory, &mut load);
                load
            };
            let elsewhere = |own: [f64; 3], other: [f64; 3]| [other[0], own[1], other[2]];
            differs |= load(&q, &qd) != load(&elsewhere(q, others), &elsewhere(qd, moving));
        }
        let name = effect.about().name;
        assert_eq!(differs, effect.feels_other_joints(), "{name}: feels_other_joints");
    }
}

/// A parameter whose column is empty stays at zero: the first joint has no inner neighbour. What is left
/// must still count as the effect, or a diagnosis could not name it there.
#[test]
fn an_effect_is_itself_wherever_it_acts() {
    let samples = Samples::random(5);
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    for effect in columned().filter(|e| e.about().scope == Scope::Joint) {
        let values = draw(effect, &mut rng);
        let (linear, nonlinear) = values.split_at(linear_count(effect));
        for joint in 0..samples.robot.dof() {
            let columns = effect.columns(&samples.motion(), joint, nonlinear);
            let acts = |c: &Vec<f64>| c.iter().any(|v| *v != 0.0);
            let shown = linear.iter().zip(&columns).map(|(v, c)| if acts(c) { *v } else { 0.0 });
            let shown: Vec<f64> = shown.collect();
            let name = effect.about().name;
            assert!(!columns.iter().any(acts) || effect.is_itself(&shown), "{name}, joint {joint}");
        }
    }
}

#[test]
fn declarations_are_complete() {
    let (mut effects, mut parameters) = (HashSet::new(), HashSet::new());
    let snake = |s: &str| {
        s.starts_with(|c: char| c.is_ascii_lowercase())
            && s.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
    };
    for effect in CATALOGUE {
        let about = effect.about();
        assert!(effects.insert(about.name) && snake(about.name), "{}", about.name);
        for text in [about.cause, about.remedy, about.source] {
            assert!(text.len() > 20 && !text.contains('\n'), "{}: {text}", about.name);
        }
        assert!(about.law.starts_with("tau "), "{}", about.name);
        let linear_first = about.parameters.is_sorted_by_key(|p| p.role == Role::Nonlinear);
        assert!(linear_first && !about.parameters.is_empty(), "{}", about.name);
        let has_columns = effect.seen() == Seen::Columns;
        assert_eq!(linear_count(*effect) > 0, has_columns, "{}", about.name);
        for p in about.parameters {
            assert!(parameters.insert(p.name) && snake(p.name), "{}", p.name);
            assert!(p.min < p.max && (p.min..=p.max).contains(&p.typical), "{}", p.name);
            assert!(!p.symbol.is_empty() && !p.unit.is_empty(), "{}", p.name);
            match p.role {
                Role::Linear => assert!((p.min..=p.max).contains(&p.null), "{}", p.name),
                Role::Nonlinear => {
                    assert!(p.null.is_nan() || p.null >= p.min, "{}", p.name);
                }
            }
            let sign_free = p.min < 0.0;
            // Of what is there no more than all can be lacking.
            let of_what_is_there = p.unit == "-" && p.min == -1.0;
            let even = p.min == -p.max || of_what_is_there;
            assert!(!sign_free || even, "{}: lopsided bounds", p.name);
        }
        assert_eq!(find(about.name).map(|e| e.about().name), Some(about.name));
        let trip = effect.round_trip();
        let trip = trip.unwrap_or_else(|| panic!("{}: say what comes back", about.name));
        assert_eq!(
            matches!(trip, RoundTrip::Fitted { .. } | RoundTrip::Followed { .. }),
            has_columns,
            "{}",
            about.name
        );
        let shows = if let RoundTrip::Fitted { shows, .. } = trip { shows } else { &[] };
        let own = |name: &&str| about.parameters.iter().any(|p| p.name == *name);
        assert!(shows.iter().all(own), "{}: {shows:?}", about.name);
    }
    assert!(find("no_such_effect").is_none());
}

/// A second of a joint that moves and is loaded, as recorded at 100 Hz.
fn channels(motion: impl Fn(f64) -> [f64; 4]) -> Channels {
    let rows: Vec<[f64; 4]> = (0..100).map(|k| motion(k as f64 * 0.01)).collect();
    let column = |i: usize| rows.iter().map(|r| r[i]).collect();
    let [q, qd, qdd, torque] = [0, 1, 2, 3].map(column);
    Channels { dt: 0.01, q, qd, qdd, torque, velocity_is_recorded: true }
}

#[test]
fn vanishes_at_its_null_value() {
    let samples = Samples::random(1);
    for effect in CATALOGUE {
        let about = effect.about();
        let value = |p: &Parameter| if p.null.is_nan() { p.typical } else { p.null };
        let null: Vec<f64> = about.parameters.iter().map(value).collect();
        let mut mechanism = Mechanism::new(samples.robot.clone());
        effect.build(&null, 1, &mut mechanism);
        assert_eq!(mechanism, Mechanism::new(samples.robot.clone()), "{}", about.name);
        let acting = samples.acting(*effect, &null, 1, &samples.q);
        assert!(acting.iter().all(|t| *t == 0.0), "{}", about.name);
        let sound = channels(|t| [t * t, 2.0 * t, 2.0, t.sin()]);
        let (mut measured, mut corrected) = (sound.clone(), sound.clone());
        effect.measure(&null, &mut measured);
        effect.correct(&null, &mut corrected);
        assert!(measured == sound && corrected == sound, "{}", about.name);
        for joint in 0..3 {
            let torque = samples.explained(*effect, &null, joint);
            assert_eq!(torque, JointSeries::zeros(3, torque.samples()), "{}", about.name);
        }
    }
}

/// Columns times values are what is injected, for several values: so the injected torque is linear
/// in the linear parameters as well.
#[test]
fn explains_what_it_injects() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    for effect in columned().filter(|e| !is_structural(*e)) {
        let name = effect.about().name;
        for seed in 0..5 {
            let samples = Samples::random(seed);
            let values = draw(effect, &mut rng);
            for from in 0..3 {
                let explained = samples.explained(effect, &values, from);
                assert_close(name, &explained, &samples.injected(effect, &values, from), 1e-9);
            }
        }
    }
}

#[test]
fn shows_somewhere_at_its_typical_value() {
    let samples = Samples::random(3);
    for effect in columned() {
        let typical: Vec<f64> = effect.about().parameters.iter().map(|p| p.typical).collect();
        let torque = samples.explained(effect, &typical, 1);
        let torque = torque.joint(1);
        let rms = (torque.iter().map(|t| t * t).sum::<f64>() / torque.len() as f64).sqrt();
        assert!((0.001..50.0).contains(&rms), "{}: {rms} N.m", effect.about().name);
    }
}

/// Where searches begin: a row of all nonlinear parameters each, inside their bounds.
#[test]
fn searches_begin_within_the_bounds() {
    let samples = Samples::random(6);
    for effect in CATALOGUE {
        let about = effect.about();
        let nonlinear: Vec<_> =
            about.parameters.iter().filter(|p| p.role == Role::Nonlinear).collect();
        for joint in 0..3 {
            let rows = effect.starts(&samples.motion(), joint);
            assert!(!rows.is_empty(), "{}", about.name);
            for row in rows {
                assert_eq!(row.len(), nonlinear.len(), "{}", about.name);
                for (value, p) in row.iter().zip(&nonlinear) {
                    assert!((p.min..=p.max).contains(value), "{}: {}", p.name, value);
                }
            }
        }
    }
}

/// References settle on what was fitted and stay there.
#[test]
fn references_follow_the_fitted_values() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for effect in CATALOGUE {
        let values = draw(*effect, &mut rng);
        let (linear, nonlinear) = values.split_at(linear_count(*effect));
        let mut settled = nonlinear.to_vec();
        effect.settle(linear, &mut settled);
        assert_eq!(settled, nonlinear, "{}", effect.about().name);
    }
    let payload = |mass: f64| {
        let mut reference = [0.0; 3];
        find("payload")
            .unwrap()
            .settle(&[&[mass, 0.1, 0.0, 0.2], &[0.0; 6][..]].concat(), &mut reference);
        reference
    };
    assert_eq!(payload(2.0), [0.05, 0.0, 0.1]);
    assert_eq!(payload(0.0), [0.0; 3]);
}

#[test]
fn dissipative_effects_take_energy() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let injected = |e: &&'static dyn Effect| !is_structural(*e);
    for effect in columned().filter(|e| e.about().dissipates).filter(injected) {
        for seed in 0..20 {
            let samples = Samples::random(seed);
            let values = draw(effect, &mut rng);
            for joint in 0..3 {
                let torque = samples.injected(effect, &values, joint);
                let power = torque.joint(joint).iter().zip(samples.qd.joint(joint));
                assert!(power.into_iter().all(|(t, qd)| t * qd >= 0.0), "{}", effect.about().name);
            }
        }
    }
    let takes = |name: &str| find(name).is_some_and(|e| e.about().dissipates);
    assert!(takes("coulomb") && takes("viscous") && !takes("current_offset"));
}

/// Bristles store energy on the way; around a closed loop they take some.
#[test]
fn presliding_takes_energy_around_a_loop() {
    let swing = |k: usize| 0.01 * (k as f64 * 0.1).sin();
    let q = JointSeries::from_joints(&[(0..630).map(swing).collect()]);
    let samples = Samples::along(pendulum(), q);
    for name in ["presliding", "lugre", "maxwell_slip", "cable_spring"] {
        let effect = find(name).unwrap();
        let typical: Vec<f64> = effect.about().parameters.iter().map(|p| p.typical).collect();
        let torque = samples.injected(effect, &typical, 0);
        let work = torque.joint(0).iter().zip(samples.qd.joint(0)).map(|(t, qd)| t * qd * DT);
        let loops = work.skip(63).sum::<f64>();
        assert!(loops > 1e-4, "{name}: {loops} J");
    }
}
