//! Golden numbers from scipy (`tests/golden/signals.py`), closed forms, and the mask.

use std::f64::consts::TAU;

use serde::Deserialize;

use super::mask::fresh;
use super::*;
use crate::recording::{Channel, Provenance, Recording};
use crate::robot::Drive;

#[derive(Deserialize)]
struct Golden {
    x: Vec<f64>,
    low_pass: Vec<GoldenLowPass>,
    savitzky_golay: Vec<GoldenSavitzkyGolay>,
}

#[derive(Deserialize)]
struct GoldenLowPass {
    cutoff_hz: f64,
    rate_hz: f64,
    order: usize,
    y: Vec<f64>,
}

#[derive(Deserialize)]
struct GoldenSavitzkyGolay {
    half: usize,
    degree: usize,
    order: usize,
    y: Vec<f64>,
}

fn golden() -> Golden {
    serde_json::from_str(include_str!("../../tests/golden/signals.json")).unwrap()
}

/// Largest |a - b| over largest |b|.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let scale = b.iter().fold(0.0, |m: f64, b| m.max(b.abs()));
    a.iter().zip(b).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs())) / scale
}

#[test]
fn low_pass_repeats_scipys_sosfiltfilt() {
    let golden = golden();
    for case in &golden.low_pass {
        let filter = LowPass::new(case.cutoff_hz, case.rate_hz, case.order).unwrap();
        let mut y = golden.x.clone();
        filter.apply(&mut y);
        assert!(distance(&y, &case.y) < 1e-11, "order {}: {}", case.order, distance(&y, &case.y));
    }
}

#[test]
fn many_columns_are_filtered_as_one_by_one() {
    let x = golden().x;
    let filter = LowPass::new(8.0, 125.0, 4).unwrap();
    let column = |c: usize| -> Vec<f64> { x.iter().map(|x| x * c as f64 + x * x).collect() };
    let mut many: Vec<Vec<f64>> = (0..19).map(column).collect();
    filter.apply_many(&mut many);
    for (c, filtered) in many.iter().enumerate() {
        let mut alone = column(c);
        filter.apply(&mut alone);
        assert_eq!(*filtered, alone);
    }
}

#[test]
fn savitzky_golay_repeats_scipy_up_to_the_ends() {
    let golden = golden();
    for case in &golden.savitzky_golay {
        let y = SavitzkyGolay::new(case.half, case.degree, 0.008).apply(&golden.x, case.order);
        let d = distance(&y, &case.y);
        assert!(d < 1e-10, "half {} degree {} order {}: {d}", case.half, case.degree, case.order);
    }
}

#[test]
fn savitzky_golay_has_its_3_db_point_at_the_cutoff() {
    let (rate, cutoff) = (125.0, 8.0);
    let smoother = SavitzkyGolay::with_cutoff(cutoff, rate, 4);
    let x: Vec<f64> = (0..500).map(|k| (TAU * cutoff * k as f64 / rate).cos()).collect();
    let y = smoother.apply(&x, 0);
    let gain = y[200..300].iter().zip(&x[200..300]).map(|(y, x)| y * x).sum::<f64>()
        / x[200..300].iter().map(|x| x * x).sum::<f64>();
    assert!((gain - 0.5f64.sqrt()).abs() < 0.05, "{gain}");
}

/// sin(w k dt), dt = 8 ms
fn sinusoid(hz: f64) -> Vec<f64> {
    (0..400).map(|k| (TAU * hz * 0.008 * k as f64).sin()).collect()
}

#[test]
fn differences_err_as_theory_says() {
    for hz in [4.0, 8.0] {
        let w = TAU * hz;
        let (x, dt) = (sinusoid(hz), 0.008);
        let (d1, d2) = (central_difference(&x, dt), second_difference(&x, dt));
        let d_mean = mean_difference(&x, dt);
        for k in 10..390 {
            let (sin, cos) = (x[k], (w * dt * k as f64).cos());
            let first = (w * dt).powi(8) / 630.0;
            let second = (w * dt).powi(8) / 3150.0;
            assert!((d1[k] - w * cos).abs() <= 1.05 * first * w + 1e-11);
            assert!((d2[k] + w * w * sin).abs() <= 1.05 * second * w * w + 1e-8);
            let sinc = (w * dt).sin() / (w * dt);
            assert!((d_mean[k] - w * cos * sinc).abs() < 1e-9 * w);
        }
        let (k, first) = (125, (w * dt).powi(8) / 630.0);
        assert!((d1[k] - w * (w * dt * k as f64).cos()).abs() >= 0.8 * first * w * 0.9);
    }
}

