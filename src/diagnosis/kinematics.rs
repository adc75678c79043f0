//! Does the recorded velocity follow the recorded position?
//!
//! Torque cannot tell where motion is made from positions, so this is asked of the channels
//! themselves. A velocity that lags by T obeys T d(qd_r)/dt = qd - qd_r, with qd from positions:
//! one least-squares slope per joint and recording. Recorded position and velocity pass one and the
//! same low-pass, so that the law holds at every row. The motion the torque is made from will not do:
//! where a command is recorded it is smoothed less than the velocity, and what smoothing rounds off
//! the velocity where a joint sets off and stops is left on one side of standstill only (a lag of 20 us
//! where there was none).

use super::answer::LAG;
use super::discrepancy::SIMULTANEOUS;
use super::observed::Observed;
use super::{BeforeAfter, Cause, Checked, Settings, Value};
use crate::effects::{Motion, find};
use crate::regression::Blocks;
use crate::series::JointSeries;
use crate::signals::{LowPass, central_difference};
use crate::statistics::{effective_samples, normal_quantile};

/// Confidence level of the interval.
const LEVEL: f64 = 0.9;
/// Standard deviations from none, on both recordings.
const CLEAR: f64 = 5.0;
/// Least share of the mean square of qd - qd_r on the check recording that a lag must take off.
const LEAST_SHARE: f64 = 0.05;
/// Largest distance of the joints' own lags from the common one, root mean square, relative to their own: it still
/// takes off three quarters.
const ALIKE: f64 = 0.5;
/// Probability that a lag found this clearly is none.
const DOUBT: f64 = 0.03;

/// Lag of one joint's recorded velocity with its standard deviation, s.
#[derive(Debug, Clone, Copy)]
struct Lag {
    value: f64,
    sd: f64,
}

/// A recorded velocity that lags.
#[derive(Debug, Clone)]
pub struct Lagging {
    /// Joints that lag, from 0; all of them where they lag alike.
    joints: Vec<usize>,
    /// Lag of all joints alike, or of one joint.
    lag: Lag,
    whole_arm: bool,
    shrink: Checked,
}

/// Joints (from 0) and their lag.
struct Late {
    joints: Vec<usize>,
    lag: Lag,
}

/// The recorded velocity and what it has to answer for.
struct Channel {
    /// d(qd_r)/dt, and qd - qd_r, at the rows of the evidence.
    slope: Blocks,
    error: Blocks,
}

/// The lag both recordings agree on; `None` where velocities are not recorded, or follow.
pub fn lagging(fit: &Observed<'_>, check: &Observed<'_>, settings: &Settings) -> Option<Lagging> {
    let channels = [channel(fit)?, channel(check)?];
    let known =
        |j: usize| find(LAG).and_then(|e| fit.twin.values_at(e, j)).map_or(0.0, |values| values[0]);
    let more = |lag: Lag, j: usize| Lag { value: lag.value - known(j), ..lag };
    let both = |j: usize| channels.each_ref().map(|c| more(slope_of(c, j), j));
    let each: Vec<(usize, [Lag; 2])> = (0..fit.joints()).map(|j| (j, both(j))).collect();
    let late = each.iter().filter(|(j, lags)| agree(*j, *lags, &channels[1]));
    let late: Vec<(usize, Lag)> = late.map(|(j, lags)| (*j, lags[0])).collect();
    let strongest = late.iter().max_by(|a, b| a.1.z().total_cmp(&b.1.z()))?;
    let told = each.iter().filter(|(_, lags)| lags[0].sd.is_finite());
    let (all, lags): (Vec<usize>, Vec<Lag>) = told.map(|(j, lags)| (*j, lags[0])).unzip();
    let common = pooled(&lags);
    let whole_arm = late.len() > 1 && are_alike(&lags, common);
    let (joints, lag) = match whole_arm {
        true => (all, common),
        false => (vec![strongest.0], strongest.1),
    };
    if lag.value <= SIMULTANEOUS * fit.samples.dt {
        return None;
    }
    let late = Late { joints, lag };
    let shrink = in_torque(check, &channels[1], &late, settings.seed);
    Some(Lagging { joints: late.joints, lag, whole_arm, shrink })
}

