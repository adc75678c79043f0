//! Two-sided p-values by the survival function, so that they neither underflow nor exceed 1, and
//! the quantiles that go with them.

use std::f64::consts::{LN_10, PI};

use statrs::function::gamma::ln_gamma;

/// P(|Z| > |z|) and its decimal logarithm, which stays finite where `p` is 0 (below 1e-308).
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct PValue {
    pub p: f64,
    pub log10_p: f64,
}

impl PValue {
    fn from_ln(ln_p: f64) -> Self {
        Self { p: ln_p.exp().min(1.0), log10_p: (ln_p / LN_10).min(0.0) }
    }
}

/// 2 (1 - Phi(|z|)) = erfc(|z| / sqrt 2).
pub fn normal_two_sided(z: f64) -> PValue {
    let x2 = 0.5 * z * z;
    if x2.is_infinite() {
        return PValue::from_ln(f64::NEG_INFINITY);
    }
    let ln_front = -x2 + 0.5 * (x2 / PI).ln();
    if x2 > 2.0 {
        return PValue::from_ln(ln_front - x2.ln() + erfc_fraction(x2).ln());
    }
    let p = 1.0 - 2.0 * erf_series(x2) * ln_front.exp();
    PValue { p, log10_p: p.log10() }
}

/// erf x = 2 x e^(-x^2) / sqrt pi times sum (2 x^2)^n / (2n + 1)!!, Abramowitz and Stegun 7.1.6.
fn erf_series(x2: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for n in 1..60 {
        term *= 2.0 * x2 / f64::from(2 * n + 1);
        sum += term;
    }
    sum
}

/// erfc x = e^(-x^2) / (x sqrt pi) times 1/(1 + (1/2x^2)/(1 + (2/2x^2)/(1 + ...))), Abramowitz and
/// Stegun 7.1.14, from the bottom up.
fn erfc_fraction(x2: f64) -> f64 {
    let step = |tail: f64, k: i32| 1.0 + f64::from(k) / (2.0 * x2) / tail;
    1.0 / (1..=120).rev().fold(1.0, step)
}

/// P(|T| > |t|) = I_{nu/(nu + t^2)}(nu/2, 1/2) for Student's t with `dof` = nu degrees of freedom;
/// normal for an infinite `dof`.
pub fn student_two_sided(t: f64, dof: f64) -> PValue {
    if dof.is_infinite() {
        return normal_two_sided(t);
    }
    let a = 0.5 * dof;
    let ratio = t * t / dof;
    if ratio.is_infinite() {
        return PValue::from_ln(f64::NEG_INFINITY);
    }
    let (x, y) = (1.0 / (1.0 + ratio), ratio / (1.0 + ratio));
    let ln_front = -a * ratio.ln_1p() + 0.5 * y.ln() - ln_beta_half(a);
    if x < (a + 1.0) / (a + 2.5) {
        PValue::from_ln(ln_front - a.ln() + beta_fraction(a, 0.5, x).ln())
    } else {
        let p = 1.0 - 2.0 * (ln_front).exp() * beta_fraction(0.5, a, y);
        PValue { p, log10_p: p.log10() }
    }
}

/// ln B(a, 1/2) = ln Gamma(a) + ln Gamma(1/2) - ln Gamma(a + 1/2); for large a by the asymptotic
/// series of the ratio, where the difference of logarithms would cancel.
fn ln_beta_half(a: f64) -> f64 {
    let ln_ratio = if a < 100.0 {
        ln_gamma(a + 0.5) - ln_gamma(a)
    } else {
        0.5 * a.ln() - 1.0 / (8.0 * a) + 1.0 / (192.0 * a.powi(3)) - 1.0 / (640.0 * a.powi(5))
    };
    0.5 * PI.ln() - ln_ratio
}

/// Continued fraction of the incomplete beta function by Lentz's method (Press et al., Numerical
/// Recipes, section 6.4): I_x(a, b) = x^a (1-x)^b / (a B(a, b)) times it.
fn beta_fraction(a: f64, b: f64, x: f64) -> f64 {
    const TINY: f64 = 1e-300;
    const TERMS: usize = 100_000;
    let guard = |v: f64| if v.abs() < TINY { TINY } else { v };
    let mut c = 1.0;
    let mut d = 1.0 / guard(1.0 - (a + b) * x / (a + 1.0));
    let mut h = d;
    for m in 1..TERMS {
        let m = m as f64;
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        d = 1.0 / guard(1.0 + even * d);
        c = guard(1.0 + even / c);
        h *= d * c;
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / guard(1.0 + odd * d);
        c = guard(1.0 + odd / c);
        h *= d * c;
        if (d * c - 1.0).abs() < 1e-16 {
            break;
        }
    }
    h
}

/// z with P(|Z| > z) = `alpha`: 2.5758 for 0.01.
pub fn normal_quantile(alpha: f64) -> f64 {
    student_quantile(alpha, f64::INFINITY)
}

/// t with P(|T| > t) = `alpha` for `dof` degrees of freedom, by bisection.
pub fn student_quantile(alpha: f64, dof: f64) -> f64 {
    let beyond = |t: f64| student_two_sided(t, dof).log10_p > alpha.log10();
    let (mut low, mut high) = (0.0, 1.0);
    while beyond(high) && high < 1e150 {
        (low, high) = (high, 2.0 * high);
    }
    while high - low > 1e-15 * high {
        let middle = f64::midpoint(low, high);
        if middle <= low || middle >= high {
            break;
        }
        match beyond(middle) {
            true => low = middle,
            false => high = middle,
        }
    }
    f64::midpoint(low, high)
}
