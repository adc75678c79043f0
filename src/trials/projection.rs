//! Least squares by orthonormal columns.

/// Columns shorter than this add nothing.
const SHORTEST: f64 = 1e-9;

/// Adds what of `column` the orthonormal columns `open` do not have yet.
pub fn add_to(open: &mut Vec<Vec<f64>>, column: Vec<f64>) {
    let column = without(open, column);
    let length = dot(&column, &column).sqrt();
    if length > SHORTEST {
        open.push(column.iter().map(|x| x / length).collect());
    }
}

/// What of `x` is orthogonal to the orthonormal columns `open`.
pub fn without(open: &[Vec<f64>], mut x: Vec<f64>) -> Vec<f64> {
    for column in open {
        let along = dot(column, &x);
        x.iter_mut().zip(column).for_each(|(x, c)| *x -= along * c);
    }
    x
}

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
