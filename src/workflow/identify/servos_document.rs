//! `identify --json` of position servos.

use std::iter::zip;

use serde::Serialize;

use super::IdentifiedServos;
use super::servos::Told;
use crate::diagnosis::{By, TimeOffset};
use crate::identification::levenberg_marquardt::Stop;
use crate::recording::Provenance;
use crate::servo::{Estimate, PositionGap, Settings};
use crate::signals::Conditioning;

/// Document of the schema `armtwin.identification/1`; its gaps are of positions, not of torque.
#[derive(Serialize)]
pub struct ServosDocument<'a> {
    schema: &'static str,
    version: &'static str,
    by: By,
    recordings: Vec<&'a Provenance>,
    checks: Vec<&'a Provenance>,
    twin: &'a str,
    servo: Option<&'a crate::robot::Servo>,
    terms: &'a [String],
    settings: Settings,
    conditioning: &'a Conditioning,
    methods: [MethodPart<'a>; 1],
}

#[derive(Serialize)]
struct MethodPart<'a> {
    method: &'static str,
    joints: Vec<Joint<'a>>,
    /// Values of the whole arm.
    arm: Vec<&'a Estimate>,
    /// Position errors, recording by recording.
    fit: Gaps<'a>,
    check: Gaps<'a>,
}

#[derive(Serialize)]
struct Gaps<'a> {
    before: Vec<&'a PositionGap>,
    after: Vec<&'a PositionGap>,
    /// Against the first recording that is fitted.
    time_offset: Vec<Option<TimeOffset>>,
    /// Step of the simulation, s.
    step_s: Vec<f64>,
}

impl<'a> Gaps<'a> {
    fn new(gaps: impl Iterator<Item = (&'a PositionGap, &'a PositionGap)>, told: &[Told]) -> Self {
        let (before, after) = gaps.unzip();
        let time_offset = told.iter().map(|t| t.time_offset).collect();
        Self { before, after, time_offset, step_s: told.iter().map(|t| t.track.step_s()).collect() }
    }
}

#[derive(Serialize)]
struct Joint<'a> {
    joint: usize,
    samples: usize,
    cost: f64,
    evaluations: usize,
    seconds: f64,
    stopped: Stop,
    fit: Option<Share>,
    check: Option<Share>,
    parameters: Vec<&'a Estimate>,
}

/// Errors of a joint over several recordings, each counting alike.
#[derive(Serialize)]
struct Share {
    r2: f64,
    mse_rad2: f64,
    mean_abs_rad: f64,
}

impl Share {
    fn of<'g>(j: usize, gaps: impl Iterator<Item = &'g PositionGap>) -> Option<Self> {
        let all: Vec<_> = gaps.map(|g| g.joints[j]).collect();
        let n = all.len() as f64;
        (!all.is_empty()).then(|| Self {
            r2: all.iter().map(|g| g.r2).sum::<f64>() / n,
            mse_rad2: all.iter().map(|g| g.rms_rad.powi(2)).sum::<f64>() / n,
            mean_abs_rad: all.iter().map(|g| g.mean_abs_rad).sum::<f64>() / n,
        })
    }
}

impl IdentifiedServos {
    /// What `identify --json` writes.
    pub fn document(&self) -> ServosDocument<'_> {
        fn sources(told: &[Told]) -> Vec<&Provenance> {
            told.iter().map(|t| &t.provenance).collect()
        }
        let dof = self.twin.robot.dof();
        ServosDocument {
            schema: "armtwin.identification/1",
            version: env!("CARGO_PKG_VERSION"),
            by: By::Simulation,
            recordings: sources(&self.fit),
            checks: sources(&self.check),
            twin: &self.twin.source,
            servo: self.twin.drive.servo.as_ref(),
            terms: &self.terms,
            settings: self.settings,
            conditioning: &self.conditioning,
            methods: [MethodPart {
                method: "simulation",
                joints: (0..dof).map(|j| self.joint(j)).collect(),
                arm: self.fitted.estimates.iter().filter(|e| e.joint.is_none()).collect(),
                fit: Gaps::new(zip(&self.fitted.before, &self.fitted.after), &self.fit),
                check: Gaps::new(
                    self.checked.iter().map(|[before, after]| (before, after)),
                    &self.check,
                ),
            }],
        }
    }

    fn joint(&self, j: usize) -> Joint<'_> {
        let fitted = &self.fitted;
        let own = |e: &&Estimate| e.joint == Some(j + 1);
        Joint {
            joint: j + 1,
            samples: fitted.samples / self.twin.robot.dof(),
            cost: fitted.cost,
            evaluations: fitted.evaluations,
            seconds: self.seconds,
            stopped: fitted.stop,
            fit: Share::of(j, fitted.after.iter()),
            check: Share::of(j, self.checked.iter().map(|[_, after]| after)),
            parameters: fitted.estimates.iter().filter(own).collect(),
        }
    }
}
