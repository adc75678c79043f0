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
    let n = v.len();
    for (i, p) in p.iter_mut().enumerate() {
        *p = p.clamp(-limit[i], limit[i]);
    }
    for (i, v) in v.iter_mut().enumerate() {
        *v = (0..n).map(|j| g[(i, j)] * (b[j] - p[j])).sum();
    }
    let largest = limit.iter().fold(0.0, |m: f64, r| m.max(*r));
    for _ in 0..SWEEPS {
        let mut moved = 0.0_f64;
        for j in 0..n {
            let next = (p[j] + v[j] / g[(j, j)]).clamp(-limit[j], limit[j]);
            let change = next - p[j];
            if change != 0.0 {
                p[j] = next;
                v.iter_mut().enumerate().for_each(|(i, v)| *v -= g[(i, j)] * change);
                moved = moved.max(change.abs());
            }
        }
        if moved <= SETTLED * largest {
            break;
        }
    }
    // Rounding must not make a standing joint creep.
    for j in (0..n).filter(|&j| p[j].abs() < limit[j]) {
        v[j] = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solved(b: [f64; 2], limit: [f64; 2]) -> ([f64; 2], [f64; 2]) {
        let a = DMatrix::from_row_slice(2, 2, &[2.0, 0.9, 0.9, 1.0]);
        let g = a.clone().try_inverse().unwrap();
        let b = DVector::from_row_slice(&b);
        let (mut p, mut v) = ([0.0; 2], [0.0; 2]);
        solve(&g, &b, &limit, &mut p, &mut v);
        let left = &b - &a * DVector::from_row_slice(&v) - DVector::from_row_slice(&p);
        assert!(left.norm() < 1e-10, "{left}");
        (p, v)
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
