//! Physics identities on seeded random trees, and a closed-form double pendulum. Golden numbers
//! from pinocchio are in `tests/golden`.

use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Unit, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::robot::{Body, Inertia, Joint, Limits, Placement, builtin};
use crate::series::JointSeries;

const SEEDS: std::ops::Range<u64> = 0..20;

struct State {
    robot: Robot,
    ws: Workspace,
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
}

impl State {
    /// A tree of seven bodies with random axes, inertias and gravity, in random motion.
    fn random(seed: u64) -> Self {
        let rng = &mut ChaCha8Rng::seed_from_u64(seed);
        let bodies = (0..7).map(|i| random_body(rng, i)).collect();
        let flange = random_placement(rng);
        let gravity = vector(rng) * 10.0;
        let robot =
            Robot { name: format!("tree {seed}"), bodies, gravity, flange, flange_on: None };
        let ws = Workspace::new(&robot);
        let mut draw = || (0..7).map(|_| rng.random_range(-2.0..2.0)).collect::<Vec<f64>>();
        Self { robot, ws, q: draw(), qd: draw(), qdd: draw() }
    }

    fn tau(&mut self, qdd: &[f64]) -> DVector<f64> {
        let mut tau = vec![0.0; 7];
        inverse_dynamics(&self.robot, &mut self.ws, &self.q, &self.qd, qdd, &mut tau);
        tau.into()
    }

    fn mass(&mut self) -> DMatrix<f64> {
        mass_matrix(&self.robot, &mut self.ws, &self.q)
    }

    fn energy(&mut self, q: &[f64]) -> Energy {
        energy(&self.robot, &mut self.ws, q, &self.qd)
    }
}

fn vector(rng: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0))
}

fn random_placement(rng: &mut ChaCha8Rng) -> Placement {
    let rotation = *Rotation3::new(vector(rng) * 3.0).matrix();
    Placement { rotation, translation: vector(rng) }
}

fn random_body(rng: &mut ChaCha8Rng, i: usize) -> Body {
    let root = Matrix3::from_fn(|_, _| rng.random_range(-0.5..0.5));
    let about_com = root * root.transpose() + Matrix3::identity() * 0.01;
    let inertia = Inertia { mass: rng.random_range(0.1..5.0), com: vector(rng), about_com };
    let placement = random_placement(rng);
    let axis = Unit::new_normalize(vector(rng));
    let limits = Limits { lower: -3.0, upper: 3.0, velocity: 3.0, effort: 100.0 };
    let joint = Joint { name: format!("joint {i}"), placement, axis, limits };
    let parent = (i > 0).then(|| rng.random_range(0..i));
    Body { name: format!("body {i}"), parent, joint, inertia }
}

fn assert_close(a: &DVector<f64>, b: &DVector<f64>, tolerance: f64) {
    let error = (a - b).amax();
    assert!(error <= tolerance * (1.0 + a.amax()), "{error:e} apart: {a} {b}");
}

/// Central difference of `f` along `direction` from the state's q.
fn along(s: &State, direction: &[f64], mut f: impl FnMut(&[f64]) -> f64) -> f64 {
    let h = 1e-5;
    let at = |sign: f64| -> Vec<f64> {
        s.q.iter().zip(direction).map(|(q, d)| q + sign * h * d).collect()
    };
    (f(&at(1.0)) - f(&at(-1.0))) / (2.0 * h)
}

#[test]
fn torque_is_linear_in_acceleration_with_the_mass_matrix_as_slope() {
    for seed in SEEDS {
        let mut s = State::random(seed);
        let bias = s.tau(&[0.0; 7]);
        let m = s.mass();
        for j in 0..7 {
            let mut unit = [0.0; 7];
            unit[j] = 1.0;
            let column = s.tau(&unit) - &bias;
            assert_close(&m.column(j).into_owned(), &column, 1e-12);
        }
        assert!(m.clone().cholesky().is_some(), "not positive definite: {m}");
    }
}

