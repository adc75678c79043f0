//! Smooth functions of a positive variable, tabulated for evaluation without a logarithm.
//!
//! Four pieces per octave, found by the leading bits of the argument; on each a Chebyshev series
//! in the argument itself. A function of 1/w that is bounded in the right half-plane is bounded
//! 8 half-widths from the middle of each piece, so 14 terms (rho = 16) leave 1e-16.

use multiversion::multiversion;

use super::chebyshev;

/// Functions evaluated side by side, padded to whole blocks.
const BLOCK: usize = 8;
/// Terms of a series.
const TERMS: usize = 14;
/// Bits of a double that are shifted out: sign, exponent and two bits of the mantissa remain.
const SHIFT: u32 = 50;

#[derive(Debug, Clone)]
pub struct Tables {
    /// Leading bits of the first piece.
    first: u64,
    functions: usize,
    pieces: Vec<Piece>,
    /// Piece after piece, block after block, term after term.
    coefficients: Vec<[f64; BLOCK]>,
}

#[derive(Debug, Clone, Copy)]
struct Piece {
    middle: f64,
    /// 1 / half-width
    scale: f64,
}

impl Tables {
    /// The ends of the pieces that cover `[low, high]`.
    pub fn covered(low: f64, high: f64) -> (f64, f64) {
        let first = low.to_bits() >> SHIFT;
        let last = high.to_bits() >> SHIFT;
        (f64::from_bits(first << SHIFT), f64::from_bits((last + 1) << SHIFT))
    }

    /// Tabulates `functions` functions between two ends from [`Tables::covered`].
    pub fn new(low: f64, high: f64, functions: usize, f: impl Fn(f64) -> Vec<f64>) -> Self {
        let first = low.to_bits() >> SHIFT;
        let count = (high.to_bits() >> SHIFT) - first;
        let ends = |i: u64| {
            (f64::from_bits((first + i) << SHIFT), f64::from_bits((first + i + 1) << SHIFT))
        };
        let piece = |(a, b): (f64, f64)| Piece { middle: 0.5 * (a + b), scale: 2.0 / (b - a) };
        let pieces: Vec<Piece> = (0..count).map(|i| piece(ends(i))).collect();
        let coefficients = pieces.iter().flat_map(|p| series(p, functions, &f)).collect();
        Self { first, functions, pieces, coefficients }
    }

    /// Calls `use_values` with the values of all functions at `x`; outside the pieces the series
    /// of the nearest one are continued.
    pub fn with<T>(&self, x: f64, use_values: impl FnOnce(&[f64]) -> T) -> T {
        let index = (x.to_bits() >> SHIFT).saturating_sub(self.first) as usize;
        let index = index.min(self.pieces.len() - 1);
        let t = (x - self.pieces[index].middle) * self.pieces[index].scale;
        let blocks = self.functions.div_ceil(BLOCK);
        let start = index * blocks * TERMS;
        let series = &self.coefficients[start..start + blocks * TERMS];
        let (mut near, mut far) = ([0.0; 4 * BLOCK], Vec::new());
        let values = if blocks <= 4 {
            &mut near[..]
        } else {
            far.resize(blocks * BLOCK, 0.0);
            &mut far[..]
        };
        for (block, out) in series.chunks_exact(TERMS).zip(values.chunks_exact_mut(BLOCK)) {
            out.copy_from_slice(&clenshaw(block, t));
        }
        use_values(&values[..self.functions])
    }
}

/// Series of one piece: per block, `TERMS` coefficients of `BLOCK` functions.
fn series(piece: &Piece, functions: usize, f: &impl Fn(f64) -> Vec<f64>) -> Vec<[f64; BLOCK]> {
    let at = |t: f64| f(piece.middle + t / piece.scale);
    let values: Vec<Vec<f64>> = chebyshev::nodes(TERMS).into_iter().map(at).collect();
    let turn = chebyshev::coefficients(TERMS);
    let blocks = functions.div_ceil(BLOCK);
    let mut out = vec![[0.0; BLOCK]; blocks * TERMS];
    for (j, row) in turn.iter().enumerate() {
        for (weight, value) in row.iter().zip(&values) {
            for (k, v) in value.iter().enumerate() {
                out[(k / BLOCK) * TERMS + j][k % BLOCK] += weight * v;
            }
        }
    }
    out
}

/// sum c_j T_j(t) for `BLOCK` series at once (Clenshaw's recurrence).
#[multiversion(targets("x86_64+avx512f+avx512dq", "x86_64+avx2", "aarch64+neon"))]
fn clenshaw(series: &[[f64; BLOCK]], t: f64) -> [f64; BLOCK] {
    let (mut b1, mut b2) = ([0.0; BLOCK], [0.0; BLOCK]);
    let twice = 2.0 * t;
    for c in series[1..].iter().rev() {
        for l in 0..BLOCK {
            let b = (c[l] - b2[l]) + twice * b1[l];
            b2[l] = b1[l];
            b1[l] = b;
        }
    }
    std::array::from_fn(|l| (series[0][l] - b2[l]) + t * b1[l])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decaying_exponentials_are_reproduced_to_machine_precision() {
        let f = |x: f64| (1..11).map(|k| (-0.3 * f64::from(k) / x).exp()).collect::<Vec<_>>();
        let (low, high) = Tables::covered(0.005, 0.5);
        assert!(low <= 0.005 && high > 0.5);
        let tables = Tables::new(low, high, 10, f);
        for i in 0..=1000 {
            let x = 0.005 * 100f64.powf(f64::from(i) / 1000.0);
            tables.with(x, |values| {
                for (value, exact) in values.iter().zip(f(x)) {
                    assert!((value - exact).abs() < 2e-15, "{x}: {value} {exact}");
                }
            });
        }
    }
}
