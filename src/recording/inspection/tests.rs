//! Known numbers go in, the inspection says them back.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

use super::*;
use crate::recording::{Channel, Provenance};

/// Joint 1: rest for 4 s, then 0.5 (1 - cos(2 pi t / 4)) rad; joint 2 stands still.
fn recording(time: Vec<f64>) -> Recording {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let noise = Normal::new(0.0, 0.05).unwrap();
    let w = std::f64::consts::FRAC_PI_2;
    let phase = |t: &f64| w * (t - 4.0).max(0.0);
    let q: Vec<f64> = time.iter().map(|t| 0.5 * (1.0 - phase(t).cos())).collect();
    let qd: Vec<f64> = time.iter().map(|t| 0.5 * w * phase(t).sin()).collect();
    let mut current = || -> Vec<f64> {
        qd.iter().map(|v| ((v + noise.sample(&mut rng)) / 0.0022).round() * 0.0022).collect()
    };
    let (current_0, current_1) = (current(), current());
    let zeros = vec![0.0; time.len()];
    let columns = [
        ("actual_q_0", q),
        ("actual_q_1", zeros.clone()),
        ("actual_qd_0", qd.clone()),
        ("actual_qd_1", zeros),
        ("actual_current_0", current_0),
        ("actual_current_1", current_1),
    ];
    let channels = columns.map(|(n, values)| Channel { name: n.into(), values }).into();
    Recording { time, channels, provenance: Provenance::default() }
}

fn grid(n: usize) -> Vec<f64> {
    (0..n).map(|k| 0.008 * k as f64).collect()
}

fn says(inspection: &Inspection, part: &str) -> bool {
    inspection.findings.iter().any(|f| f.contains(part))
}

#[test]
fn noise_step_and_motion_come_out_as_they_went_in() {
    let inspection = inspect(&recording(grid(3000)));
    let current = inspection.signals.iter().find(|s| s.name == "actual_current").unwrap();
    for column in &current.columns {
        assert!(column.noise_at_rest && (column.noise / 0.05 - 1.0).abs() < 0.1, "{column:?}");
        assert!((column.step.unwrap() / 0.0022 - 1.0).abs() < 1e-6, "{column:?}");
    }
    let m = &inspection.motion[0];
    assert!((m.top_speed() - 0.785).abs() < 1e-3 && (m.acceleration - 1.23).abs() < 0.03, "{m:?}");
    assert_eq!(m.reversals, 9);
    assert!(m.velocity_correlation.unwrap() > 0.9999);
    assert!((m.velocity_slope.unwrap() - 1.0).abs() < 1e-3);
    assert!(says(&inspection, "joint 2: no motion"), "{:?}", inspection.findings);
    assert!(!says(&inspection, "joint 1"), "{:?}", inspection.findings);
}

#[test]
fn steps_that_noise_does_not_blur_are_told() {
    let with_noise = |sigma: f64| {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let noise = Normal::new(0.0, sigma).unwrap();
        let mut coarse = recording(grid(3000));
        for (channel, from) in [(4, 2), (5, 2)] {
            let current = coarse.channels[from].values.clone();
            let seen =
                current.iter().map(|v| ((v + noise.sample(&mut rng)) / 0.022).round() * 0.022);
            coarse.channels[channel].values = seen.collect();
        }
        says(&inspect(&coarse), "joint 1: actual_current comes in steps of 0.0220 A, 4 % of")
    };
    assert!(with_noise(1e-4));
    assert!(!with_noise(0.01));
}

#[test]
fn gaps_are_counted_and_placed() {
    let mut time = grid(3000);
    time.drain(1500..1503);
    time.remove(2000);
    let s = inspect(&recording(time)).sampling;
    assert_eq!((s.missing, s.gaps.len()), (4, 2));
    assert!((s.gaps[0].after_s - 1499.0 * 0.008).abs() < 1e-9);
    assert!((s.nominal_hz - 125.0).abs() < 1e-6);
    let every_third_missing = (0..3000).filter(|k| k % 3 != 2).map(|k| 0.008 * k as f64).collect();
    let s = inspect(&recording(every_third_missing)).sampling;
    assert_eq!(s.missing, 999);
    let uneven = (0..3000).map(|k| [0.0, 0.01, 0.02][k % 3] + 0.032 * (k / 3) as f64).collect();
    let inspection = inspect(&recording(uneven));
    assert_eq!(inspection.sampling.missing, 0);
    assert!(says(&inspection, "10.0 to 12.0 ms, 93.8 Hz"), "{:?}", inspection.findings);
}

#[test]
fn wrong_units_and_stuck_or_repeated_columns_are_told() {
    let mut degrees = recording(grid(3000));
    degrees.channels[0].values.iter_mut().for_each(|q| *q *= 57.29578);
    degrees.channels[4].values.iter_mut().for_each(|i| *i *= 1000.0);
    degrees.channels[5].values.fill(0.25);
    degrees.time.iter_mut().for_each(|t| *t *= 1000.0);
    let inspection = inspect(&degrees);
    for part in ["degrees", "mA", "set time_scale", "stuck: actual_current_1"] {
        assert!(says(&inspection, part), "{part}: {:?}", inspection.findings);
    }
    let mut twice = recording(grid(3000));
    twice.channels[0].values.iter_mut().for_each(|q| *q *= -1.0);
    for (from, to) in [(4, "target_current_0"), (5, "target_current_1")] {
        twice
            .channels
            .push(Channel { name: to.into(), values: twice.channels[from].values.clone() });
    }
    let inspection = inspect(&twice);
    assert!(
        says(&inspection, "target_current repeats actual_current"),
        "{:?}",
        inspection.findings
    );
    assert!(
        says(&inspection, "joint 1: actual_qd correlates by -1.000"),
        "{:?}",
        inspection.findings
    );
}