/// Two joints of sin(2 pi 0.5 t) and its multiples; the current is 2 A times the velocity.
fn recording(time: &[f64]) -> Recording {
    let w = TAU * 0.5;
    let at = |f: &dyn Fn(f64) -> f64| -> Vec<f64> { time.iter().map(|t| f(*t)).collect() };
    let mut channels = Vec::new();
    for (j, a) in [1.0, 0.5].into_iter().enumerate() {
        let mut add = |stem: &str, values| {
            channels.push(Channel { name: format!("{stem}_{j}"), values });
        };
        for prefix in ["actual", "target"] {
            add(&format!("{prefix}_q"), at(&|t| a * (w * t).sin()));
            add(&format!("{prefix}_qd"), at(&|t| a * w * (w * t).cos()));
        }
        add("target_qdd", at(&|t| -a * w * w * (w * t).sin()));
        add("actual_current", at(&|t| 2.0 * a * w * (w * t).cos()));
    }
    Recording { time: time.to_vec(), channels, provenance: Provenance::default() }
}

fn drive() -> Drive {
    Drive::new(vec![100.0; 2], vec![0.1; 2])
}

fn uniform(samples: usize) -> Vec<f64> {
    (0..samples).map(|k| 5.0 + 0.008 * k as f64).collect()
}

#[test]
fn every_kind_of_derivative_recovers_a_sinusoid() {
    let recording = recording(&uniform(1500));
    use Derivatives::{Paper, Position, Recorded, TrackingError};
    for derivatives in [Position, TrackingError, Recorded, Paper] {
        let how = Conditioning { derivatives, ..Conditioning::default() };
        let samples = condition(&recording, &drive(), 2, &how).unwrap();
        for k in (0..samples.len()).filter(|k| samples.usable[*k]) {
            let w = TAU * 0.5;
            let phase = w * samples.time(k);
            for (j, a) in [(0, 1.0), (1, 0.5)] {
                let q = samples.q.joint(j)[k] - a * phase.sin();
                let qd = samples.qd.joint(j)[k] - a * w * phase.cos();
                let qdd = samples.qdd.joint(j)[k] + a * w * w * phase.sin();
                assert!(q.abs() < 1e-5 && qd.abs() < 2e-4, "{derivatives:?} {k}: {q} {qd}");
                assert!(qdd.abs() < 5e-3, "{derivatives:?} {k}: {qdd}");
            }
        }
        let torque = samples.torque.joint(0)[300];
        assert!((torque - 20.0 * samples.qd.joint(0)[300]).abs() < 1e-2);
    }
}

#[test]
fn irregular_time_is_resampled_and_gaps_are_left_out() {
    // 8 ms steps with jitter, one pause of 0.4 s
    let mut time = Vec::new();
    for k in 0..1500 {
        let jitter = 0.002 * f64::from((k * 7919) % 13) / 13.0;
        time.push(0.008 * f64::from(k) + jitter + if k >= 700 { 0.4 } else { 0.0 });
    }
    let samples = condition(&recording(&time), &drive(), 2, &Conditioning::default()).unwrap();
    let w = TAU * 0.5;
    let mut unused = 0;
    for k in 0..samples.len() {
        if !samples.usable[k] {
            unused += 1;
            continue;
        }
        let error = samples.qd.joint(0)[k] - w * (w * samples.time(k)).cos();
        assert!(error.abs() < 2e-4, "{k}: {error}");
    }
    // two margins of 0.5 s at the ends, two beside the pause
    let expected = (2.0 + 0.4) / samples.dt;
    assert!((f64::from(unused) - expected).abs() < 6.0, "{unused} {expected}");
    assert!(samples.notes.iter().any(|n| n.contains("1 gaps")), "{:?}", samples.notes);
}

