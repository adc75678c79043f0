//! Files of a diagnosis.

use std::path::Path;

use anyhow::Context;
use serde::Serialize;

use super::Diagnosed;
use super::page::facts;
use crate::cli::save;
use crate::diagnosis::{Diagnosis, Settings, words};
use crate::recording::Provenance;
use crate::report::html::{DiagnosisReport, diagnosis_report};
use crate::signals::Conditioning;

/// `diagnosis.json`: the diagnosis, and everything that led to it.
#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    diagnosis: &'a Diagnosis,
    /// In one sentence.
    says: String,
    seed: u64,
    settings: &'a Settings,
    conditioning: &'a Conditioning,
    fit: Source<'a>,
    check: Source<'a>,
    twin: String,
    mended_twin: String,
    seconds: f64,
}

#[derive(Serialize)]
struct Source<'a> {
    #[serde(flatten)]
    provenance: &'a Provenance,
    signals: &'a [String],
}

/// What was written into `out`, and how to look at it.
pub fn written(out: &Path) -> String {
    let at = |file: &str| out.join(file).display().to_string();
    let rrd = match cfg!(feature = "viewer") {
        true => format!("rerun {}", at("twin.rrd")),
        false => "twin.rrd is not written: this armtwin was built without the viewer".into(),
    };
    format!(
        "{}: what is above, for programs\n{}: with pictures, for any browser\n{}: the mended \
         twin\n{rrd}",
        at("diagnosis.json"),
        at("report.html"),
        at("twin.toml")
    )
}

/// What [`write`] makes.
pub const FILES: [&str; 4] = ["diagnosis.json", "report.html", "twin.rrd", "twin.toml"];

/// Into the folder `out`, which is made if need be.
pub fn write(done: &Diagnosed, out: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(out).with_context(|| format!("cannot make {}", out.display()))?;
    json(done, &out.join("diagnosis.json"))?;
    save::text(&out.join("report.html"), &report(done)?)?;
    #[cfg(feature = "viewer")]
    crate::viewer::write_rrd(&super::scene::scene(done), &out.join("twin.rrd"))?;
    Ok(done.mended.save(&out.join("twin.toml"))?)
}

fn report(done: &Diagnosed) -> anyhow::Result<String> {
    let settings = toml::to_string(&done.settings)?;
    let conditioning = toml::to_string(&done.fit.samples.conditioning)?;
    let mut facts = facts(done);
    facts.push(("seed".into(), done.settings.seed.to_string()));
    facts.push(("armtwin".into(), format!("{}, {:.1} s", done.diagnosis.armtwin, done.seconds)));
    Ok(diagnosis_report(&DiagnosisReport {
        diagnosis: &done.diagnosis,
        traces: &done.traces,
        facts: &facts,
        files: &[
            ("The mended twin (twin.toml)", done.mended.to_toml()),
            ("The twin as given", done.twin.to_toml()),
            ("Settings of the search", settings),
            ("Conditioning of the recordings", conditioning),
        ],
    }))
}

pub fn json(done: &Diagnosed, path: &Path) -> anyhow::Result<()> {
    let source = |r: &super::load::Recorded| -> (Provenance, Vec<String>) {
        (r.recording.provenance.clone(), r.samples.notes.clone())
    };
    let (fit, check) = (source(&done.fit), source(&done.check));
    let document = Document {
        diagnosis: &done.diagnosis,
        says: words::sentence(&done.diagnosis),
        seed: done.settings.seed,
        settings: &done.settings,
        conditioning: &done.fit.samples.conditioning,
        fit: Source { provenance: &fit.0, signals: &fit.1 },
        check: Source { provenance: &check.0, signals: &check.1 },
        twin: done.twin.to_toml(),
        mended_twin: done.mended.to_toml(),
        seconds: done.seconds,
    };
    save::document(path, &document)
}
