//! Loops over samples, compiled for several instruction sets and chosen at run time.
//!
//! Sums run in 16 fixed lanes and nothing is contracted to fused multiply-add, so a result has
//! the same bits whichever version runs.

use std::ops::Range;

use multiversion::multiversion;

const LANES: usize = 16;

/// a . b
#[multiversion(targets("x86_64+avx512f+avx512dq", "x86_64+avx2", "aarch64+neon"))]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; LANES];
    let (head_a, tail_a) = a.as_chunks::<LANES>();
    let (head_b, tail_b) = b.as_chunks::<LANES>();
    for (x, y) in head_a.iter().zip(head_b) {
        for l in 0..LANES {
            lanes[l] += x[l] * y[l];
        }
    }
    let tail: f64 = tail_a.iter().zip(tail_b).map(|(x, y)| x * y).sum();
    lanes.iter().sum::<f64>() + tail
}

/// y += alpha x
#[multiversion(targets("x86_64+avx512f+avx512dq", "x86_64+avx2", "aarch64+neon"))]
pub fn axpy(alpha: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += alpha * x;
    }
}

/// L^-1 v of a lower triangle, column after column.
#[multiversion(targets("x86_64+avx512f+avx512dq", "x86_64+avx2", "aarch64+neon"))]
pub fn solve_lower(lower: &[f64], v: &mut [f64]) {
    let m = v.len();
    for j in 0..m {
        let column = &lower[j * m..(j + 1) * m];
        let (known, rest) = v.split_at_mut(j + 1);
        known[j] /= column[j];
        rest.iter_mut().zip(&column[j + 1..]).for_each(|(y, l)| *y -= known[j] * l);
    }
}

/// B'a for several columns.
pub fn dots(a: &[f64], b: &[&[f64]]) -> Vec<f64> {
    b.iter().map(|column| dot(a, column)).collect()
}

/// B'a of every a, from the rows where it is not zero; each column of B is read once for all of them.
pub fn dots_of(a: &[Vec<f64>], b: &[&[f64]]) -> Vec<Vec<f64>> {
    let there = |a: &Vec<f64>| {
        let first = a.iter().position(|v| *v != 0.0)?;
        Some(first..a.iter().rposition(|v| *v != 0.0)? + 1)
    };
    let rows: Vec<Range<usize>> = a.iter().map(|a| there(a).unwrap_or(0..0)).collect();
    let mut products = vec![Vec::with_capacity(b.len()); a.len()];
    for b in b {
        for ((a, rows), products) in a.iter().zip(&rows).zip(&mut products) {
            products.push(dot(&a[rows.clone()], &b[rows.clone()]));
        }
    }
    products
}

/// Samples whose intermediate results stay in the cache.
const CACHED: usize = 512;

/// `[r . y, r . r]` of r = a - B x, which is never stored as a whole.
pub fn dots_of_rest(a: &[f64], b: &[&[f64]], x: &[f64], y: &[f64]) -> [f64; 2] {
    let (mut with_y, mut square) = (0.0, 0.0);
    let mut buffer = [0.0; CACHED];
    for (i, (a, y)) in a.chunks(CACHED).zip(y.chunks(CACHED)).enumerate() {
        let r = &mut buffer[..a.len()];
        r.copy_from_slice(a);
        for (column, x) in b.iter().zip(x) {
            axpy(-x, &column[i * CACHED..][..r.len()], r);
        }
        with_y += dot(r, y);
        square += dot(r, r);
    }
    [with_y, square]
}

/// How many sums [`add_squares_about_quartic`] runs side by side.
pub const SQUARES: usize = 8;

