//! `identify --json`: the contract's fields, and everything that led to them.

use serde::Serialize;

use super::{Identified, Summary, Used};
use crate::identification::{self, Dropped, Located, MethodResult, Settings, TorqueScale};
use crate::signals::Conditioning;
use crate::workflow::Source;

/// Document of the schema `armtwin.identification/1`.
#[derive(Serialize)]
pub struct IdentificationDocument<'a> {
    schema: &'static str,
    version: &'static str,
    recording: Source<'a>,
    check: Option<Source<'a>>,
    twin: TwinFacts<'a>,
    /// Effects that were fitted.
    terms: Vec<&'static str>,
    seed: u64,
    level: f64,
    settings: &'a Settings,
    conditioning: &'a Conditioning,
    /// Nonlinear parameters that were searched for, by effect and joint.
    searched: Vec<Searched>,
    /// Terms taken out by `reduce`; null without it.
    dropped: Option<&'a [Dropped]>,
    methods: &'a [MethodResult],
    verdict: Vec<String>,
    /// The drives' gains by a known load; null without one.
    torque_scale: Option<&'a TorqueScale>,
    /// With a payload: how far links may be from the model's, as a share of a mass.
    links_spread: Option<f64>,
    /// The rigid body; null without `inertia`.
    inertia: Option<&'a Summary>,
}

#[derive(Serialize)]
struct Searched {
    effect: &'static str,
    /// From 1 at the base.
    joint: usize,
    /// Empty where the effect does not show.
    parameters: Vec<&'static str>,
    starts: usize,
}

#[derive(Serialize)]
struct TwinFacts<'a> {
    robot: &'a str,
    drive: &'a crate::robot::Drive,
    effects: &'a [String],
    values: &'a std::collections::BTreeMap<String, Vec<f64>>,
}

fn searched(l: &Located) -> Searched {
    let (effect, joint) = (l.effect.about().name, l.joint + 1);
    Searched { effect, joint, parameters: l.searched(), starts: l.starts }
}

impl Used {
    fn source(&self) -> Source<'_> {
        Source::of(&self.provenance, &self.samples)
    }
}

impl Identified {
    /// What `identify --json` writes.
    pub fn document(&self) -> IdentificationDocument<'_> {
        IdentificationDocument {
            schema: "armtwin.identification/1",
            version: env!("CARGO_PKG_VERSION"),
            recording: self.fit.source(),
            check: self.check.as_ref().map(Used::source),
            twin: TwinFacts {
                robot: &self.twin.source,
                drive: &self.twin.drive,
                effects: &self.twin.effects,
                values: &self.twin.values,
            },
            terms: self.terms.names(),
            seed: self.settings.seed,
            level: identification::LEVEL,
            settings: &self.settings,
            conditioning: &self.conditioning,
            searched: self.located.iter().map(searched).collect(),
            dropped: self.dropped.as_deref(),
            methods: &self.results,
            verdict: self.results.last().map(identification::verdict).unwrap_or_default(),
            torque_scale: self.scaled.as_ref().map(|s| &s.scale),
            links_spread: self.links_spread,
            inertia: self.rigid_body.as_ref(),
        }
    }
}
