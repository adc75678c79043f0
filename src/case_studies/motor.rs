//! Figures of the first case study: the motor's voltage, its speed measured and calculated.

use super::figures::{Figure, FigureError, Line, Panel, draw};
use crate::motor::Motor;
use crate::motor::experiment::Record;
use crate::motor::model::COUNT;
use crate::motor::report::{Method, MotorError, recordings, run};
use crate::motor::scenario::Scenario;
use crate::motor::simulate::{Accuracy, Failure, Output, simulate};

#[derive(Debug, thiserror::Error)]
pub enum MotorFigureError {
    #[error(transparent)]
    Motor(#[from] MotorError),
    #[error("the identified motor cannot be simulated: {0}")]
    Simulation(Failure),
    #[error(transparent)]
    Figure(#[from] FigureError),
}

/// One scenario, both recordings; calculated with what NLSE identified.
///
/// # Errors
/// If the scenario cannot be identified or drawn.
pub fn of_motor(scenario: &Scenario, seed: u64) -> Result<Vec<Figure>, MotorFigureError> {
    let report = run(scenario, &[Method::Nlse], seed, &|| {})?;
    let mut values = [0.0; COUNT];
    for method in &report.methods {
        values.iter_mut().zip(&method.parameters).for_each(|(v, p)| *v = p.value);
    }
    let motor = Motor::from_array(&values);
    let [fit, check] = recordings(scenario, seed)?;
    let one = |(record, what): (&Record, &str)| -> Result<Figure, MotorFigureError> {
        let file = format!("motor_{}_{what}.svg", scenario.number);
        let caption = format!(
            "As Figs. 5 to 10: voltage, speed measured and calculated, error; scenario {}, {what}.",
            scenario.number
        );
        let mut calculated = Output::default();
        simulate(&motor, &record.input, Accuracy::TRUTH, &mut calculated)
            .map_err(MotorFigureError::Simulation)?;
        Ok(Figure { file, caption, svg: draw(&panels(record, &calculated), 3)? })
    };
    [(&fit, "identification"), (&check, "verification")].into_iter().map(one).collect()
}

fn panels(record: &Record, calculated: &Output) -> [Panel; 3] {
    let dt = record.input.sample_time;
    let line = |label: &str, colour, y: Vec<f64>| {
        let points = y.into_iter().enumerate().map(|(k, y)| ((k + 1) as f64 * dt, y)).collect();
        Line::new(label, colour, points)
    };
    let held = record.input.holds.iter();
    let voltage = held.flat_map(|h| std::iter::repeat_n(h.voltage, h.samples)).collect();
    let measured = &record.measured.omega;
    let error = measured.iter().zip(&calculated.omega).map(|(m, c)| m - c).collect();
    let speeds =
        vec![line("measured", 5, measured.clone()), line("NLSE", 0, calculated.omega.clone())];
    [
        ("Voltage", "V", vec![line("", 0, voltage)]),
        ("Speed", "rad/s", speeds),
        ("Error", "rad/s", vec![line("", 3, error)]),
    ]
    .map(|(title, up, lines)| Panel {
        title: title.into(),
        across: "s",
        up,
        lines,
        equal: false,
    })
}
