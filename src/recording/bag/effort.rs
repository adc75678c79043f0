//! Current or torque? A slow arm carries its weight: effort in N.m follows gravity one to one, in
//! amperes by one over gear ratio times torque constant, some ten times less.

use nalgebra::{DMatrix, DVector};

use crate::recording::Recording;
use crate::recording::bag_map::{BagMap, Effort};
use crate::recording::check::split_index;
use crate::robot::{self, BUILT_IN, Chain, Robot, Workspace, gravity_torque};
use crate::series::JointSeries;

/// N.m per N.m: other links, payloads and what inertia adds leave room.
const TORQUE: std::ops::Range<f64> = 0.6..1.6;
/// A per N.m: 4 to 40 N.m/A.
const CURRENT: std::ops::Range<f64> = 0.025..0.25;
/// Gravity must explain this share of what friction leaves.
const FEWEST_EXPLAINED: f64 = 0.5;
/// Joints on which gravity varies less than this share of the largest say nothing.
const FEWEST_VARYING: f64 = 0.2;
/// N.m, standard deviation: less is no test.
const LEAST_GRAVITY: f64 = 2.0;
const MOST_SAMPLES: usize = 4000;

/// What effort is, and why.
pub struct Evidence {
    pub effort: Option<Effort>,
    /// One clause.
    pub why: String,
}

/// Holds `effort` at positions `q` (one column per joint) against the gravity of `robot`, or of
/// every built-in arm where the names are those of one and it is not said which.
pub fn by_gravity(q: &[Vec<f64>], effort: &[Vec<f64>], arms: &[Robot]) -> Evidence {
    let evidence = |effort, why| Evidence { effort, why };
    if arms.is_empty() {
        return evidence(None, "the arm is not known".into());
    }
    let slopes: Vec<(&Robot, Slopes)> = arms
        .iter()
        .filter(|arm| arm.dof() == q.len())
        .filter_map(|arm| Some((arm, slopes(arm, q, effort)?)))
        .collect();
    if slopes.is_empty() {
        return evidence(None, "gravity does not show in it".into());
    }
    let says = |kind: Effort| -> Vec<&(&Robot, Slopes)> {
        slopes.iter().filter(|(_, s)| s.kind() == Some(kind)).collect()
    };
    match (says(Effort::Torque).first(), says(Effort::Current).first()) {
        (Some(_), Some(_)) => {
            evidence(None, "it is torque for one arm and current for another".into())
        }
        (Some((arm, s)), None) => evidence(Some(Effort::Torque), s.in_words(&arm.name)),
        (None, Some((arm, s))) => evidence(Some(Effort::Current), s.in_words(&arm.name)),
        (None, None) => evidence(None, slopes[0].1.in_words(&slopes[0].0.name)),
    }
}

/// The arm named, with what was assumed about it, or all built-in ones.
pub fn arms(map: &BagMap, universal_robots: bool) -> Result<(Vec<Robot>, Vec<String>), String> {
    let chain = Chain { base: map.base.clone(), tip: map.tip.clone(), flange: None };
    match &map.robot {
        Some(name) => match robot::load(name, &chain) {
            Ok(loaded) => Ok((vec![loaded.robot], loaded.notes)),
            Err(error) => Err(error.to_string()),
        },
        None if universal_robots => Ok((BUILT_IN.iter().map(|t| t.robot()).collect(), Vec::new())),
        None => Ok((Vec::new(), Vec::new())),
    }
}

/// Joint (from 0) and units of effort per N.m of gravity.
struct Slopes(Vec<(usize, f64)>);

impl Slopes {
    fn kind(&self) -> Option<Effort> {
        let all = |range: &std::ops::Range<f64>| self.0.iter().all(|(_, s)| range.contains(s));
        match () {
            () if all(&TORQUE) => Some(Effort::Torque),
            () if all(&CURRENT) => Some(Effort::Current),
            () => None,
        }
    }

    fn in_words(&self, arm: &str) -> String {
        let each: Vec<_> =
            self.0.iter().map(|(j, s)| format!("{s:.2} at joint {}", j + 1)).collect();
        format!("per N.m of a {arm}'s gravity it has {}", each.join(", "))
    }
}

