//! Properties over the whole catalogue, and one closed-form number per effect.

use std::collections::HashSet;

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::robot::{Body, Inertia, Joint, Limits, Placement, inverse_dynamics_series};

/// A chain of `dof` joints with random masses, axes and offsets.
fn random_arm(dof: usize, rng: &mut ChaCha8Rng) -> Robot {
    let mut vector = |scale: f64| {
        Vector3::from_fn(|_, _| scale * rng.random_range(-1.0..1.0)) + Vector3::x() * 0.1
    };
    let limits = Limits { lower: -3.0, upper: 3.0, velocity: 3.0, effort: 100.0 };
    let mut body = |j: usize| Body {
        name: format!("body{j}"),
        parent: j.checked_sub(1),
        joint: Joint {
            name: format!("joint{j}"),
            placement: Placement {
                rotation: Rotation3::new(vector(1.0)).into_inner(),
                translation: vector(0.4),
            },
            axis: Unit::new_normalize(vector(1.0)),
            limits,
        },
        inertia: Inertia {
            mass: 2.0 + j as f64,
            com: vector(0.2),
            about_com: Matrix3::from_diagonal(&Vector3::new(0.02, 0.03, 0.04)),
        },
    };
    let bodies = (0..dof).map(&mut body).collect();
    let flange = Placement {
        rotation: Rotation3::new(Vector3::new(0.3, -0.4, 0.5)).into_inner(),
        translation: Vector3::new(0.05, -0.02, 0.1),
    };
    Robot { name: "random".into(), bodies, gravity: Vector3::new(0.1, 0.2, -9.81), flange }
}

/// One joint about y, so that gravity pulls on what lies along x; 3 kg at 0.4 m; flange at 0.5 m.
fn pendulum() -> Robot {
    let mut arm = random_arm(1, &mut ChaCha8Rng::seed_from_u64(0));
    let body = &mut arm.bodies[0];
    body.joint.placement = Placement::identity();
    body.joint.axis = Unit::new_normalize(-Vector3::y());
    body.inertia =
        Inertia { mass: 3.0, com: Vector3::x() * 0.4, about_com: Matrix3::identity() * 0.01 };
    arm.gravity = Vector3::new(0.0, 0.0, -9.81);
    arm.flange = Placement { rotation: Matrix3::identity(), translation: Vector3::x() * 0.5 };
    arm
}

struct Samples {
    robot: Robot,
    q: JointSeries,
    qd: JointSeries,
    qdd: JointSeries,
}

impl Samples {
    fn random(seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let robot = random_arm(3, &mut rng);
        let mut series = |scale: f64| {
            let row = |_| (0..20).map(|_| scale * rng.random_range(-1.0..1.0)).collect();
            JointSeries::from_joints(&(0..3).map(row).collect::<Vec<Vec<f64>>>())
        };
        let (q, qd, qdd) = (series(3.0), series(1.0), series(5.0));
        Self { robot, q, qd, qdd }
    }

    fn one(robot: Robot, q: f64, qd: f64, qdd: f64) -> Self {
        let one = |x: f64| JointSeries::from_joints(&[vec![x]]);
        Self { robot, q: one(q), qd: one(qd), qdd: one(qdd) }
    }

