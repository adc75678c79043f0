//! Kernel estimates of long-run covariance with a named kernel and bandwidth.

use std::f64::consts::PI;

use nalgebra::DMatrix;

/// Weight of a lag over the bandwidth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kernel {
    /// 1 - |x|: Newey and West, Econometrica 55(3), 1987.
    Bartlett,
    /// 25/(12 pi^2 x^2) (sin(6 pi x/5)/(6 pi x/5) - cos(6 pi x/5)): optimal among the kernels that
    /// yield positive estimates, Andrews, Econometrica 59(3), 1991, Eq. 2.7.
    QuadraticSpectral,
}

/// How far the kernel reaches.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bandwidth {
    /// In rows: lag l has the weight k(l / bandwidth). Newey and West's L lags are L + 1.
    Fixed(f64),
    /// Andrews (1991), Eq. 6.2 and 6.4, with an AR(1) fitted to each score.
    Andrews,
}

impl Kernel {
    pub fn weight(self, x: f64) -> f64 {
        let x = x.abs();
        match self {
            Self::Bartlett => (1.0 - x).max(0.0),
            Self::QuadraticSpectral if x < 1e-3 => 1.0 - (6.0 * PI * x / 5.0).powi(2) / 10.0,
            Self::QuadraticSpectral => {
                let y = 6.0 * PI * x / 5.0;
                3.0 / (y * y) * (y.sin() / y - y.cos())
            }
        }
    }

    /// Integral of k^2: a variance estimated with bandwidth S from n rows has about
    /// 2 n / (2 S times it) degrees of freedom (Priestley, Spectral Analysis, section 6.2.3).
    pub fn square_integral(self) -> f64 {
        match self {
            Self::Bartlett => 2.0 / 3.0,
            Self::QuadraticSpectral => 1.0,
        }
    }

    /// Andrews' bandwidth for `n` rows of an AR(1) with coefficient `rho`: 1.1447 (alpha1 n)^(1/3)
    /// or 1.3221 (alpha2 n)^(1/5).
    pub fn andrews(self, rho: f64, n: f64) -> f64 {
        let alpha2 = 4.0 * rho * rho / (1.0 - rho).powi(4);
        match self {
            Self::Bartlett => {
                let alpha1 = alpha2 * ((1.0 - rho) / (1.0 + rho)).powi(2);
                1.1447 * (alpha1 * n).cbrt()
            }
            Self::QuadraticSpectral => 1.3221 * (alpha2 * n).powf(0.2),
        }
    }
}

/// sum_t sum_s k((t - s)/S) g_t g_s^T over the rows g_t of `scores` (rows x columns): the
/// covariance of their sum. `slots` are the rows' times; what lies between is taken as zero (amplitude
/// modulation: Parzen, Sankhya A 25, 1963; Datta and Du, "Nonparametric HAC estimation for time
/// series data with missing observations", 2012). No small-sample correction.
pub fn long_run_covariance(
    scores: &DMatrix<f64>,
    slots: &[usize],
    kernel: Kernel,
    bandwidth: Bandwidth,
) -> DMatrix<f64> {
    let columns: Vec<Vec<f64>> =
        scores.column_iter().map(|c| zero_filled(c.as_slice(), slots)).collect();
    let s = match bandwidth {
        Bandwidth::Fixed(s) => s,
        Bandwidth::Andrews => pooled_andrews(&columns, kernel),
    };
    let p = columns.len();
    let mut sum = DMatrix::zeros(p, p);
    for i in 0..p {
        for j in i..p {
            sum[(i, j)] = weighted_lags(&columns[i], &columns[j], kernel, s);
            sum[(j, i)] = sum[(i, j)];
        }
    }
    sum
}

/// The series on all slots from the first row's to the last row's.
pub(super) fn zero_filled(values: &[f64], slots: &[usize]) -> Vec<f64> {
    let (first, last) = (slots.first().copied().unwrap_or(0), slots.last().copied().unwrap_or(0));
    let mut filled = vec![0.0; last - first + 1];
    for (v, slot) in values.iter().zip(slots) {
        filled[slot - first] = *v;
    }
    filled
}

/// sum over t, s of k((t - s)/S) a_t b_s, symmetrised.
pub(super) fn weighted_lags(a: &[f64], b: &[f64], kernel: Kernel, bandwidth: f64) -> f64 {
    let same = std::ptr::eq(a, b);
    let mut sum = dot(a, b);
    for lag in 1..reach(kernel, bandwidth, a.len()) {
        let w = kernel.weight(lag as f64 / bandwidth);
        let ahead = dot(&a[lag..], b);
        let behind = if same { ahead } else { dot(a, &b[lag..]) };
        sum += w * (ahead + behind);
    }
    sum
}

/// Lags with weight: all of them for the quadratic spectral kernel.
fn reach(kernel: Kernel, bandwidth: f64, n: usize) -> usize {
    match kernel {
        _ if bandwidth <= 0.0 => 1,
        Kernel::Bartlett => n.min(bandwidth.ceil() as usize),
        Kernel::QuadraticSpectral => n,
    }
}

/// Over the shorter of the two; in lanes, because all lags of the quadratic spectral kernel add up
/// to n^2 / 2 products.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len().min(b.len());
    let (heads_a, rest_a) = a[..n].as_chunks::<8>();
    let (heads_b, rest_b) = b[..n].as_chunks::<8>();
    let mut lanes = [0.0; 8];
    for (a, b) in heads_a.iter().zip(heads_b) {
        for l in 0..8 {
            lanes[l] += a[l] * b[l];
        }
    }
    lanes.iter().sum::<f64>() + rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum::<f64>()
}

/// Andrews (1991), Eq. 6.4 with unit weights: alpha pooled over the scores.
fn pooled_andrews(columns: &[Vec<f64>], kernel: Kernel) -> f64 {
    let n = columns.first().map_or(0, Vec::len) as f64;
    let (mut above, mut below) = (0.0, 0.0);
    for c in columns {
        let rho = first_order(c);
        let variance = (dot(c, c) - rho * dot(&c[1..], c)) / n;
        let spectrum = (variance / (1.0 - rho).powi(2)).powi(2);
        let rate = kernel.andrews(rho, 1.0);
        let exponent = if kernel == Kernel::Bartlett { 3.0 } else { 5.0 };
        above += spectrum * rate.powf(exponent);
        below += spectrum;
    }
    let exponent = if kernel == Kernel::Bartlett { 1.0 / 3.0 } else { 0.2 };
    if below > 0.0 { (above / below * n).powf(exponent) } else { 0.0 }
}

/// Least-squares AR(1) coefficient without constant, kept inside +-0.97 (Andrews and Monahan,
/// Econometrica 60(4), 1992, section 4).
pub(super) fn first_order(x: &[f64]) -> f64 {
    let power = dot(x, x);
    if power == 0.0 { 0.0 } else { (dot(&x[1..], x) / power).clamp(-0.97, 0.97) }
}