#[test]
fn forward_dynamics_undoes_inverse_dynamics_with_and_without_rotors() {
    for seed in SEEDS {
        let mut s = State::random(seed);
        let wanted = DVector::from_vec(s.qdd.clone());
        let qdd = s.qdd.clone();
        let tau = s.tau(&qdd);
        let mut got = vec![0.0; 7];
        forward_dynamics(&s.robot, &mut s.ws, &s.q, &s.qd, tau.as_slice(), &mut got);
        assert_close(&wanted, &got.clone().into(), 1e-9);

        let rotors = [0.3, 0.0, 1.0, 0.1, 2.0, 0.5, 0.7];
        let loaded = tau + DVector::from_fn(7, |i, _| rotors[i] * qdd[i]);
        let (q, qd, tau) = (&s.q, &s.qd, loaded.as_slice());
        forward_dynamics_with_rotors(&s.robot, &mut s.ws, &rotors, q, qd, tau, &mut got);
        assert_close(&wanted, &got.into(), 1e-9);
    }
}

#[test]
fn gravity_torque_is_the_gradient_of_the_potential_and_inverse_dynamics_at_rest() {
    for seed in SEEDS {
        let mut s = State::random(seed);
        let mut g = vec![0.0; 7];
        gravity_torque(&s.robot, &mut s.ws, &s.q, &mut g);
        let g = DVector::from_vec(g);
        s.qd = vec![0.0; 7];
        assert_close(&s.tau(&[0.0; 7]), &g, 1e-12);
        let gradient = DVector::from_fn(7, |j, _| {
            let mut unit = [0.0; 7];
            unit[j] = 1.0;
            let mut ws = s.ws.clone();
            along(&s, &unit, |q| energy(&s.robot, &mut ws, q, &s.qd).potential)
        });
        assert_close(&gradient, &g, 1e-7);
    }
}

#[test]
fn kinetic_energy_is_the_quadratic_form_of_the_mass_matrix() {
    for seed in SEEDS {
        let mut s = State::random(seed);
        let qd = DVector::from_vec(s.qd.clone());
        let q = s.q.clone();
        let kinetic = s.energy(&q).kinetic;
        let form = 0.5 * qd.dot(&(s.mass() * &qd));
        assert!((kinetic - form).abs() <= 1e-12 * (1.0 + form), "{kinetic} {form}");
    }
}

/// Both at once, into a matrix that held something else.
#[test]
fn the_equation_of_motion_is_the_mass_matrix_beside_the_torque_of_no_acceleration() {
    for seed in SEEDS {
        let mut s = State::random(seed);
        let (mass, torque) = (s.mass(), s.tau(&[0.0; 7]));
        let (mut m, mut bias) = (DMatrix::from_element(7, 7, 1e3), vec![0.0; 7]);
        equation_of_motion(&s.robot, &mut s.ws, [&s.q, &s.qd], &mut m, &mut bias);
        assert_eq!(m, mass);
        assert_close(&DVector::from_vec(bias), &torque, 1e-12);
    }
}

/// Without drive the power qd . (C qd) equals 1/2 qd . dM/dt qd: dM/dt - 2 C does no work.
#[test]
fn coriolis_forces_do_no_work_beyond_the_change_of_the_mass_matrix() {
    for seed in SEEDS {
        let mut s = State::random(seed);
        s.robot.gravity = Vector3::zeros();
        let qd = DVector::from_vec(s.qd.clone());
        let power = qd.dot(&s.tau(&[0.0; 7]));
        let mut ws = s.ws.clone();
        let mass_rate = along(&s, &s.qd, |q| (mass_matrix(&s.robot, &mut ws, q) * &qd).dot(&qd));
        assert!(
            (2.0 * power - mass_rate).abs() <= 1e-6 * (1.0 + power.abs()),
            "{power} {mass_rate}"
        );
    }
}

#[test]
fn the_drive_power_is_the_rate_of_energy() {
    for seed in SEEDS {
        let mut s = State::random(seed);
        let qdd = s.qdd.clone();
        let power = DVector::from_vec(s.qd.clone()).dot(&s.tau(&qdd));
        let h = 1e-5;
        let mut total = |sign: f64| {
            let t = sign * h;
            let q: Vec<f64> = (0..7).map(|j| s.q[j] + t * s.qd[j] + 0.5 * t * t * qdd[j]).collect();
            let qd: Vec<f64> = (0..7).map(|j| s.qd[j] + t * qdd[j]).collect();
            energy(&s.robot, &mut s.ws, &q, &qd).total()
        };
        let rate = (total(1.0) - total(-1.0)) / (2.0 * h);
        assert!((power - rate).abs() <= 1e-6 * (1.0 + power.abs()), "{power} {rate}");
    }
}

