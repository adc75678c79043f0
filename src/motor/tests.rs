//! Physics, accuracy and derivatives of the motor.

use super::dormand_prince::{Field, Step};
use super::model::{COUNT, Motor, index};
use super::sensitivity::{Sensitivities, simulate_with_sensitivities};
use super::simulate::{Accuracy, Failure, Hold, Input, Output, simulate};
use super::sliding::Sliding;

pub(super) const TRUTH: Motor = Motor {
    j: 0.1,
    k: 0.2,
    l: 0.1,
    r: 1.5,
    t_s: 0.1,
    t_c: 0.2,
    t_v1: 0.05,
    t_v2: 0.05,
    t_v3: 0.02,
    omega_s: 0.01,
};

/// Equally long holds.
pub(super) fn held(levels: &[f64], samples: usize, sample_time: f64) -> Input {
    let holds = levels.iter().map(|&voltage| Hold { voltage, samples }).collect();
    Input { holds, sample_time }
}

pub(super) fn input() -> Input {
    let levels = vec![4.0, -3.0, 0.9, 1.3, 0.4, -5.0, 2.0, 0.3, -0.9, -1.2, 5.0, -4.0];
    held(&levels, 50, 0.005)
}

fn output_of(motor: &Motor, input: &Input, tolerance: f64) -> Output {
    let mut output = Output::default();
    let accuracy = Accuracy { tolerance, ..Accuracy::TRUTH };
    simulate(motor, input, accuracy, &mut output).unwrap();
    output
}

fn farthest(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |m, (x, y)| m.max((x - y).abs()))
}

#[derive(serde::Deserialize)]
struct Golden {
    hold: f64,
    dt: f64,
    levels: Vec<f64>,
    cases: Vec<GoldenCase>,
}

#[derive(serde::Deserialize)]
struct GoldenCase {
    parameters: [f64; COUNT],
    events: usize,
    omega: Vec<f64>,
    current: Vec<f64>,
}

#[test]
fn agrees_with_scipy_through_stops_reversals_and_creep() {
    let golden: Golden =
        serde_json::from_str(include_str!("../../tests/golden/dc_motor.json")).unwrap();
    let samples_per_hold = (golden.hold / golden.dt).round() as usize;
    let input = held(&golden.levels, samples_per_hold, golden.dt);
    for case in golden.cases {
        assert!(case.events >= 10);
        let output = output_of(&Motor::from_array(&case.parameters), &input, 1e-12);
        let (omega, current) =
            (farthest(&output.omega, &case.omega), farthest(&output.current, &case.current));
        assert!(omega < 2e-9 && current < 2e-9, "{omega} {current}");
    }
}

#[test]
fn error_falls_with_the_tolerance() {
    let reference = output_of(&TRUTH, &input(), 1e-13);
    let error =
        |tolerance| farthest(&output_of(&TRUTH, &input(), tolerance).omega, &reference.omega);
    assert!(error(1e-6) < 3e-5, "{}", error(1e-6));
    assert!(error(1e-8) < 3e-7, "{}", error(1e-8));
    assert!(error(1e-10) < 3e-9, "{}", error(1e-10));
}

#[test]
fn the_polynomial_of_a_step_is_its_continuous_extension() {
    let field = Sliding::new(&TRUTH, 3.0, 1.0);
    let y = [1.0, 0.02];
    let dense = Step::take(&field, &y, &field.rate(&y), 0.01).dense();
    for (n, theta) in [(0, 0.0), (1, 0.3), (0, 0.7), (1, 1.0)] {
        let powers = dense.powers(n);
        let value = powers.iter().rev().fold(0.0, |sum, p| sum * theta + p);
        assert!((value - dense.component(n, theta)).abs() < 1e-15, "{n} {theta}");
    }
}

#[test]
fn prepared_rates_are_those_of_the_model() {
    for (voltage, sign, i, w) in [(3.0, 1.0, 0.7, 0.004), (-4.0, -1.0, 1.2, -2.0)] {
        let [di, dw] = Sliding::new(&TRUTH, voltage, sign).rate(&[i, w]);
        assert!((di - TRUTH.current_rate(voltage, i, w)).abs() < 1e-12);
        assert!((dw - TRUTH.acceleration(i, w, sign)).abs() < 1e-12);
    }
}

#[test]
fn stands_below_breakaway_and_keeps_standing() {
    // K U / R = 0.0933 < T_s: whatever the transient, the motor never moves.
    let input = held(&[0.7; 4], 20, 0.01);
    let output = output_of(&TRUTH, &input, 1e-9);
    assert!(output.omega.iter().all(|&w| w == 0.0));
    let end = output.current.last().unwrap();
    let exact = 0.7 / 1.5 * (1.0 - (-1.5_f64 / 0.1 * 0.8).exp());
    assert!((end - exact).abs() < 1e-15);
}

#[test]
fn comes_to_a_stop_in_finite_time_and_sticks() {
    let input = held(&[5.0, 0.0, 0.0, 0.0], 100, 0.01);
    let output = output_of(&TRUTH, &input, 1e-9);
    assert!(output.omega[99] > 1.0);
    let stop = output.omega.iter().skip(100).position(|&w| w == 0.0).unwrap();
    assert!(output.omega[100 + stop..].iter().all(|&w| w == 0.0));
}

