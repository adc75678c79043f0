//! Forward sensitivities: d(i, w)/d(parameters) along a simulation, exact for the discrete solution.
//!
//! While sliding, S = dy/dtheta obeys the variational equation S' = (df/dy) S + df/dtheta. Where the
//! speed passes zero at t_e the right-hand side jumps from f- to f+, and with it the sensitivity
//! (saltation): S+ = S- + (f- - f+) dt_e/dtheta with dt_e/dtheta = -S_w / f_w-. The current's rate is
//! continuous at w = 0, hence S_i+ = S_i-, S_w+ = S_w- f_w+ / f_w-, which is zero when the motor stands.
//! At breakaway dw/dt is continuous (both zero), so nothing jumps. While standing, the closed form of
//! the current is differentiated. Source: Hiskens and Pai, Trajectory sensitivity analysis of hybrid
//! systems, IEEE Trans. Circuits and Systems I 47(2), 2000, Eq. 37 to 45.
//!
//! Output is not differentiable where a change of parameters changes the sequence of modes (a stop
//! that is just reached or just missed): there the derivative is one-sided.

use super::dormand_prince::Field;
use super::model::{COUNT, Motor, index};
use super::simulate::{Accuracy, CURRENT, Failure, Hybrid, Input, OMEGA, run};

/// i, w, di/dtheta (10), dw/dtheta (10)
const N: usize = 2 + 2 * COUNT;
const S_I: usize = 2;
const S_W: usize = 2 + COUNT;

/// Output and its derivatives, sample after sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sensitivities {
    pub omega: Vec<f64>,
    pub current: Vec<f64>,
    pub d_omega: Vec<[f64; COUNT]>,
    pub d_current: Vec<[f64; COUNT]>,
}

/// Simulates from rest with sensitivities. `output` is overwritten and keeps its memory.
pub fn simulate_with_sensitivities(
    motor: &Motor,
    input: &Input,
    accuracy: Accuracy,
    output: &mut Sensitivities,
) -> Result<(), Failure> {
    output.omega.clear();
    output.current.clear();
    output.d_omega.clear();
    output.d_current.clear();
    run(&Varied(*motor), input, accuracy, &mut |y: &[f64; N]| {
        output.current.push(y[CURRENT]);
        output.omega.push(y[OMEGA]);
        output.d_current.push(std::array::from_fn(|p| y[S_I + p]));
        output.d_omega.push(std::array::from_fn(|p| y[S_W + p]));
    })
}

#[derive(Clone, Copy)]
struct Varied(Motor);

struct VariedSliding {
    system: Varied,
    voltage: f64,
    sign: f64,
}

impl Varied {
    /// d(di/dt)/dtheta at fixed state.
    #[inline]
    fn current_partials(&self, i: f64, w: f64, di: f64) -> [f64; COUNT] {
        let l = self.0.l;
        let mut d = [0.0; COUNT];
        d[index::K] = -w / l;
        d[index::L] = -di / l;
        d[index::R] = -i / l;
        d
    }

    /// d(dw/dt)/dtheta at fixed state.
    #[inline]
    fn speed_partials(&self, i: f64, w: f64, dw: f64, sign: f64) -> [f64; COUNT] {
        let m = &self.0;
        let speed = sign * w;
        let e = m.stribeck(speed);
        let mut d = [0.0; COUNT];
        d[index::J] = -dw;
        d[index::K] = i;
        d[index::T_S] = -sign * e;
        d[index::T_C] = -sign * (1.0 - e);
        d[index::T_V1] = -w;
        d[index::T_V2] = -w * speed;
        d[index::T_V3] = -w * w * w;
        d[index::OMEGA_S] = -sign * (m.t_s - m.t_c) * e * speed / (m.omega_s * m.omega_s);
        d.map(|x| x / m.j)
    }
}

impl Field<N> for VariedSliding {
    #[inline]
    fn rate(&self, y: &[f64; N]) -> [f64; N] {
        let Self { system, voltage, sign } = *self;
        let m = &system.0;
        let (i, w) = (y[CURRENT], y[OMEGA]);
        let mut dy = [0.0; N];
        dy[CURRENT] = m.current_rate(voltage, i, w);
        dy[OMEGA] = m.acceleration(i, w, sign);
        let f_i = system.current_partials(i, w, dy[CURRENT]);
        let f_w = system.speed_partials(i, w, dy[OMEGA], sign);
        let (ii, iw) = (-m.r / m.l, -m.k / m.l);
        let (wi, ww) = (m.k / m.j, -m.friction_slope(w, sign) / m.j);
        for p in 0..COUNT {
            dy[S_I + p] = ii * y[S_I + p] + iw * y[S_W + p] + f_i[p];
            dy[S_W + p] = wi * y[S_I + p] + ww * y[S_W + p] + f_w[p];
        }
        dy
    }
}

impl Hybrid<N> for Varied {
    type Sliding = VariedSliding;

    fn motor(&self) -> &Motor {
        &self.0
    }

    fn sliding(&self, voltage: f64, sign: f64) -> VariedSliding {
        VariedSliding { system: *self, voltage, sign }
    }

    fn stand(&self, voltage: f64, y: &[f64; N], time: f64) -> [f64; N] {
        let Motor { l, r, .. } = self.0;
        let (end, decay) = (voltage / r, (-r / l * time).exp());
        let gap = y[CURRENT] - end;
        let mut after = [0.0; N];
        after[CURRENT] = end + gap * decay;
        for p in 0..COUNT {
            after[S_I + p] = decay * y[S_I + p];
        }
        after[S_I + index::L] += gap * decay * r * time / (l * l);
        after[S_I + index::R] += (decay - 1.0) * end / r - gap * decay * time / l;
        after
    }

    fn switch(&self, y: &mut [f64; N], before: f64, after: f64) {
        for s in &mut y[S_W..] {
            *s *= after / before;
        }
    }
}