    fn motion(&self) -> Motion<'_> {
        Motion::new(&self.robot, 0.01, &self.q, &self.qd, &self.qdd)
    }

    fn explained(&self, effect: &dyn Effect, values: &[f64], joint: usize) -> Vec<f64> {
        let linear = linear_count(effect);
        let columns = effect.columns(&self.motion(), joint, &values[linear..]);
        assert_eq!(columns.len(), linear, "{}", effect.about().name);
        let mut sum = vec![0.0; self.q.samples()];
        for (column, value) in columns.iter().zip(values) {
            assert_eq!(column.len(), sum.len(), "{}", effect.about().name);
            sum.iter_mut().zip(column).for_each(|(s, c)| *s += c * value);
        }
        sum
    }

    /// What `build` and `act` make the drive supply while the joint slides.
    fn injected(&self, effect: &dyn Effect, values: &[f64], joint: usize) -> Vec<f64> {
        let mut mechanism = Mechanism::new(self.robot.clone());
        effect.build(values, joint, &mut mechanism);
        if effect.about().name == "payload" {
            mechanism.robot = without_second_moment(&self.robot, values);
        }
        let rigid = |robot: &Robot| inverse_dynamics_series(robot, &self.q, &self.qd, &self.qdd);
        let (before, after) = (rigid(&self.robot), rigid(&mechanism.robot));
        (0..self.q.samples())
            .map(|k| {
                let qd = self.qd.joint(joint)[k];
                let transmitted = before.joint(joint)[k];
                let state = JointState {
                    q: self.q.joint(joint)[k],
                    qd,
                    transmitted,
                    ..JointState::default()
                };
                let mut load = JointLoad::default();
                effect.act(values, &state, &mut vec![0.0; effect.about().memory], &mut load);
                let sliding = load.dry * coulomb::sign(qd) + load.damping * qd + load.torque;
                let built = after.joint(joint)[k] - transmitted
                    + mechanism.armature[joint] * self.qdd.joint(joint)[k];
                sliding + built
            })
            .collect()
    }
}

/// The columns of a payload leave out what is quadratic in its centre of mass (see payload.rs).
fn without_second_moment(robot: &Robot, values: &[f64]) -> Robot {
    let com = Vector3::new(values[1], values[2], values[3]) / values[0];
    let about_flange = Matrix3::identity() * com.dot(&com) - com * com.transpose();
    robot.with_payload(values[0], com, -values[0] * about_flange)
}

fn linear_count(effect: &dyn Effect) -> usize {
    effect.about().parameters.iter().filter(|p| p.role == Role::Linear).count()
}

/// Values within the bounds, the same draw for every effect.
fn draw(effect: &dyn Effect, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let inside = |p: &Parameter| p.min + (p.max - p.min) * rng.random_range(0.05..0.95);
    effect.about().parameters.iter().map(inside).collect()
}

fn assert_close(name: &str, a: &[f64], b: &[f64]) {
    for (a, b) in a.iter().zip(b) {
        assert!((a - b).abs() <= 1e-9 * (1.0 + b.abs()), "{name}: {a} and {b}");
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
        assert!(about.law.starts_with("tau = "), "{}", about.name);
        let linear_first = about.parameters.is_sorted_by_key(|p| p.role == Role::Nonlinear);
        assert!(linear_first && !about.parameters.is_empty(), "{}", about.name);
        for p in about.parameters {
            assert!(parameters.insert(p.name) && snake(p.name), "{}", p.name);
            assert!(p.min < p.max && (p.min..=p.max).contains(&p.typical), "{}", p.name);
            assert!(!p.symbol.is_empty() && !p.unit.is_empty(), "{}", p.name);
            match p.role {
                Role::Linear => assert!((p.min..=p.max).contains(&p.null), "{}", p.name),
                Role::Nonlinear => assert!(p.null.is_nan() || p.null.is_finite(), "{}", p.name),
            }
            let sign_free = p.min < 0.0;
            assert!(!sign_free || p.min == -p.max, "{}: lopsided bounds", p.name);
        }
        assert_eq!(find(about.name).map(|e| e.about().name), Some(about.name));
    }
    assert!(find("no_such_effect").is_none());
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
        let state = JointState { q: 0.4, qd: -0.3, transmitted: 5.0, ..JointState::default() };
        let mut load = JointLoad::default();
        effect.act(&null, &state, &mut vec![0.0; about.memory], &mut load);
        assert_eq!(load, JointLoad::default(), "{}", about.name);
        for joint in 0..3 {
            let torque = samples.explained(*effect, &null, joint);
            assert!(torque.iter().all(|&t| t == 0.0), "{}", about.name);
        }
    }
}