fn channel(evidence: &Observed<'_>) -> Option<Channel> {
    let samples = evidence.samples;
    let sensed = samples.sensed.as_ref()?;
    let how = &samples.conditioning;
    let filter =
        LowPass::if_wanted(how.motion_cutoff_hz, samples.rate_hz(), how.filter_order).ok()?;
    let smooth = |series: &JointSeries| {
        series.map_joints(|_, x| {
            let mut x = x.to_vec();
            filter.iter().for_each(|f| f.apply(&mut x));
            x
        })
    };
    let by_time =
        |series: &JointSeries| series.map_joints(|_, x| central_difference(x, samples.dt));
    let velocity = smooth(&sensed.qd);
    let at_rows = |series: &JointSeries| {
        let rows = evidence.rows.iter().enumerate();
        Blocks(rows.map(|(j, rows)| rows.iter().map(|&k| series.joint(j)[k]).collect()).collect())
    };
    let slope = at_rows(&by_time(&velocity));
    let mut error = at_rows(&by_time(&smooth(&sensed.q)));
    error.add_scaled(-1.0, &at_rows(&velocity));
    Some(Channel { slope, error })
}

/// T of one joint by least squares; samples counted by what is independent of what is left.
fn slope_of(channel: &Channel, j: usize) -> Lag {
    let information = channel.slope.dot(&channel.slope, j);
    if information <= 0.0 {
        return Lag { value: 0.0, sd: f64::INFINITY };
    }
    let value = channel.error.dot(&channel.slope, j) / information;
    let left: Vec<f64> = channel
        .error
        .joint(j)
        .iter()
        .zip(channel.slope.joint(j))
        .map(|(e, s)| e - value * s)
        .collect();
    let power = left.iter().map(|r| r * r).sum::<f64>() / left.len() as f64;
    let share = effective_samples(&left) / left.len() as f64;
    Lag { value, sd: (power / (share * information)).sqrt() }
}

impl Lag {
    fn z(&self) -> f64 {
        self.value / self.sd
    }
}

/// Does a joint lag on both recordings, and does that of the first take something off the second?
fn agree(j: usize, [fit, check]: [Lag; 2], on_check: &Channel) -> bool {
    let clear = fit.z() > CLEAR && check.z() > CLEAR;
    let [power, cross, slope] = [
        on_check.error.dot(&on_check.error, j),
        on_check.error.dot(&on_check.slope, j),
        on_check.slope.dot(&on_check.slope, j),
    ];
    let taken = (2.0 * fit.value * cross - fit.value.powi(2) * slope) / power;
    clear && taken > LEAST_SHARE
}

/// Mean over the joints; as uncertain as they differ.
fn pooled(lags: &[Lag]) -> Lag {
    let n = lags.len() as f64;
    let value = lags.iter().map(|l| l.value).sum::<f64>() / n;
    let own = lags.iter().map(|l| l.sd.powi(2)).sum::<f64>();
    let apart = lags.iter().map(|l| (l.value - value).powi(2)).sum::<f64>();
    Lag { value, sd: (own + apart * n / (n - 1.0).max(1.0)).sqrt() / n }
}

/// Does the common lag stand for those of the joints, each as well as it is known?
fn are_alike(lags: &[Lag], common: Lag) -> bool {
    let squares =
        |from: f64| -> f64 { lags.iter().map(|l| ((l.value - from) / l.sd).powi(2)).sum() };
    squares(common.value) < ALIKE.powi(2) * squares(0.0)
}

