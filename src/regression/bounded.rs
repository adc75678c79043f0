//! Linear least squares in a box: min |A x - y| with lower <= x <= upper.
//!
//! The active-set method BVLS of Stark and Parker, *Bounded-variable least-squares: an algorithm
//! and applications*, Computational Statistics 10, 1995. Meant for small systems (a tall one is
//! compressed by QR first).

use nalgebra::{DMatrix, DVector};

use super::bounds::Bounds;

/// Where a variable is held.
#[derive(Clone, Copy, PartialEq)]
enum Hold {
    Free,
    Lower,
    Upper,
}

/// The minimiser; among several (dependent columns) one of them.
pub fn solve(a: &DMatrix<f64>, y: &DVector<f64>, bounds: &Bounds) -> DVector<f64> {
    let n = a.ncols();
    let mut x = DVector::from_fn(n, |i, _| bounds.clamp(i, 0.0));
    let mut hold: Vec<Hold> = vec![Hold::Free; n];
    let mut barred = vec![false; n];
    for _ in 0..20 * n + 20 {
        let z = free_solution(a, y, &x, &hold);
        match first_blocked(&x, &z, &hold, bounds) {
            Some((i, share)) => {
                x += (&z - &x) * share;
                hold_at_nearer_bound(&mut x, &mut hold, i, &z, bounds);
            }
            None => {
                if (&z - &x).amax() > 0.0 {
                    barred.fill(false);
                }
                x = z;
                let pull = a.transpose() * (y - a * &x);
                let Some(i) = most_pulled_inwards(&pull, &hold, &barred, a, y) else { break };
                hold[i] = Hold::Free;
                barred[i] = true;
            }
        }
    }
    x
}

/// Least squares over the free variables, the others as they are.
fn free_solution(
    a: &DMatrix<f64>,
    y: &DVector<f64>,
    x: &DVector<f64>,
    hold: &[Hold],
) -> DVector<f64> {
    let free: Vec<usize> = (0..x.len()).filter(|&i| hold[i] == Hold::Free).collect();
    let mut z = x.clone();
    if free.is_empty() {
        return z;
    }
    free.iter().for_each(|&i| z[i] = 0.0);
    let rest = y - a * &z;
    let part = super::qr::Qr::new(free.iter().map(|&i| a.column(i).as_slice().to_vec()).collect());
    let solution = part.solve(&part.transpose_times(rest.as_slice()));
    free.iter().zip(solution.iter()).for_each(|(&i, &v)| z[i] = v);
    z
}

/// The free variable that meets its bound first on the way from `x` to `z`, and after which share.
fn first_blocked(
    x: &DVector<f64>,
    z: &DVector<f64>,
    hold: &[Hold],
    bounds: &Bounds,
) -> Option<(usize, f64)> {
    (0..x.len())
        .filter(|&i| hold[i] == Hold::Free && bounds.clamp(i, z[i]) != z[i])
        .map(|i| (i, (bounds.clamp(i, z[i]) - x[i]) / (z[i] - x[i])))
        .min_by(|p, q| p.1.total_cmp(&q.1))
}

fn hold_at_nearer_bound(
    x: &mut DVector<f64>,
    hold: &mut [Hold],
    i: usize,
    z: &DVector<f64>,
    bounds: &Bounds,
) {
    let upwards = z[i] > bounds.upper(i);
    hold[i] = if upwards { Hold::Upper } else { Hold::Lower };
    x[i] = if upwards { bounds.upper(i) } else { bounds.lower(i) };
}

/// The held variable whose gradient wants it back inside the most.
fn most_pulled_inwards(
    pull: &DVector<f64>,
    hold: &[Hold],
    barred: &[bool],
    a: &DMatrix<f64>,
    y: &DVector<f64>,
) -> Option<usize> {
    let tolerance = |i: usize| 1e-12 * a.column(i).norm() * y.norm();
    let inwards = |i: usize| match hold[i] {
        Hold::Free => 0.0,
        Hold::Lower => pull[i],
        Hold::Upper => -pull[i],
    };
    (0..hold.len())
        .filter(|&i| !barred[i] && inwards(i) > tolerance(i))
        .max_by(|&i, &j| inwards(i).total_cmp(&inwards(j)))
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// Karush, Kuhn, Tucker: gradient zero inside, pointing outwards on a bound.
    fn assert_optimal(a: &DMatrix<f64>, y: &DVector<f64>, bounds: &Bounds, x: &DVector<f64>) {
        let pull = a.transpose() * (y - a * x);
        for i in 0..x.len() {
            assert!(bounds.lower(i) <= x[i] && x[i] <= bounds.upper(i), "{x}");
            assert!(pull[i] < 1e-9 || x[i] == bounds.upper(i), "{i}: {pull}");
            assert!(pull[i] > -1e-9 || x[i] == bounds.lower(i), "{i}: {pull}");
        }
    }

    #[test]
    fn random_problems_meet_the_optimality_conditions() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for _ in 0..300 {
            let a = DMatrix::from_fn(9, 6, |_, _| rng.random::<f64>() - 0.5);
            let y = DVector::from_fn(9, |_, _| 4.0 * rng.random::<f64>() - 2.0);
            let lower: Vec<f64> = (0..6).map(|_| rng.random::<f64>() - 1.0).collect();
            let upper = lower.iter().map(|l| l + 0.1 + rng.random::<f64>()).collect();
            let bounds = Bounds::new(lower, upper).unwrap();
            assert_optimal(&a, &y, &bounds, &solve(&a, &y, &bounds));
        }
    }

    #[test]
    fn dependent_columns_and_zero_columns_are_no_obstacle() {
        let mut a = DMatrix::from_fn(5, 4, |i, j| ((i * i + 3 * j) as f64).sin());
        a.column_mut(2).fill(0.0);
        let twice = 2.0 * a.column(0);
        a.set_column(3, &twice);
        let y = DVector::from_vec(vec![1.0, -2.0, 0.5, 3.0, 1.0]);
        let bounds = Bounds::new(vec![0.0; 4], vec![0.3; 4]).unwrap();
        assert_optimal(&a, &y, &bounds, &solve(&a, &y, &bounds));
    }
}
