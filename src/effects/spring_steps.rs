//! Many equal steps of a link on a linear spring at once.
//!
//! A step of length h (semi-implicit Euler) of wind-up w and rate r, under a load that rises by a step's
//! share d with every step,
//!
//! ```text
//! r_i+1 = r_i + h m (tau + i d - K w_i - D r_i),     w_i+1 = w_i + h r_i+1
//! ```
//!
//! is linear in (w, r), tau and d. So are n of them, and as many again follow from these: where one after
//! the other would wait for the one before, they take log2 n doublings.

/// What n steps make of a state, and the sum of w after each of them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Steps {
    n: f64,
    /// (w, r) by (w, r), by tau and by d.
    state: [[f64; 2]; 2],
    load: [f64; 2],
    rise: [f64; 2],
    /// Sum of w by (w, r), by tau and by d.
    sum: [f64; 2],
    sum_load: f64,
    sum_rise: f64,
}

impl Steps {
    const NONE: Self = Self {
        n: 0.0,
        state: [[1.0, 0.0], [0.0, 1.0]],
        load: [0.0; 2],
        rise: [0.0; 2],
        sum: [0.0; 2],
        sum_load: 0.0,
        sum_rise: 0.0,
    };

    /// One step of `h` s of a link with `mobility` m (1/(kg.m2)) on a spring of `stiffness` K (N.m/rad) and
    /// `damping` D (N.m.s/rad).
    pub fn one(stiffness: f64, damping: f64, mobility: f64, h: f64) -> Self {
        let pushed = h * mobility;
        let (by_w, by_r) = (-pushed * stiffness, 1.0 - pushed * damping);
        let state = [[1.0 + h * by_w, h * by_r], [by_w, by_r]];
        let load = [h * pushed, pushed];
        let (sum, sum_load) = (state[0], load[0]);
        Self { n: 1.0, state, load, rise: [0.0; 2], sum, sum_load, sum_rise: 0.0 }
    }

    /// `n` of these.
    pub fn times(&self, n: u32) -> Self {
        let bits = (0..u32::BITS - n.leading_zeros()).rev();
        bits.fold(Self::NONE, |all, bit| {
            let twice = all.then(&all);
            if n >> bit & 1 == 1 { twice.then(self) } else { twice }
        })
    }

    /// These, then those.
    pub fn then(&self, next: &Self) -> Self {
        let after = |x: [f64; 2]| [dot(next.state[0], x), dot(next.state[1], x)];
        let column = |i: usize| [self.state[0][i], self.state[1][i]];
        let [by_w, by_r] = [after(column(0)), after(column(1))];
        let load = after(self.load);
        let rise = after(self.rise);
        Self {
            n: self.n + next.n,
            state: [[by_w[0], by_r[0]], [by_w[1], by_r[1]]],
            load: [0, 1].map(|i| load[i] + next.load[i]),
            rise: [0, 1].map(|i| rise[i] + self.n * next.load[i] + next.rise[i]),
            sum: [0, 1].map(|i| self.sum[i] + dot(next.sum, column(i))),
            sum_load: self.sum_load + dot(next.sum, self.load) + next.sum_load,
            sum_rise: self.sum_rise
                + dot(next.sum, self.rise)
                + self.n * next.sum_load
                + next.sum_rise,
        }
    }

    /// (w, r) after the steps from `state`, and the sum of w, where `load` (N.m) is that of the first step and rises by
    /// `rise` with each.
    pub fn from(&self, state: [f64; 2], load: f64, rise: f64) -> ([f64; 2], f64) {
        let of = |i: usize| dot(self.state[i], state) + self.load[i] * load + self.rise[i] * rise;
        let sum = dot(self.sum, state) + self.sum_load * load + self.sum_rise * rise;
        ([of(0), of(1)], sum)
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_steps_at_once_are_those_steps_one_after_the_other() {
        let (stiffness, damping, mobility, h) = (1e4, 20.0, 1.0 / 0.3, 2.5e-4);
        let one = Steps::one(stiffness, damping, mobility, h);
        let start: [f64; 2] = [2e-3, -0.1];
        let (load, rise) = (30.0, -0.4);
        let ([mut w, mut r], mut sum) = (start, 0.0);
        for n in 0..40u32 {
            let (found, found_sum) = one.times(n).from(start, load, rise);
            assert!((found[0] - w).abs() < 1e-15, "{n}: {found:?}, {w}");
            assert!((found[1] - r).abs() < 1e-13, "{n}: {found:?}, {r}");
            assert!((found_sum - sum).abs() < 1e-14, "{n}: {found_sum}, {sum}");
            let torque = load + rise * f64::from(n) - stiffness * w - damping * r;
            r += h * mobility * torque;
            w += h * r;
            sum += w;
        }
    }
}
