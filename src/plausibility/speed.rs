//! Is the recorded velocity what the recorded position changes by? Asked of sums over stretches of time,
//! so that noise, rounding, filters and delays of either do not matter.

use super::{Doubt, FACTOR, named, near};
use crate::recording::Recording;
use crate::recording::inspection::step;
use crate::series::JointSeries;

/// Length of a stretch: longer than filters and delays, shorter than motions.
const STRETCH_S: f64 = 0.25;
const MOST_STRETCHES: usize = 4000;
/// Fewer say nothing.
const FEWEST_STRETCHES: usize = 20;
/// Two columns agree from this correlation on, ...
const AGREES: f64 = 0.9;
/// ... and have nothing to do with each other below this.
const DIFFERS: f64 = 0.5;
/// rad (or degrees): a joint that moves less over the whole recording is not asked.
const TRAVEL: f64 = 0.05;

/// What a factor between velocity and differentiated position can mean.
const UNITS: [(f64, &str); 4] = [
    (
        57.295_779_513,
        "actual_qd is in degrees/s or actual_q in other units than it: scale = 0.0174532925",
    ),
    (0.017_453_292_5, "actual_q is in degrees: scale = 0.0174532925"),
    (1000.0, "actual_qd is in mrad/s: scale = 0.001"),
    (1e-3, "actual_q is in mrad, or time in milliseconds: scale = 0.001, time_scale = 0.001"),
];

/// Changes of position, and sums of velocity, over stretches, joint by joint.
struct Changes {
    position: Vec<Vec<f64>>,
    velocity: Vec<Vec<f64>>,
}

/// Slope and correlation of a joint's velocity over its position's change.
#[derive(Clone, Copy)]
struct Agreement {
    slope: f64,
    correlation: f64,
}

pub fn doubts(recording: &Recording, time_scale: f64) -> Vec<Doubt> {
    let Some(changes) = changes(recording, time_scale) else { return Vec::new() };
    let own: Vec<(usize, Agreement)> =
        (0..changes.position.len()).filter_map(|j| Some((j, changes.agreement(j, j)?))).collect();
    let common = common_factor(&own);
    let off = |a: &Agreement| {
        let slope = a.slope.abs();
        common.is_some_and(|common| near(slope, common)) || !(1.0 / FACTOR..FACTOR).contains(&slope)
    };
    let agrees = |a: &Agreement| a.correlation.abs() >= AGREES;
    let of = |test: &dyn Fn(&Agreement) -> bool| -> Vec<(usize, Agreement)> {
        own.iter().copied().filter(|(_, a)| test(a)).collect()
    };
    let scaled = of(&|a| agrees(a) && off(a));
    let flipped = of(&|a| agrees(a) && !off(a) && a.slope < 0.0);
    let foreign = of(&|a| a.correlation.abs() < DIFFERS);
    [factor(&scaled), sign(&flipped), changes.order(&foreign)].into_iter().flatten().collect()
}

/// The slope that all joints share, where velocity and position agree but for it.
pub fn common_slope(recording: &Recording, time_scale: f64) -> Option<f64> {
    let changes = changes(recording, time_scale)?;
    let own = (0..changes.position.len()).filter_map(|j| changes.agreement(j, j));
    let mut slopes: Vec<f64> =
        own.filter(|a| a.correlation >= AGREES).map(|a| a.slope.abs()).collect();
    median(&mut slopes)
}

fn median(slopes: &mut [f64]) -> Option<f64> {
    slopes.sort_unstable_by(f64::total_cmp);
    slopes.get(slopes.len() / 2).copied()
}

/// The factor by which the velocity of most joints is off, and of more than one: a gear or gripper of one joint has
/// no part in it.
fn common_factor(own: &[(usize, Agreement)]) -> Option<f64> {
    let told = own.iter().filter(|(_, a)| a.correlation.abs() >= AGREES);
    let mut slopes: Vec<f64> = told.map(|(_, a)| a.slope.abs()).collect();
    let common = median(&mut slopes).filter(|common| !near(*common, 1.0))?;
    let alike = slopes.iter().filter(|s| near(**s, common)).count();
    (alike > 1 && 2 * alike > slopes.len()).then_some(common)
}

fn joints(of: &[(usize, Agreement)]) -> String {
    named(&of.iter().map(|(j, _)| *j).collect::<Vec<_>>())
}