#[test]
fn alternating_steps_give_the_mean_rate_and_rounded_stamps_the_true_one() {
    let alternating: Vec<f64> =
        (0..200).map(|k| 0.032 * f64::from(k / 2) + 0.024 * f64::from(k % 2)).collect();
    let grid = UniformGrid::new(&alternating, None, Interpolation::Cubic, 5.0);
    assert!((grid.dt - 0.016).abs() < 1e-4, "{}", grid.dt);
    let rounded: Vec<f64> =
        (0..300).map(|k| (f64::from(k) * 1000.0 / 30.0).round() / 1e3).collect();
    let grid = UniformGrid::new(&rounded, None, Interpolation::Cubic, 5.0);
    assert!((grid.dt - 1.0 / 30.0).abs() < 1e-5, "{}", grid.dt);
    let regular = UniformGrid::new(&uniform(300), None, Interpolation::Cubic, 5.0);
    assert_eq!((regular.len(), regular.interpolated()), (300, 0.0));
}

#[test]
fn white_noise_on_position_reaches_acceleration_as_the_filters_say() {
    // Parseval: var(qdd) = sigma^2 / pi times the integral of (w/dt)^4 |H|^4 (two passes of |H|^2)
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    let n = 60_000;
    let mut noisy = recording(&uniform(n));
    let noise: Vec<f64> = (0..n).map(|_| StandardNormal.sample(&mut rng)).collect();
    noisy.channels[0].values = noise;
    let how = Conditioning { motion_cutoff_hz: 8.0, ..Conditioning::default() };
    let samples = condition(&noisy, &drive(), 2, &how).unwrap();
    let qdd: Vec<f64> = samples.qdd.joint(0)[200..n - 200].to_vec();
    let measured = qdd.iter().map(|a| a * a).sum::<f64>() / qdd.len() as f64;
    let wc = (TAU * 8.0 * 0.004).tan();
    let steps = 20_000;
    let spectrum = |i: usize| {
        let w = (i as f64 + 0.5) / f64::from(steps) * std::f64::consts::PI;
        let h2 = 1.0 / (1.0 + ((w / 2.0).tan() / wc).powi(8));
        (w / 0.008).powi(4) * h2 * h2
    };
    let theory = (0..steps as usize).map(spectrum).sum::<f64>() / f64::from(steps);
    assert!((measured / theory - 1.0).abs() < 0.05, "{measured} against {theory}");
}

#[test]
fn rows_slide_keep_their_distance_and_know_their_time() {
    let how = Conditioning { standstill_rad_s: 0.5, guard_s: 0.04, ..Conditioning::default() };
    let samples = condition(&recording(&uniform(1500)), &drive(), 2, &how).unwrap();
    assert_eq!(samples.decimation(), 6);
    let rows = samples.rows(0);
    let qd = samples.qd.joint(0);
    for (&k, &slot) in rows.samples.iter().zip(&rows.slots) {
        assert!(samples.usable[k] && k == 6 * slot);
        assert!(qd[k - 5..=k + 5].iter().all(|v| v.abs() > 0.5), "{k}");
    }
    let kept = samples.mask(0).iter().filter(|m| **m).count();
    assert!(rows.len().abs_diff(kept / 6) < 12 && rows.len() > 100);
    assert!(rows.slots.windows(2).any(|w| w[1] > w[0] + 1), "reversals are masked");
    assert_eq!(rows.take(qd)[3], qd[rows.samples[3]]);
}

#[test]
fn a_mask_is_eroded_around_its_holes_but_not_at_its_ends() {
    let mask = [true, true, true, false, true, true, true, true];
    let eroded = [true, false, false, false, false, false, true, true];
    assert_eq!(erode(&mask, 2), eroded);
    assert_eq!(runs(&eroded), [0..1, 6..8]);
    assert!(runs(&[]).is_empty());
}

#[test]
fn readings_within_a_step_of_the_encoder_are_one() {
    let usable: Vec<bool> = (0..220).map(|k| k != 50).collect();
    // At rest until 100, then a step in five samples, then three steps a sample.
    let steps = |k: usize| match k {
        0..100 => 0.0,
        100..200 => ((k - 100) / 5) as f64,
        _ => 20.0 + 3.0 * (k - 200) as f64,
    };
    let q: Vec<f64> = (0..220).map(|k| 0.001 * steps(k)).collect();
    let kept: Vec<usize> =
        (0..220).zip(fresh(&q, 0.001, &usable)).filter(|p| p.1).map(|p| p.0).collect();
    let (rest, moving): (Vec<usize>, Vec<usize>) = kept.into_iter().partition(|k| *k < 105);
    assert_eq!(rest, [24, 77], "a hole ends what is one reading");
    let slow = (0..19).map(|i| 107 + 5 * i);
    assert!(moving.into_iter().eq(slow.chain(200..220)));
    assert!(fresh(&[0.3; 9], 0.0, &[true; 9]).iter().filter(|f| **f).count() == 1);
}

