//! Every kind of motion: smooth, within limits, repeatable, at rest at both ends, exciting.

use nalgebra::{DMatrix, Matrix3, Unit, Vector3};

use super::trajectory::{Piece, Shape};
use super::*;
use crate::robot::{Body, Inertia, Joint, Limits, Placement, Robot};

const KINDS: [Kind; 5] =
    [Kind::Mixed, Kind::Fourier, Kind::RandomFrequency, Kind::Plateaus, Kind::PointToPoint];

/// Six joints with different limits; the rest does not matter to a trajectory.
fn arm() -> Robot {
    let body = |j: usize| Body {
        name: format!("body{j}"),
        parent: j.checked_sub(1),
        joint: Joint {
            name: format!("joint{j}"),
            placement: Placement::identity(),
            axis: Unit::new_normalize(Vector3::z()),
            limits: Limits { lower: -3.0, upper: 3.0, velocity: 1.0 + j as f64, effort: 100.0 },
        },
        inertia: Inertia { mass: 1.0, com: Vector3::zeros(), about_com: Matrix3::identity() },
    };
    Robot {
        name: "ur-like".into(),
        bodies: (0..6).map(body).collect(),
        gravity: Vector3::new(0.0, 0.0, -9.81),
        flange: Placement::identity(),
        flange_on: None,
    }
}

fn make(kind: Kind, seed: u64) -> Trajectory {
    Settings { kind, seed, ..Settings::default() }.trajectory(&arm()).unwrap()
}

#[test]
fn limits_hold_on_a_fine_grid() {
    for kind in KINDS {
        for seed in 0..5 {
            let settings = Settings { kind, seed, ..Settings::default() };
            let envelope = Envelope::new(&arm(), &settings).unwrap();
            let s = settings.trajectory(&arm()).unwrap().sampled(0.002);
            for j in 0..6 {
                let peak = |x: &[f64]| x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
                let centred: Vec<_> = s.q.joint(j).iter().map(|q| q - envelope.centre[j]).collect();
                let tight = 1.0 + 1e-9;
                assert!(peak(&centred) <= envelope.range[j] * tight, "{kind:?} {seed} q{j}");
                assert!(peak(s.qd.joint(j)) <= envelope.velocity[j] * tight, "{kind:?} qd{j}");
                assert!(peak(s.qdd.joint(j)) <= envelope.acceleration[j] * tight, "{kind:?} {j}");
            }
        }
    }
}

#[test]
fn velocity_and_acceleration_are_the_derivatives() {
    let dt = 1e-3;
    for kind in KINDS {
        let s = make(kind, 3).sampled(dt);
        for j in 0..6 {
            for (x, xd) in [(&s.q, &s.qd), (&s.qd, &s.qdd)] {
                let (x, xd) = (x.joint(j), xd.joint(j));
                for k in 2..x.len() - 2 {
                    let central =
                        (x[k - 2] - 8.0 * x[k - 1] + 8.0 * x[k + 1] - x[k + 2]) / 12.0 / dt;
                    // A jump of the jerk J would show as J dt / 12 or so; a jump of qdd as 1.
                    assert!((central - xd[k]).abs() < 2e-3, "{kind:?} joint {j} sample {k}");
                }
            }
        }
    }
}

#[test]
fn rests_at_both_ends_and_beyond() {
    for kind in KINDS {
        let motion = make(kind, 4);
        assert!((motion.duration() - 60.0).abs() < 1e-9);
        let (mut q, mut qd, mut qdd) = ([0.0; 6], [1.0; 6], [1.0; 6]);
        for t in [-1.0, 0.0, 0.9, 59.1, 60.0, 99.0] {
            motion.at(t, &mut q, &mut qd, &mut qdd);
            assert!(qd.iter().chain(&qdd).all(|v| v.abs() < 1e-12), "{kind:?} at {t} s: {qd:?}");
        }
    }
}

#[test]
fn a_seed_is_a_motion() {
    for kind in KINDS {
        assert_eq!(make(kind, 7), make(kind, 7));
        assert_ne!(make(kind, 7), make(kind, 8));
    }
}

