//! The way from a recording to samples, one step after the other.

use super::channels::{Picked, Torque, pick};
use super::tracking::tracked;
use super::{
    Conditioning, Derivatives, LowPass, Samples, Sensed, SignalError, UniformGrid,
    central_difference, erode, mean_difference, second_difference,
};
use crate::recording::Recording;
use crate::robot::{Drive, Told, servo};
use crate::series::JointSeries;

/// Usable samples below which nothing can be fitted.
const FEWEST_USABLE: usize = 10;

/// Puts the first `dof` joints of `recording` on a uniform grid and differentiates as `how` says.
/// The torque is `joint_torque_*` where recorded, else current through `drive`.
pub fn condition(
    recording: &Recording,
    drive: &Drive,
    dof: usize,
    how: &Conditioning,
) -> Result<Samples, SignalError> {
    check(how)?;
    let mut picked = pick(recording, drive, dof, how.derivatives)?;
    let grid = lay_grid(&recording.time, how)?;
    let mut notes = std::mem::take(&mut picked.notes);
    notes.extend(describe(&grid, &recording.time));
    let carry = |s: &JointSeries| s.map_joints(|_, x| grid.resample(x));
    let sensed = |qd| Sensed { q: carry(&picked.q), qd: carry(qd) };
    let sensed = picked.unused_qd.as_ref().map(sensed);
    let motion = differentiate(&picked, carry, grid.dt, how)?;
    let smoothed_further = smoothed_further(&picked, carry, grid.dt, how)?;
    let usable = usable(&grid, how)?;
    let [q, qd, qdd] = motion;
    let (torque, told) = torque(&picked, drive, &grid, &qd);
    let mut samples = Samples {
        dt: grid.dt,
        start: grid.start,
        q,
        qd,
        qdd,
        torque,
        told,
        response: None,
        sensed,
        smoothed_further,
        temperature: picked.temperature.as_ref().map(carry),
        usable,
        conditioning: how.clone(),
        notes,
    };
    samples.torque_filter()?;
    samples.notes.push(decimated(&samples));
    Ok(samples)
}

/// Torque on the grid, N.m, and what servos were told where it follows from that.
fn torque(
    picked: &Picked,
    drive: &Drive,
    grid: &UniformGrid,
    qd: &JointSeries,
) -> (JointSeries, Option<Told>) {
    let carry = |s: &JointSeries| s.map_joints(|_, x| grid.resample(x));
    match (&picked.torque, &drive.servo) {
        (Torque::Recorded(torque), _) => (carry(torque), None),
        (Torque::Servo { command, settings }, Some(servo)) => {
            let settings = servo::Settings {
                register: settings.register.as_ref().map(carry),
                powered: settings.powered.as_ref().map(carry),
            };
            let q = carry(&picked.q);
            let (mut told, torque) = servo.told(carry(command), &q, qd, &settings, grid.dt);
            told.recorded = grid.in_gap().iter().map(|gap| !gap).collect();
            told.resolution = (0..q.joints()).map(|j| resolution(picked.q.joint(j))).collect();
            (torque, Some(told))
        }
        (Torque::Servo { .. }, None) => (JointSeries::zeros(qd.joints(), qd.samples()), None),
    }
}

/// Smallest step between neighbouring values that is none of rounding; 0 where nothing changes.
fn resolution(values: &[f64]) -> f64 {
    let steps = values.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|s| *s > 1e-9);
    let least = steps.fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

/// What becomes of the samples where torque is regressed on them.
fn decimated(samples: &Samples) -> String {
    let (n, cutoff) = (samples.decimation(), samples.conditioning.torque_cutoff_hz);
    let kept = samples.rate_hz() / n as f64;
    match cutoff > 0.0 {
        true => format!("regressions use {kept:.3} Hz (1 in {n}) after a low-pass at {cutoff} Hz"),
        false => format!("regressions use {kept:.3} Hz (1 in {n}), not low-passed"),
    }
}

/// Refuses settings no recording could be conditioned with.
fn check(how: &Conditioning) -> Result<(), SignalError> {
    let bad = |key, value, remedy| Err(SignalError::Setting { key, value, remedy });
    let not_negative = [
        ("motion_cutoff_hz", how.motion_cutoff_hz),
        ("standstill_cutoff_hz", how.standstill_cutoff_hz),
        ("torque_cutoff_hz", how.torque_cutoff_hz),
        ("standstill_rad_s", how.standstill_rad_s),
        ("guard_s", how.guard_s),
        ("margin_s", how.margin_s),
    ];
    for (key, value) in not_negative {
        if !(value >= 0.0 && value.is_finite()) {
            return bad(key, value, "give a finite number of at least 0");
        }
    }
    if let Some(rate) = how.rate_hz.filter(|r| !(*r > 0.0 && r.is_finite())) {
        return bad(
            "rate_hz",
            rate,
            "give a rate above 0, or leave it out for the recording's own",
        );
    }
    if how.gap_periods.is_nan() || how.gap_periods < 1.5 {
        return bad("gap_periods", how.gap_periods, "give at least 1.5");
    }
    if how.decimation == Some(0) {
        return bad("decimation", 0.0, "1 keeps every sample");
    }
    Ok(())
}

/// Instants a sensible grid can have; more means a wrong rate or a wrong time column.
const MOST_SAMPLES: f64 = 5e7;