#[test]
fn regressor_times_parameters_is_inverse_dynamics() {
    for seed in SEEDS {
        let mut s = State::random(seed);
        let qdd = s.qdd.clone();
        let tau = s.tau(&qdd);
        let y = regressor(&s.robot, &mut s.ws, &s.q, &s.qd, &qdd);
        let pi =
            DVector::from_iterator(70, s.robot.bodies.iter().flat_map(|b| b.inertia.parameters()));
        assert_close(&tau, &(&y * pi), 1e-12);
        let block = body_regressor(&s.robot, &mut s.ws, &s.q, &s.qd, &qdd, 5);
        assert_eq!(block, y.columns(50, 10).into_owned());
    }
}

#[test]
fn jacobian_maps_joint_rates_to_the_velocity_of_the_point() {
    for seed in SEEDS {
        let s = State::random(seed);
        let point = Vector3::new(0.3, -0.2, 0.5);
        let velocity = point_jacobian(&s.robot, &s.q, 6, &point) * DVector::from_vec(s.qd.clone());
        for axis in 0..3 {
            let moved = along(&s, &s.qd, |q| body_placements(&s.robot, q)[6].point(&point)[axis]);
            assert!((velocity[axis] - moved).abs() < 1e-8, "{velocity} {moved}");
        }
        let turned = Matrix3::from_fn(|i, j| {
            along(&s, &s.qd, |q| body_placements(&s.robot, q)[6].rotation[(i, j)])
        });
        let spin = turned * body_placements(&s.robot, &s.q)[6].rotation.transpose();
        let omega = Vector3::new(spin.m32, spin.m13, spin.m21);
        assert!((velocity.fixed_rows::<3>(3) - omega).amax() < 1e-8, "{velocity} {omega}");
    }
}

#[test]
fn inertia_survives_its_parameters_and_changes_of_frame() {
    let rng = &mut ChaCha8Rng::seed_from_u64(1);
    let body = random_body(rng, 0).inertia;
    let back = Inertia::from_parameters(&body.parameters());
    assert!((back.about_com - body.about_com).amax() < 1e-13);
    assert!((back.com - body.com).amax() < 1e-13);
    let placement = random_placement(rng);
    let there = body.seen_from(&placement).seen_from(&placement.inverse());
    assert!((there.about_com - body.about_com).amax() < 1e-13);
    assert!((there.com - body.com).amax() < 1e-13);
    let other = random_body(rng, 0).inertia;
    let (a, b) = (body.parameters(), other.parameters());
    let sum = body.joined_with(&other).parameters();
    assert!((0..10).all(|k| (sum[k] - a[k] - b[k]).abs() < 1e-13), "{sum:?}");
}

#[test]
fn a_payload_loads_the_joints_as_its_column_of_the_regressor_says() {
    let robot = builtin("ur5").unwrap();
    let (q, qd, qdd) = ([0.1, -1.2, 1.0, 0.3, 0.8, -0.4], [0.5; 6], [-1.0; 6]);
    let com = Vector3::new(0.01, 0.02, 0.05);
    let loaded = robot.with_payload(2.0, com, Matrix3::identity() * 0.01);
    let ws = &mut Workspace::new(&robot);
    let (mut bare, mut full) = ([0.0; 6], [0.0; 6]);
    inverse_dynamics(&robot, ws, &q, &qd, &qdd, &mut bare);
    inverse_dynamics(&loaded, ws, &q, &qd, &qdd, &mut full);
    let load = Inertia { mass: 2.0, com, about_com: Matrix3::identity() * 0.01 };
    let parameters = load.seen_from(&robot.flange).parameters();
    let columns = body_regressor(&robot, ws, &q, &qd, &qdd, 5);
    let expected = columns * DVector::from_row_slice(&parameters);
    let difference = DVector::from_fn(6, |j, _| full[j] - bare[j]);
    assert_close(&difference, &expected, 1e-12);
}

