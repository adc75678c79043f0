//! What was measured over time, beside what identified motors do under the same voltage.

use super::Motor;
use super::error::MotorError;
use super::experiment::Record;
use super::model::COUNT;
use super::report::{MethodReport, ScenarioReport, recordings};
use super::scenario::Scenario;
use super::simulate::{Accuracy, Failure, Output, simulate};

/// One recording. All series have a value per entry of `time`.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// "identification" or "verification".
    pub recording: &'static str,
    /// s
    pub time: Vec<f64>,
    /// V
    pub voltage: Vec<f64>,
    /// Its torque is that of the true K.
    pub measured: Signals,
    /// What the true motor did, without noise.
    pub truth: Signals,
    /// By method.
    pub calculated: Vec<(&'static str, Signals)>,
}

/// rad/s, A, and the motor's torque K i, N.m.
#[derive(Debug, Clone, PartialEq)]
pub struct Signals {
    pub omega: Vec<f64>,
    pub current: Vec<f64>,
    pub torque: Vec<f64>,
}

/// Both recordings of `scenario`, with the motors of `report`.
///
/// # Errors
/// If a motor cannot be simulated.
pub fn series(scenario: &Scenario, report: &ScenarioReport) -> Result<[Series; 2], MotorError> {
    let [fit, check] = recordings(scenario, report.seed)?;
    Ok([
        one("identification", fit, &scenario.truth, &report.methods)?,
        one("verification", check, &scenario.truth, &report.methods)?,
    ])
}

fn one(
    recording: &'static str,
    record: Record,
    truth: &Motor,
    methods: &[MethodReport],
) -> Result<Series, MotorError> {
    let Record { input, measured } = record;
    let signals = |motor: &Motor| -> Result<Signals, Failure> {
        let mut output = Output::default();
        simulate(motor, &input, Accuracy::TRUTH, &mut output)?;
        Ok(Signals::of(output, motor))
    };
    let calculated = |m: &MethodReport| -> Result<(&'static str, Signals), MotorError> {
        let values: [f64; COUNT] = std::array::from_fn(|k| m.parameters[k].value);
        let found = signals(&Motor::from_array(&values)).map_err(|_| MotorError::NothingFits)?;
        Ok((m.method, found))
    };
    let held = input.holds.iter().flat_map(|h| std::iter::repeat_n(h.voltage, h.samples));
    Ok(Series {
        recording,
        time: (1..=input.samples()).map(|k| k as f64 * input.sample_time).collect(),
        voltage: held.collect(),
        measured: Signals::of(measured, truth),
        truth: signals(truth).map_err(MotorError::Truth)?,
        calculated: methods.iter().map(calculated).collect::<Result<_, _>>()?,
    })
}

impl Signals {
    fn of(Output { omega, current }: Output, motor: &Motor) -> Self {
        let torque = current.iter().map(|i| motor.k * i).collect();
        Self { omega, current, torque }
    }
}
