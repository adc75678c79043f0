//! Figures of the first case study: the motor's voltage, its speed measured and calculated.

use super::figures::{Figure, FigureError, Line, Panel, draw};
use crate::motor::report::{Method, MotorError, run};
use crate::motor::scenario::Scenario;
use crate::motor::series::{Series, series};

#[derive(Debug, thiserror::Error)]
pub enum MotorFigureError {
    #[error(transparent)]
    Motor(#[from] MotorError),
    #[error(transparent)]
    Figure(#[from] FigureError),
}

/// One scenario, both recordings; calculated with what NLSE identified.
///
/// # Errors
/// If the scenario cannot be identified or drawn.
pub fn of_motor(scenario: &Scenario, seed: u64) -> Result<Vec<Figure>, MotorFigureError> {
    let report = run(scenario, &[Method::Nlse], seed, &|| {})?;
    let one = |s: &Series| -> Result<Figure, MotorFigureError> {
        let what = s.recording;
        let file = format!("motor_{}_{what}.svg", scenario.number);
        let caption = format!(
            "As Figs. 5 to 10: voltage, speed measured and calculated, error; scenario {}, {what}.",
            scenario.number
        );
        Ok(Figure { file, caption, svg: draw(&panels(s), 3)? })
    };
    series(scenario, &report)?.iter().map(one).collect()
}

fn panels(s: &Series) -> [Panel; 3] {
    let line = |label: &str, colour, y: Vec<f64>| {
        Line::new(label, colour, s.time.iter().copied().zip(y).collect())
    };
    let measured = &s.measured.omega;
    let mut speeds = vec![line("measured", 5, measured.clone())];
    let mut errors = Vec::new();
    for (_, calculated) in &s.calculated {
        speeds.push(line("NLSE", 0, calculated.omega.clone()));
        let error = measured.iter().zip(&calculated.omega).map(|(m, c)| m - c).collect();
        errors.push(line("", 3, error));
    }
    [
        ("Voltage", "V", vec![line("", 0, s.voltage.clone())]),
        ("Speed", "rad/s", speeds),
        ("Error", "rad/s", errors),
    ]
    .map(|(title, up, lines)| Panel {
        title: title.into(),
        across: "s",
        up,
        lines,
        equal: false,
    })
}
