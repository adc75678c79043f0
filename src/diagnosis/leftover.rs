//! Is something systematic left, once the causes are taken off?
//!
//! Sensor noise is spread over all frequencies, what a model lacks lies where the arm moves. So the
//! residual's power in the band of the motion is held against its level where nothing moves: their
//! ratio is 1 for noise and far more sensitive than the sum of squares.

use rustfft::{FftPlanner, num_complex::Complex};

use super::Leftover;
use super::colour::Colour;
use super::columns::Blocks;
use super::evidence::Evidence;

/// Of the motion, Hz.
const MOTION_HZ: f64 = 4.0;
/// Of the highest frequency that is left by filters: where nothing moves.
const QUIET: [f64; 2] = [0.5, 0.9];
/// Ratios up to which nothing systematic is claimed: encoder noise through the arm's inertia and
/// small errors of a signature stay below it.
pub const SYSTEMATIC: f64 = 2.0;
/// The same of all frequencies: play rattles, and what a motor answers to it is fast. Clean arms of
/// the blind trials stay below 1.2; with coloured noise one in twenty came to 1.42.
pub const LOUD: f64 = 1.4;
/// Up to this, in the motion's band and in all, the best joint counts as at its noise: the twin is
/// exact then.
const EXACT: f64 = 2.0;

/// Power in the band of the motion over the level of the noise, joint by joint; 1 where a joint
/// has no rows.
pub fn in_motion_band(evidence: &Evidence<'_>, residual: &Blocks) -> Vec<f64> {
    let rate = evidence.samples.rate_hz() / evidence.samples.decimation() as f64;
    let cutoff = evidence.samples.conditioning.torque_cutoff_hz;
    let top = if cutoff > 0.0 { cutoff.min(0.5 * rate) } else { 0.5 * rate };
    residual.0.iter().map(|rows| ratio(rows, rate, top)).collect()
}

/// Mean square over that of the noise, joint by joint; 0 where a joint has no rows.
fn over_noise(evidence: &Evidence<'_>, residual: &Blocks, noise: Colour) -> Vec<f64> {
    let level = |(j, s): (usize, f64)| {
        let n = evidence.rows[j].len().max(1) as f64;
        s / n / (noise.mean_square * evidence.sigma[j].powi(2)).max(f64::MIN_POSITIVE)
    };
    residual.squares().into_iter().enumerate().map(level).collect()
}

/// `top_hz`: beyond it filters have taken the noise away.
fn ratio(rows: &[f64], rate_hz: f64, top_hz: f64) -> f64 {
    let power = periodogram(rows);
    let per_hz = rows.len() as f64 / rate_hz;
    let at = |hz: f64| ((hz * per_hz) as usize).min(power.len());
    let [from, to] = QUIET.map(|share| at(share * top_hz));
    let mean = |band: &[f64]| band.iter().sum::<f64>() / band.len() as f64;
    let (Some(low), Some(quiet)) = (power.get(1..at(MOTION_HZ)), power.get(from..to)) else {
        return 1.0;
    };
    let noise = mean(quiet);
    if noise > 0.0 && !low.is_empty() { mean(low) / noise } else { 1.0 }
}

/// |FFT|^2 with a Hann window, frequencies 0 to half the rate.
fn periodogram(x: &[f64]) -> Vec<f64> {
    let n = x.len();
    if n < 16 {
        return Vec::new();
    }
    let hann = |k: usize| 0.5 - 0.5 * (std::f64::consts::TAU * (k as f64 + 0.5) / n as f64).cos();
    let mut values: Vec<Complex<f64>> =
        x.iter().enumerate().map(|(k, x)| Complex { re: hann(k) * x, im: 0.0 }).collect();
    FftPlanner::new().plan_fft_forward(n).process(&mut values);
    values[..n / 2].iter().map(Complex::norm_sqr).collect()
}

/// What the causes leave, in short.
pub struct Remains {
    /// Power in the motion's band over the noise, per joint, before and after the causes.
    pub before: Vec<f64>,
    pub after: Vec<f64>,
    /// Mean square over that of the noise, per joint, before and after the causes.
    pub chi2_before: Vec<f64>,
    pub chi2_per_sample: Vec<f64>,
    /// Is what is fast at a joint the motor's answer to something known (`Fit::answered`)?
    pub answered: Vec<bool>,
}

impl Remains {
    pub fn new(
        evidence: &Evidence<'_>,
        [before, after]: [&Blocks; 2],
        noise: Colour,
        answered: Vec<bool>,
    ) -> Self {
        let in_band = |residual: &Blocks| {
            let levels = in_motion_band(evidence, residual).into_iter();
            levels.map(|level| level / noise.in_motion_band).collect()
        };
        Self {
            before: in_band(before),
            after: in_band(after),
            chi2_before: over_noise(evidence, before, noise),
            chi2_per_sample: over_noise(evidence, after, noise),
            answered,
        }
    }