#[test]
fn mixed_shows_slow_and_fast_of_every_joint() {
    for seed in 0..5 {
        let s = make(Kind::Mixed, seed).sampled(0.008);
        for j in 0..6 {
            let speed: Vec<f64> = s.qd.joint(j).iter().map(|v| v.abs()).collect();
            let seconds = |low: f64, high: f64| {
                speed.iter().filter(|&&v| v > low && v <= high).count() as f64 * 0.008
            };
            assert!(seconds(0.004, 0.1) > 10.0, "slow, joint {j}: {}", seconds(0.004, 0.1));
            assert!(seconds(0.02, 0.1) > 5.0, "Stribeck, joint {j}: {}", seconds(0.02, 0.1));
            let top = speed.iter().fold(0.0_f64, |m, &v| m.max(v));
            assert!(top > 0.7, "joint {j} reaches {top} rad/s");
        }
    }
}

/// Per joint: Coulomb, Stribeck, viscous, quadratic, inertia, gravity (sine and cosine), offset,
/// each of unit length; sine, cosine and offset are nearly dependent in a range of +-1 rad.
#[test]
fn mixed_separates_friction_from_inertia_and_gravity() {
    for seed in 0..5 {
        let s = make(Kind::Mixed, seed).sampled(0.02);
        for j in 0..6 {
            let rows: Vec<[f64; 8]> = (0..s.q.samples())
                .map(|k| [s.q.joint(j)[k], s.qd.joint(j)[k], s.qdd.joint(j)[k]])
                .filter(|[_, qd, _]| qd.abs() > 0.02)
                .map(|[q, v, a]| {
                    let sign = v.signum();
                    let stribeck = sign * (-(v / 0.05).abs()).exp();
                    [sign, stribeck, v, v * v.abs(), a, q.sin(), q.cos(), 1.0]
                })
                .collect();
            let mut x = DMatrix::from_fn(rows.len(), 8, |i, c| rows[i][c]);
            for mut column in x.column_iter_mut() {
                column.normalize_mut();
            }
            let values = x.svd(false, false).singular_values;
            let condition = values.max() / values.min();
            eprintln!("seed {seed} joint {}: condition {condition:.1}", j + 1);
            assert!(condition < 80.0, "seed {seed} joint {}: condition {condition}", j + 1);
        }
    }
}

#[test]
fn short_motions_and_other_rests_work() {
    for kind in KINDS {
        for (duration_s, rest_s) in [(2.0, 0.0), (5.0, 0.5), (12.0, 5.0)] {
            let settings = Settings { kind, duration_s, rest_s, ..Settings::default() };
            let motion = settings.trajectory(&arm()).unwrap();
            assert!((motion.duration() - duration_s).abs() < 1e-9);
        }
    }
}

/// Where a joint may hardly move, and where a motion lasts for a day.
#[test]
fn little_room_and_long_times_ask_for_little_memory() {
    for kind in KINDS {
        for (range_rad, duration_s) in [(1e-9, 1e3), (1e-9, 1e5), (1.0, 1e5)] {
            let settings = Settings { kind, range_rad, duration_s, ..Settings::default() };
            let motion = settings.trajectory(&arm()).unwrap();
            let strokes = |p: &Piece| match &p.shape {
                Shape::Strokes { strokes } => strokes.iter().map(Vec::len).sum(),
                _ => 1,
            };
            let parts: usize = motion.pieces.iter().map(strokes).sum();
            assert!(parts as f64 <= 4.0 * 6.0 * duration_s, "{kind:?} {range_rad}: {parts} parts");
            let (mut q, mut qd, mut qdd) = ([0.0; 6], [0.0; 6], [0.0; 6]);
            let envelope = Envelope::new(&arm(), &settings).unwrap();
            for k in 0..1000 {
                motion.at(f64::from(k) * 1.234, &mut q, &mut qd, &mut qdd);
                let inside =
                    |j: usize| (q[j] - envelope.centre[j]).abs() <= range_rad * (1.0 + 1e-6);
                assert!((0..6).all(inside), "{kind:?} {range_rad}: {q:?}");
            }
        }
    }
}

#[test]
fn bad_settings_are_named() {
    let wrong = |s: Settings| s.trajectory(&arm()).unwrap_err().to_string();
    let base = Settings::default;
    assert!(wrong(Settings { duration_s: f64::NAN, ..base() }).contains("motion.duration_s"));
    assert!(wrong(Settings { duration_s: 3.0, ..base() }).contains("motion.duration_s"));
    assert!(wrong(Settings { range_rad: -1.0, ..base() }).contains("motion.range_rad"));
    assert!(wrong(Settings { home_rad: Some(vec![0.0; 5]), ..base() }).contains("5 angles"));
    assert!(wrong(Settings { home_rad: Some(vec![4.0; 6]), ..base() }).contains("joint 1 at 4"));
    let unknown = toml::from_str::<Settings>("amplitude = 3").unwrap_err().to_string();
    assert!(unknown.contains("amplitude") && unknown.contains("range_rad"), "{unknown}");
    let kind = toml::from_str::<Settings>("kind = \"wiggle\"").unwrap_err().to_string();
    assert!(kind.contains("random_frequency"), "{kind}");
}

