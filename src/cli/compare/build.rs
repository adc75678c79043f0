//! From a recording and a twin to the comparison of both.

use super::fit;
use super::judge::{self, Report, Value};
use super::summary;
use crate::cli::progress;
use crate::effects::{Effect, Parameter};
use crate::identification::Terms;
use crate::recording::Recording;
use crate::resimulation::{closed_loop, command};
use crate::series::JointSeries;
use crate::signals::{Conditioning, Samples, condition};
use crate::simulation::ControllerSettings;
use crate::twin::Twin;
use crate::viewer::{self, Comparison};

/// What `compare` found.
pub struct Compared {
    pub scene: Comparison,
    pub report: Report,
    /// What reading and conditioning did to the recording, in sentences.
    pub notes: Vec<String>,
}

/// Fits `terms` on the recording, predicts the torque of the recorded motion, and drives the twin
/// along the recorded command.
pub fn compare(
    recording: &Recording,
    twin: &Twin,
    terms: Option<&Terms>,
    how: &Conditioning,
) -> anyhow::Result<Compared> {
    let samples = condition(recording, &twin.drive, twin.robot.dof(), how)?;
    let fitted = terms.map_or(Vec::new(), Terms::names);
    let twin = match terms {
        Some(terms) => fit::fit(twin, terms, &samples)?,
        None => twin.clone(),
    };
    let samples = twin.correct(&samples);
    let target_q = command(recording, &samples)?;
    let controller = ControllerSettings::default();
    let bar = progress::simulating(samples.len() as f64 * samples.dt);
    let follow = target_q.as_ref().unwrap_or(&samples.q);
    let simulated = closed_loop(&twin, follow, &samples, &controller, &mut |t| {
        bar.set_position((1000.0 * t) as u64);
        true
    })?;
    bar.finish_and_clear();
    let [measured, predicted] = torques(&twin, &samples)?;
    let names: Vec<String> = twin
        .robot
        .bodies
        .iter()
        .map(|b| b.joint.name.trim_end_matches("_joint").to_string())
        .collect();
    let torque = [&measured, &predicted];
    let joints = judge::rows(&samples, &names, torque, &simulated.q, target_q.as_ref());
    let report = Report {
        schema: "armtwin.comparison/1",
        version: env!("CARGO_PKG_VERSION"),
        recording: recording.provenance.source.clone(),
        robot: twin.source.clone(),
        values: values(&twin, &fitted),
        fitted,
        followed: if target_q.is_some() { "target_q" } else { "actual_q" },
        joints,
        controller,
        conditioning: how.clone(),
    };
    let notes = notes(recording, &samples);
    let scene = Comparison {
        title: report.recording.clone(),
        time: (0..samples.len()).map(|k| k as f64 * samples.dt).collect(),
        torque: viewer::Torque { predicted: while_moving(&predicted, &samples), measured },
        recorded: viewer::Motion { q: samples.q, qd: samples.qd },
        simulated: viewer::Motion { q: simulated.q, qd: simulated.qd },
        target_q,
        summary: summary::markdown(&report, &notes),
        robot: twin.robot,
    };
    Ok(Compared { scene, report, notes })
}

fn notes(recording: &Recording, samples: &Samples) -> Vec<String> {
    let start = format!("0 s in the plots is {} s in the recording", samples.start);
    let read = recording.provenance.notes.iter().chain(&samples.notes).cloned();
    read.chain([start]).collect()
}

/// Measured torque and the twin's for the recorded motion, low-passed alike.
fn torques(twin: &Twin, samples: &Samples) -> anyhow::Result<[JointSeries; 2]> {
    let filter = samples.torque_filter()?;
    let filtered = |series: &JointSeries| {
        series.map_joints(|_, tau| {
            let mut tau = tau.to_vec();
            if let Some(filter) = &filter {
                filter.apply(&mut tau);
            }
            tau
        })
    };
    Ok([filtered(&samples.torque), filtered(&twin.torque(&twin.motion(samples)))])
}

/// NaN where a joint stands still: there friction is whatever holds the joint.
fn while_moving(torque: &JointSeries, samples: &Samples) -> JointSeries {
    let threshold = samples.conditioning.standstill_rad_s;
    torque.map_joints(|j, tau| {
        let moves = samples.qd.joint(j).iter().map(|qd| qd.abs() > threshold);
        tau.iter().zip(moves).map(|(&t, moves)| if moves { t } else { f64::NAN }).collect()
    })
}

/// The rotor inertia of the drive and the values of all effects the twin knows.
fn values(twin: &Twin, fitted: &[&str]) -> Vec<Value> {
    let rotors = Value {
        parameter: "rotor_inertia",
        unit: "kg.m2",
        fitted: fitted.contains(&"rotor_inertia"),
        values: twin.drive.rotor_inertia.clone(),
    };
    let of_effect = |effect: &'static dyn Effect| {
        let about = effect.about();
        about.parameters.iter().map(move |p| (about.name, p))
    };
    let value = |(effect, p): (&str, &Parameter)| Value {
        parameter: p.name,
        unit: p.unit,
        fitted: fitted.contains(&effect),
        values: twin.values.get(p.name).cloned().unwrap_or_default(),
    };
    std::iter::once(rotors).chain(twin.known().flat_map(of_effect).map(value)).collect()
}