#[test]
fn what_is_wrong_is_named_and_a_remedy_given() {
    let all = recording(&uniform(1500));
    let message = |r: &Recording, dof, how: &Conditioning| {
        condition(r, &drive(), dof, how).unwrap_err().to_string()
    };
    let default = Conditioning::default();
    let missing = message(&all, 3, &default);
    assert!(missing.contains("actual_q_2") && missing.contains("actual_q_0..1"), "{missing}");
    let mut no_current = all.clone();
    no_current.channels.retain(|c| !c.name.starts_with("actual_current"));
    assert!(message(&no_current, 2, &default).contains("joint_torque_*"));
    let short = message(&recording(&uniform(60)), 2, &default);
    assert!(short.contains("too few") && short.contains("margin_s"), "{short}");
    assert!(message(&recording(&uniform(5)), 2, &default).contains("too few"));
    let high = Conditioning { motion_cutoff_hz: 70.0, ..default.clone() };
    assert!(message(&all, 2, &high).contains("62.500 Hz"));
    let negative = Conditioning { guard_s: -1.0, ..default.clone() };
    assert!(message(&all, 2, &negative).contains("guard_s = -1"));
    let mut recorded = all.clone();
    recorded.channels.retain(|c| c.name != "target_qdd_1");
    let tracking = Conditioning { derivatives: Derivatives::TrackingError, ..default };
    assert!(message(&recorded, 2, &tracking).contains("target_qdd_1"));
}

#[test]
fn a_recorded_torque_wins_over_current() {
    let mut both = recording(&uniform(1500));
    for j in 0..2 {
        let name = format!("joint_torque_{j}");
        both.channels.push(Channel { name, values: vec![7.0; 1500] });
    }
    let samples = condition(&both, &drive(), 2, &Conditioning::default()).unwrap();
    assert!(samples.torque.joint(1).iter().all(|t| *t == 7.0));
}

#[test]
fn a_torque_cutoff_above_nyquist_is_refused_at_once() {
    let how = Conditioning { torque_cutoff_hz: 80.0, ..Conditioning::default() };
    let error = condition(&recording(&uniform(1500)), &drive(), 2, &how).unwrap_err();
    assert!(matches!(error, SignalError::Cutoff { cutoff_hz: 80.0, .. }), "{error}");
}

/// `SOURCE.md` beside the recording: 82.1 s at 125 Hz, 60.7 s of it moving, top speeds per joint.
#[test]
fn a_real_recording_is_conditioned_as_its_description_says() {
    let shared = std::env::var("ARMTWIN_SHARED")
        .unwrap_or_else(|_| concat!(env!("CARGO_MANIFEST_DIR"), "/../shared").into());
    let path = std::path::Path::new(&shared)
        .join("recordings/kkufieta-ur5_modeling_force_estimate/Movement_No6_Acc_slow_Verify_Model");
    if !path.exists() {
        eprintln!("skipped: {} is not there", path.display());
        return;
    }
    let recording = crate::recording::read(&path, None).unwrap();
    let samples = condition(&recording, &Drive::ur5(), 6, &Conditioning::default()).unwrap();
    assert!((samples.rate_hz() - 125.0).abs() < 1e-6);
    assert!((samples.len() as f64 * samples.dt - 82.1).abs() < 0.1);
    let fast = |j, k: usize| samples.qd.joint(j)[k].abs() > 0.02;
    let moving = (0..samples.len()).filter(|&k| (0..6).any(|j| fast(j, k))).count();
    assert!((moving as f64 * samples.dt - 60.7).abs() < 0.5);
    let top = |j| samples.qd.joint(j).iter().fold(0.0f64, |m, v| m.max(v.abs()));
    for (j, expected) in [1.06, 1.06, 1.06, 0.92, 1.02, 1.10].into_iter().enumerate() {
        assert!((top(j) - expected).abs() < 0.1, "joint {}: {}", j + 1, top(j));
        let still = samples.sliding(j).iter().filter(|s| !**s).count();
        let share = still as f64 / samples.len() as f64;
        assert!((0.48..0.90).contains(&share), "joint {}: {share}", j + 1);
    }
}
