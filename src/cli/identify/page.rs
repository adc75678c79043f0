//! An identification as a report with pictures.

use std::path::Path;

use super::{Loaded, Report, fitted, links, print, scale};
use crate::cli::save;
use crate::effects::{Scope, find};
use crate::identification;
use crate::report::html::{Fact, IdentificationReport, JointCurves, identification_report};
use crate::signals::Samples;
use crate::twin::Twin;

pub fn write(report: &Report<'_>, path: &Path) -> anyhow::Result<()> {
    let twin = fitted(report)?.map(|(twin, _)| twin);
    let judged = &report.check.unwrap_or(report.fit).samples;
    let joints = twin.as_ref().map(|twin| curves(twin, judged)).transpose()?;
    let mut files = vec![
        ("Settings of the search", serde_json::to_string_pretty(report.settings)?),
        ("Conditioning of the recordings", toml::to_string(report.conditioning)?),
        ("The twin as given", report.twin.to_toml()),
    ];
    files.extend(twin.map(|twin| ("The twin with what was found", twin.to_toml())));
    let html = identification_report(&IdentificationReport {
        results: report.results,
        joints: &joints.unwrap_or_default(),
        found: &found(report),
        dropped: &report.dropped.map_or(Vec::new(), print::dropped),
        facts: &facts(report),
        files: &files,
    });
    save::text(path, &html)
}

fn found(report: &Report<'_>) -> Vec<String> {
    let joints = report.results.last().map_or(Vec::new(), identification::verdict);
    let scale = report.scaled.map_or(Vec::new(), scale::lines);
    let body = report.rigid_body.map_or(Vec::new(), links::lines);
    joints.into_iter().chain(scale).chain(body).collect()
}

/// What the joints need beyond what moves the masses: as recorded, and as the twin has it.
fn curves(twin: &Twin, samples: &Samples) -> anyhow::Result<Vec<JointCurves>> {
    let samples = &twin.correct(samples);
    let filter = samples.torque_filter()?;
    let heavy = |name: &String| find(name).is_some_and(|e| e.about().scope != Scope::Joint);
    let mut bare = twin.clone();
    bare.effects.retain(heavy);
    let motion = twin.motion(samples);
    let time: Vec<f64> = (0..samples.len()).map(|k| samples.time(k)).collect();
    let (whole, masses) = (twin.torque(&motion), bare.torque(&motion));
    let joint = |j: usize| {
        let rows = samples.rows(j);
        let filtered = |mut all: Vec<f64>| -> Vec<f64> {
            if let Some(filter) = &filter {
                filter.apply(&mut all);
            }
            rows.take(&all)
        };
        let less = |a: &[f64]| -> Vec<f64> {
            filtered(a.iter().zip(masses.joint(j)).map(|(a, m)| a - m).collect())
        };
        JointCurves {
            joint: j + 1,
            time: rows.take(&time),
            step: samples.decimation() as f64 * samples.dt,
            position: rows.take(samples.q.joint(j)),
            velocity: rows.take(samples.qd.joint(j)),
            masses: filtered(masses.joint(j).to_vec()),
            measured: less(samples.torque.joint(j)),
            fitted: less(whole.joint(j)),
        }
    };
    Ok((0..samples.joints()).map(joint).filter(|c| !c.velocity.is_empty()).collect())
}

fn facts(report: &Report<'_>) -> Vec<Fact> {
    let mut facts = vec![("robot".to_string(), report.twin.source.clone())];
    let source = |what: &str, loaded: &Loaded| -> Vec<Fact> {
        let from = &loaded.recording.provenance;
        let notes = from.notes.iter().chain(&loaded.samples.notes);
        std::iter::once((what.to_string(), format!("{} ({})", from.source, from.format)))
            .chain(notes.map(|note| (String::new(), note.clone())))
            .collect()
    };
    facts.extend(source("fit", report.fit));
    facts.extend(report.check.iter().flat_map(|c| source("check", c)));
    facts.push(("fitted".into(), report.terms.names().join(", ")));
    facts.push(("signals".into(), print::signals(report)));
    facts.push(("seed".into(), report.settings.seed.to_string()));
    facts.push(("armtwin".into(), env!("CARGO_PKG_VERSION").into()));
    facts
}
