//! The output-error problem: simulate with trial parameters, compare with what was measured.
//!
//! r = (yhat(theta) - y) / sigma, channel after channel, sigma the noise of the channel as its
//! second differences show it. With the speed alone |r| is the paper's Eq. 5 up to a constant; with
//! the current as well the weights make ampere and radian per second comparable.

use std::cell::RefCell;

use super::consumer::Consumer;
use super::experiment::Record;
use super::model::{COUNT, Motor};
use super::scenario::{Channel, Scenario};
use super::sensitivity::{Sensitivities, simulate_with_sensitivities};
use super::simulate::{Accuracy, simulate_each, simulate_into};
use super::squares::Squares;
use crate::identification::levenberg_marquardt::Residuals;
use crate::regression::bounds::Bounds;
use crate::statistics::noise_from_differences;

pub struct OutputError<'a> {
    record: &'a Record,
    channels: Vec<Channel>,
    /// Standard deviation of the noise, per channel.
    pub sigma: Vec<f64>,
    /// Positions of the parameters that are searched for.
    pub free: Vec<usize>,
    /// Values of those that are not.
    base: [f64; COUNT],
    accuracy: Accuracy,
}

impl<'a> OutputError<'a> {
    /// `given` parameters keep their value.
    pub fn new(record: &'a Record, measured: &[Channel], given: &[Option<f64>; COUNT]) -> Self {
        let sigma = measured.iter().map(|&c| noise_of(record.measured.channel(c))).collect();
        Self {
            record,
            channels: measured.to_vec(),
            sigma,
            free: (0..COUNT).filter(|&k| given[k].is_none()).collect(),
            base: given.map(|g| g.unwrap_or(0.0)),
            accuracy: Accuracy::SEARCH,
        }
    }

    pub fn samples(&self) -> usize {
        self.record.input.samples()
    }

    /// All ten from those searched for.
    pub fn motor(&self, x: &[f64]) -> Motor {
        Motor::from_array(&self.complete(x))
    }

    pub fn complete(&self, x: &[f64]) -> [f64; COUNT] {
        let mut all = self.base;
        for (&k, &value) in self.free.iter().zip(x) {
            all[k] = value;
        }
        all
    }

    /// Bounds of the parameters searched for; the scenario's are checked to be a box.
    pub fn bounds(&self, bounds: &[[f64; 2]; COUNT]) -> Bounds {
        let of = |end: usize| self.free.iter().map(|&k| bounds[k][end]).collect();
        Bounds::new(of(0), of(1)).unwrap_or_else(|_| Bounds::unbounded(self.free.len()))
    }

    /// sqrt(mean r^2), in units of the noise; infinite where the motor cannot be simulated.
    pub fn cost(&self, x: &[f64]) -> f64 {
        self.cost_at(self.accuracy, f64::INFINITY, x)
    }

    /// The cost where it is below `limit`, as accurate as a swarm needs it; elsewhere any number
    /// from `limit` up, for the simulation ends when that is sure.
    pub fn cost_below(&self, limit: f64, x: &[f64]) -> f64 {
        self.cost_at(Accuracy::SWARM, limit, x)
    }

    fn cost_at(&self, accuracy: Accuracy, limit: f64, x: &[f64]) -> f64 {
        let count = self.count() as f64;
        let channels = self.channels.iter().zip(&self.sigma);
        let mut sum = Squares::new(&self.record.measured, channels, limit * limit * count);
        if simulate_into(&self.motor(x), &self.record.input, accuracy, &mut sum).is_err() {
            return f64::INFINITY;
        }
        let cost = (sum.total() / count).sqrt();
        if sum.has_enough() { cost.max(limit) } else { cost }
    }

    fn offset(&self, channel: Channel) -> Option<(usize, f64)> {
        let at = self.channels.iter().position(|&c| c == channel)?;
        Some((at * self.samples(), 1.0 / self.sigma[at]))
    }
}

/// Never zero, so that a noiseless recording has weights too.
fn noise_of(signal: &[f64]) -> f64 {
    let size = signal.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let floor = if size > 0.0 { 1e-9 * size } else { 1.0 };
    noise_from_differences(signal).max(floor)
}

impl Residuals for OutputError<'_> {
    fn count(&self) -> usize {
        self.samples() * self.channels.len()
    }

    fn residuals(&self, x: &[f64], out: &mut [f64]) {
        let measured = &self.record.measured;
        let (omega, current) = (self.offset(Channel::Omega), self.offset(Channel::Current));
        let mut k = 0;
        let done = simulate_each(&self.motor(x), &self.record.input, self.accuracy, |i, w| {
            if let Some((at, weight)) = omega {
                out[at + k] = weight * (w - measured.omega[k]);
            }
            if let Some((at, weight)) = current {
                out[at + k] = weight * (i - measured.current[k]);
            }
            k += 1;
        });
        if done.is_err() {
            out.fill(f64::INFINITY);
        }
    }

    fn jacobian(&self, x: &[f64], r: &[f64], _: &Bounds) -> Vec<Vec<f64>> {
        thread_local! {
            static SPACE: RefCell<Sensitivities> = RefCell::default();
        }
        SPACE.with_borrow_mut(|s| {
            let motor = self.motor(x);
            if simulate_with_sensitivities(&motor, &self.record.input, self.accuracy, s).is_err() {
                return vec![vec![f64::NAN; r.len()]; x.len()];
            }
            self.free.iter().map(|&p| self.column(s, p)).collect()
        })
    }
}

impl OutputError<'_> {
    fn column(&self, s: &Sensitivities, p: usize) -> Vec<f64> {
        let mut column = vec![0.0; self.count()];
        for (channel, rows) in [(Channel::Omega, &s.d_omega), (Channel::Current, &s.d_current)] {
            if let Some((at, weight)) = self.offset(channel) {
                let part = &mut column[at..at + rows.len()];
                part.iter_mut().zip(rows).for_each(|(c, row)| *c = weight * row[p]);
            }
        }
        column
    }
}

impl Scenario {
    /// The problem this scenario poses for a recording of it.
    pub fn problem<'a>(&self, record: &'a Record) -> OutputError<'a> {
        OutputError::new(record, &self.measured, &self.given)
    }
}
