//! Rate-independent friction states of presliding, advanced by a displacement.

/// Dahl's bristle z, -1 to 1, after `dx` more: dz/dx = (1 - z sign(dx)) / width, solved exactly,
/// z = s + (z - s) exp(-|dx| / width) with s = sign(dx). Dahl, Aerospace Corp. TOR-0158(3107-18),
/// 1968, with exponent 1.
pub fn dahl(z: f64, dx: f64, width: f64) -> f64 {
    let s = super::coulomb::sign(dx);
    s + (z - s) * (-(dx / width).abs()).exp()
}

/// Dahl's bristle, scaled to the level at which it slips, which is constant over `dx` more.
pub fn bent(z: f64, dx: f64, width: f64, level: f64) -> f64 {
    level * dahl(z / level, dx, width * level)
}

/// A spring that slips at z = -1 and 1 after `dx` more (Jenkins element): one of Maxwell-slip.
pub fn slip(z: f64, dx: f64, width: f64) -> f64 {
    (z + dx / width).clamp(-1.0, 1.0)
}

/// The states of `advance`, which is given the sample, the state before it and how far the joint turned since,
/// along the angles `q` (rad), zero at the first.
pub(super) fn along(q: &[f64], advance: impl Fn(usize, f64, f64) -> f64) -> Vec<f64> {
    let mut z = 0.0;
    let mut next = |k: usize| {
        z = advance(k, z, q[k] - q[k.max(1) - 1]);
        z
    };
    (0..q.len()).map(&mut next).collect()
}