fn factor(scaled: &[(usize, Agreement)]) -> Option<Doubt> {
    let (_, first) = scaled.first()?;
    let slope = first.slope.abs();
    let meaning = UNITS.iter().find(|(unit, _)| near(slope, *unit));
    Some(Doubt {
        what: format!(
            "{}: actual_qd is {slope:.4} times what actual_q changes by per second",
            joints(scaled)
        ),
        remedy: match meaning {
            Some((_, meaning)) => format!("{meaning} in a column map (--columns)"),
            None => "correct the unit of one of them in a column map (--columns)".into(),
        },
    })
}

fn sign(flipped: &[(usize, Agreement)]) -> Option<Doubt> {
    (!flipped.is_empty()).then(|| Doubt {
        what: format!("{}: actual_qd goes the other way than actual_q", joints(flipped)),
        remedy: "turn the sign of one of them in a column map (scale = [1, -1, ...])".into(),
    })
}

impl Changes {
    fn agreement(&self, position: usize, velocity: usize) -> Option<Agreement> {
        let (x, y) = (&self.position[position], &self.velocity[velocity]);
        let n = x.len() as f64;
        let (mx, my) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
        let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
        for (x, y) in x.iter().zip(y) {
            xx += (x - mx) * (x - mx);
            yy += (y - my) * (y - my);
            xy += (x - mx) * (y - my);
        }
        let moves = xx > 0.0 && yy > 0.0 && x.iter().map(|x| x.abs()).sum::<f64>() > TRAVEL;
        moves.then(|| Agreement { slope: xy / xx, correlation: xy / (xx * yy).sqrt() })
    }

    /// Columns that belong to other joints, or to nothing.
    fn order(&self, foreign: &[(usize, Agreement)]) -> Option<Doubt> {
        let fits = |j: usize, k: usize| {
            self.agreement(j, k).is_some_and(|a| {
                a.correlation >= AGREES && (1.0 / FACTOR..FACTOR).contains(&a.slope)
            })
        };
        let others = 0..self.velocity.len();
        let told: Vec<(usize, usize)> = foreign
            .iter()
            .filter_map(|(j, _)| Some((*j, others.clone().find(|k| k != j && fits(*j, *k))?)))
            .collect();
        let columns = |told: &[(usize, usize)]| {
            let each: Vec<_> =
                told.iter().map(|(j, k)| format!("actual_qd_{k} goes with actual_q_{j}")).collect();
            each.join(", ")
        };
        let remedy = "name the columns joint by joint, base to wrist, in a column map (--columns)";
        match (told.is_empty(), foreign.is_empty()) {
            (false, _) => Some(Doubt {
                what: format!("the columns are in another order: {}", columns(&told)),
                remedy: remedy.into(),
            }),
            (true, false) => Some(Doubt {
                what: format!("{}: actual_qd is not what actual_q changes by", joints(foreign)),
                remedy: "correct its columns in a column map (--columns), or leave actual_qd out"
                    .into(),
            }),
            (true, true) => None,
        }
    }
}

/// `None` where one of them is not recorded, or too short.
fn changes(recording: &Recording, time_scale: f64) -> Option<Changes> {
    let (q, qd) = (recording.joints("actual_q")?, recording.joints("actual_qd")?);
    let time = &recording.time;
    let step = step(time) * time_scale;
    let length = ((STRETCH_S / step).round() as usize).clamp(1, 10_000);
    let all = (time.len() - 1) / length;
    if q.joints() != qd.joints() || all < FEWEST_STRETCHES {
        return None;
    }
    let starts: Vec<usize> =
        (0..all).step_by(all.div_ceil(MOST_STRETCHES)).map(|k| k * length).collect();
    let change = |series: &JointSeries, j: usize| -> Vec<f64> {
        starts.iter().map(|k| series.joint(j)[k + length] - series.joint(j)[*k]).collect()
    };
    let sum = |j: usize| -> Vec<f64> {
        let v = qd.joint(j);
        let trapezoid = |k: usize| 0.5 * (v[k] + v[k + 1]) * (time[k + 1] - time[k]) * time_scale;
        starts.iter().map(|k| (*k..k + length).map(trapezoid).sum()).collect()
    };
    Some(Changes {
        position: (0..q.joints()).map(|j| change(&q, j)).collect(),
        velocity: (0..q.joints()).map(sum).collect(),
    })
}
