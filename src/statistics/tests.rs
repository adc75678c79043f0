//! Golden numbers from statsmodels, scipy and mpmath (`tests/golden/statistics.py`), and what holds
//! by construction.

use nalgebra::DMatrix;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::Deserialize;

use super::*;

#[derive(Deserialize)]
struct Golden {
    x: Vec<Vec<f64>>,
    y: Vec<f64>,
    beta: Vec<f64>,
    covariance: Vec<Vec<f64>>,
    p: Vec<f64>,
    interval: Vec<[f64; 2]>,
    newey_west: std::collections::BTreeMap<String, Vec<Vec<f64>>>,
    gapped: Vec<usize>,
    errors: Vec<f64>,
    quadratic_spectral: Vec<Vec<f64>>,
    normal_tail: Vec<[f64; 3]>,
    student_tail: Vec<[f64; 4]>,
    student_quantile: Vec<[f64; 3]>,
    acf: Vec<f64>,
    ljung_box: Vec<[f64; 3]>,
}

impl Golden {
    fn load() -> Self {
        serde_json::from_str(include_str!("../../tests/golden/statistics.json")).unwrap()
    }

    fn jacobian(&self) -> DMatrix<f64> {
        DMatrix::from_column_slice(self.y.len(), self.x.len(), &self.x.concat())
    }

    fn residual(&self) -> Vec<f64> {
        let predicted = self.jacobian() * nalgebra::DVector::from_column_slice(&self.beta);
        self.y.iter().zip(predicted.iter()).map(|(y, p)| y - p).collect()
    }

    fn slots(&self) -> Vec<usize> {
        (100..100 + self.y.len()).collect()
    }
}

fn close(a: f64, b: f64, relative: f64) {
    assert!((a - b).abs() <= relative * b.abs().max(1e-300), "{a} is not {b}");
}

#[test]
fn least_squares_covariance_and_tests_repeat_statsmodels() {
    let golden = Golden::load();
    let jacobian = golden.jacobian();
    let design = Design::new(&jacobian).unwrap();
    let residual = golden.residual();
    let (beta, zero) = (design.solve(&golden.y), [0.0; 3]);
    let found =
        infer(beta.as_slice(), &zero, &jacobian, &residual, &golden.slots(), None, 0.99).unwrap();
    let covariance = design.unit_covariance() * found.sigma.powi(2);
    for k in 0..3 {
        close(beta[k], golden.beta[k], 1e-12);
        (0..3).for_each(|l| close(covariance[(k, l)], golden.covariance[k][l], 1e-10));
        close(found.asymptotic[k].p, golden.p[k], 1e-9);
        close(found.asymptotic[k].low, golden.interval[k][0], 1e-10);
        close(found.asymptotic[k].high, golden.interval[k][1], 1e-10);
        let n = golden.y.len() as f64;
        let paper = found.paper[k].standard_error * n.sqrt();
        close(paper, found.asymptotic[k].standard_error, 1e-14);
        close(found.paper[k].high - beta[k], 2.58 * found.paper[k].standard_error, 1e-9);
    }
}

#[test]
fn newey_west_with_fixed_lags_repeats_statsmodels() {
    let golden = Golden::load();
    let jacobian = golden.jacobian();
    let design = Design::new(&jacobian).unwrap();
    let e = golden.residual();
    let basis = design.basis();
    let scores = DMatrix::from_fn(e.len(), 3, |t, k| basis[(t, k)] * e[t]);
    for (lags, expected) in &golden.newey_west {
        let bandwidth = Bandwidth::Fixed(lags.parse::<f64>().unwrap() + 1.0);
        let s = long_run_covariance(&scores, &golden.slots(), Kernel::Bartlett, bandwidth);
        let covariance = design.sandwich(&s);
        for k in 0..3 {
            (0..3).for_each(|l| close(covariance[(k, l)], expected[k][l], 1e-9));
        }
    }
}

#[test]
fn the_quadratic_spectral_kernel_sees_gaps_at_their_true_length() {
    let golden = Golden::load();
    let jacobian = golden.jacobian();
    let scores = DMatrix::from_fn(60, 3, |t, k| jacobian[(t, k)] * golden.errors[t]);
    let (kernel, bandwidth) = (Kernel::QuadraticSpectral, Bandwidth::Fixed(4.5));
    let found = long_run_covariance(&scores, &golden.gapped, kernel, bandwidth);
    for k in 0..3 {
        (0..3).for_each(|l| close(found[(k, l)], golden.quadratic_spectral[k][l], 1e-9));
    }
    let automatic = long_run_covariance(&scores, &golden.gapped, kernel, Bandwidth::Andrews);
    assert!(automatic.symmetric_eigenvalues().min() >= 0.0);
}

