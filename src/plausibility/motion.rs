//! Motion and torque of a recording, thinned and smoothed as far as the weight of an arm needs.

use crate::recording::Recording;
use crate::recording::inspection::step;
use crate::robot::Drive;
use crate::series::JointSeries;
use crate::signals::Conditioning;

/// Instants that are looked at.
const INSTANTS: usize = 800;
/// Half width of differences and means, s: noise shrinks, motions do not.
const HALF_S: f64 = 0.04;
/// Instants whose neighbours are further away than this many half widths lie in a gap.
const GAP: f64 = 2.0;

/// Joint by joint at the instants, SI.
pub struct Motion {
    pub q: JointSeries,
    pub qd: JointSeries,
    pub qdd: JointSeries,
    /// Rows of the recording, and how many around each are averaged.
    rows: Vec<usize>,
    half: usize,
}

impl Motion {
    /// Does any joint move as fast as identification asks for?
    pub fn slides(&self) -> bool {
        let standstill = Conditioning::default().standstill_rad_s;
        (0..self.qd.joints()).any(|j| self.qd.joint(j).iter().any(|qd| qd.abs() > standstill))
    }

    /// From positions alone; `None` without, or from too few rows.
    pub fn new(recording: &Recording, time_scale: f64, dof: usize) -> Option<Self> {
        let q = recording.joints("actual_q").filter(|q| q.joints() == dof)?;
        let time = &recording.time;
        let step = step(time) * time_scale;
        let half = ((HALF_S / step).round() as usize).max(1);
        let n = time.len();
        if n < 4 * half + 20 {
            return None;
        }
        let every = (n - 2 * half).div_ceil(INSTANTS);
        let together = |k: &usize| {
            (time[k + half] - time[k - half]) * time_scale < 2.0 * GAP * half as f64 * step
        };
        let rows: Vec<usize> = (half..n - half).step_by(every).filter(together).collect();
        let each = |f: &dyn Fn(&[f64], usize) -> f64| {
            q.map_joints(|_, x| rows.iter().map(|k| f(x, *k)).collect())
        };
        let h = |k: usize| 0.5 * (time[k + half] - time[k - half]) * time_scale;
        let first = |x: &[f64], k: usize| (x[k + half] - x[k - half]) / (2.0 * h(k));
        let second = |x: &[f64], k: usize| (x[k + half] - 2.0 * x[k] + x[k - half]) / (h(k) * h(k));
        let (qd, qdd) = (each(&first), each(&second));
        let q = each(&|x, k| x[k]);
        Some(Self { q, qd, qdd, rows, half })
    }

    /// Means of another series of the recording around the same instants.
    pub fn means(&self, series: &JointSeries) -> JointSeries {
        let width = (2 * self.half + 1) as f64;
        let mean =
            |x: &[f64], k: usize| x[k - self.half..=k + self.half].iter().sum::<f64>() / width;
        series.map_joints(|_, x| self.rows.iter().map(|k| mean(x, *k)).collect())
    }
}

/// Torque of the drives, and the stem of the columns it is from.
pub struct Torque {
    pub stem: &'static str,
    pub values: JointSeries,
}

/// As commands take it: `joint_torque_*` where recorded, else current through the drive.
pub fn torque(recording: &Recording, drive: &Drive, dof: usize) -> Option<Torque> {
    let of = |stem| recording.joints(stem).filter(|s| s.joints() == dof);
    if let Some(values) = of("joint_torque") {
        return Some(Torque { stem: "joint_torque", values });
    }
    let current = of("actual_current")?;
    Some(Torque { stem: "actual_current", values: drive.torque_series(&current) })
}