#[test]
fn ur_arms_stay_above_the_table() {
    for name in ["ur3", "ur5", "ur10e"] {
        let robot = crate::robot::builtin(name).unwrap();
        for (kind, seed) in KINDS.into_iter().flat_map(|k| (0..3).map(move |s| (k, s))) {
            let s = Settings { kind, seed, ..Settings::default() }.trajectory(&robot).unwrap();
            let s = s.sampled(0.05);
            let mut q = [0.0; 6];
            for k in 0..s.q.samples() {
                s.q.sample_into(k, &mut q);
                let flange = crate::robot::flange_placement(&robot, &q).translation.z;
                assert!(flange > 0.02, "{name} {kind:?} seed {seed}: flange at {flange} m");
            }
        }
    }
}

/// A scenario's coefficients come out as they stand, and the arm rests at both ends.
#[test]
fn a_series_is_the_sum_of_its_coefficients() {
    let text = "kind = \"series\"\nduration_s = 12\nrest_s = 1\nhome_rad = [0.0, -1.7, 0.9, -0.8, -1.5, 0.1]\n\
                [series]\nperiod_s = 5.0\nfade_s = 2.0\n\
                sine_rad = [[0.1, 0.02], [0.0, 0.05], [0.0, 0.0], [0.2, 0.0], [0.0, 0.0], [0.0, -0.1]]\n\
                cosine_rad = [[0.0, 0.03], [0.1, 0.0], [0.0, 0.0], [0.0, 0.1], [0.0, 0.0], [0.3, 0.0]]";
    let settings: Settings = toml::from_str(text).unwrap();
    let motion = settings.trajectory(&arm()).unwrap();
    let (mut q, mut qd, mut qdd) = ([0.0; 6], [0.0; 6], [0.0; 6]);
    motion.at(5.3, &mut q, &mut qd, &mut qdd);
    let w = std::f64::consts::TAU / 5.0;
    let (s1, c1) = (w * 4.3).sin_cos();
    let (s2, c2) = (2.0 * w * 4.3).sin_cos();
    assert!((q[0] - (0.1 * s1 + 0.02 * s2 + 0.03 * c2)).abs() < 1e-12);
    assert!((q[5] - (0.1 - 0.1 * s2 + 0.3 * c1)).abs() < 1e-12);
    assert!((qd[3] - w * (0.2 * c1 - 2.0 * 0.1 * s2)).abs() < 1e-12);
    motion.at(0.5, &mut q, &mut qd, &mut qdd);
    assert_eq!((q[1], qd), (-1.7, [0.0; 6]));
    assert_eq!(toml::from_str::<Settings>(&toml::to_string(&settings).unwrap()).unwrap(), settings);

    let wrong = |change: &dyn Fn(&mut super::Series)| {
        let mut bad = settings.clone();
        bad.series.iter_mut().for_each(change);
        bad.trajectory(&arm()).unwrap_err().to_string()
    };
    assert!(wrong(&|s| s.period_s = 0.0).contains("motion.series.period_s = 0"));
    assert!(wrong(&|s| s.fade_s = 5.1).contains("motion.series.fade_s = 5.1"));
    assert!(wrong(&|s| s.sine_rad.truncate(5)).contains("6 lists"));
    assert!(wrong(&|s| s.cosine_rad[2].push(0.0)).contains("equally long"));
    let many = vec![vec![0.0; 2000]; 6];
    let long = |s: &mut super::Series| {
        (s.sine_rad, s.cosine_rad) = (many.clone(), many.clone());
    };
    assert!(wrong(&long).contains("100 000 sines times seconds"));
    assert!(wrong(&|s| s.sine_rad[0][0] = 3.0).contains("joint 1 reaches 3.03"));
    let none = Settings { series: None, ..settings }.trajectory(&arm()).unwrap_err();
    assert!(none.to_string().contains("[motion.series]"), "{none}");
}
