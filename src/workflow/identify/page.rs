//! An identification as a report with pictures.

use super::{Identified, Used, words};
use crate::effects::{Scope, find};
use crate::identification;
use crate::report::Fact;
use crate::report::html::{IdentificationReport, JointCurves, identification_report};
use crate::signals::Samples;
use crate::twin::Twin;
use crate::workflow::WorkflowError;

impl Identified {
    /// One HTML file for any browser.
    ///
    /// # Errors
    /// If the twin with the values found cannot be made.
    pub fn html(&self) -> Result<String, WorkflowError> {
        let twin = self.fitted()?.map(|(twin, _)| twin);
        let judged = &self.check.as_ref().unwrap_or(&self.fit).samples;
        let joints = twin.as_ref().map(|twin| curves(twin, judged)).transpose()?;
        // Plain tables of numbers, strings and lists: nothing JSON or TOML cannot hold.
        let settings = serde_json::to_string_pretty(&self.settings).unwrap_or_default();
        let conditioning = toml::to_string(&self.conditioning).unwrap_or_default();
        let mut files = vec![
            ("Settings of the search", settings),
            ("Conditioning of the recordings", conditioning),
            ("The twin as given", self.twin.to_toml()),
        ];
        files.extend(twin.map(|twin| ("The twin with what was found", twin.to_toml())));
        Ok(identification_report(&IdentificationReport {
            results: &self.results,
            joints: &joints.unwrap_or_default(),
            found: &found(self),
            dropped: &self.dropped.as_deref().map_or(Vec::new(), words::dropped),
            facts: &facts(self),
            files: &files,
        }))
    }
}

fn found(done: &Identified) -> Vec<String> {
    let joints = done.results.last().map_or(Vec::new(), identification::verdict);
    let scale = done.scaled.as_ref().map_or(Vec::new(), words::torque_constants);
    let body = done.rigid_body.as_ref().map_or(Vec::new(), words::links);
    joints.into_iter().chain(scale).chain(body).collect()
}

/// What the joints need beyond what moves the masses: as recorded, and as the twin has it.
fn curves(twin: &Twin, samples: &Samples) -> Result<Vec<JointCurves>, WorkflowError> {
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

fn facts(done: &Identified) -> Vec<Fact> {
    let mut facts = vec![("robot".to_string(), done.twin.source.clone())];
    let source = |what: &str, used: &Used| -> Vec<Fact> {
        let from = &used.provenance;
        let notes = from.notes.iter().chain(&used.samples.notes);
        std::iter::once((what.to_string(), format!("{} ({})", from.source, from.format)))
            .chain(notes.map(|note| (String::new(), note.clone())))
            .collect()
    };
    facts.extend(source("fit", &done.fit));
    facts.extend(done.check.iter().flat_map(|c| source("check", c)));
    facts.push(("fitted".into(), done.terms.names().join(", ")));
    facts.push(("signals".into(), words::signals(done)));
    facts.push(("seed".into(), done.settings.seed.to_string()));
    facts.push(("armtwin".into(), env!("CARGO_PKG_VERSION").into()));
    facts
}
