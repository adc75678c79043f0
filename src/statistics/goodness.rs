//! How well a prediction matches a measurement.

/// All from the same samples; sums over y (measured) and yhat (predicted).
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Goodness {
    /// 1 - sum (y - yhat)^2 / sum (y - mean y)^2; below 0 where the mean would predict better,
    /// NaN where y is constant.
    pub r2: f64,
    /// The paper's Eq. 20, sum (yhat - mean y)^2 / sum (y - mean y)^2: can exceed 1.
    pub r2_printed: f64,
    /// In the square of y's unit.
    pub mse: f64,
    pub rmse: f64,
}

impl Goodness {
    pub fn of(measured: &[f64], predicted: &[f64]) -> Self {
        let n = measured.len() as f64;
        let mean = measured.iter().sum::<f64>() / n;
        let about_mean = |v: &[f64]| v.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        let sse: f64 = measured.iter().zip(predicted).map(|(y, p)| (y - p).powi(2)).sum();
        let total = about_mean(measured);
        Self {
            r2: 1.0 - sse / total,
            r2_printed: about_mean(predicted) / total,
            mse: sse / n,
            rmse: (sse / n).sqrt(),
        }
    }
}
