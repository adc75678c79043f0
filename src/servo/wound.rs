//! Joints whose link hangs on the motor by a spring, or half a gap behind it: q_link = q_motor - w.
//!
//! In the coordinates (q_motor, w), S the columns of the joints that give way,
//!
//! ```text
//! [M + A   -M S ] d [qd_motor]   [tau - bias  ]
//! [-S'M   S'M S ] dt[   wd   ] = [S'bias - T  ]
//! ```
//!
//! The torque T that a transmission carries is taken at the middle of the step ahead, w + h wd/2: stable however
//! stiff it is against the step. Teeth push and do not pull; whether they touch is found by trying.

use nalgebra::{DMatrix, DVector};

use super::ServoError;
use crate::effects::{Mechanism, Transmission};

/// Tries for which teeth touch, at most: a step that does not settle keeps the last of them.
pub const TRIES: usize = 4;

/// A joint that gives way.
#[derive(Debug, Clone)]
pub struct Wound {
    /// From 0.
    pub joint: usize,
    law: Transmission,
    /// w, rad.
    pub angle: f64,
    /// wd, rad/s.
    pub rate: f64,
    /// State of the hysteresis, -1 to 1.
    bent: f64,
    /// The side on which teeth touch: -1, 1, or 0 for none.
    side: f64,
}

impl Wound {
    /// Those of a mechanism.
    ///
    /// # Errors
    /// Names a joint without a rotor: a motor without inertia cannot be moved against a spring.
    pub fn all(mechanism: &Mechanism) -> Result<Vec<Self>, ServoError> {
        let laws = mechanism.transmission.iter().enumerate();
        let laws = laws.filter_map(|(joint, law)| Some((joint, (*law)?)));
        let of = |(joint, law): (usize, Transmission)| {
            let sound = mechanism.armature[joint] > 0.0 && law.stiffness > 0.0;
            let still = Self { joint, law, angle: 0.0, rate: 0.0, bent: 0.0, side: 0.0 };
            if sound { Ok(still) } else { Err(ServoError::Elastic { joint: joint + 1 }) }
        };
        laws.map(of).collect()
    }

    /// At rest under the torque that the link weighs, N.m.
    pub fn hang(&mut self, torque: f64) {
        self.angle = self.law.wind_up(torque);
        (self.rate, self.bent) = (0.0, 0.0);
        self.side = self.law.side(self.angle);
    }

    /// What the transmission adds to the equation of its wind-up over a step of `h` s that changes velocities for `kick` s: to the
    /// diagonal, and to the right-hand side.
    pub fn carries(&self, [kick, h]: [f64; 2]) -> [f64; 2] {
        let (stiffness, damping) = match self.side {
            0.0 => (0.0, 0.0),
            _ => (self.law.stiffness_at(self.angle), self.law.damping),
        };
        let beyond = self.angle - 0.5 * self.side * self.law.gap;
        let torque = stiffness * beyond + self.law.hysteresis * self.bent;
        let stiffness = stiffness + self.law.bending();
        [kick * (0.5 * h * stiffness + damping), -kick * torque]
    }

    /// Where the teeth touch if the wind-up changes by `rate` (rad/s) over a step of `h` s; is that what was assumed?
    pub fn is_settled(&mut self, h: f64, rate: f64) -> bool {
        let middle = self.angle + 0.5 * h * rate;
        let mut side = self.law.side(middle);
        let beyond = middle - 0.5 * side * self.law.gap;
        // Damping would hold back teeth that part.
        let carried = self.law.stiffness * beyond + self.law.damping * rate;
        if self.law.gap > 0.0 && side == self.side && side * carried < 0.0 {
            side = 0.0;
        }
        std::mem::replace(&mut self.side, side) == side
    }

    pub fn advance(&mut self, h: f64, rate: f64) {
        self.rate = rate;
        self.angle += h * rate;
        self.bent = self.law.bent(self.bent, h * rate);
        self.side = self.law.side(self.angle);
    }
}

/// The mass matrix `m` of motors and wind-ups, kg.m2, from that of the links.
pub fn with_wind_ups(links: &DMatrix<f64>, wound: &[Wound], m: &mut DMatrix<f64>) {
    let dof = links.nrows();
    m.view_mut((0, 0), (dof, dof)).copy_from(links);
    for (i, a) in wound.iter().enumerate() {
        for j in 0..dof {
            m[(dof + i, j)] = -links[(a.joint, j)];
            m[(j, dof + i)] = -links[(j, a.joint)];
        }
        for (j, b) in wound.iter().enumerate() {
            m[(dof + i, dof + j)] = links[(a.joint, b.joint)];
        }
    }
}

/// Adds what the transmissions carry to the equations of a step ([`Wound::carries`]).
pub fn couple(wound: &[Wound], times: [f64; 2], m: &mut DMatrix<f64>, b: &mut DVector<f64>) {
    let first = m.nrows() - wound.len();
    for (i, wound) in (first..).zip(wound) {
        let [diagonal, right] = wound.carries(times);
        m[(i, i)] += diagonal;
        b[i] += right;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// However stiff the spring is: a link that is let go swings as far as it was wound up and no further, where the velocity of
    /// the first step changes for half of it, too.
    #[test]
    fn a_stiff_spring_throws_no_link_further_than_it_was() {
        let law = Transmission {
            stiffness: 1e9,
            hardening: 0.0,
            damping: 0.0,
            gap: 0.0,
            hysteresis: 0.0,
            hysteresis_width: 1e-3,
        };
        let wound = Wound { joint: 0, law, angle: 1e-3, rate: 0.0, bent: 0.0, side: 1.0 };
        let (h, inertia) = (4e-3, 0.1);
        for kick in [0.5 * h, h] {
            let [diagonal, right] = wound.carries([kick, h]);
            let after = wound.angle + h * right / (inertia + diagonal);
            assert!(after.abs() < 1.0001 * wound.angle, "{kick}: {after}");
        }
    }
}
