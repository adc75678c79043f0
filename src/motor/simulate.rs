//! Simulation of the motor as a hybrid system: it slides in one direction or the other, or stands.
//!
//! Sliding is integrated by Dormand-Prince 5(4) under error control; a zero of w is located on the
//! continuous extension, and there the set-valued friction law decides: stand while |K i| <= T_s,
//! else slide on in the direction of the torque. Standing has a closed form, and so has the moment
//! of breaking away. The voltage is constant during a hold; every hold starts a new step.
//!
//! The error of a step is measured in rad/s and in shares of the stall current, so that the
//! choice of steps does not change when current and torques are expressed in other units.

use super::consumer::Consumer;
use super::dormand_prince::{Field, Step};
use super::model::Motor;
use super::sliding::Sliding;

/// One level of voltage, held for a whole number of samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hold {
    /// V
    pub voltage: f64,
    pub samples: usize,
}

/// Piecewise constant voltage, sampled on a grid that fits it.
#[derive(Debug, Clone, PartialEq)]
pub struct Input {
    pub holds: Vec<Hold>,
    /// s
    pub sample_time: f64,
}

impl Input {
    /// Samples after the start (t = 0 is not one of them: the state there is known).
    pub fn samples(&self) -> usize {
        self.holds.iter().map(|h| h.samples).sum()
    }

    /// s
    pub fn duration(&self) -> f64 {
        self.samples() as f64 * self.sample_time
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// Local error per step, rad/s (and share of the stall current).
    pub tolerance: f64,
    /// Steps, accepted or not, after which a simulation is given up.
    pub steps: usize,
}

impl Accuracy {
    /// For data that stand for the truth.
    pub const TRUTH: Self = Self { tolerance: 1e-10, steps: 10_000_000 };
    /// For the thousands of simulations of a search: far below any measurement noise.
    pub const SEARCH: Self = Self { tolerance: 1e-6, steps: 200_000 };
    /// For the hundred thousand of a swarm, which only compares costs.
    pub const SWARM: Self = Self { tolerance: 1e-5, steps: 200_000 };
}

/// Why there is no output: a matter of parameters that are no motor, so searches expect it.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Failure {
    #[error("speed ran away (over {LIMIT} rad/s) at {0} s: friction must not become negative")]
    Runaway(f64),
    #[error("too many integration steps at {0} s: omega_s is too small for the inertia")]
    Stiff(f64),
}

/// rad/s
const LIMIT: f64 = 1e3;
/// What the first step of all tries, s.
const FIRST_STEP: f64 = 0.01;
/// Longest step, s.
const LONGEST_STEP: f64 = 1.0;
/// Shorter remainders of a hold are rounding, s.
const INSTANT: f64 = 1e-12;

/// Sampled output, one value per sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Output {
    /// rad/s
    pub omega: Vec<f64>,
    /// A
    pub current: Vec<f64>,
}

/// Simulates from rest. `output` is overwritten and keeps its memory.
pub fn simulate(
    motor: &Motor,
    input: &Input,
    accuracy: Accuracy,
    output: &mut Output,
) -> Result<(), Failure> {
    output.omega.clear();
    output.current.clear();
    simulate_each(motor, input, accuracy, |i, w| {
        output.current.push(i);
        output.omega.push(w);
    })
}

/// Simulates from rest and hands over (current, speed) sample by sample; nothing is kept.
pub fn simulate_each(
    motor: &Motor,
    input: &Input,
    accuracy: Accuracy,
    mut each: impl FnMut(f64, f64),
) -> Result<(), Failure> {
    run(&Plain(*motor), input, accuracy, &mut |y: &[f64; 2]| each(y[CURRENT], y[OMEGA]))
}

/// Simulates from rest until `out` has enough.
pub(super) fn simulate_into(
    motor: &Motor,
    input: &Input,
    accuracy: Accuracy,
    out: &mut impl Consumer<2>,
) -> Result<(), Failure> {
    run(&Plain(*motor), input, accuracy, out)
}

pub(super) const CURRENT: usize = 0;
pub(super) const OMEGA: usize = 1;

