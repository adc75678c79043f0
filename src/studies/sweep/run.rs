//! Blocks of cells on all cores.
//!
//! Every worker is a thread with a pool of its own and alone: what a cell does in parallel is done in
//! turn, so no cell waits for another's and a killed study loses one cell per worker.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;

use super::alone::{self, Part, Spent};
use super::store::Store;
use super::study::Study;
use crate::studies::StudyError;

/// Makes a cell in a process of its own, which puts it into the store.
pub type Alone<'a> = &'a (dyn Fn(usize) -> Result<(), StudyError> + Sync);

/// What was done and how fast.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct Ran {
    pub cells: usize,
    /// Wall clock, s.
    pub seconds: f64,
    /// Length of the simulated motion, s, and how many steps of the arm that was.
    pub simulated_seconds: f64,
    pub steps: u64,
}

impl Ran {
    fn add(&mut self, spent: &Spent) {
        self.cells += 1;
        self.simulated_seconds += spent.simulated_seconds;
        self.steps += spent.steps;
    }
}

/// Makes the cells in `blocks` on `workers` threads and keeps every one as it is done; `tick` is
/// told of each.
///
/// # Errors
/// The first cell that cannot be kept or made; the others under way are finished and kept.
pub fn run(
    study: &Study,
    store: &Store,
    blocks: &[Vec<usize>],
    workers: usize,
    process: Option<Alone<'_>>,
    tick: &(dyn Fn() + Sync),
) -> Result<Ran, StudyError> {
    let clock = Instant::now();
    let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    let (ran, wrong) = (Mutex::new(Ran::default()), Mutex::new(None));
    let work = || -> Result<(), StudyError> {
        while let Some(block) = blocks.get(next.fetch_add(1, Ordering::Relaxed)) {
            let mut bench = None;
            for &number in block {
                if stop.load(Ordering::Relaxed) {
                    return Ok(());
                }
                let spent = match process {
                    Some(process) => process(number).and_then(|()| store.spent(number))?,
                    None => {
                        let part: Part = alone::on(study, &study.cell(number), &mut bench)?;
                        store.keep(number, &part)?;
                        part.spent
                    }
                };
                if let Ok(mut ran) = ran.lock() {
                    ran.add(&spent);
                }
                tick();
            }
        }
        Ok(())
    };
    let worker = || {
        let pool = alone::pool_of_one();
        if let Err(error) = work() {
            stop.store(true, Ordering::Relaxed);
            if let Ok(mut wrong) = wrong.lock() {
                wrong.get_or_insert(error);
            }
        }
        drop(pool);
    };
    std::thread::scope(|scope| {
        for _ in 0..workers.clamp(1, blocks.len().max(1)) {
            scope.spawn(worker);
        }
    });
    if let Some(error) = wrong.into_inner().unwrap_or_default() {
        return Err(error);
    }
    let ran = ran.into_inner().unwrap_or_default();
    Ok(Ran { seconds: clock.elapsed().as_secs_f64(), ..ran })
}
