//! Trials on somebody's own recordings: known effects grafted onto recordings of a real arm.
//!
//! What an effect asks of the drive along the recorded motion is added to the recorded current or
//! torque; what sits in a sensor changes its channel. Noise, wrong masses and all that the twin
//! lacks anyway stay as they are, so an answer is worth here what it is worth on that arm. Every
//! ordered pair of recordings is a case of its own too, untouched: its answer is the base line
//! that answers to grafted pairs are held against. Effects that inverse dynamics cannot show are
//! left out, and so are those that the twin fits anyway.
//!
//! A graft is worked out by the law that explains it: this shows what real noise and a wrong twin do to
//! an answer. Whether the laws are right is for cases that rapier or others make.

mod foreign;
mod graft;
mod ground;
mod plan;
mod shape;
mod size;
mod sources;
#[cfg(test)]
mod tests;
mod write;

pub use sources::Sources;

use std::path::Path;

use rayon::prelude::*;
use serde::Serialize;

use self::ground::Ground;
use self::plan::Plan;
use self::size::Graft;
use super::{Seals, TrialError, seal};
use crate::diagnosis::Settings;
use crate::twin::Twin;

/// What to draw.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DrawOn {
    /// Cases with an effect grafted on; the untouched pairs come on top. `None`: every effect at every
    /// strength once.
    pub cases: Option<usize>,
    pub seed: u64,
    /// Gap of the effect over what the twin leaves of the untouched recording.
    pub strengths: Vec<f64>,
    /// Kinds or effects, by name; empty is all.
    pub only: Vec<String>,
    /// What the answerer is told.
    pub settings: Settings,
}

impl Default for DrawOn {
    fn default() -> Self {
        Self {
            cases: None,
            seed: 1,
            strengths: vec![0.5, 1.0, 2.0, 4.0],
            only: Vec::new(),
            settings: Settings::default(),
        }
    }
}

/// Cases planned on recordings that are ready to be grafted on. Nothing is written yet.
pub struct Planned<'a> {
    how: &'a DrawOn,
    twin: &'a Twin,
    grounds: Vec<Ground>,
    /// Effects that can be grafted.
    names: Vec<&'static str>,
    plans: Vec<Plan>,
}

/// Draws all cases into `out` in parallel and seals them. `begin` is told how many there are, `done`
/// of each.
///
/// # Errors
/// If a recording cannot be conditioned, no effect can be grafted, or a file cannot be written.
pub fn draw_on(
    how: &DrawOn,
    twin: &Twin,
    sources: &Sources,
    out: &Path,
    begin: &(dyn Fn(usize) + Sync),
    done: &(dyn Fn() + Sync),
) -> Result<Seals, TrialError> {
    let planned = Planned::new(how, twin, sources)?;
    begin(planned.plans.len());
    // All sizes before the first file: nothing is written where a graft cannot be found.
    let sized = |plan: &Plan| {
        let graft = planned.sized(plan)?;
        graft.iter().for_each(|_| done());
        Ok::<_, TrialError>(graft)
    };
    let grafts: Vec<Option<Graft>> =
        planned.plans.par_iter().map(sized).collect::<Result<_, _>>()?;
    seal::make_folder(out)?;
    planned.plans.par_iter().zip(&grafts).try_for_each(|(plan, graft)| {
        planned.write(plan, graft.as_ref(), out)?;
        if graft.is_none() {
            done();
        }
        Ok::<_, TrialError>(())
    })?;
    let grafted = grafts.iter().flatten().count();
    let made = format!(
        "`armtwin trial draw --on` {} recordings, {} untouched pairs, {grafted} with an effect \
         grafted on (seed {}), armtwin {}",
        planned.grounds.len(),
        planned.plans.len() - grafted,
        how.seed,
        env!("CARGO_PKG_VERSION")
    );
    seal::seal(out, made)
}

impl<'a> Planned<'a> {
    fn new(how: &'a DrawOn, twin: &'a Twin, sources: &Sources) -> Result<Self, TrialError> {
        let grounds = sources.grounds(twin)?;
        let names = plan::graftable(how, twin, &grounds)?;
        let plans = plan::plans(how, &names, grounds.len())?;
        Ok(Self { how, twin, grounds, names, plans })
    }

    /// Fit and check recording of a plan.
    fn pair(&self, plan: &Plan) -> [&Ground; 2] {
        plan.pair.map(|i| &self.grounds[i])
    }

    fn sized(&self, plan: &Plan) -> Result<Option<Graft>, TrialError> {
        let Some(wanted) = &plan.graft else { return Ok(None) };
        size::sized(wanted, &self.names, self.pair(plan), plan.rng(self.how.seed)).map(Some)
    }
}