/// Adds (p(first + k spacing) - a[k])^2 of all k to the sums, which are to be added up in the end;
/// p is a quartic by its coefficients from theta^0 on.
#[multiversion(targets("x86_64+avx512f+avx512dq", "x86_64+avx2", "aarch64+neon"))]
pub fn add_squares_about_quartic(
    p: &[f64; 5],
    first: f64,
    spacing: f64,
    a: &[f64],
    sums: &mut [f64; SQUARES],
) {
    let rest = |k: f64, a: f64| {
        let theta = first + k * spacing;
        p[0] + theta * (p[1] + theta * (p[2] + theta * (p[3] + theta * p[4]))) - a
    };
    let (whole, tail) = a.as_chunks::<SQUARES>();
    let mut k: [f64; SQUARES] = std::array::from_fn(|l| l as f64);
    for a in whole {
        for l in 0..SQUARES {
            let r = rest(k[l], a[l]);
            sums[l] += r * r;
            k[l] += SQUARES as f64;
        }
    }
    let mut padded = [0.0; SQUARES];
    padded[..tail.len()].copy_from_slice(tail);
    for l in 0..SQUARES {
        let r = if l < tail.len() { rest(k[l], padded[l]) } else { 0.0 };
        sums[l] += r * r;
    }
}

/// sign(speed) exp(-|speed / scale|^exponent), the Stribeck column (exponent 1: the paper's Eq. 1);
/// zero at rest.
#[multiversion(targets("x86_64+avx512f+avx512dq", "x86_64+avx2", "aarch64+neon"))]
pub fn stribeck(speed: &[f64], scale: f64, exponent: f64, out: &mut [f64]) {
    let rate = 1.0 / scale;
    out.iter_mut().zip(speed).for_each(|(o, w)| *o = w.abs() * rate);
    // A power does not vectorise, and hardly anybody asks for one here.
    if exponent != 1.0 {
        out.iter_mut().for_each(|o| *o = o.powf(exponent));
    }
    for (o, &w) in out.iter_mut().zip(speed) {
        let e = exp_of_negative(-*o);
        *o = if w == 0.0 { 0.0 } else { e.copysign(w) };
    }
}

/// exp(x) for x <= 0 to about one unit in the last place, without a branch so that loops
/// vectorise; below -708 (where doubles become subnormal) it stays at exp(-708), 3e-308.
///
/// Cody and Waite's reduction x = n ln 2 + r, |r| <= ln 2 / 2, then a Taylor polynomial.
#[inline(always)]
pub fn exp_of_negative(x: f64) -> f64 {
    const LN2_HIGH: f64 = 6.931_471_803_691_238e-1;
    const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;
    // Adding it rounds to an integer, left in the low bits of the mantissa.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let x = x.max(-708.0);
    let shifted = x * std::f64::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = (x - n * LN2_HIGH) - n * LN2_LOW;
    let two_to_n = f64::from_bits((shifted.to_bits() << 52).wrapping_add(1023 << 52));
    taylor_exp(r) * two_to_n
}