#[test]
fn tails_are_right_far_out() {
    let golden = Golden::load();
    for [z, p, log10_p] in golden.normal_tail {
        let found = normal_two_sided(-z);
        close(found.p, p, 1e-12);
        assert!((found.log10_p - log10_p).abs() < 1e-9 * log10_p.abs() + 1e-12, "{z}");
    }
    for [t, dof, p, log10_p] in golden.student_tail {
        let found = student_two_sided(t, dof);
        close(found.p, p, 1e-8);
        assert!((found.log10_p - log10_p).abs() < 1e-9 * log10_p.abs() + 1e-12, "{t} {dof}");
    }
    for [alpha, dof, t] in golden.student_quantile {
        close(student_quantile(alpha, dof), t, 1e-9);
    }
    close(normal_quantile(0.01), 2.575_829_303_548_901, 1e-13);
    assert!(normal_two_sided(1e3).log10_p < -200_000.0);
}

#[test]
fn autocorrelation_and_whiteness_repeat_statsmodels() {
    let golden = Golden::load();
    for (found, expected) in autocorrelation(&golden.y, 6).iter().zip(&golden.acf) {
        close(*found, *expected, 1e-11);
    }
    for [lags, statistic, p] in golden.ljung_box {
        let found = ljung_box(&golden.y, lags as usize, 0);
        close(found.statistic, statistic, 1e-10);
        close(found.p, p, 1e-8);
    }
}

fn normal(n: usize, seed: u64) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    (0..n).map(|_| StandardNormal.sample(&mut rng)).collect()
}

/// First-order autoregression with coefficient `rho` and variance 1.
fn first_order(n: usize, rho: f64, seed: u64) -> Vec<f64> {
    let mut e = normal(n, seed);
    for t in 1..n {
        e[t] = rho * e[t - 1] + (1.0 - rho * rho).sqrt() * e[t];
    }
    e
}

#[test]
fn undetermined_directions_are_found_whatever_the_units() {
    let (a, b) = (normal(50, 1), normal(50, 2));
    let columns = [a.clone(), a.iter().map(|a| 2000.0 * a).collect(), b, vec![0.0; 50]];
    let jacobian = DMatrix::from_column_slice(50, 4, &columns.concat());
    let design = Design::new(&jacobian).unwrap();
    assert_eq!((design.rank(), design.undetermined().len()), (2, 2));
    assert!(design.condition() > 1e12);
    let both = design.undetermined().iter().find(|d| d.parameters == [0, 1]).unwrap();
    close(both.weights[0] / both.weights[1], -2000.0, 1e-9);
    assert!(design.undetermined().iter().any(|d| d.parameters == [3]));
    let determined: Vec<bool> = (0..4).map(|k| design.is_determined(k)).collect();
    assert_eq!(determined, [false, false, true, false]);

    let slots: Vec<usize> = (0..50).collect();
    let e = normal(50, 3);
    let found = infer(&[1.0; 4], &[0.0; 4], &jacobian, &e, &slots, None, 0.99).unwrap();
    assert!(found.robust[0].low.is_nan() && found.robust[0].p == 1.0);
    assert!(found.robust[2].low < 1.0 && found.robust[2].high > 1.0);
}

#[test]
fn goodness_by_hand() {
    let found = Goodness::of(&[1.0, 2.0, 3.0], &[0.0, 2.0, 4.0]);
    let expected = Goodness { r2: 0.0, r2_printed: 4.0, mse: 2.0 / 3.0, rmse: (2f64 / 3.0).sqrt() };
    assert_eq!(found, expected);
}

#[test]
fn an_autoregression_is_recovered_across_gaps() {
    let x = first_order(6000, 0.8, 4);
    let slots: Vec<usize> = (0..6000).filter(|k| k % 50 < 30).collect();
    let kept: Vec<f64> = slots.iter().map(|&k| x[k]).collect();
    assert_eq!(contiguous(&slots).len(), 120);
    let model = Autoregression::fit(&kept, &slots);
    assert!((model.coefficients[1] + 0.8).abs() < 0.06, "{:?}", model.coefficients);
    let gamma = model.autocovariance(10);
    assert!((gamma[5] / gamma[0] - 0.8f64.powi(5)).abs() < 0.08, "{gamma:?}");
    let again = Autoregression::from_autocovariance(&model.autocovariance(model.order()));
    for (a, b) in again.coefficients.iter().zip(&model.coefficients) {
        assert!((a - b).abs() < 1e-9);
    }
}