/// Columns times values are what is injected, for several values: so the injected torque is linear
/// in the linear parameters as well.
#[test]
fn explains_what_it_injects() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    for effect in CATALOGUE {
        for seed in 0..5 {
            let samples = Samples::random(seed);
            let values = draw(*effect, &mut rng);
            for joint in 0..3 {
                let name = effect.about().name;
                let explained = samples.explained(*effect, &values, joint);
                assert_close(name, &explained, &samples.injected(*effect, &values, joint));
            }
        }
    }
}

#[test]
fn shows_somewhere_at_its_typical_value() {
    let samples = Samples::random(3);
    for effect in CATALOGUE {
        let typical: Vec<f64> = effect.about().parameters.iter().map(|p| p.typical).collect();
        let torque = samples.explained(*effect, &typical, 1);
        let rms = (torque.iter().map(|t| t * t).sum::<f64>() / torque.len() as f64).sqrt();
        assert!((0.02..50.0).contains(&rms), "{}: {rms} N.m", effect.about().name);
    }
}

#[test]
fn dissipative_effects_take_energy() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    for effect in CATALOGUE.iter().filter(|e| e.about().dissipates) {
        for seed in 0..20 {
            let samples = Samples::random(seed);
            let values = draw(*effect, &mut rng);
            for joint in 0..3 {
                let torque = samples.injected(*effect, &values, joint);
                let power = torque.iter().zip(samples.qd.joint(joint)).map(|(t, qd)| t * qd);
                assert!(power.into_iter().all(|p| p >= 0.0), "{}", effect.about().name);
            }
        }
    }
    let takes = |name: &str| find(name).is_some_and(|e| e.about().dissipates);
    assert!(takes("coulomb") && takes("viscous") && !takes("current_offset"));
}

/// Values, motion (q, qd, qdd of a pendulum of 3 kg at 0.4 m, flange at 0.5 m) and the torque
/// worked out by hand. A new effect needs a line here.
fn closed_form(name: &str) -> (Vec<f64>, [f64; 3], f64) {
    match name {
        "coulomb" => (vec![5.0], [0.0, -0.3, 0.0], -5.0),
        "viscous" => (vec![6.0], [0.0, -0.5, 0.0], -3.0),
        "viscous_quadratic" => (vec![2.0], [0.0, -0.5, 0.0], -0.5),
        "viscous_cubic" => (vec![4.0], [0.0, -0.5, 0.0], -0.5),
        // 2 / e at the Stribeck velocity
        "stribeck" => (vec![2.0, 0.05], [0.0, 0.05, 0.0], 0.735_758_882_342_884_6),
        "rotor_inertia" => (vec![1.1], [0.3, 1.0, -2.0], -2.2),
        "current_offset" => (vec![-0.7], [1.0, 1.0, 1.0], -0.7),
        // 0.05 x 3 kg x 9.81 m/s2 x 0.4 m cos 60 deg
        "load_friction" => (vec![0.05], [std::f64::consts::FRAC_PI_3, 0.1, 0.0], 0.2943),
        // (2 kg x 0.5 m + 0.1 kg.m) x 9.81 m/s2 held level, plus the inertia
        // 2 kg (0.5 m)^2 + 2 x 0.5 m x 0.1 kg.m at 3 rad/s2
        "payload" => (vec![2.0, 0.1, 0.0, 0.0], [0.0, 0.0, 3.0], 10.791 + 1.8),
        _ => panic!("{name}: work out a number by hand and put it here"),
    }
}

#[test]
fn agrees_with_numbers_worked_out_by_hand() {
    for effect in CATALOGUE {
        let name = effect.about().name;
        let (values, [q, qd, qdd], expected) = closed_form(name);
        let sample = Samples::one(pendulum(), q, qd, qdd);
        assert_close(name, &sample.explained(*effect, &values, 0), &[expected]);
        assert_close(name, &sample.injected(*effect, &values, 0), &[expected]);
    }
}
