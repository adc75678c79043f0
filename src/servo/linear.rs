//! What a simulated motion leaves of recorded positions, for a diagnosis: the motion, what torque shows of itself
//! beside it, and the torque the twin gives along it.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::replay::lead;
use super::{Plant, ServoError, Track};
use crate::effects::Motion;
use crate::robot::{Robot, Told};
use crate::series::JointSeries;
use crate::signals::{Giving, Response, Samples, central_difference};
use crate::twin::Twin;

/// A twin's motion along a track, from the measured state at the begin of every stretch.
pub struct Along {
    pub q: JointSeries,
    pub qd: JointSeries,
    pub qdd: JointSeries,
    /// What the servos that the twin assumes make of it.
    pub told: Told,
    /// What torque shows of itself beside it.
    pub response: Response,
}

/// A stretch of it, joint by joint.
struct Moved {
    q: Vec<Vec<f64>>,
    qd: Vec<Vec<f64>>,
    giving: Vec<Giving>,
}

impl Along {
    /// # Errors
    /// If the twin has no servos, an effect this simulation does not have, or runs away.
    pub fn new(
        twin: &Twin,
        track: &Track,
        stretches: Vec<Range<usize>>,
    ) -> Result<Self, ServoError> {
        let assumed = twin.drive.servo.as_ref().ok_or(ServoError::NoServo)?;
        let of = |stretch: &Range<usize>| moved(twin, track, stretch);
        let all: Vec<Moved> = stretches.par_iter().map(of).collect::<Result<_, ServoError>>()?;
        let (mut q, mut qd) = (track.q.clone(), JointSeries::zeros(track.joints(), track.len()));
        let mut qdd = qd.clone();
        let mut joints: Vec<Giving> = assumed.gain.iter().map(|k| still(*k, track.len())).collect();
        for (stretch, part) in stretches.iter().zip(all) {
            for (j, joint) in joints.iter_mut().enumerate() {
                let at = stretch.clone();
                q.joint_mut(j)[at.clone()].copy_from_slice(&part.q[j]);
                qd.joint_mut(j)[at.clone()].copy_from_slice(&part.qd[j]);
                let rate = central_difference(&part.qd[j], track.dt);
                qdd.joint_mut(j)[at.clone()].copy_from_slice(&rate);
                put(joint, at, &part.giving[j]);
            }
        }
        for (j, joint) in joints.iter_mut().enumerate() {
            let both = track.q.joint(j).iter().zip(q.joint(j));
            joint.error = both.map(|(recorded, simulated)| recorded - simulated).collect();
        }
        let told = assumed.at(&track.told, &q);
        Ok(Self { q, qd, qdd, told, response: Response::new(track.dt, stretches, joints) })
    }

    /// The motion as felt by `robot`.
    pub fn motion<'a>(&'a self, robot: &'a Robot, track: &'a Track) -> Motion<'a> {
        Motion {
            start: track.start,
            told: Some(&self.told),
            temperature: track.temperature.as_ref(),
            ..Motion::new(robot, track.dt, &self.q, &self.qd, &self.qdd)
        }
    }
}

/// `recorded`, whose track is given, as seen from the motion of `twin`, led along its command over stretches of `horizon_s` that
/// begin in measured states: `torque` is the twin's along that motion (with all values it has), and
/// `response` holds what the recorded position shows beyond it.
///
/// # Errors
/// If the twin has no servos, an effect this simulation does not have, or runs away.
pub fn linearised(
    twin: &Twin,
    recorded: &Samples,
    track: &Track,
    horizon_s: f64,
) -> Result<Samples, ServoError> {
    let along = Along::new(twin, track, track.stretches(horizon_s))?;
    let mut usable = vec![false; track.len()];
    along.response.stretches.iter().for_each(|s| usable[s.clone()].fill(true));
    let torque = twin.torque(&along.motion(&twin.robot, track));
    let Along { q, qd, qdd, told, response } = along;
    Ok(Samples {
        q,
        qd,
        qdd,
        torque,
        told: Some(told),
        response: Some(Arc::new(response)),
        sensed: None,
        smoothed_further: None,
        usable,
        ..recorded.clone()
    })
}

fn still(scale: f64, samples: usize) -> Giving {
    let zeros = || vec![0.0; samples];
    Giving {
        inertia: vec![1.0; samples],
        damping: zeros(),
        slope: zeros(),
        slides: vec![false; samples],
        error: zeros(),
        scale,
    }
}

fn put(all: &mut Giving, at: Range<usize>, part: &Giving) {
    all.inertia[at.clone()].copy_from_slice(&part.inertia);
    all.damping[at.clone()].copy_from_slice(&part.damping);
    all.slope[at.clone()].copy_from_slice(&part.slope);
    all.slides[at].copy_from_slice(&part.slides);
}

fn moved(twin: &Twin, track: &Track, stretch: &Range<usize>) -> Result<Moved, ServoError> {
    let dof = track.joints();
    let none = || vec![Vec::with_capacity(stretch.len()); dof];
    let mut all = Moved { q: none(), qd: none(), giving: vec![Giving::default(); dof] };
    let mut plant = Plant::new(twin, track.start)?;
    lead(&mut plant, track, stretch, |plant| {
        for j in 0..dof {
            let now = plant.yields(j);
            all.q[j].push(plant.shown(j));
            all.qd[j].push(plant.speed(j));
            let giving = &mut all.giving[j];
            giving.inertia.push(now.inertia);
            giving.damping.push(now.damping);
            giving.slope.push(now.slope);
            giving.slides.push(now.slides);
        }
    })?;
    Ok(all)
}