fn lay_grid(time: &[f64], how: &Conditioning) -> Result<UniformGrid, SignalError> {
    let seconds = time.last().unwrap_or(&0.0) - time.first().unwrap_or(&0.0);
    if time.len() < FEWEST_USABLE {
        return Err(too_short(time.len(), seconds, 0.0, how));
    }
    if let Some(rate) = how.rate_hz.filter(|rate| rate * seconds > MOST_SAMPLES) {
        let remedy = "that is more than 50 million samples; choose a lower rate";
        return Err(SignalError::Setting { key: "rate_hz", value: rate, remedy });
    }
    Ok(UniformGrid::new(time, how.rate_hz, how.interpolation, how.gap_periods))
}

fn too_short(samples: usize, seconds: f64, dt: f64, how: &Conditioning) -> SignalError {
    let needed_s = 2.0 * how.margin_s + FEWEST_USABLE as f64 * dt;
    SignalError::TooShort { samples, seconds, needed_s, margin_s: how.margin_s }
}

/// What the grid changed, in sentences.
fn describe(grid: &UniformGrid, time: &[f64]) -> Vec<String> {
    let (samples, rate) = (grid.len(), 1.0 / grid.dt);
    let between = 100.0 * grid.interpolated();
    let mut notes = vec![format!(
        "{} recorded instants -> {samples} samples at {rate:.3} Hz, {between:.1} % interpolated",
        time.len()
    )];
    let gaps = grid.gaps();
    if let Some(longest) = gaps.iter().map(|g| g.end - g.start).max_by(f64::total_cmp) {
        let count = gaps.len();
        notes.push(format!("{count} gaps in time, the longest {longest:.3} s, left out"));
    }
    notes
}

/// False in gaps, at both ends and within the margin of either.
fn usable(grid: &UniformGrid, how: &Conditioning) -> Result<Vec<bool>, SignalError> {
    let n = grid.len();
    let margin = (how.margin_s / grid.dt).round() as usize;
    let recorded: Vec<bool> = grid.in_gap().iter().map(|gap| !gap).collect();
    let mut usable = erode(&recorded, margin);
    usable[..margin.min(n)].fill(false);
    usable[n.saturating_sub(margin)..].fill(false);
    if usable.iter().filter(|u| **u).count() < FEWEST_USABLE {
        return Err(too_short(n, n as f64 * grid.dt, grid.dt, how));
    }
    Ok(usable)
}

/// q, qd, qdd on the grid; `carry` resamples.
fn differentiate(
    picked: &Picked,
    carry: impl Fn(&JointSeries) -> JointSeries,
    dt: f64,
    how: &Conditioning,
) -> Result<[JointSeries; 3], SignalError> {
    let filter = LowPass::if_wanted(how.motion_cutoff_hz, 1.0 / dt, how.filter_order)?;
    let smooth = |series: &JointSeries| low_passed(filter.as_ref(), carry(series));
    let by_time = |x: &JointSeries| x.map_joints(|_, x| central_difference(x, dt));
    match (&picked.target, &picked.qd) {
        (Some(target), _) => Ok(tracked(&carry(&picked.q), &target.each_ref().map(carry), dt, how)),
        (None, Some(qd)) if how.derivatives == Derivatives::Paper => {
            let qd = carry(qd);
            let qdd = qd.map_joints(|_, x| mean_difference(x, dt));
            Ok([carry(&picked.q), qd, qdd])
        }
        (None, Some(qd)) => {
            let qd = smooth(qd);
            let qdd = by_time(&qd);
            Ok([smooth(&picked.q), qd, qdd])
        }
        (None, None) => {
            let q = smooth(&picked.q);
            let qdd = q.map_joints(|_, x| second_difference(x, dt));
            let qd = by_time(&q);
            Ok([q, qd, qdd])
        }
    }
}

/// What half the sharpest cutoff takes further from the acceleration, everywhere alike; `None` where the motion is not
/// smoothed.
fn smoothed_further(
    picked: &Picked,
    carry: impl Fn(&JointSeries) -> JointSeries,
    dt: f64,
    how: &Conditioning,
) -> Result<Option<JointSeries>, SignalError> {
    let cutoff = how.sharpest_cutoff_hz();
    if cutoff <= 0.0 || how.derivatives == Derivatives::Paper {
        return Ok(None);
    }
    let smoothed = |motion_cutoff_hz: f64| {
        let how = Conditioning { motion_cutoff_hz, standstill_cutoff_hz: 0.0, ..how.clone() };
        differentiate(picked, &carry, dt, &how).map(|[_, _, qdd]| qdd)
    };
    let (at, half) = (smoothed(cutoff)?, smoothed(0.5 * cutoff)?);
    let less = |j: usize, half: &[f64]| half.iter().zip(at.joint(j)).map(|(h, a)| h - a).collect();
    Ok(Some(half.map_joints(less)))
}

fn low_passed(filter: Option<&LowPass>, series: JointSeries) -> JointSeries {
    let Some(filter) = filter else { return series };
    let mut rows: Vec<Vec<f64>> = (0..series.joints()).map(|j| series.joint(j).to_vec()).collect();
    filter.apply_many(&mut rows);
    JointSeries::from_joints(&rows)
}
