//! A designed motion: within its limits, better than chance, the same for the same seed.

use nalgebra::{DMatrix, Matrix3, Unit, Vector3};

use super::question::{Question, Recorder};
use super::*;
use crate::effects::Motion;
use crate::motion::{Envelope, Kind, Sampled, Settings};
use crate::robot::{Body, Drive, Inertia, Joint, Limits, Placement, Robot, flange_placement};
use crate::twin::Twin;

pub(super) fn twin() -> Twin {
    let text = include_str!("../../scenarios/twins/ur5.toml");
    Twin::parse(text, std::path::Path::new("ur5.toml")).unwrap()
}

pub(super) fn request(ask: Ask, seed: u64, evaluations: usize) -> Request {
    Request {
        ask,
        seconds: 10.0,
        range_rad: 1.0,
        speed_rad_s: 1.5,
        acceleration_rad_s2: 5.0,
        home_rad: None,
        around: Surroundings::default(),
        radius_m: None,
        tool_m: 0.0,
        clearance_m: 0.02,
        noise_nm: None,
        rate_hz: 125.0,
        seed,
        evaluations,
    }
}

fn friction() -> Ask {
    Ask::learn("friction", 6).unwrap()
}

fn refused(twin: &Twin, request: &Request) -> String {
    design(twin, request, |_| ()).err().expect("a refusal").to_string()
}

/// Every limit at 500 Hz, held against what was asked for and not against the search's own books.
#[test]
fn every_limit_is_held() {
    let twin = twin();
    let home = [0.0, -1.75, 0.95, -0.8, -1.5, 0.0];
    let around = Surroundings { table_z: Some(0.0), ..Surroundings::default() };
    for seed in 1..4 {
        let request = Request { around: around.clone(), ..request(friction(), seed, 120) };
        let made = design(&twin, &request, |_| ()).unwrap();
        let s = made.trajectory.sampled(0.002);
        let tau = made.twin.torque(&Motion::new(&made.twin.robot, 0.002, &s.q, &s.qd, &s.qdd));
        let capsules = Capsules::new(&twin.robot, None, 0.0);
        let mut q = [0.0; 6];
        for k in 0..s.q.samples() {
            s.q.sample_into(k, &mut q);
            for j in 0..6 {
                assert!((q[j] - home[j]).abs() <= 1.0, "seed {seed} joint {j}: {}", q[j]);
                assert!(s.qd.joint(j)[k].abs() <= 1.5 && s.qdd.joint(j)[k].abs() <= 5.0);
                assert!(tau.joint(j)[k].abs() <= [150.0, 28.0][usize::from(j > 2)]);
            }
            let closest = capsules.closest(&twin.robot, &q, &around).unwrap();
            assert!(closest.distance_m >= 0.02, "seed {seed} sample {k}: {closest:?}");
        }
        let reached = &made.report.commanded.speed_rad_s;
        assert!(reached.share() > 0.8, "seed {seed}: it hardly moves: {reached:?}");
        assert!(made.report.simulated.acceleration_rad_s2.is_none());
    }
}

#[test]
fn friction_and_inertia_are_told_more_sharply_than_by_random_sines() {
    for (ask, least) in [("friction", 1.05), ("inertia", 1.2)] {
        let ask = Ask::learn(ask, 6).unwrap();
        let report = design(&twin(), &request(ask, 1, 600), |_| ()).unwrap().report;
        let narrower = report.narrower.unwrap();
        eprintln!("{narrower} times narrower, of {} random motions", report.random_sines.motions);
        assert!(report.random_sines.motions >= 5);
        assert!(narrower > least, "{narrower}");
        for t in &report.told {
            assert!(t.half_width.is_finite() && t.half_width > 0.0, "{t:?}");
        }
    }
}

/// Gautier and Khalil: a six-joint arm with its first axis upright has 36 base parameters with the
/// rotors of joints 3 to 6 apart, of 60; here rotor inertias of joints 1 and 2 stand for two of them.
#[test]
fn what_follows_from_other_parameters_is_named() {
    let report = design(&twin(), &request(Ask::learn("inertia", 6).unwrap(), 1, 40), |_| ());
    let report = report.unwrap().report;
    assert_eq!(report.told.len() + report.not_told.len(), 60);
    assert_eq!(report.told.len(), 34, "{:?}", report.not_told);
    assert!(report.not_told.contains(&"m of link 1".to_string()), "{:?}", report.not_told);
}

#[test]
fn rivals_are_told_apart_or_said_to_be_the_same() {
    let apart = |pair: &str| request(Ask::apart(pair, 6).unwrap(), 1, 200);
    let report = design(&twin(), &apart("payload,base_tilt"), |_| ()).unwrap().report;
    let (here, random) = (report.nats.unwrap(), report.random_sines.nats.unwrap());
    assert!(here > random, "{here} {random}");
    assert!(report.told.is_empty());
    let same = refused(&twin(), &apart("coulomb@2,coulomb@2"));
    assert!(same.contains("no motion tells coulomb@2 from coulomb@2"), "{same}");
}

