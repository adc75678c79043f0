//! Autoregressive model of a residual with gaps.

use std::ops::Range;

/// Reflection coefficients are kept inside the unit circle by this much.
const LARGEST_REFLECTION: f64 = 0.9999;
/// Autocovariances below this share of the variance count as zero.
const NEGLIGIBLE: f64 = 1e-9;

/// sum_i a_i e_{t-i} = white noise, a_0 = 1, with autocovariances gamma_0 .. gamma_p.
#[derive(Debug, Clone, PartialEq)]
pub struct Autoregression {
    /// a_0 = 1, a_1, ... a_p
    pub coefficients: Vec<f64>,
    autocovariance: Vec<f64>,
    innovation: f64,
}

/// Neighbours in time among rows: stretches in which `slots` grow by one.
pub fn contiguous(slots: &[usize]) -> Vec<Range<usize>> {
    let mut cuts = vec![0];
    cuts.extend((1..slots.len()).filter(|&i| slots[i] != slots[i - 1] + 1));
    cuts.push(slots.len());
    cuts.windows(2).map(|w| w[0]..w[1]).filter(|r| !r.is_empty()).collect()
}

impl Autoregression {
    /// Burg's method over the contiguous stretches of `x` (de Waele and Broersen, "The Burg
    /// algorithm for segments", IEEE Transactions on Signal Processing 48(10), 2000), the order up
    /// to 10 log10 n by Akaike's criterion. `x` has mean zero.
    pub fn fit(x: &[f64], slots: &[usize]) -> Self {
        let mut forward: Vec<Vec<f64>> =
            contiguous(slots).into_iter().map(|r| x[r].to_vec()).collect();
        let mut backward = forward.clone();
        let n = x.len() as f64;
        let mut model = Self::white(x.iter().map(|e| e * e).sum::<f64>() / n);
        let (mut best, mut least) = (model.clone(), n * model.innovation.ln());
        for order in 1..=(10.0 * n.log10()) as usize {
            let Some(k) = reflection(&mut forward, &mut backward, order) else { break };
            model.extend(k);
            let akaike = n * model.innovation.ln() + 2.0 * order as f64;
            if akaike < least {
                (best, least) = (model.clone(), akaike);
            }
        }
        best
    }

    /// Levinson-Durbin recursion from autocovariances gamma_0 .. gamma_p (Brockwell and Davis, Time
    /// Series: Theory and Methods, section 8.2).
    pub fn from_autocovariance(gamma: &[f64]) -> Self {
        let mut model = Self::white(gamma[0]);
        for p in 1..gamma.len() {
            let next = model.coefficients.iter().zip(gamma[1..=p].iter().rev());
            let k = -next.map(|(a, g)| a * g).sum::<f64>() / model.innovation;
            model.extend(k.clamp(-LARGEST_REFLECTION, LARGEST_REFLECTION));
        }
        model
    }

    fn white(variance: f64) -> Self {
        let variance = variance.max(f64::MIN_POSITIVE);
        Self { coefficients: vec![1.0], autocovariance: vec![variance], innovation: variance }
    }

    pub fn order(&self) -> usize {
        self.coefficients.len() - 1
    }

    /// Variance of the white noise.
    pub fn innovation(&self) -> f64 {
        self.innovation
    }

    /// One order more, with reflection coefficient `k`.
    fn extend(&mut self, k: f64) {
        let next = predict(&self.coefficients, &self.autocovariance) - k * self.innovation;
        self.autocovariance.push(next);
        self.coefficients.push(0.0);
        let reversed: Vec<f64> = self.coefficients.iter().rev().copied().collect();
        self.coefficients.iter_mut().zip(&reversed).for_each(|(a, r)| *a += k * r);
        self.innovation *= 1.0 - k * k;
    }

    /// gamma_0, gamma_1, ... up to where they stay negligible, at most `longest` lags.
    pub fn autocovariance(&self, longest: usize) -> Vec<f64> {
        let mut gamma = self.autocovariance.clone();
        let small = NEGLIGIBLE * gamma[0];
        let mut quiet = 0;
        while gamma.len() <= longest && quiet <= self.order() {
            let next = predict(&self.coefficients, &gamma);
            quiet = if next.abs() < small { quiet + 1 } else { 0 };
            gamma.push(next);
        }
        gamma.truncate(longest + 1);
        gamma
    }
}

/// gamma_l = -sum a_i gamma_{l-i}
fn predict(a: &[f64], gamma: &[f64]) -> f64 {
    -a[1..].iter().zip(gamma.iter().rev()).map(|(a, g)| a * g).sum::<f64>()
}

/// Burg's k = -2 sum f b / sum (f^2 + b^2) over all stretches, which it updates. `None` when too
/// few pairs are left for one order more.
fn reflection(f: &mut Vec<Vec<f64>>, b: &mut Vec<Vec<f64>>, order: usize) -> Option<f64> {
    f.retain(|x| x.len() > 1);
    b.retain(|x| x.len() > 1);
    f.iter_mut().for_each(|x| x.copy_within(1.., 0));
    f.iter_mut().chain(b.iter_mut()).for_each(|x| x.truncate(x.len() - 1));
    let pairs = || f.iter().flatten().zip(b.iter().flatten());
    let power: f64 = pairs().map(|(f, b)| f * f + b * b).sum();
    if pairs().count() < 5 * order || power <= 0.0 {
        return None;
    }
    let k = -2.0 * pairs().map(|(f, b)| f * b).sum::<f64>() / power;
    let k = k.clamp(-LARGEST_REFLECTION, LARGEST_REFLECTION);
    for (f, b) in f.iter_mut().flatten().zip(b.iter_mut().flatten()) {
        (*f, *b) = (*f + k * *b, *b + k * *f);
    }
    Some(k)
}
