//! Golden numbers from statsmodels, scipy and mpmath (`tests/golden/statistics.py`), and what holds
//! by construction.

use nalgebra::DMatrix;
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
    let found = infer(beta.as_slice(), &zero, &jacobian, &residual, &golden.slots(), 0.99).unwrap();
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