/// The torque a twin is wrong by whose velocity is late by what the check recording shows, and by
/// what the fitted lag leaves of it. Sensor noise is left out: differentiated twice it would drown
/// both.
fn in_torque(evidence: &Observed<'_>, channel: &Channel, late: &Late, seed: u64) -> Checked {
    let samples = evidence.samples;
    let jerk = samples.qdd.map_joints(|_, x| central_difference(x, samples.dt));
    let wrong = |left: f64| {
        let behind = |x: &JointSeries, slope: &JointSeries| {
            let mut x = x.clone();
            for &j in &late.joints {
                let by = slope_of(channel, j).value - left;
                x.joint_mut(j).iter_mut().zip(slope.joint(j)).for_each(|(x, s)| *x -= by * s);
            }
            x
        };
        let (qd, qdd) = (behind(&samples.qd, &samples.qdd), behind(&samples.qdd, &jerk));
        let robot = &evidence.twin.robot;
        let fed = evidence.twin.torque(&Motion { qd: &qd, qdd: &qdd, ..evidence.motion(robot) });
        fed.map_joints(|j, f| f.iter().zip(evidence.known.joint(j)).map(|(f, k)| f - k).collect())
    };
    let (before, after, masks) = (wrong(0.0), wrong(late.lag.value), evidence.masks());
    BeforeAfter { samples, before: &before, after: &after, masks: &masks }.checked(seed)
}

impl Lagging {
    /// `None` where the effect is taken out of the catalogue.
    pub fn cause(&self, settings: &Settings) -> Option<Cause> {
        if settings.without.iter().any(|name| name == LAG) {
            return None;
        }
        let about = find(LAG)?.about();
        let half = normal_quantile(1.0 - LEVEL) * self.lag.sd;
        let value = Value {
            name: LAG.into(),
            joint: None,
            unit: "s".into(),
            value: self.lag.value,
            low: (self.lag.value - half).max(0.0),
            high: self.lag.value + half,
            at_bound: false,
        };
        Some(Cause {
            effect: about.name.into(),
            joints: self.named(),
            probability: 1.0 - DOUBT,
            equivalent: vec![],
            parameters: vec![value],
            shrink: self.shrink,
            replaces: None,
            recording: None,
            found_without_check: true,
            cause: about.cause.into(),
            remedy: about.remedy.into(),
        })
    }

    /// Joints from 1; none for the whole arm.
    fn named(&self) -> Vec<usize> {
        match self.whole_arm {
            true => vec![],
            false => self.joints.iter().map(|j| j + 1).collect(),
        }
    }

    pub fn says(&self) -> String {
        let place = match &self.joints[..] {
            [j] if !self.whole_arm => format!("of joint {}", j + 1),
            _ => "of all joints".into(),
        };
        format!(
            "recorded velocities {place} lag {:.1} ms behind the positions; motion is made from \
             positions here, so that the torque gap does not contain it",
            1e3 * self.lag.value
        )
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};
    use rayon::prelude::*;

    use super::*;
    use crate::diagnosis::{conditioning, noise_floor};
    use crate::recording::Recording;
    use crate::signals::testing::samples;
    use crate::signals::{Samples, Sensed, condition};
    use crate::simulation::{Scenario, Simulation};
    use crate::twin::{PerJoint, Twin};

    /// Six joints moving by sines; velocities recorded `late` s late (a first-order lag follows a
    /// sine of frequency w late by atan(w T) / w and smaller by 1 / sqrt(1 + w^2 T^2)), and noisy.
    fn moving(late: impl Fn(usize) -> f64, seed: u64) -> Samples {
        let wave = |j: usize| 1.0 + 0.3 * j as f64;
        let mut made = samples(6, 4000, |j, t| 0.5 * (wave(j) * t).sin());
        let twin = Twin::default();
        made.torque = twin.torque(&twin.motion(&made));
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let noise = Normal::new(0.0, 1.5e-3).unwrap();
        let recorded = made.qd.map_joints(|j, qd| {
            let (w, lag) = (wave(j), late(j));
            let (turn, gain) = ((w * lag).atan(), 1.0 / (1.0 + (w * lag).powi(2)).sqrt());
            let at = |k: usize| gain * 0.5 * w * (w * k as f64 * 0.008 - turn).cos();
            (0..qd.len()).map(|k| at(k) + noise.sample(&mut rng)).collect()
        });
        made.sensed = Some(Sensed { q: made.q.clone(), qd: recorded });
        made
    }

    fn found(late: impl Fn(usize) -> f64 + Copy) -> Option<Lagging> {
        between(&moving(late, 1), &moving(late, 2))
    }

