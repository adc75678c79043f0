//! The right-hand side of Eq. 12 to 15 for one voltage and one direction of sliding, prepared for
//! the many steps that are taken with it: no division, no sign to look at.

use super::dormand_prince::Field;
use super::model::{Motor, stribeck};

/// i' = drive - a i - b w,
/// w' = c i - (dry + w (v_1 + w (v_2 + w v_3))) - rise exp(-w / w_s), w_s with the sign of w.
pub struct Sliding {
    drive: f64,
    a: f64,
    b: f64,
    c: f64,
    dry: f64,
    v_1: f64,
    v_2: f64,
    v_3: f64,
    rise: f64,
    per_omega_s: f64,
}

impl Sliding {
    /// `sign` is +1 or -1.
    pub fn new(motor: &Motor, voltage: f64, sign: f64) -> Self {
        let Motor { j, k, l, r, t_s, t_c, t_v1, t_v2, t_v3, omega_s } = *motor;
        Self {
            drive: voltage / l,
            a: r / l,
            b: k / l,
            c: k / j,
            dry: sign * t_c / j,
            v_1: t_v1 / j,
            v_2: sign * t_v2 / j,
            v_3: t_v3 / j,
            rise: sign * (t_s - t_c) / j,
            per_omega_s: sign / omega_s,
        }
    }
}

impl Field<2> for Sliding {
    #[inline(always)]
    fn rate(&self, y: &[f64; 2]) -> [f64; 2] {
        let [i, w] = *y;
        let viscous = w * (self.v_1 + w * (self.v_2 + w * self.v_3));
        let stribeck = self.rise * stribeck(-w * self.per_omega_s);
        [self.drive - self.a * i - self.b * w, self.c * i - self.dry - stribeck - viscous]
    }
}