    /// Joints that hold more than noise at these levels of all frequencies.
    pub fn loud<'a>(&'a self, levels: &'a [f64]) -> impl Iterator<Item = usize> + 'a {
        (0..levels.len()).filter(|&j| levels[j] > LOUD && !self.answered[j])
    }

    /// Did nothing stand out before the causes, where the arm moves and above?
    pub fn were_quiet(&self) -> bool {
        let slow = self.before.iter().all(|ratio| *ratio <= SYSTEMATIC);
        slow && self.loud(&self.chi2_before).next().is_none()
    }

    /// How far from its noise even the best joint is: 1 for an exact twin.
    pub fn inexactness(&self) -> f64 {
        let each = self.after.iter().zip(&self.chi2_per_sample).map(|(a, c)| a.max(*c));
        each.filter(|level| *level > 0.0).fold(f64::INFINITY, f64::min).max(1.0)
    }

    /// What stays at the worst joint, in units of how far the best is from its noise.
    pub fn farthest(&self) -> f64 {
        self.after.iter().copied().fold(1.0, f64::max) / self.inexactness()
    }

    pub fn is_exact(&self) -> bool {
        self.inexactness() < EXACT
    }

    /// Of what was systematic at these joints, in units of their noise, the share that is gone.
    /// Where little stood out in the motion's band (play rattles above it) all frequencies may say
    /// so too.
    pub fn explained(&self, joints: &[usize]) -> f64 {
        let above =
            |ratios: &[f64]| -> f64 { joints.iter().map(|&j| (ratios[j] - 1.0).max(0.0)).sum() };
        let share = |before: &[f64], after: &[f64]| match above(before) {
            before if before > 0.0 => 1.0 - above(after) / before,
            _ => 1.0,
        };
        let in_band = share(&self.before, &self.after);
        match joints.iter().all(|&j| self.before[j] < SYSTEMATIC) {
            true => in_band.max(share(&self.chi2_before, &self.chi2_per_sample)),
            false => in_band,
        }
    }
}

/// For the answer: levels on the check recording and what they mean.
pub fn leftover(remains: &Remains) -> Leftover {
    let worse: Vec<usize> =
        (0..remains.after.len()).filter(|&j| remains.after[j] > SYSTEMATIC).collect();
    let times = |joints: &[usize], levels: &[f64]| {
        let each = joints.iter().map(|&j| match levels[j] < 10.0 {
            true => format!("joint {} ({:.1} times)", j + 1, levels[j]),
            false => format!("joint {} ({:.0} times)", j + 1, levels[j]),
        });
        each.collect::<Vec<_>>().join(", ")
    };
    let loud: Vec<usize> = remains.loud(&remains.chi2_per_sample).collect();
    let slow = match (worse.is_empty(), loud.is_empty()) {
        (true, true) => {
            "nothing systematic: where the arm moves there is no more than noise".into()
        }
        (true, false) => format!("below {MOTION_HZ} Hz there is no more than noise"),
        (false, _) => format!(
            "below {MOTION_HZ} Hz there is more than noise at {}",
            times(&worse, &remains.after)
        ),
    };
    let fast = match loud.is_empty() {
        true => String::new(),
        false => {
            let joints = times(&loud, &remains.chi2_per_sample);
            format!("; over all frequencies there is more at {joints}")
        }
    };
    let says = format!("{slow}{fast}");
    Leftover {
        chi2_per_sample: remains.chi2_per_sample.clone(),
        in_motion_band: remains.after.clone(),
        systematic: !worse.is_empty(),
        says,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn white_noise_has_ratio_one_and_a_slow_wave_stands_out() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(4);
        let noise: Vec<f64> = (0..6000).map(|_| StandardNormal.sample(&mut rng)).collect();
        assert!((ratio(&noise, 125.0, 62.5) - 1.0).abs() < 0.15, "{}", ratio(&noise, 125.0, 62.5));
        // A fifth of the noise's power within 4 of 62.5 Hz: 1 + 0.2 * 62.5 / 4.
        let wave = |k: usize| 0.2f64.sqrt() * 2f64.sqrt() * (0.1 * k as f64).sin();
        let waved: Vec<f64> = noise.iter().enumerate().map(|(k, x)| x + wave(k)).collect();
        assert!((ratio(&waved, 125.0, 62.5) - 4.1).abs() < 0.5, "{}", ratio(&waved, 125.0, 62.5));
    }
}