#[test]
fn steady_speed_satisfies_the_torque_balance() {
    let input = held(&[4.0; 20], 10, 0.1);
    let output = output_of(&TRUTH, &input, 1e-10);
    let (w, i) = (*output.omega.last().unwrap(), *output.current.last().unwrap());
    assert!((TRUTH.r * i + TRUTH.k * w - 4.0).abs() < 1e-8);
    let friction = 0.2 + 0.05 * w + 0.05 * w * w + 0.02 * w * w * w;
    assert!((TRUTH.k * i - friction).abs() < 1e-8);
}

#[test]
fn energy_balance_closes() {
    // U i = R i^2 + T_f w + d/dt (L i^2 / 2 + J w^2 / 2), by Simpson's rule within holds.
    let input = held(&[5.0, -2.0, 3.0], 2000, 2e-4);
    let output = output_of(&TRUTH, &input, 1e-12);
    let power = |k: usize, u: f64| {
        let (i, w) = if k == 0 { (0.0, 0.0) } else { (output.current[k - 1], output.omega[k - 1]) };
        let friction = if w == 0.0 { 0.0 } else { TRUTH.sliding_friction(w, w.signum()) };
        u * i - TRUTH.r * i * i - friction * w
    };
    let mut work = 0.0;
    for (n, hold) in input.holds.iter().enumerate() {
        let u = hold.voltage;
        for k in (n * 2000..(n + 1) * 2000).step_by(2) {
            work += 2e-4 / 3.0 * (power(k, u) + 4.0 * power(k + 1, u) + power(k + 2, u));
        }
    }
    let (i, w) = (output.current.last().unwrap(), output.omega.last().unwrap());
    let stored = 0.5 * TRUTH.l * i * i + 0.5 * TRUTH.j * w * w;
    assert!((work - stored).abs() < 1e-6 * stored, "{work} {stored}");
}

#[test]
fn rescaling_current_and_torques_leaves_the_speed() {
    let c = 1.3;
    let scaled = Motor {
        j: TRUTH.j / c,
        l: TRUTH.l * c,
        r: TRUTH.r * c,
        t_s: TRUTH.t_s / c,
        t_c: TRUTH.t_c / c,
        t_v1: TRUTH.t_v1 / c,
        t_v2: TRUTH.t_v2 / c,
        t_v3: TRUTH.t_v3 / c,
        ..TRUTH
    };
    let (a, b) = (output_of(&TRUTH, &input(), 1e-6), output_of(&scaled, &input(), 1e-6));
    assert!(farthest(&a.omega, &b.omega) < 1e-12);
    let current: Vec<f64> = b.current.iter().map(|i| i * c).collect();
    assert!(farthest(&a.current, &current) < 1e-11);
}

#[test]
fn negative_friction_is_a_failure_not_a_hang() {
    let runaway = Motor { t_v3: -0.5, ..TRUTH };
    let result = simulate(&runaway, &input(), Accuracy::SEARCH, &mut Output::default());
    assert!(matches!(result, Err(Failure::Runaway(_))), "{result:?}");
}

#[test]
fn sensitivities_match_central_differences() {
    for motor in [TRUTH, Motor { t_s: 0.3, t_c: 0.15, omega_s: 0.1, ..TRUTH }] {
        let mut exact = Sensitivities::default();
        let accuracy = Accuracy { tolerance: 1e-11, ..Accuracy::TRUTH };
        simulate_with_sensitivities(&motor, &input(), accuracy, &mut exact).unwrap();
        for p in 0..COUNT {
            let (dw, di) = differences(&motor, p, 1e-5);
            let column: Vec<f64> = exact.d_omega.iter().map(|s| s[p]).collect();
            let size = column.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            assert!(farthest(&column, &dw) < 2e-4 * size, "{p}: {} {size}", farthest(&column, &dw));
            let column: Vec<f64> = exact.d_current.iter().map(|s| s[p]).collect();
            let size = column.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            assert!(farthest(&column, &di) < 2e-4 * size, "{p}: {} {size}", farthest(&column, &di));
        }
    }
}

fn differences(motor: &Motor, p: usize, share: f64) -> (Vec<f64>, Vec<f64>) {
    let step = share * motor.to_array()[p];
    let at = |sign: f64| {
        let mut v = motor.to_array();
        v[p] += sign * step;
        output_of(&Motor::from_array(&v), &input(), 1e-13)
    };
    let (up, down) = (at(1.0), at(-1.0));
    let slope =
        |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| (x - y) / (2.0 * step)).collect();
    (slope(&up.omega, &down.omega), slope(&up.current, &down.current))
}

#[test]
fn plain_and_varied_simulations_are_the_same() {
    let mut with = Sensitivities::default();
    simulate_with_sensitivities(&TRUTH, &input(), Accuracy::SEARCH, &mut with).unwrap();
    let plain = output_of(&TRUTH, &input(), Accuracy::SEARCH.tolerance);
    assert!(farthest(&with.omega, &plain.omega) < 1e-12);
    let r = with.d_omega.iter().map(|s| s[index::R].abs()).fold(0.0, f64::max);
    assert!(r > 0.1);
}
