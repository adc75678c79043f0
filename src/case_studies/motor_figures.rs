//! Counterparts of the paper's figures 5 to 10: the motor's voltage, its speed measured and
//! calculated with what PSO and NLSE identified, the errors, and without the noise that hides them.

use super::draw::{Line, Panel};
use super::figures::Figure;
use crate::motor::Motor;
use crate::motor::experiment::Record;
use crate::motor::model::COUNT;
use crate::motor::report::{MethodReport, MotorError, ScenarioReport, recordings};
use crate::motor::scenario::Scenario;
use crate::motor::simulate::{Accuracy, Failure, Output, simulate};

#[derive(Debug, thiserror::Error)]
pub enum MotorFigureError {
    #[error(transparent)]
    Motor(#[from] MotorError),
    #[error("the identified motor cannot be simulated: {0}")]
    Simulation(Failure),
}

/// Both recordings of a scenario, beside every method of its report.
///
/// # Errors
/// If the true or an identified motor cannot be simulated.
pub fn of_motor(
    scenario: &Scenario,
    report: &ScenarioReport,
) -> Result<Vec<Figure>, MotorFigureError> {
    let [fit, check] = recordings(scenario, report.seed)?;
    let one = |(record, what): (&Record, &str)| -> Result<Figure, MotorFigureError> {
        let truth = speed(&scenario.truth, record)?;
        let of = |m: &MethodReport| Ok((label(m), speed(&identified(m), record)?));
        let curves: Vec<_> =
            report.methods.iter().map(of).collect::<Result<_, MotorFigureError>>()?;
        Ok(Figure {
            name: format!("motor_{}_{what}", scenario.number),
            caption: format!(
                "As Figs. 5 to 10: voltage, speed measured and calculated, error, and speed \
                 calculated less true; scenario {}, {what}.",
                scenario.number
            ),
            panels: panels(record, &truth, &curves).into(),
            columns: 2,
            path: vec![],
        })
    };
    [(&fit, "identification"), (&check, "verification")].into_iter().map(one).collect()
}

fn label(method: &MethodReport) -> &'static str {
    if method.method == "pso" { "PSO" } else { "NLSE" }
}

fn identified(method: &MethodReport) -> Motor {
    let mut values = [0.0; COUNT];
    values.iter_mut().zip(&method.parameters).for_each(|(v, p)| *v = p.value);
    Motor::from_array(&values)
}

/// Of a motor with the recording's voltage, rad/s.
fn speed(motor: &Motor, record: &Record) -> Result<Vec<f64>, MotorFigureError> {
    let mut output = Output::default();
    simulate(motor, &record.input, Accuracy::TRUTH, &mut output)
        .map_err(MotorFigureError::Simulation)?;
    Ok(output.omega)
}

fn panels(record: &Record, truth: &[f64], curves: &[(&str, Vec<f64>)]) -> [Panel; 4] {
    let dt = record.input.sample_time;
    let line = |label: &str, colour, y: Vec<f64>| {
        let points = y.into_iter().enumerate().map(|(k, y)| ((k + 1) as f64 * dt, y)).collect();
        Line::new(label, colour, points)
    };
    let held = record.input.holds.iter();
    let voltage = held.flat_map(|h| std::iter::repeat_n(h.voltage, h.samples)).collect();
    let measured = &record.measured.omega;
    let colour = |label: &str| if label == "PSO" { 3 } else { 0 };
    let less = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>();
    let mut speeds = vec![line("measured", 5, measured.clone())];
    let (mut errors, mut from_truth) = (Vec::new(), Vec::new());
    for (label, omega) in curves {
        speeds.push(line(label, colour(label), omega.clone()));
        errors.push(line(label, colour(label), less(measured, omega)));
        from_truth.push(line(label, colour(label), less(omega, truth)));
    }
    [
        ("Voltage", "V", vec![line("", 0, voltage)]),
        ("Speed", "rad/s", speeds),
        ("Error", "rad/s", errors),
        ("Calculated less true", "rad/s", from_truth),
    ]
    .map(|(title, up, lines)| Panel {
        title: title.into(),
        across: "s",
        up,
        lines,
        equal: false,
    })
}