#[test]
fn series_equal_single_calls_at_every_sample() {
    let robot = builtin("ur5").unwrap();
    let samples = 1100;
    let series = |phase: f64| {
        let rows: Vec<Vec<f64>> = (0..6)
            .map(|j| (0..samples).map(|k| (phase + 0.01 * k as f64 + j as f64).sin()).collect())
            .collect();
        JointSeries::from_joints(&rows)
    };
    let (q, qd, qdd) = (series(0.0), series(1.0), series(2.0));
    let tau = inverse_dynamics_series(&robot, &q, &qd, &qdd);
    let columns = body_regressor_series(&robot, &q, &qd, &qdd, 5);
    let ws = &mut Workspace::new(&robot);
    for k in [0, 511, 512, 1099] {
        let mut s = [[0.0; 6]; 3];
        q.sample_into(k, &mut s[0]);
        qd.sample_into(k, &mut s[1]);
        qdd.sample_into(k, &mut s[2]);
        let mut expected = [0.0; 6];
        inverse_dynamics(&robot, ws, &s[0], &s[1], &s[2], &mut expected);
        let block = body_regressor(&robot, ws, &s[0], &s[1], &s[2], 5);
        for j in 0..6 {
            assert_eq!(tau.joint(j)[k], expected[j]);
            assert!((0..10).all(|p| columns[p].joint(j)[k] == block[(j, p)]));
        }
    }
}

/// Two thin rods hanging from a horizontal axis, angles from the vertical, the second relative:
/// Murray, Li, Sastry, *A Mathematical Introduction to Robotic Manipulation*, 1994, section 4.2.3.
#[test]
fn double_pendulum_matches_its_closed_form() {
    let (m1, m2, l1, r1, r2, i1, i2) = (1.3, 0.7, 0.9, 0.4, 0.25, 0.06, 0.02);
    let robot = double_pendulum([m1, m2], l1, [r1, r2], [i1, i2]);
    let ([t1, t2], [w1, w2], [a1, a2]) = ([0.4, -1.1], [1.2, 0.7], [-0.3, 2.0]);
    let alpha = i1 + i2 + m1 * r1 * r1 + m2 * (l1 * l1 + r2 * r2);
    let beta = m2 * l1 * r2;
    let delta = i2 + m2 * r2 * r2;
    let (s2, c2) = f64::sin_cos(t2);
    let g = crate::robot::GRAVITY;
    let g2 = m2 * g * r2 * f64::sin(t1 + t2);
    let expected = [
        (alpha + 2.0 * beta * c2) * a1 + (delta + beta * c2) * a2
            - beta * s2 * w2 * w1
            - beta * s2 * (w1 + w2) * w2
            + (m1 * r1 + m2 * l1) * g * f64::sin(t1)
            + g2,
        (delta + beta * c2) * a1 + delta * a2 + beta * s2 * w1 * w1 + g2,
    ];
    let mut tau = [0.0; 2];
    let ws = &mut Workspace::new(&robot);
    inverse_dynamics(&robot, ws, &[t1, t2], &[w1, w2], &[a1, a2], &mut tau);
    for j in 0..2 {
        assert!((tau[j] - expected[j]).abs() < 1e-13, "{tau:?} {expected:?}");
    }
}

/// Turns about y, hangs along -z.
fn double_pendulum(m: [f64; 2], l1: f64, r: [f64; 2], i: [f64; 2]) -> Robot {
    let limits = Limits { lower: -9.0, upper: 9.0, velocity: 9.0, effort: 9.0 };
    let body = |k: usize, drop: f64| Body {
        name: format!("rod {k}"),
        parent: k.checked_sub(1),
        joint: Joint {
            name: format!("hinge {k}"),
            placement: Placement {
                rotation: Matrix3::identity(),
                translation: Vector3::new(0.0, 0.0, -drop),
            },
            axis: Vector3::y_axis(),
            limits,
        },
        inertia: Inertia {
            mass: m[k],
            com: Vector3::new(0.0, 0.0, -r[k]),
            about_com: Matrix3::from_diagonal(&Vector3::new(i[k], i[k], 1e-4)),
        },
    };
    Robot {
        name: "double pendulum".into(),
        bodies: vec![body(0, 0.0), body(1, l1)],
        gravity: Vector3::new(0.0, 0.0, -crate::robot::GRAVITY),
        flange: Placement::identity(),
        flange_on: None,
    }
}
