//! A recording as it is searched: the recorded torque, where it counts, and how noisy it is.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, OnceLock};

use super::DiagnosisError;
use super::floor::Floor;
use super::kept::Kept;
use super::smoothing::{missing, sureness};
use crate::effects::{Motion, Rigid};
use crate::regression::Blocks;
use crate::robot::Robot;
use crate::series::JointSeries;
use crate::signals::{ALIKE, Decimator, Samples, cycle};
use crate::statistics::{design_effect, pairs};
use crate::twin::Twin;

/// Fewer rows of a joint say nothing about it: two seconds of sliding at the 20 Hz that a low-pass
/// of 8 Hz leaves.
pub const FEWEST_ROWS: usize = 40;

pub struct Observed<'a> {
    /// Which of the recordings: 0 is the one to fit, 1 the one to check.
    pub index: usize,
    pub twin: &'a Twin,
    pub samples: &'a Samples,
    /// Samples used, joint by joint: sliding, usable, decimated; none where there are too few.
    pub rows: Vec<Vec<usize>>,
    /// Samples after which the motion comes again.
    pub cycle: Option<usize>,
    /// Rows that are a cycle apart, by their places, joint by joint.
    pub again: Vec<Vec<[usize; 2]>>,
    /// Standard deviation of the noise of `torque`, joint by joint, N.m.
    pub sigma: Vec<f64>,
    /// That over the standard deviation of each row, at most 1 (`smoothing`): rows of torque and of columns are
    /// scaled by it.
    pub sureness: Blocks,
    /// Recorded torque at the rows, N.m, filtered and scaled as all columns are.
    pub torque: Blocks,
    /// What the twin knows, over all samples, before sensors, N.m.
    pub known: JointSeries,
    /// Columns that a search comes back to, at the rows and over all samples.
    pub kept: Kept<Vec<Blocks>>,
    pub series: Kept<Series>,
    filter: Option<Decimator>,
    /// The arm with what it was last said to carry, and its torque along this motion.
    rigid: Mutex<VecDeque<(Robot, Arc<Rigid>)>>,
    rigid_rows: OnceLock<Blocks>,
    known_rows: OnceLock<Blocks>,
}

/// Columns over all samples, joint by joint.
pub type Series = Vec<Vec<Vec<f64>>>;

/// Loads whose torque is kept.
const LOADS: usize = 8;

impl<'a> Observed<'a> {
    /// # Errors
    /// If no joint slides long enough.
    pub fn new(
        index: usize,
        twin: &'a Twin,
        samples: &'a Samples,
        floor: &[Floor],
    ) -> Result<Self, DiagnosisError> {
        let filter = samples.torque_filter()?.as_ref().map(Decimator::new);
        let sigma: Vec<f64> = floor.iter().map(|f| f.noise_nm).collect();
        let rows: Vec<Vec<usize>> = (0..samples.joints())
            .map(|j| samples.rows(j).samples)
            .map(|rows| if rows.len() < FEWEST_ROWS { Vec::new() } else { rows })
            .collect();
        if rows.iter().all(Vec::is_empty) {
            let problem = format!(
                "no joint has {FEWEST_ROWS} samples of sliding motion (|qd| above {} rad/s): \
                 record a motion of the joints in question",
                samples.conditioning.standstill_rad_s
            );
            return Err(DiagnosisError::Recording(problem));
        }
        let cycle = cycle(samples, ALIKE);
        let every = samples.decimation();
        let again = |rows| cycle.map_or_else(Vec::new, |lag| pairs(rows, lag, every));
        let again = rows.iter().map(|rows: &Vec<usize>| again(rows)).collect();
        let known = twin.torque(&twin.motion(samples));
        let missing = missing(samples, twin, &known)?;
        let sure = |j: usize| match &missing {
            Some(all) => sureness(all.joint(j), &rows[j], samples.quarter_period(), sigma[j]),
            None => vec![1.0; rows[j].len()],
        };
        let sureness = Blocks((0..rows.len()).map(sure).collect());
        let torque = Blocks::default();
        let (kept, series, rigid) = (Kept::default(), Kept::default(), Mutex::default());
        let (rigid_rows, known_rows) = (OnceLock::new(), OnceLock::new());
        let mut observed = Self {
            index,
            twin,
            samples,
            rows,
            cycle,
            again,
            sigma,
            sureness,
            torque,
            known,
            kept,
            series,
            filter,
            rigid,
            rigid_rows,
            known_rows,
        };
        let torque = |j| {
            let mut torque = observed.block(j, samples.torque.joint(j));
            if let Some(response) = &samples.response {
                let seen = response.seen(j);
                torque.iter_mut().zip(&observed.rows[j]).for_each(|(t, &k)| *t += seen[k]);
            }
            torque
        };
        observed.torque = Blocks((0..samples.joints()).map(torque).collect());
        Ok(observed)
    }