/// What the driver needs to know of a state vector that begins with current and speed.
pub(super) trait Hybrid<const N: usize>: Copy {
    type Sliding: Field<N>;
    fn motor(&self) -> &Motor;
    /// y' while sliding in direction `sign`.
    fn sliding(&self, voltage: f64, sign: f64) -> Self::Sliding;
    /// y after standing for `time`.
    fn stand(&self, voltage: f64, y: &[f64; N], time: f64) -> [f64; N];
    /// Adjusts the state to a change of mode at w = 0, given dw/dt before and after.
    fn switch(&self, y: &mut [f64; N], before: f64, after: f64);
}

#[derive(Clone, Copy)]
struct Plain(Motor);

impl Hybrid<2> for Plain {
    type Sliding = Sliding;

    fn motor(&self) -> &Motor {
        &self.0
    }

    fn sliding(&self, voltage: f64, sign: f64) -> Sliding {
        Sliding::new(&self.0, voltage, sign)
    }

    fn stand(&self, voltage: f64, y: &[f64; 2], time: f64) -> [f64; 2] {
        [self.0.standing_current(voltage, y[CURRENT], time), 0.0]
    }

    fn switch(&self, _: &mut [f64; 2], _: f64, _: f64) {}
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Mode {
    Stand,
    /// +1 or -1
    Slide(f64),
}

impl Mode {
    /// What the set-valued law allows at w = 0.
    fn at_rest(motor: &Motor, current: f64) -> Self {
        let torque = motor.k * current;
        if torque.abs() <= motor.t_s { Self::Stand } else { Self::Slide(torque.signum()) }
    }

    fn acceleration(self, motor: &Motor, current: f64) -> f64 {
        match self {
            Self::Stand => 0.0,
            Self::Slide(sign) => motor.acceleration(current, 0.0, sign),
        }
    }
}

/// The state of a run within one hold.
struct Run<'a, const N: usize, S, F> {
    system: S,
    voltage: f64,
    y: [f64; N],
    mode: Mode,
    /// Since the start of the hold, s.
    t: f64,
    /// Length of the hold, s.
    end: f64,
    /// Next sample within the hold, from 1.
    next: usize,
    sample_time: f64,
    samples: usize,
    /// Length the next step tries, s.
    h: f64,
    steps: usize,
    most_steps: usize,
    /// What errors of current and speed are multiplied with: 1 is what is tolerated. Current
    /// counts in shares of the stall current at full voltage.
    strictness: [f64; 2],
    out: &'a mut F,
}

pub(super) fn run<const N: usize, S: Hybrid<N>>(
    system: &S,
    input: &Input,
    accuracy: Accuracy,
    out: &mut impl Consumer<N>,
) -> Result<(), Failure> {
    let peak = input.holds.iter().fold(0.0_f64, |m, h| m.max(h.voltage.abs()));
    let stall_current = peak.max(f64::MIN_POSITIVE) / system.motor().r;
    let mut run = Run {
        system: *system,
        voltage: 0.0,
        y: [0.0; N],
        mode: Mode::Stand,
        t: 0.0,
        end: 0.0,
        next: 1,
        sample_time: input.sample_time,
        samples: 0,
        h: FIRST_STEP,
        steps: 0,
        most_steps: accuracy.steps,
        strictness: [1.0 / (stall_current * accuracy.tolerance), 1.0 / accuracy.tolerance],
        out,
    };
    let mut start = 0.0;
    for hold in &input.holds {
        run.hold(hold).map_err(|e| e.shifted(start))?;
        if run.out.has_enough() {
            break;
        }
        start += run.end;
    }
    Ok(())
}

impl Failure {
    fn shifted(self, by: f64) -> Self {
        match self {
            Self::Runaway(t) => Self::Runaway(t + by),
            Self::Stiff(t) => Self::Stiff(t + by),
        }
    }
}