fn slopes(arm: &Robot, q: &[Vec<f64>], effort: &[Vec<f64>]) -> Option<Slopes> {
    let samples = q[0].len();
    if samples < 3 {
        return None;
    }
    let kept: Vec<usize> = (1..samples - 1).step_by(samples.div_ceil(MOST_SAMPLES)).collect();
    let mut gravity = vec![Vec::with_capacity(kept.len()); q.len()];
    let (mut workspace, mut torque) = (Workspace::new(arm), vec![0.0; q.len()]);
    for k in &kept {
        let pose: Vec<f64> = q.iter().map(|column| column[*k]).collect();
        gravity_torque(arm, &mut workspace, &pose, &mut torque);
        gravity.iter_mut().zip(&torque).for_each(|(column, g)| column.push(*g));
    }
    let spread: Vec<f64> = gravity.iter().map(|g| deviation(g)).collect();
    let largest = spread.iter().fold(LEAST_GRAVITY, |a, b| a.max(*b));
    let heavy = (0..q.len()).filter(|j| spread[*j] >= FEWEST_VARYING * largest);
    let all: Option<Vec<_>> = heavy
        .map(|j| {
            let moving = |k: &usize| q[j][k + 1] - q[j][k - 1];
            let speeds: Vec<f64> = kept.iter().map(moving).collect();
            let measured: Vec<f64> = kept.iter().map(|k| effort[j][*k]).collect();
            Some((j, slope(&gravity[j], &speeds, &measured)?))
        })
        .collect();
    all.filter(|all| !all.is_empty()).map(Slopes)
}

/// Fits s of measured = s gravity + offset + dry and viscous friction; `None` where gravity explains little.
fn slope(gravity: &[f64], speed: &[f64], measured: &[f64]) -> Option<f64> {
    let top = speed.iter().fold(f64::MIN_POSITIVE, |m, v| m.max(v.abs()));
    let direction = |v: f64| if v.abs() < 1e-3 * top { 0.0 } else { v.signum() };
    let all = DMatrix::from_fn(measured.len(), 4, |k, c| match c {
        0 => 1.0,
        1 => direction(speed[k]),
        2 => speed[k] / top,
        _ => gravity[k],
    });
    let y = DVector::from_column_slice(measured);
    let fit = |columns: usize| -> Option<(DVector<f64>, f64)> {
        let x = all.columns(0, columns).into_owned();
        let found = x.clone().svd(true, true).solve(&y, 1e-9).ok()?;
        let left = (&y - &x * &found).norm_squared();
        Some((found, left))
    };
    let ((_, without), (found, with)) = (fit(3)?, fit(4)?);
    (with <= (1.0 - FEWEST_EXPLAINED) * without).then_some(found[3])
}

fn deviation(values: &[f64]) -> f64 {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt()
}

/// Names `effort_*` of a recording by the gravity of `arm`, where nothing else told what it is.
pub fn settle(recording: &mut Recording, arm: &Robot) {
    let (Some(q), Some(effort)) = (recording.joints("actual_q"), recording.joints("effort")) else {
        return;
    };
    if ["actual_current", "joint_torque"].iter().any(|stem| recording.joint_count(stem) > 0) {
        return;
    }
    let columns =
        |s: &JointSeries| (0..s.joints()).map(|j| s.joint(j).to_vec()).collect::<Vec<_>>();
    let found = by_gravity(&columns(&q), &columns(&effort), std::slice::from_ref(arm));
    let notes = &mut recording.provenance.notes;
    let Some(kind) = found.effort else {
        notes.push(format!("effort: gravity does not tell current from torque ({})", found.why));
        return;
    };
    notes.retain(|note| !note.starts_with("effort may be current or torque"));
    notes.push(format!("effort taken as {}, by gravity: {}", kind.words(), found.why));
    for channel in &mut recording.channels {
        if let Some(("effort", j)) = split_index(&channel.name) {
            channel.name = format!("{}_{j}", kind.stem());
        }
    }
}