#[test]
fn correlated_samples_are_worth_fewer() {
    let found = effective_samples(&first_order(20_000, 0.8, 5));
    let theory = 20_000.0 * 0.2 / 1.8;
    assert!((found / theory - 1.0).abs() < 0.15, "{found} against {theory}");
    assert!(effective_samples(&normal(2000, 6)) > 1500.0);
}

#[test]
fn block_bootstrap_sees_correlation_and_repeats_with_its_seed() {
    let (n, rho) = (4000, 0.8);
    let x = first_order(n, rho, 7);
    let mean = |[sum]: [f64; 1]| sum / n as f64;
    let block = block_length(rho, n);
    let [low, high] = block_bootstrap([&x], block, 1000, 0.95, 8, mean);
    let theory = 2.0 * 1.96 * ((1.0 + rho) / (1.0 - rho) / n as f64).sqrt();
    assert!(((high - low) / theory - 1.0).abs() < 0.2, "{} against {theory}", high - low);
    assert_eq!([low, high], block_bootstrap([&x], block, 1000, 0.95, 8, mean));
    assert_eq!(block_length(0.0, n), 1);
}

#[test]
fn noise_is_found_under_motion() {
    let (rate, sigma) = (125.0, 0.03);
    let motion = |k: usize| (std::f64::consts::TAU * 0.7 * k as f64 / rate).sin();
    let x: Vec<f64> =
        normal(6000, 9).iter().enumerate().map(|(k, e)| motion(k) + sigma * e).collect();
    assert!((noise_from_differences(&x) / sigma - 1.0).abs() < 0.05);
    assert!((noise_from_periodogram(&x, rate, 30.0..60.0) / sigma - 1.0).abs() < 0.15);
    assert!(noise_from_periodogram(&x, rate, 70.0..90.0).is_nan());
}

#[test]
fn what_cannot_be_inferred_is_refused() {
    let jacobian = DMatrix::from_element(10, 1, 1.0);
    let slots: Vec<usize> = (0..10).collect();
    let refuse = |residual: &[f64], slots: &[usize], level| {
        infer(&[1.0], &[0.0], &jacobian, residual, slots, None, level).unwrap_err()
    };
    let mut bad = vec![0.1; 10];
    bad[4] = f64::NAN;
    let not_finite = StatisticsError::NotFinite { what: "the residual", row: 4 };
    assert_eq!(refuse(&bad, &slots, 0.99), not_finite);
    assert_eq!(refuse(&[0.1; 10], &[3; 10], 0.99), StatisticsError::Order { row: 1 });
    assert_eq!(refuse(&[0.1; 10], &slots, 1.0), StatisticsError::Level { level: 1.0 });
    assert!(matches!(refuse(&[0.1; 9], &slots, 0.99), StatisticsError::Length { .. }));
    let short = DMatrix::from_element(2, 1, 1.0);
    let few = infer(&[1.0], &[0.0], &short, &[0.0; 2], &[0, 1], None, 0.99).unwrap_err();
    assert_eq!(few, StatisticsError::TooFewRows { rows: 2, parameters: 1 });
}

#[test]
fn what_nothing_tells_is_not_determined() {
    let slots: Vec<usize> = (0..40).collect();
    let jacobian = DMatrix::zeros(40, 2);
    let found = infer(&[1.0, 2.0], &[0.0; 2], &jacobian, &[0.1; 40], &slots, None, 0.99).unwrap();
    assert_eq!(found.design.rank(), 0);
    assert!(found.robust.iter().all(|r| r.p == 1.0 && r.low.is_nan()));
}

#[test]
fn a_perfect_fit_has_no_spread_and_no_panic() {
    let jacobian = DMatrix::from_fn(40, 2, |i, k| (i as f64).powi(k as i32));
    let slots: Vec<usize> = (0..40).collect();
    let found = infer(&[1.0, 2.0], &[0.0; 2], &jacobian, &[0.0; 40], &slots, None, 0.99).unwrap();
    assert!(found.robust[0].high - found.robust[0].low < 1e-100);
    assert_eq!((found.robust[1].p, found.asymptotic[1].p, found.paper[1].p), (0.0, 0.0, 0.0));
}
