//! What is found in recordings of real arms, beside what is known of them.

mod cases;
mod tables;

use std::path::Path;

use indicatif::ProgressBar;
use serde::Serialize;

use self::cases::{Case, FLANGE, NAMED, PLAIN, Setup, UNTOUCHED};
use super::super::save;
use super::arm::{Arm, conditioning};
use super::sensor::{Push, pushes};
use crate::external_wrench::{Contact, Criteria};

/// All that stands on the page.
#[derive(Serialize)]
struct Measured {
    criteria: Criteria,
    pushes: Vec<Push>,
    /// In the recording with the sensor: any link may be touched, the flange alone, the same with
    /// the torque scale of the arm's own controller.
    sensed: [Vec<Contact>; 3],
    named: Vec<Found>,
    untouched: Vec<Found>,
}

/// Contacts in a recording, its time counted from its start.
#[derive(Serialize)]
struct Found {
    recording: String,
    fit: String,
    seconds: f64,
    /// Intervals that are known, s.
    known: Vec<[f64; 2]>,
    contacts: Vec<Contact>,
}

pub fn run(folder: &Path, out: Option<&Path>, json: Option<&Path>) -> anyhow::Result<()> {
    let bar = ProgressBar::new_spinner();
    bar.enable_steady_tick(std::time::Duration::from_millis(100));
    let measured = measured(folder, &|what| bar.set_message(what.to_string()))?;
    bar.finish_and_clear();
    save::page(out, &tables::page(&measured))?;
    if let Some(path) = json {
        save::json(path, "armtwin.contacts-validation/1", &measured)?;
    }
    Ok(())
}

fn measured(folder: &Path, tell: &dyn Fn(&str)) -> anyhow::Result<Measured> {
    let ways = [(PLAIN, false), (PLAIN, true), (FLANGE, true)];
    let mut sensed = Vec::new();
    for (case, at_flange) in ways {
        let criteria = Criteria { at_flange, ..Criteria::default() };
        sensed.push(found(folder, &case, &criteria, tell)?.contacts);
    }
    let all = |cases: &[Case]| -> anyhow::Result<Vec<Found>> {
        cases.iter().map(|case| found(folder, case, &Criteria::default(), tell)).collect()
    };
    let log = cases::path(folder, &PLAIN.setup, PLAIN.recording).join("log_force_sensor.csv.gz");
    Ok(Measured {
        criteria: Criteria::default(),
        pushes: pushes(&log)?,
        sensed: sensed.try_into().unwrap_or_default(),
        named: all(NAMED)?,
        untouched: all(&[UNTOUCHED.to_vec(), cases::unloaded()].concat())?,
    })
}

fn found(
    folder: &Path,
    case: &Case,
    criteria: &Criteria,
    tell: &dyn Fn(&str),
) -> anyhow::Result<Found> {
    tell(&format!("{} against {}", case.recording, case.fit));
    let Setup { with, .. } = &case.setup;
    let twin = cases::twin(&case.setup)?;
    let with: Vec<String> = with.iter().map(ToString::to_string).collect();
    let source = |name| cases::source(folder, &case.setup, name);
    let (recording, fit) = (source(case.recording)?, source(case.fit)?);
    let arm = Arm::fitted(&twin, &fit, &with, &conditioning(), &())?;
    let (samples, _) = arm.left(&recording)?;
    let mut contacts = arm.contacts(&recording, &[fit], criteria, &())?;
    contacts.iter_mut().for_each(|c| c.shift(-samples.start));
    Ok(Found {
        recording: case.recording.into(),
        fit: case.fit.into(),
        seconds: samples.len() as f64 * samples.dt,
        known: case.known.to_vec(),
        contacts,
    })
}