impl<const N: usize, S: Hybrid<N>, F: Consumer<N>> Run<'_, N, S, F> {
    fn hold(&mut self, hold: &Hold) -> Result<(), Failure> {
        self.voltage = hold.voltage;
        self.samples = hold.samples;
        self.end = hold.samples as f64 * self.sample_time;
        self.t = 0.0;
        self.next = 1;
        while self.end - self.t > INSTANT {
            match self.mode {
                Mode::Stand => self.stand(),
                Mode::Slide(sign) => self.slide(sign)?,
            }
        }
        // A sample that rounding left behind lies at the end of the hold.
        while self.next <= self.samples {
            self.out.take(&self.y);
            self.next += 1;
        }
        Ok(())
    }

    /// Stands until breakaway or the end of the hold.
    fn stand(&mut self) {
        let motor = self.system.motor();
        let left = self.end - self.t;
        let breakaway = motor.breakaway_time(self.voltage, self.y[CURRENT]);
        let time = breakaway.unwrap_or(left).min(left);
        while self.next <= self.samples && self.sample_at() <= self.t + time {
            let y = self.system.stand(self.voltage, &self.y, self.sample_at() - self.t);
            self.out.take(&y);
            self.next += 1;
        }
        self.y = self.system.stand(self.voltage, &self.y, time);
        self.t += time;
        if breakaway.is_some_and(|b| b <= left) {
            self.mode = Mode::Slide(self.voltage.signum());
        }
    }

    /// Slides until the speed is zero or the hold ends.
    fn slide(&mut self, sign: f64) -> Result<(), Failure> {
        let field = self.system.sliding(self.voltage, sign);
        let mut k1 = field.rate(&self.y);
        loop {
            let left = self.end - self.t;
            if left <= INSTANT {
                return Ok(());
            }
            let h = self.h.min(left);
            let step = Step::take(&field, &self.y, &k1, h);
            self.steps += 1;
            if self.steps > self.most_steps {
                return Err(Failure::Stiff(self.t));
            }
            let error = self.error(&step);
            self.adapt(h, error);
            if error > 1.0 {
                continue;
            }
            if sign * step.y1[OMEGA] < 0.0 {
                self.arrest(&step, sign);
                return Ok(());
            }
            if step.y1[OMEGA].abs() > LIMIT {
                return Err(Failure::Runaway(self.t));
            }
            self.read_off(&step, 1.0);
            k1 = *step.rate_at_end();
            self.y = step.y1;
            self.t = if h == left { self.end } else { self.t + h };
        }
    }

    /// The speed passed zero within the step: go there and let the friction law decide.
    fn arrest(&mut self, step: &Step<N>, sign: f64) {
        let dense = step.dense();
        let theta = zero_of(|theta| sign * dense.component(OMEGA, theta));
        self.read_off(step, theta);
        self.t += theta * step.h;
        self.y = dense.at(theta);
        self.y[OMEGA] = 0.0;
        let motor = *self.system.motor();
        let mode = Mode::at_rest(&motor, self.y[CURRENT]);
        let before = motor.acceleration(self.y[CURRENT], 0.0, sign);
        let after = mode.acceleration(&motor, self.y[CURRENT]);
        self.system.switch(&mut self.y, before, after);
        self.mode = mode;
    }

    /// Puts out the samples in the first `theta` of a step.
    #[inline]
    fn read_off(&mut self, step: &Step<N>, theta: f64) {
        let last = self.samples_until(self.t + theta * step.h);
        if self.next > last {
            return;
        }
        let per_h = 1.0 / step.h;
        let first = (self.sample_at() - self.t) * per_h;
        let count = last + 1 - self.next;
        self.out.take_all(&step.dense(), first, self.sample_time * per_h, count);
        self.next = last + 1;
    }

    /// The last sample of this hold that is not after `time`.
    fn samples_until(&self, time: f64) -> usize {
        let mut k = (time / self.sample_time) as usize;
        while (k + 1) as f64 * self.sample_time <= time {
            k += 1;
        }
        while k as f64 * self.sample_time > time {
            k -= 1;
        }
        k.min(self.samples)
    }

    fn sample_at(&self) -> f64 {
        self.next as f64 * self.sample_time
    }

    /// Error of a step as a multiple of what is tolerated.
    fn error(&self, step: &Step<N>) -> f64 {
        let of = |n: usize| (step.error[n] * self.strictness[n]).abs();
        let worst = of(OMEGA).max(of(CURRENT));
        if worst.is_nan() { f64::INFINITY } else { worst }
    }

    /// Step length control (Hairer, Norsett, Wanner II.4, Eq. 4.13). A last short step before the
    /// end of a hold says little about the next one, so it may only shorten it.
    fn adapt(&mut self, h: f64, error: f64) {
        // Half the digits do for a length, in half the time.
        let factor = (0.9 * f64::from((error as f32).powf(-0.2))).clamp(0.2, 5.0);
        let cut_short = h < self.h && factor > 1.0;
        self.h = if cut_short { self.h.max(h * factor) } else { h * factor };
        self.h = self.h.min(LONGEST_STEP);
    }
}

/// Where `f` turns from positive to negative in [0, 1], by bisection.
fn zero_of(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..52 {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}
