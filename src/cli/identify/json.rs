//! `identify --json`: the contract's fields, and everything that led to them.

use std::path::Path;

use serde::Serialize;

use super::Report;
use super::inertia::Summary;
use crate::cli::save;
use crate::identification::{self, Dropped, Located, MethodResult, Settings, TorqueScale};
use crate::recording::Provenance;
use crate::signals::Conditioning;

#[derive(Serialize)]
struct Document<'a> {
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
    /// Terms taken out by `--reduce`; null without it.
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
struct Source<'a> {
    #[serde(flatten)]
    provenance: &'a Provenance,
    signals: &'a [String],
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

pub fn write(report: &Report<'_>, path: &Path) -> anyhow::Result<()> {
    let source = |l: &super::Loaded| -> (Provenance, Vec<String>) {
        (l.recording.provenance.clone(), l.samples.notes.clone())
    };
    let fit = source(report.fit);
    let check = report.check.map(source);
    let document = Document {
        schema: "armtwin.identification/1",
        version: env!("CARGO_PKG_VERSION"),
        recording: Source { provenance: &fit.0, signals: &fit.1 },
        check: check.as_ref().map(|c| Source { provenance: &c.0, signals: &c.1 }),
        twin: TwinFacts {
            robot: &report.twin.source,
            drive: &report.twin.drive,
            effects: &report.twin.effects,
            values: &report.twin.values,
        },
        terms: report.terms.names(),
        seed: report.settings.seed,
        level: identification::LEVEL,
        settings: report.settings,
        conditioning: report.conditioning,
        searched: report.located.iter().map(searched).collect(),
        dropped: report.dropped,
        methods: report.results,
        verdict: report.results.last().map(identification::verdict).unwrap_or_default(),
        torque_scale: report.scaled.map(|s| &s.scale),
        links_spread: report.links_spread,
        inertia: report.rigid_body,
    };
    save::document(path, &document)
}
