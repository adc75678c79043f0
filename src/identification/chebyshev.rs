//! Chebyshev interpolation: nodes, Lagrange weights, coefficients, Clenshaw's recurrence.
//!
//! Trefethen, *Approximation Theory and Approximation Practice*, 2013, chapters 3 to 8.

use std::f64::consts::PI;

/// The `n` zeros of T_n, cos((k + 1/2) pi / n).
pub fn nodes(n: usize) -> Vec<f64> {
    (0..n).map(|k| ((k as f64 + 0.5) * PI / n as f64).cos()).collect()
}

/// The Lagrange polynomials on [`nodes`]: an interpolant at `x` is the dot product of their values
/// with the values at the nodes (barycentric formula, Trefethen, Theorem 5.1).
#[derive(Debug, Clone)]
pub struct Lagrange {
    nodes: Vec<f64>,
    weights: Vec<f64>,
}

impl Lagrange {
    pub fn new(n: usize) -> Self {
        let weight = |k: usize| {
            let sine = ((k as f64 + 0.5) * PI / n as f64).sin();
            if k.is_multiple_of(2) { sine } else { -sine }
        };
        Self { nodes: nodes(n), weights: (0..n).map(weight).collect() }
    }

    /// Their values at `x`.
    pub fn at(&self, x: f64) -> Vec<f64> {
        if let Some(hit) = self.nodes.iter().position(|&node| node == x) {
            return (0..self.nodes.len()).map(|k| if k == hit { 1.0 } else { 0.0 }).collect();
        }
        let pairs = self.weights.iter().zip(&self.nodes);
        let mut values: Vec<f64> = pairs.map(|(w, node)| w / (x - node)).collect();
        let scale = 1.0 / values.iter().sum::<f64>();
        values.iter_mut().for_each(|v| *v *= scale);
        values
    }
}

/// The matrix that turns values at [`nodes`] into Chebyshev coefficients, row after row.
pub fn coefficients(n: usize) -> Vec<Vec<f64>> {
    let row = |j: usize| {
        let scale = if j == 0 { 1.0 } else { 2.0 } / n as f64;
        (0..n).map(|k| scale * (j as f64 * (k as f64 + 0.5) * PI / n as f64).cos()).collect()
    };
    (0..n).map(row).collect()
}

/// How many nodes on an interval of half-width `half_width` reach `accuracy` for a function that
/// is analytic and bounded within `distance` of the interval across (Trefethen, Theorem 8.2).
pub fn nodes_needed(distance: f64, half_width: f64, accuracy: f64) -> usize {
    let semi_axis = distance / half_width;
    let rho = semi_axis + (1.0 + semi_axis * semi_axis).sqrt();
    (-accuracy.ln() / rho.ln()).ceil() as usize + 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_reproduce_a_polynomial() {
        let f = |x: f64| 1.0 - 3.0 * x + 4.0 * x.powi(5);
        let values: Vec<f64> = nodes(7).into_iter().map(f).collect();
        let x = 0.37;
        let by_lagrange: f64 = Lagrange::new(7).at(x).iter().zip(&values).map(|(l, v)| l * v).sum();
        let series: f64 = coefficients(7)
            .iter()
            .enumerate()
            .map(|(j, row)| {
                let c: f64 = row.iter().zip(&values).map(|(m, v)| m * v).sum();
                c * (j as f64 * x.acos()).cos()
            })
            .sum();
        assert!((by_lagrange - f(x)).abs() < 1e-14);
        assert!((series - f(x)).abs() < 1e-14);
        assert_eq!(Lagrange::new(3).at(nodes(3)[1]), [0.0, 1.0, 0.0]);
    }

    #[test]
    fn the_number_of_nodes_is_enough_for_a_function_with_a_known_pole() {
        let f = |x: f64| 1.0 / (1.0 + 4.0 * x * x);
        let n = nodes_needed(0.5, 1.0, 1e-10);
        let values: Vec<f64> = nodes(n).into_iter().map(f).collect();
        for i in 0..100 {
            let x = -1.0 + 0.02 * f64::from(i);
            let p: f64 = Lagrange::new(n).at(x).iter().zip(&values).map(|(l, v)| l * v).sum();
            assert!((p - f(x)).abs() < 1e-8, "{n} nodes, {x}");
        }
    }
}