/// The box stands where the flange of another design swings out furthest.
#[test]
fn a_box_in_the_way_is_avoided() {
    let free = design(&twin(), &request(friction(), 2, 150), |_| ()).unwrap();
    let poses = |d: &Design| -> Vec<Vec<f64>> {
        let s = d.trajectory.sampled(0.01);
        let pose = |k: usize| (0..6).map(|j| s.q.joint(j)[k]).collect();
        (0..s.q.samples()).map(pose).collect()
    };
    let flange = |q: &Vec<f64>| flange_placement(&twin().robot, q).translation;
    let all: Vec<Vector3<f64>> = poses(&free).iter().map(flange).collect();
    let from_start = |p: &Vector3<f64>| (p - all[0]).norm();
    let far = all.iter().max_by(|a, b| from_start(a).total_cmp(&from_start(b))).unwrap();
    let [lower, upper] = [-0.03, 0.03].map(|by| far.add_scalar(by).into());
    let around = Surroundings { table_z: Some(0.0), keep_out: vec![Cuboid { lower, upper }] };
    let request = Request { around: around.clone(), ..request(friction(), 2, 150) };
    let made = design(&twin(), &request, |_| ()).unwrap();
    let capsules = Capsules::new(&twin().robot, None, 0.0);
    let nearest = |d: &Design| {
        let at = |q: &Vec<f64>| capsules.closest(&d.twin.robot, q, &around).unwrap().distance_m;
        poses(d).iter().map(at).fold(f64::INFINITY, f64::min)
    };
    assert!(nearest(&free) < 0.0, "the box stands in nobody's way");
    assert!(nearest(&made) >= 0.02);
    let closest = made.report.simulated.closest.unwrap();
    assert!(closest.distance_m >= 0.02, "{closest:?}");
}

#[test]
fn what_cannot_be_is_said() {
    let high = Surroundings { table_z: Some(0.9), ..Surroundings::default() };
    let message = refused(&twin(), &Request { around: high, ..request(friction(), 1, 40) });
    assert!(message.contains("the table come within") && message.contains("--home"), "{message}");
    let message = refused(&twin(), &Request { seconds: 1.0, ..request(friction(), 1, 40) });
    assert!(message.contains("--seconds = 1"), "{message}");
    let noise = Some(vec![1.0; 5]);
    let message = refused(&twin(), &Request { noise_nm: noise, ..request(friction(), 1, 40) });
    assert!(message.contains("5 values") && message.contains("6 joints"), "{message}");
    let weak = |twin: &mut Twin| twin.drive.torque_limit = Some(vec![20.0; 6]);
    let mut twin = twin();
    weak(&mut twin);
    let message = refused(&twin, &request(friction(), 1, 40));
    assert!(message.contains("torque"), "{message}");
}

/// Two joints on parallel level axes; links of 1 m, 2 kg, their masses in the middle.
fn two_joints() -> Twin {
    let body = |j: usize| Body {
        name: format!("link{j}"),
        parent: j.checked_sub(1),
        joint: Joint {
            name: format!("joint{j}"),
            placement: Placement { translation: Vector3::x() * j as f64, ..Placement::identity() },
            axis: Unit::new_normalize(Vector3::y()),
            limits: Limits { lower: -3.0, upper: 3.0, velocity: 2.0, effort: 100.0 },
        },
        inertia: Inertia {
            mass: 2.0,
            com: Vector3::x() * 0.5,
            about_com: Matrix3::identity() * 0.1,
        },
    };
    let robot = Robot {
        name: "two".into(),
        bodies: (0..2).map(body).collect(),
        gravity: Vector3::new(0.0, 0.0, -9.81),
        flange: Placement { translation: Vector3::x(), ..Placement::identity() },
        flange_on: None,
    };
    let drive = Drive::new(vec![1.0; 2], vec![1.0; 2]);
    Twin { source: "two".into(), robot, drive, effects: vec![], ..Twin::default() }
}

/// Coulomb and viscous friction beside rotor inertia and offset: dense, joint by joint.
#[test]
fn information_of_a_two_joint_arm_by_hand() {
    let twin = two_joints();
    let settings = Settings { kind: Kind::Fourier, duration_s: 20.0, ..Settings::default() };
    let motion = settings.trajectory(&twin.robot).unwrap().sampled(0.05);
    let recorder = Recorder { rate_hz: 100.0, noise_nm: vec![0.5, 2.0] };
    let envelope = Envelope::new(&twin.robot, &settings).unwrap();
    let ask = Ask::learn("coulomb,viscous", 2).unwrap();
    let question = Question::new(&twin, &twin, &ask, &recorder, &envelope);
    let answer = question.answer(&motion, 0.05).unwrap();
    let mut log_det = 0.0;
    for (j, sigma) in [0.5, 2.0].into_iter().enumerate() {
        let rows: Vec<usize> =
            (0..motion.q.samples()).filter(|&k| motion.qd.joint(j)[k].abs() > 0.02).collect();
        let row = |k: usize| {
            let (v, a) = (motion.qd.joint(j)[k], motion.qdd.joint(j)[k]);
            [v.signum(), v, a, 1.0]
        };
        let x = DMatrix::from_fn(rows.len(), 4, |i, c| row(rows[i])[c]);
        let inverse = (x.tr_mul(&x) * (100.0 * 0.05) / (sigma * sigma)).try_inverse().unwrap();
        let asked = inverse.view((0, 0), (2, 2)).into_owned();
        // In units of what is typical: 5 N.m and 6 N.m.s/rad.
        log_det += (25.0 * 36.0 / asked.determinant()).ln();
        let order = [j, 2 + j];
        for (i, place) in order.into_iter().enumerate() {
            assert!((answer.deviations[place] / asked[(i, i)].sqrt() - 1.0).abs() < 1e-9);
        }
    }
    assert!((answer.log_det - log_det).abs() < 1e-8, "{} {log_det}", answer.log_det);
    let still = Sampled { qd: motion.qd.map_joints(|_, v| vec![0.0; v.len()]), ..motion };
    assert!(question.answer(&still, 0.05).is_none());
}
