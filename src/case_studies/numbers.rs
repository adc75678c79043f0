//! What the page shows, for programs.

use std::collections::BTreeMap;

use serde::Serialize;

use super::boxes::Boxed;
use super::figures::Figure;
use super::motor::Results;
use super::page::Page;
use super::ur5::{Dropped, Study};
use super::versus::Duel;
use crate::identification::{LEVEL, MethodResult};
use crate::motor::report::ScenarioReport;
use crate::motor::study::Study as MotorStudy;

#[derive(Serialize)]
pub struct Numbers<'a> {
    /// How they were made.
    command: &'a str,
    /// Confidence level of the intervals.
    level: f64,
    /// True values of the synthetic recording, base to wrist.
    injected: &'a BTreeMap<&'static str, Vec<f64>>,
    studies: Vec<Estimates<'a>>,
    duels: Vec<Law<'a>>,
    /// Duels on the synthetic recording, with bounds around the truth.
    boxes: Vec<Boxes<'a>>,
    motor: Option<Motor<'a>>,
    /// Files, seen from the page.
    figures: Vec<String>,
}

#[derive(Serialize)]
struct Estimates<'a> {
    name: &'a str,
    fit: &'a str,
    check: &'a str,
    /// Results of each method with all terms.
    methods: &'a [MethodResult],
    /// Result without the dropped terms.
    reduced: &'a MethodResult,
    dropped: &'a [Dropped],
}

#[derive(Serialize)]
struct Law<'a> {
    law: &'a str,
    joints: &'a [Duel],
}

#[derive(Serialize)]
struct Boxes<'a> {
    law: &'a str,
    /// Duels by width of the bounds.
    widths: &'a [Boxed],
}

/// Motor scenarios and studies as in `armtwin motor --json`.
#[derive(Serialize)]
struct Motor<'a> {
    scenarios: &'a [ScenarioReport],
    studies: &'a [MotorStudy],
}

impl Page<'_> {
    pub fn numbers(&self) -> Numbers<'_> {
        Numbers {
            command: &self.command,
            level: LEVEL,
            injected: &self.injected,
            studies: std::iter::once(self.synthetic).chain(self.real).map(estimates).collect(),
            duels: self.duels.iter().map(|(law, joints)| Law { law, joints }).collect(),
            boxes: self.boxed.iter().map(|(law, widths)| Boxes { law, widths }).collect(),
            motor: self.motor.as_ref().map(motor),
            figures: self.figures.iter().map(Figure::file).collect(),
        }
    }
}

fn estimates(study: &Study) -> Estimates<'_> {
    Estimates {
        name: study.name,
        fit: &study.fit.source,
        check: &study.check.source,
        methods: &study.results,
        reduced: &study.reduced,
        dropped: &study.dropped,
    }
}

fn motor(results: &Results) -> Motor<'_> {
    Motor { scenarios: &results.reports, studies: &results.studies }
}
