//! What a motion must stay within, and by how much it does.

use super::capsules::{Capsules, Closest, Surroundings};
use crate::effects::Motion;
use crate::motion::{Envelope, Sampled};
use crate::robot::Robot;
use crate::series::JointSeries;
use crate::twin::Twin;

pub struct Limits<'a> {
    pub robot: &'a Robot,
    /// Angle, speed and acceleration.
    pub envelope: Envelope,
    /// N.m; infinite where nobody said.
    pub torque: Vec<f64>,
    pub capsules: Capsules,
    pub around: &'a Surroundings,
    /// Smallest distance of surfaces, m.
    pub clearance_m: f64,
}

/// How far a motion goes, at the joint that comes closest to its limit.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Reached {
    /// From 1 at the base.
    pub joint: usize,
    pub value: f64,
    pub limit: f64,
}

/// What a motion makes of its limits.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Held {
    /// Angle from the centre of the allowed angles, rad.
    pub angle_rad: Reached,
    pub speed_rad_s: Reached,
    /// Absent along a simulated motion, where dry friction at a reversal jerks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub acceleration_rad_s2: Option<Reached>,
    /// Absent where no limit is known.
    pub torque_nm: Option<Reached>,
    /// Absent where nothing can touch.
    pub closest: Option<Closest>,
}

impl Reached {
    pub fn share(&self) -> f64 {
        self.value / self.limit
    }

    /// Value of the joint with the largest share of its limit; `None` without a joint that has a limit.
    fn worst(series: &JointSeries, from: &[f64], limits: &[f64]) -> Option<Self> {
        let of = |j: usize| {
            let value = series.joint(j).iter().fold(0.0_f64, |m, x| m.max((x - from[j]).abs()));
            Self { joint: j + 1, value, limit: limits[j] }
        };
        let all = (0..series.joints()).map(of).filter(|r| r.limit.is_finite());
        all.max_by(|a, b| a.share().total_cmp(&b.share()))
    }
}

impl<'a> Limits<'a> {
    /// Torque limits are the smaller of the arm's and the drive's.
    pub fn new(
        twin: &'a Twin,
        envelope: Envelope,
        capsules: Capsules,
        around: &'a Surroundings,
        clearance_m: f64,
    ) -> Self {
        let effort = twin.robot.bodies.iter().map(|b| b.joint.limits.effort).enumerate();
        let torque = effort.map(|(j, effort)| twin.drive.largest_torque(j).min(effort)).collect();
        Self { robot: &twin.robot, envelope, torque, capsules, around, clearance_m }
    }

    /// How far a motion with the torque `tau` goes beyond `share` of the limits of torque and
    /// `spare` m more than the clearance; 0 where it does not.
    pub fn exceeded(&self, q: &JointSeries, tau: &JointSeries, share: f64, spare: f64) -> f64 {
        let zero = vec![0.0; tau.joints()];
        let torque = Reached::worst(tau, &zero, &self.torque).map_or(0.0, |r| r.share());
        let distance = self.nearest(q).map_or(f64::INFINITY, |(d, _)| d);
        let too_near = (self.clearance_m + spare - distance).max(0.0) / self.capsules.radius;
        (torque - share).max(0.0) + too_near
    }

    /// How the limits are held along a commanded motion.
    pub fn held(&self, motion: &Sampled, tau: &JointSeries) -> Held {
        let zero = vec![0.0; tau.joints()];
        let acceleration = Reached::worst(&motion.qdd, &zero, &self.envelope.acceleration);
        Held { acceleration_rad_s2: acceleration, ..self.held_by(&motion.q, &motion.qd, tau) }
    }

    /// How the limits are held along a simulated motion.
    pub fn held_by(&self, q: &JointSeries, qd: &JointSeries, tau: &JointSeries) -> Held {
        let Envelope { centre, range, velocity, .. } = &self.envelope;
        let zero = vec![0.0; tau.joints()];
        let nothing = || Reached { joint: 1, value: 0.0, limit: 1.0 };
        let closest = self
            .nearest(q)
            .map(|(distance_m, what)| Closest { distance_m, between: self.capsules.named(what) });
        Held {
            angle_rad: Reached::worst(q, centre, range).unwrap_or_else(nothing),
            speed_rad_s: Reached::worst(qd, &zero, velocity).unwrap_or_else(nothing),
            acceleration_rad_s2: None,
            torque_nm: Reached::worst(tau, &zero, &self.torque),
            closest,
        }
    }

    fn nearest(&self, q: &JointSeries) -> Option<(f64, super::capsules::Between)> {
        let mut pose = vec![0.0; q.joints()];
        let at = |k: usize| {
            q.sample_into(k, &mut pose);
            self.capsules.nearest(self.robot, &pose, self.around)
        };
        (0..q.samples()).filter_map(at).min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

impl Held {
    /// The first limit that is passed, in words; `None` where all are held.
    pub fn passed(&self, clearance_m: f64) -> Option<String> {
        let over = |what: &str, unit: &str, reached: Option<&Reached>| {
            let Reached { joint, value, limit } = reached.filter(|r| r.value > r.limit)?;
            Some(format!("joint {joint} reaches {value:.3} {unit}, its {what} is {limit:.3}"))
        };
        let near = self.closest.as_ref().filter(|c| c.distance_m < clearance_m).map(|c| {
            let ([a, b], mm) = (&c.between, 1e3 * c.distance_m);
            format!(
                "{a} and {b} come within {mm:.0} mm, {:.0} mm are to be kept",
                1e3 * clearance_m
            )
        });
        over("range from the middle", "rad", Some(&self.angle_rad))
            .or_else(|| over("speed limit", "rad/s", Some(&self.speed_rad_s)))
            .or_else(|| over("acceleration limit", "rad/s2", self.acceleration_rad_s2.as_ref()))
            .or_else(|| over("torque limit", "N.m", self.torque_nm.as_ref()))
            .or(near)
    }
}
/// What the drive of `twin` must supply along a motion that is sampled every `dt` seconds, N.m.
pub fn torque_along(twin: &Twin, motion: &Sampled, dt: f64) -> JointSeries {
    let Sampled { q, qd, qdd } = motion;
    twin.torque(&Motion::new(&twin.robot, dt, q, qd, qdd))
}