    fn between(fit: &Samples, check: &Samples) -> Option<Lagging> {
        let twin = Twin::default();
        let floors = [noise_floor(fit, &twin), noise_floor(check, &twin)];
        let [fit, check] = [(fit, &floors[0]), (check, &floors[1])]
            .map(|(s, floor)| Observed::new(0, &twin, s, floor).unwrap());
        lagging(&fit, &check, &Settings::default())
    }

    #[test]
    fn a_lag_of_all_joints_is_one_cause_and_closes_its_own_gap() {
        let lag = found(|_| 0.01).unwrap();
        let cause = lag.cause(&Settings::default()).unwrap();
        let value = &cause.parameters[0];
        assert!(cause.joints.is_empty() && value.low < 0.01 && 0.01 < value.high, "{cause:?}");
        assert!((value.value - 0.01).abs() < 2e-4 && cause.shrink.fraction > 0.9, "{cause:?}");
        let without = Settings { without: vec![LAG.into()], ..Settings::default() };
        assert!(lag.cause(&without).is_none());
    }

    #[test]
    fn a_joint_that_lags_otherwise_does_not_hide_what_all_lag_by() {
        let lag = found(|j| if j == 3 { 0.002 } else { 0.01 }).unwrap();
        assert!(lag.cause(&Settings::default()).unwrap().joints.is_empty());
        let lag = found(|j| if j < 2 { 0.01 } else { 0.002 }).unwrap();
        assert_eq!(lag.cause(&Settings::default()).unwrap().joints.len(), 1);
    }

    #[test]
    fn one_joint_lags_or_none() {
        let lag = found(|j| if j == 2 { 0.01 } else { 0.0 }).unwrap();
        assert_eq!(lag.cause(&Settings::default()).unwrap().joints, [3]);
        assert!(found(|_| 0.0).is_none());
        assert!(found(|_| 2e-4).is_none(), "channels are not simultaneous that well");
    }

    /// An arm in rapier that sets off, stops and sticks, whose motion follows a recorded command: its
    /// sensors read `times` over, each time with noise of their own.
    fn simulated(late: f64, times: u64) -> Vec<[Samples; 2]> {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/effects");
        let mut scenario = Scenario::load(&folder.join("velocity_lag.toml")).unwrap();
        scenario.shorten(30.0);
        let table = scenario.effects.get_mut(LAG).unwrap();
        table.insert(LAG.into(), PerJoint::All(late));
        let made = scenario.work_out("lag").unwrap();
        let mut simulation = Simulation::new(&made.setup).unwrap();
        let motions = [&made.fit, &made.check];
        let runs = motions.map(|m| simulation.run(m, 1, 0, &mut |_| true).unwrap());
        let twin = Twin::default();
        let samples = |recording: &Recording| {
            let how = conditioning(recording, 6);
            condition(recording, &twin.drive, 6, &how).unwrap()
        };
        let again = |seed| {
            let number =
                |i: usize| samples(&simulation.sensed_again(&runs[i], seed, i as u64).recording);
            [number(0), number(1)]
        };
        (0..times).map(again).collect()
    }

    /// With the motion the torque is made from in place of the recorded positions, and lines between
    /// samples in the sensor, nine of these thirty lay within.
    #[test]
    fn lags_of_an_arm_that_sets_off_and_stops_lie_within_their_intervals() {
        const TIMES: u64 = 10;
        let wide = normal_quantile(1.0 - LEVEL);
        [0.002, 0.01, 0.06].par_iter().for_each(|&late| {
            let of = |[fit, check]: &[Samples; 2]| between(fit, check).unwrap().lag;
            let off = |lag: Lag| (lag.value - late) / lag.sd;
            let off: Vec<f64> = simulated(late, TIMES).iter().map(of).map(off).collect();
            let within = off.iter().filter(|off| off.abs() < wide).count();
            let mean = off.iter().sum::<f64>() / TIMES as f64;
            assert!(within >= 8 && mean.abs() < 0.7, "{late} s: {off:?} standard deviations");
        });
    }
}
