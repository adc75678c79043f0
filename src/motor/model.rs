//! The white-box DC motor of the paper's section 3.1, Eq. 12 to 16.
//!
//!   U = R i + L di/dt + K w            (Eq. 12, 13)
//!   K i = J dw/dt + T_f(w)             (Eq. 15; scenario 2, Eq. 16, has T_v2 = T_v3 = 0)
//!
//! Sliding friction (Eq. 1), s = sign(w):
//!
//!   T_f = s [T_c + (T_s - T_c) exp(-|w / w_s|)] + T_v1 w + T_v2 s w^2 + T_v3 w^3
//!
//! At w = 0 the law is set-valued, T_f in [-T_s, T_s]: the motor stands while |K i| <= T_s.

/// How many parameters the motor has.
pub const COUNT: usize = 10;

/// Positions in parameter arrays, in the order of the paper's Tables III and IV.
pub mod index {
    pub const J: usize = 0;
    pub const K: usize = 1;
    pub const L: usize = 2;
    pub const R: usize = 3;
    pub const T_S: usize = 4;
    pub const T_C: usize = 5;
    pub const T_V1: usize = 6;
    pub const T_V2: usize = 7;
    pub const T_V3: usize = 8;
    pub const OMEGA_S: usize = 9;
}

/// Names as used in scenario files, on the command line and in JSON.
pub const NAMES: [&str; COUNT] =
    ["J", "K", "L", "R", "T_s", "T_c", "T_v1", "T_v2", "T_v3", "omega_s"];

pub const UNITS: [&str; COUNT] = [
    "kg.m2",
    "N.m/A",
    "H",
    "ohm",
    "N.m",
    "N.m",
    "N.m.s/rad",
    "N.m.s2/rad2",
    "N.m.s3/rad3",
    "rad/s",
];

/// The position of a parameter by name.
pub fn position(name: &str) -> Option<usize> {
    NAMES.iter().position(|n| *n == name)
}

/// The ten parameters, SI units (see [`UNITS`]). Immutable once built.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motor {
    /// Inertia, kg.m^2
    pub j: f64,
    /// Torque and back-EMF constant, N.m/A = V.s/rad
    pub k: f64,
    /// Inductance, H
    pub l: f64,
    /// Resistance, ohm
    pub r: f64,
    /// Static friction (breakaway), N.m
    pub t_s: f64,
    /// Coulomb friction, N.m
    pub t_c: f64,
    /// Linear, quadratic, cubic viscous friction
    pub t_v1: f64,
    pub t_v2: f64,
    pub t_v3: f64,
    /// Stribeck velocity, rad/s
    pub omega_s: f64,
}

impl Motor {
    pub fn from_array(v: &[f64; COUNT]) -> Self {
        let [j, k, l, r, t_s, t_c, t_v1, t_v2, t_v3, omega_s] = *v;
        Self { j, k, l, r, t_s, t_c, t_v1, t_v2, t_v3, omega_s }
    }

    pub fn to_array(&self) -> [f64; COUNT] {
        [
            self.j,
            self.k,
            self.l,
            self.r,
            self.t_s,
            self.t_c,
            self.t_v1,
            self.t_v2,
            self.t_v3,
            self.omega_s,
        ]
    }

    /// di/dt by Eq. 12 and 13, A/s.
    #[inline]
    pub fn current_rate(&self, voltage: f64, current: f64, omega: f64) -> f64 {
        (voltage - self.r * current - self.k * omega) / self.l
    }

    /// dw/dt by Eq. 15 while sliding in direction `sign` (+1 or -1), rad/s^2.
    #[inline]
    pub fn acceleration(&self, current: f64, omega: f64, sign: f64) -> f64 {
        (self.k * current - self.sliding_friction(omega, sign)) / self.j
    }

    /// Eq. 1 for one direction of sliding; smooth in omega, also a little beyond standstill,
    /// so that an integration step may look past the reversal it is about to find.
    #[inline]
    pub fn sliding_friction(&self, omega: f64, sign: f64) -> f64 {
        let speed = sign * omega;
        let dry = self.t_c + (self.t_s - self.t_c) * self.stribeck(speed);
        sign * (dry + speed * (self.t_v1 + speed * (self.t_v2 + speed * self.t_v3)))
    }

    /// dT_f/dw of the sliding law, N.m.s/rad.
    #[inline]
    pub fn friction_slope(&self, omega: f64, sign: f64) -> f64 {
        let speed = sign * omega;
        let viscous = self.t_v1 + speed * (2.0 * self.t_v2 + 3.0 * speed * self.t_v3);
        viscous - (self.t_s - self.t_c) * self.stribeck(speed) / self.omega_s
    }

    /// exp(-|w / w_s|) for speed = |w|; see [`stribeck`].
    #[inline]
    pub fn stribeck(&self, speed: f64) -> f64 {
        stribeck(-speed / self.omega_s)
    }

    /// Current after standing for `time` seconds at constant voltage (w = 0), A:
    /// i = U/R + (i_0 - U/R) exp(-R t / L).
    pub fn standing_current(&self, voltage: f64, start: f64, time: f64) -> f64 {
        let end = voltage / self.r;
        end + (start - end) * (-self.r / self.l * time).exp()
    }

    /// When, after standing from `start` amperes at constant voltage, |K i| reaches T_s; s.
    /// `None`: never. The direction is the sign of the voltage.
    pub fn breakaway_time(&self, voltage: f64, start: f64) -> Option<f64> {
        let end = voltage / self.r;
        let limit = voltage.signum() * self.t_s / self.k;
        if self.k * end.abs() <= self.t_s {
            return None;
        }
        let time = self.l / self.r * ((end - start) / (end - limit)).ln();
        Some(time.max(0.0))
    }
}

/// exp(x), capped where a trial step overshoots a reversal by far, and left out where it vanishes
/// beside the dry friction it is added to (below 4e-18).
#[inline(always)]
pub fn stribeck(x: f64) -> f64 {
    const HIGHEST: f64 = 30.0;
    const LOWEST: f64 = -40.0;
    if x < LOWEST { 0.0 } else { x.min(HIGHEST).exp() }
}
