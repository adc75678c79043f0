//! The explicit Runge-Kutta pair of Dormand and Prince, order 5(4), with Shampine's continuous
//! extension of order 4.
//!
//! Source: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, 2nd ed., II.4
//! (Table 5.2) and II.6 (Eq. 6.12 and the code DOPRI5). Arrays live on the stack: no allocation.

/// y' = f(y); the system is autonomous because voltage is constant during a step.
pub trait Field<const N: usize> {
    fn rate(&self, y: &[f64; N]) -> [f64; N];
}

/// One step from `y0` over `h`, and what is needed to read off anything in between.
pub struct Step<const N: usize> {
    pub y0: [f64; N],
    pub y1: [f64; N],
    pub h: f64,
    /// Difference of the order-5 and the order-4 solution.
    pub error: [f64; 2],
    stages: [[f64; N]; 7],
}

const A2: [f64; 1] = [1.0 / 5.0];
const A3: [f64; 2] = [3.0 / 40.0, 9.0 / 40.0];
const A4: [f64; 3] = [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0];
const A5: [f64; 4] = [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0];
const A6: [f64; 5] =
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0];
const B: [f64; 6] =
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0];
const E: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];
const D: [f64; 7] = [
    -12715105075.0 / 11282082432.0,
    0.0,
    87487479700.0 / 32700410799.0,
    -10690763975.0 / 1880347072.0,
    701980252875.0 / 199316789632.0,
    -1453857185.0 / 822651844.0,
    69997945.0 / 29380423.0,
];

impl<const N: usize> Step<N> {
    /// Takes one step; `k1` is f(y0), kept from the step before.
    #[inline]
    pub fn take(field: &impl Field<N>, y0: &[f64; N], k1: &[f64; N], h: f64) -> Self {
        let mut k = [[0.0; N]; 7];
        k[0] = *k1;
        k[1] = field.rate(&combine(y0, h, &k, &A2));
        k[2] = field.rate(&combine(y0, h, &k, &A3));
        k[3] = field.rate(&combine(y0, h, &k, &A4));
        k[4] = field.rate(&combine(y0, h, &k, &A5));
        k[5] = field.rate(&combine(y0, h, &k, &A6));
        let y1 = combine(y0, h, &k, &B);
        k[6] = field.rate(&y1);
        let error = [0, 1].map(|n| h * (0..7).map(|s| E[s] * k[s][n]).sum::<f64>());
        Self { y0: *y0, y1, h, error, stages: k }
    }

    /// f at the end of the step, the next step's `k1`.
    pub fn rate_at_end(&self) -> &[f64; N] {
        &self.stages[6]
    }

    /// The continuous extension, prepared for many readings.
    #[inline]
    pub fn dense(&self) -> Dense<N> {
        let k = &self.stages;
        let mut c = [[0.0; N]; 4];
        for n in 0..N {
            let rise = self.y1[n] - self.y0[n];
            c[0][n] = rise;
            c[1][n] = self.h * k[0][n] - rise;
            c[2][n] = rise - self.h * k[6][n] - c[1][n];
            c[3][n] = self.h * (0..7).map(|s| D[s] * k[s][n]).sum::<f64>();
        }
        Dense { y0: self.y0, c }
    }
}

/// y(theta), theta from 0 to 1 over the step.
pub struct Dense<const N: usize> {
    y0: [f64; N],
    c: [[f64; N]; 4],
}

impl<const N: usize> Dense<N> {
    #[inline]
    pub fn at(&self, theta: f64) -> [f64; N] {
        std::array::from_fn(|n| self.component(n, theta))
    }

    /// The coefficients of theta^0 to theta^4 of one component.
    #[inline]
    pub fn powers(&self, n: usize) -> [f64; 5] {
        let [c0, c1, c2, c3] = self.c.map(|c| c[n]);
        [self.y0[n], c0 + c1, c2 + c3 - c1, -c2 - 2.0 * c3, c3]
    }

    #[inline]
    pub fn component(&self, n: usize, theta: f64) -> f64 {
        let rest = 1.0 - theta;
        let c = &self.c;
        self.y0[n] + theta * (c[0][n] + rest * (c[1][n] + theta * (c[2][n] + rest * c[3][n])))
    }
}

#[inline(always)]
fn combine<const N: usize, const M: usize>(
    y0: &[f64; N],
    h: f64,
    k: &[[f64; N]; 7],
    a: &[f64; M],
) -> [f64; N] {
    let mut y = [0.0; N];
    for n in 0..N {
        let mut slope = 0.0;
        for (m, weight) in a.iter().enumerate() {
            slope += weight * k[m][n];
        }
        y[n] = y0[n] + h * slope;
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A damped oscillator, y = exp(-t/4) (cos t, -sin t).
    struct Oscillator;

    impl Field<2> for Oscillator {
        fn rate(&self, y: &[f64; 2]) -> [f64; 2] {
            [-0.25 * y[0] + y[1], -y[0] - 0.25 * y[1]]
        }
    }

    fn exact(t: f64) -> f64 {
        (-0.25 * t).exp() * t.cos()
    }

    /// Largest errors at the ends of `steps` steps to t = 2, and in the middle of each.
    fn errors(steps: usize) -> (f64, f64) {
        let h = 2.0 / steps as f64;
        let mut y = [1.0, 0.0];
        let (mut at_ends, mut between) = (0.0_f64, 0.0_f64);
        for n in 0..steps {
            let step = Step::take(&Oscillator, &y, &Oscillator.rate(&y), h);
            let t = n as f64 * h;
            at_ends = at_ends.max((step.y1[0] - exact(t + h)).abs());
            between = between.max((step.dense().component(0, 0.5) - exact(t + 0.5 * h)).abs());
            y = step.y1;
        }
        (at_ends, between)
    }

    #[test]
    fn order_is_five_and_of_the_extension_at_least_four() {
        let ((coarse, coarse_between), (fine, fine_between)) = (errors(10), errors(20));
        let order = (coarse / fine).log2();
        assert!((4.8..5.3).contains(&order), "{order}");
        assert!((coarse_between / fine_between).log2() > 3.9);
    }
}