    pub fn joints(&self) -> usize {
        self.samples.joints()
    }

    /// How many times over a joint's rows count that have these values: once where the motion does not come again.
    pub fn design_effect(&self, joint: usize, values: &[f64]) -> f64 {
        let cycles = self.cycle.map_or(1.0, |lag| self.samples.len() as f64 / lag as f64);
        design_effect(values, &self.again[joint], cycles)
    }

    /// The motion, as felt by `robot`.
    pub fn motion<'b>(&'b self, robot: &'b Robot) -> Motion<'b> {
        Motion { robot, ..self.twin.motion(self.samples) }
    }

    /// The rigid arm's torque along this motion, kept for the next candidate.
    pub fn rigid(&self, robot: &Robot) -> Arc<Rigid> {
        let Ok(mut all) = self.rigid.lock() else { return Arc::new(Rigid::new(self.joints())) };
        if let Some((_, known)) = all.iter().find(|(r, _)| r == robot) {
            return known.clone();
        }
        // Candidates change what links weigh, and gravity.
        let like = all.iter().find(|(r, _)| r.gravity == robot.gravity);
        let rigid = match like {
            Some((_, known)) => known.of_other_load(),
            None => Rigid::new(self.joints()),
        };
        let rigid = Arc::new(rigid);
        all.truncate(LOADS - 1);
        all.push_front((robot.clone(), rigid.clone()));
        rigid
    }

    /// Torque that the twin's rigid arm needs, at the rows, N.m.
    pub fn rigid_rows(&self) -> &Blocks {
        self.rigid_rows.get_or_init(|| {
            let laden = self.twin.laden();
            let rigid = self.rigid(&laden);
            let motion = Motion { rigid: Some(&rigid), ..self.motion(&laden) };
            let torque = motion.rigid_torque();
            Blocks((0..self.joints()).map(|j| self.block(j, torque.joint(j))).collect())
        })
    }

    /// Torque that the twin knows, at the rows, N.m.
    pub fn known_rows(&self) -> &Blocks {
        self.known_rows.get_or_init(|| {
            Blocks((0..self.joints()).map(|j| self.block(j, self.known.joint(j))).collect())
        })
    }

    /// A series over all samples of a joint -> its rows, filtered as the torque is, and scaled by how sure they are.
    pub fn block(&self, joint: usize, series: &[f64]) -> Vec<f64> {
        let mut rows = self.filtered(joint, series);
        rows.iter_mut().zip(self.sureness.joint(joint)).for_each(|(r, sure)| *r *= sure);
        rows
    }

    /// A series over all samples of a joint -> its rows, filtered as the torque is: by the low-pass, or by what
    /// position servos make of it.
    pub fn filtered(&self, joint: usize, series: &[f64]) -> Vec<f64> {
        let rows = &self.rows[joint];
        if rows.is_empty() {
            return Vec::new();
        }
        match (&self.samples.response, &self.filter) {
            (Some(response), _) => {
                let shown = response.to(joint, series);
                rows.iter().map(|&k| shown[k]).collect()
            }
            (None, Some(filter)) => filter.at(rows, series),
            (None, None) => rows.iter().map(|&k| series[k]).collect(),
        }
    }

    /// Rows as [`Self::block`] scales them -> in full.
    pub fn in_full(&self, joint: usize, rows: &[f64]) -> Vec<f64> {
        rows.iter().zip(self.sureness.joint(joint)).map(|(r, sure)| r / sure).collect()
    }

    /// Rows over all samples in full, zero elsewhere.
    pub fn over_time(&self, rows: &Blocks) -> JointSeries {
        let mut series = JointSeries::zeros(self.joints(), self.samples.len());
        for (j, places) in self.rows.iter().enumerate() {
            let all = series.joint_mut(j);
            places.iter().zip(self.in_full(j, rows.joint(j))).for_each(|(&k, v)| all[k] = v);
        }
        series
    }

    /// True at the rows, joint by joint.
    pub fn masks(&self) -> Vec<Vec<bool>> {
        let mask = |rows: &Vec<usize>| {
            let mut mask = vec![false; self.samples.len()];
            rows.iter().for_each(|&k| mask[k] = true);
            mask
        };
        self.rows.iter().map(mask).collect()
    }
}
