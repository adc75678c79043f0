//! Properties over the whole catalogue.

mod by_hand;

use std::collections::HashSet;

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::robot::{Body, Inertia, Joint, Limits, Placement, Robot, inverse_dynamics_series};

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

/// Of every joint, deg C.
const TEMPERATURE_C: f64 = 45.0;
const DT: f64 = 0.02;
/// Columns that hold to first order: compared at values this much smaller, less exactly.
const FIRST_ORDER: [&str; 1] = ["encoder_offset"];
const SMALL: f64 = 1e-5;
/// Degrees of freedom of their own: what they inject is tested in the simulation.
const STRUCTURAL: [&str; 2] = ["backlash", "joint_flexibility"];

struct Samples {
    robot: Robot,
    q: JointSeries,
    qd: JointSeries,
    qdd: JointSeries,
    temperature: JointSeries,
}

impl Samples {
    /// Three joints that swing from rest; velocities are backward differences of the angles.
    fn random(seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let robot = random_arm(3, &mut rng);
        let mut swing = |_| {
            let [start, size] = [3.0, 1.0].map(|scale| scale * rng.random_range(-1.0..1.0));
            let rate = rng.random_range(1.0..4.0);
            (0..60).map(|k| start + size * (1.0 - (rate * k as f64 * DT).cos())).collect()
        };
        Self::along(robot, JointSeries::from_joints(&[0, 1, 2].map(&mut swing)))
    }

    fn along(robot: Robot, q: JointSeries) -> Self {
        let backward = |x: &JointSeries| {
            x.map_joints(|_, x| (0..x.len()).map(|k| (x[k] - x[k.max(1) - 1]) / DT).collect())
        };
        let (qd, temperature) = (backward(&q), q.map_joints(|_, q| vec![TEMPERATURE_C; q.len()]));
        Self { robot, qdd: backward(&qd), q, qd, temperature }
    }

    /// The pendulum through q, qd, qdd, one row per sample.
    fn rows(rows: &[[f64; 3]]) -> Self {
        let series = |i: usize| JointSeries::from_joints(&[rows.iter().map(|r| r[i]).collect()]);
        let temperature = JointSeries::from_joints(&[vec![TEMPERATURE_C; rows.len()]]);
        let [q, qd, qdd] = [0, 1, 2].map(series);
        Self { robot: pendulum(), q, qd, qdd, temperature }
    }

    fn motion(&self) -> Motion<'_> {
        let motion = Motion::new(&self.robot, DT, &self.q, &self.qd, &self.qdd);
        Motion { temperature: Some(&self.temperature), ..motion }
    }

    /// At every joint, of the values of joint `from` (or of the whole arm).
    fn explained(&self, effect: &dyn Effect, values: &[f64], from: usize) -> JointSeries {
        let (linear, nonlinear) = values.split_at(linear_count(effect));
        let (motion, n) = (self.motion(), self.q.samples());
        let mut sum = JointSeries::zeros(self.robot.dof(), n);
        let mut add = |joint: usize, columns: Vec<Vec<f64>>| {
            assert_eq!(columns.len(), linear.len(), "{}", effect.about().name);
            for (column, value) in columns.iter().zip(linear) {
                assert_eq!(column.len(), n, "{}", effect.about().name);
                sum.joint_mut(joint).iter_mut().zip(column).for_each(|(s, c)| *s += c * value);
            }
        };
        match effect.about().scope {
            Scope::Joint => add(from, effect.columns(&motion, from, nonlinear)),
            Scope::Arm => (0..self.robot.dof())
                .for_each(|joint| add(joint, effect.columns(&motion, joint, nonlinear))),
            Scope::Link => {
                let reach = effect.reach(&motion, from, nonlinear);
                for joint in 0..self.robot.dof() {
                    add(joint, reach.iter().map(|s| s.joint(joint).to_vec()).collect());
                }
                let own = effect.columns(&motion, from, nonlinear);
                let same = own.iter().zip(&reach).all(|(c, s)| c == s.joint(from));
                assert!(same, "{}", effect.about().name);
            }
        }
        sum
    }

    /// What `build` and `act` make the drives supply while the joints slide.
    fn injected(&self, effect: &dyn Effect, values: &[f64], from: usize) -> JointSeries {
        let mut mechanism = Mechanism::new(self.robot.clone());
        effect.build(values, from, &mut mechanism);
        let true_q =
            self.q.map_joints(|j, q| q.iter().map(|q| q - mechanism.encoder_zero[j]).collect());
        let before = inverse_dynamics_series(&self.robot, &self.q, &self.qd, &self.qdd);
        let after = inverse_dynamics_series(&mechanism.robot, &true_q, &self.qd, &self.qdd);
        let added = |joint: usize, after: &[f64]| {
            let acts = joint == from || effect.about().scope == Scope::Arm;
            let acting = match acts {
                true => self.acting(effect, values, joint, &before),
                false => vec![0.0; after.len()],
            };
            let armature = mechanism.armature[joint];
            let torque = (0..after.len())
                .map(|k| after[k] + acting[k] + armature * self.qdd.joint(joint)[k])
                .map(|torque| mechanism.torque_gain[joint] * torque);
            torque.zip(before.joint(joint)).map(|(after, before)| after - before).collect()
        };
        after.map_joints(added)
    }

    /// What `act` makes the drive of one joint supply while it slides.
    fn acting(
        &self,
        effect: &dyn Effect,
        values: &[f64],
        joint: usize,
        carried: &JointSeries,
    ) -> Vec<f64> {
        let mut memory = vec![0.0; effect.about().memory];
        let step = |k: usize| {
            let at = |series: &JointSeries| sample(series, k);
            let arm = ArmState {
                robot: &self.robot,
                time: DT * k as f64,
                dt: DT,
                q: &at(&self.q),
                qd: &at(&self.qd),
                transmitted: &at(carried),
                temperature: &at(&self.temperature),
            };
            let mut load = JointLoad::default();
            effect.act(values, &arm.joint(joint), &mut memory, &mut load);
            let qd = self.qd.joint(joint)[k];
            load.dry * coulomb::sign(qd) + load.damping * qd + load.torque
        };
        (0..self.q.samples()).map(step).collect()
    }
}

fn sample(series: &JointSeries, k: usize) -> Vec<f64> {
    let mut values = vec![0.0; series.joints()];
    series.sample_into(k, &mut values);
    values
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
    let drawn: Vec<f64> = effect.about().parameters.iter().map(inside).collect();
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
            assert!(!sign_free || p.min == -p.max, "{}: lopsided bounds", p.name);
        }
        assert_eq!(find(about.name).map(|e| e.about().name), Some(about.name));
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
    for effect in columned().filter(|e| !STRUCTURAL.contains(&e.about().name)) {
        let name = effect.about().name;
        for seed in 0..5 {
            let samples = Samples::random(seed);
            let mut values = draw(effect, &mut rng);
            let share = if FIRST_ORDER.contains(&name) { 1e-3 } else { 1e-9 };
            if FIRST_ORDER.contains(&name) {
                values.iter_mut().for_each(|v| *v *= SMALL);
            }
            for from in 0..3 {
                let explained = samples.explained(effect, &values, from);
                assert_close(name, &explained, &samples.injected(effect, &values, from), share);
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
        find("payload").unwrap().settle(&[mass, 0.1, 0.0, 0.2], &mut reference);
        reference
    };
    assert_eq!(payload(2.0), [0.05, 0.0, 0.1]);
    assert_eq!(payload(0.0), [0.0; 3]);
}

#[test]
fn dissipative_effects_take_energy() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    for effect in columned().filter(|e| e.about().dissipates) {
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
