//! One cell: its rows, and what they cost.

use serde::{Deserialize, Serialize};

use super::grid::{Cell, System};
use super::stopwatch::Stopwatch;
use super::study::{Question, Study};
use super::table::{Row, Table, Value};
use super::{arm, cost, diagnosis, identification, motor};
use crate::studies::StudyError;

/// What a cell came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    pub table: Table,
    pub spent: Spent,
}

/// Time and memory spent on one cell; they depend on the machine.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Spent {
    /// Processor time for the cell's own work (wall clock where the system does not tell), s.
    pub seconds: f64,
    /// Time for the motion it shares with others of its block, if it was the first to need it, s.
    pub simulating_seconds: f64,
    /// Length of that motion, s, and steps of the arm in it.
    pub simulated_seconds: f64,
    pub steps: u64,
    /// Largest resident set of a process that ran this cell alone; 0: not measured.
    pub peak_bytes: u64,
}

/// A motion that the cells of a block share.
pub(super) enum Bench {
    Arm(Box<arm::Bench>),
    Motor(Box<motor::Bench>),
}

/// The `number`-th cell of `study`.
///
/// # Errors
/// Only if its rows do not make a table: what fails in a cell is a result.
pub fn cell(study: &Study, number: usize) -> Result<Part, StudyError> {
    let pool = pool_of_one();
    let part = on(study, &study.cell(number), &mut None);
    drop(pool);
    part
}

/// This thread becomes a pool of its own: what a cell does in parallel is done in turn, and here.
/// Without it the thread would share the program's pool: slower, not wrong.
pub(super) fn pool_of_one() -> Option<rayon::ThreadPool> {
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().ok()
}

/// A cell on its block's bench, which is made by the first to need it.
pub(super) fn on(
    study: &Study,
    cell: &Cell,
    bench: &mut Option<Bench>,
) -> Result<Part, StudyError> {
    let mut spent = Spent::default();
    let outcome = match bench {
        Some(_) => Ok(()),
        None => made(study, cell).map(|new| {
            spent = new.1;
            *bench = Some(new.0);
        }),
    };
    let clock = Stopwatch::start();
    let rows = outcome.and_then(|()| match (study.question, bench.as_ref()) {
        (Question::Identification, Some(Bench::Arm(b))) => identification::arm(study, cell, b),
        (Question::Identification, Some(Bench::Motor(b))) => motor::rows(study, cell, b),
        (Question::Diagnosis, Some(Bench::Arm(b))) => diagnosis::rows(study, cell, b),
        (Question::Cost, Some(Bench::Arm(b))) => cost::rows(study, cell, b),
        _ => Err(StudyError::Table("the motor answers no such question".into())),
    });
    spent.seconds = clock.seconds();
    let (rows, failed) = match rows {
        Ok(rows) => (rows, String::new()),
        Err(error) => (vec![nothing(study.question)], error.to_string()),
    };
    let rows: Vec<Row> = rows.into_iter().map(|row| whole(cell, &failed, row)).collect();
    Ok(Part { table: Table::of(&rows)?, spent })
}

fn made(study: &Study, cell: &Cell) -> Result<(Bench, Spent), StudyError> {
    let clock = Stopwatch::start();
    let (bench, simulated_seconds, steps) = match cell.system {
        System::Arm => {
            let bench = arm::Bench::new(study, cell)?;
            let (seconds, steps) = (bench.simulated_s, bench.steps);
            (Bench::Arm(Box::new(bench)), seconds, steps)
        }
        System::Motor => {
            let bench = motor::Bench::new(study, cell)?;
            let seconds = bench.scenario.identification.duration;
            (Bench::Motor(Box::new(bench)), seconds, 0)
        }
    };
    let simulating_seconds = clock.seconds();
    Ok((bench, Spent { simulating_seconds, simulated_seconds, steps, ..Spent::default() }))
}

fn nothing(question: Question) -> Row {
    match question {
        Question::Identification => identification::Found::default().row(),
        Question::Diagnosis => diagnosis::Named::default().row(),
        Question::Cost => cost::Work::default().row(),
    }
}

/// A row with where it belongs before it.
fn whole(cell: &Cell, failed: &str, row: Row) -> Row {
    let trajectory = cell.trajectory.and_then(|k| serde_json::to_value(k).ok());
    let trajectory = trajectory.as_ref().and_then(|v| v.as_str()).unwrap_or_default().to_string();
    let number = |x: Option<f64>| Value::Number(x.unwrap_or(f64::NAN));
    let whole = |n: Option<usize>| Value::Whole(n.unwrap_or(0) as u64);
    let place: Row = vec![
        ("cell", cell.number.into()),
        ("system", cell.system.name().into()),
        ("effect", cell.effect.as_deref().unwrap_or_default().into()),
        ("strength", cell.strength.into()),
        ("trajectory", Value::Text(trajectory)),
        ("duration_s", number(cell.duration_s)),
        ("rate_hz", number(cell.rate_hz)),
        ("joints", whole(cell.joints)),
        ("terms", whole(cell.terms)),
        ("seed", Value::Whole(cell.seed)),
        ("quantisation", cell.quantisation.into()),
        ("snr_db", number(cell.snr_db.map(super::Snr::db))),
        ("method", cell.method.name().into()),
        ("particles", whole(cell.particles)),
        ("failed", failed.into()),
    ];
    place.into_iter().chain(row).collect()
}