/// exp(r) for |r| <= ln 2 / 2; the first term left out is 4e-18.
#[inline(always)]
fn taylor_exp(r: f64) -> f64 {
    const C: [f64; 14] = [
        1.0,
        1.0,
        1.0 / 2.0,
        1.0 / 6.0,
        1.0 / 24.0,
        1.0 / 120.0,
        1.0 / 720.0,
        1.0 / 5040.0,
        1.0 / 40320.0,
        1.0 / 362_880.0,
        1.0 / 3_628_800.0,
        1.0 / 39_916_800.0,
        1.0 / 479_001_600.0,
        1.0 / 6_227_020_800.0,
    ];
    C[..13].iter().rev().fold(C[13], |sum, c| sum * r + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exp_agrees_with_the_standard_library_to_two_units_in_the_last_place() {
        for i in 0..70_000 {
            let x = -0.01 * i as f64;
            let relative = (exp_of_negative(x) / x.exp() - 1.0).abs();
            assert!(relative < 4.5e-16, "exp({x}) is off by {relative:e}");
        }
        assert_eq!(exp_of_negative(0.0), 1.0);
        assert!(exp_of_negative(-1e5) < 1e-300);
    }

    #[test]
    fn dots_agree_with_plain_sums_at_every_length() {
        for n in 0..70 {
            let a: Vec<f64> = (0..n).map(|i| f64::from(i) + 0.5).collect();
            let b: Vec<f64> = (0..n).map(|i| 2.0 - f64::from(i)).collect();
            let plain: f64 = a.iter().zip(&b).map(|(x, y)| x * y).sum();
            assert_eq!(dot(&a, &b), plain, "{n} values");
            assert_eq!(dots(&a, &[&b, &a, &b, &a, &b])[2..5], [plain, dot(&a, &a), plain]);
        }
    }

    #[test]
    fn what_a_triangle_is_solved_for_gives_what_it_was_made_of() {
        for m in 0..40 {
            let entry = |i: usize, j: usize| match i.cmp(&j) {
                std::cmp::Ordering::Less => f64::NAN,
                std::cmp::Ordering::Equal => 2.0 + i as f64,
                std::cmp::Ordering::Greater => ((3 * i + 7 * j) as f64).sin(),
            };
            let lower: Vec<f64> = (0..m * m).map(|k| entry(k % m, k / m)).collect();
            let v: Vec<f64> = (0..m).map(|i| (i as f64).cos()).collect();
            let mut solved = v.clone();
            solve_lower(&lower, &mut solved);
            for (i, v) in v.iter().enumerate() {
                let made: f64 = (0..=i).map(|j| entry(i, j) * solved[j]).sum();
                assert!((made - v).abs() < 1e-12, "{made} {v}");
            }
        }
    }

    #[test]
    fn dots_of_the_rest_agree_with_the_rest_written_out() {
        let wave = |f: f64| (0..1300).map(|i| (f * f64::from(i)).sin()).collect::<Vec<f64>>();
        let (a, b, c, y) = (wave(0.1), wave(0.2), wave(0.3), wave(0.15));
        let mut rest = a.clone();
        axpy(-0.5, &b, &mut rest);
        axpy(2.0, &c, &mut rest);
        let [with_y, square] = dots_of_rest(&a, &[&b, &c], &[0.5, -2.0], &y);
        assert!((with_y - dot(&rest, &y)).abs() < 1e-10);
        assert!((square - dot(&rest, &rest)).abs() < 1e-10);
    }

    #[test]
    fn squares_about_a_quartic_agree_with_the_quartic_written_out() {
        let p = [0.3, -1.0, 2.0, 0.5, -0.7];
        let a: Vec<f64> = (0..40).map(|i| (0.3 * f64::from(i)).sin()).collect();
        for count in 0..=a.len() {
            let plain = |(k, a): (usize, &f64)| {
                let theta = 0.01 + 0.02 * k as f64;
                let y: f64 = p.iter().enumerate().map(|(n, p)| p * theta.powi(n as i32)).sum();
                (y - a).powi(2)
            };
            let plain: f64 = a[..count].iter().enumerate().map(plain).sum();
            let mut sums = [0.0; SQUARES];
            add_squares_about_quartic(&p, 0.01, 0.02, &a[..count], &mut sums);
            let fast: f64 = sums.iter().sum();
            assert!((fast - plain).abs() <= 1e-13 * plain, "{count}: {fast} {plain}");
        }
    }

    #[test]
    fn the_stribeck_column_is_odd_in_speed_and_zero_at_rest() {
        let mut out = [9.0; 3];
        stribeck(&[-0.1, 0.0, 0.1], 0.1, 1.0, &mut out);
        assert!((out[2] - (-1.0f64).exp()).abs() < 1e-15);
        assert_eq!(out[1], 0.0);
        assert_eq!(out[0], -out[2]);
        stribeck(&[-0.1, 0.0, 0.2], 0.1, 2.0, &mut out);
        assert!((out[2] - (-4.0f64).exp()).abs() < 1e-15);
        assert_eq!(out[1], 0.0);
    }
}
