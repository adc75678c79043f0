//! Counterparts of the paper's figures 5 to 10: the motor's voltage, its speed measured and
//! calculated with what PSO and NLSE identified, the errors, and without the noise that hides them.

use super::figures::{Figure, METHODS, TIME, joined};
use crate::figure::{Colour, Panel, Scale};
use crate::motor::report::{MotorError, ScenarioReport};
use crate::motor::scenario::Scenario;
use crate::motor::series::{Series, series};

/// Both recordings of a scenario, beside every method of its report.
///
/// # Errors
/// If the true or an identified motor cannot be simulated.
pub fn of_motor(scenario: &Scenario, report: &ScenarioReport) -> Result<Vec<Figure>, MotorError> {
    let one = |s: &Series| Figure {
        name: format!("motor_{}_{}", scenario.number, s.recording),
        caption: format!(
            "As Figs. 5 to 10: voltage, speed measured and calculated, error, and speed \
             calculated less true; scenario {}, {}.",
            scenario.number, s.recording
        ),
        panels: panels(s).into(),
        columns: 2,
        path: vec![],
    };
    Ok(series(scenario, report)?.iter().map(one).collect())
}

fn panels(series: &Series) -> [Panel; 4] {
    let line = |label: &str, colour, y: &[f64]| {
        joined(label, colour, series.time.iter().copied().zip(y.iter().copied()).collect())
    };
    let less = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>();
    let (measured, truth) = (&series.measured.omega, &series.truth.omega);
    let mut speeds = vec![line("measured", Colour::Measured, measured)];
    let (mut errors, mut from_truth) = (Vec::new(), Vec::new());
    for (method, calculated) in &series.calculated {
        let Some((_, label, colour)) = METHODS.into_iter().find(|m| m.0 == *method) else {
            continue;
        };
        let omega = &calculated.omega;
        speeds.push(line(label, colour, omega));
        errors.push(line(label, colour, &less(measured, omega)));
        from_truth.push(line(label, colour, &less(omega, truth)));
    }
    [
        ("Voltage", "V", vec![line("", Colour::ByName, &series.voltage)]),
        ("Speed", "rad/s", speeds),
        ("Error", "rad/s", errors),
        ("Calculated less true", "rad/s", from_truth),
    ]
    .map(|(title, up, lines)| Panel {
        title: title.into(),
        across: TIME,
        up: (up, Scale::Linear),
        lines,
        ..Panel::default()
    })
}
