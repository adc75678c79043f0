//! From a recording and a twin to the comparison of both.

use super::fit;
use super::judge::{self, Report, Value};
use super::summary;
use crate::cli::progress;
use crate::cli::stream::Link;
use crate::effects::{Effect, Parameter, of_drive};
use crate::identification::Terms;
use crate::recording::Recording;
use crate::resimulation::{closed_loop, command};
use crate::series::JointSeries;
use crate::signals::{Conditioning, Samples, condition};
use crate::simulation::ControllerSettings;
use crate::twin::Twin;
use crate::viewer::live::{Comparing, Delivery};
use crate::viewer::{self, Comparison};

/// What `compare` found.
pub struct Compared {
    pub scene: Comparison,
    pub report: Report,
    /// What reading and conditioning did to the recording, in sentences.
    pub notes: Vec<String>,
    /// On its way to a viewer.
    pub sent: Option<Delivery>,
}

/// Fits `terms` on the recording, predicts the torque of the recorded motion, and drives the twin
/// along the recorded command; shown through `link` meanwhile.
pub fn compare(
    recording: &Recording,
    twin: &Twin,
    terms: Option<&Terms>,
    how: &Conditioning,
    link: Option<&Link>,
) -> anyhow::Result<Compared> {
    let samples = condition(recording, &twin.drive, twin.robot.dof(), how)?;
    let fitted = terms.map_or(Vec::new(), Terms::names);
    let twin = match terms {
        Some(terms) => fit::fit(twin, terms, &samples)?,
        None => twin.clone(),
    };
    let samples = twin.correct(&samples);
    let mut scene = recorded(recording, &twin, &samples)?;
    let mut shown = link.map(|link| Comparing::begin(&link.address, scene.clone())).transpose()?;
    let controller = ControllerSettings::default();
    let bar = progress::simulating(samples.len() as f64 * samples.dt);
    let follow = scene.target_q.as_ref().unwrap_or(&samples.q);
    let simulated = closed_loop(&twin, follow, &samples, &controller, &mut |now| {
        bar.set_position((1000.0 * now.time_s) as u64);
        if let Some(shown) = &mut shown {
            shown.add(now.time_s, now.q);
        }
        true
    })?;
    bar.finish_and_clear();
    scene.simulated = viewer::Motion { q: simulated.q, qd: simulated.qd };
    let report = Report {
        schema: "armtwin.comparison/1",
        version: env!("CARGO_PKG_VERSION"),
        recording: recording.provenance.source.clone(),
        robot: twin.source.clone(),
        values: values(&twin, &fitted),
        fitted,
        followed: if scene.target_q.is_some() { "target_q" } else { "actual_q" },
        joints: judge::rows(&samples, &scene),
        controller,
        conditioning: how.clone(),
    };
    let notes = notes(recording, &samples);
    scene.summary = summary::markdown(&report, &notes);
    let sent = shown.map(|shown| shown.end(&scene));
    Ok(Compared { scene, report, notes, sent })
}

/// All that can be shown before the twin is simulated.
fn recorded(recording: &Recording, twin: &Twin, samples: &Samples) -> anyhow::Result<Comparison> {
    let [measured, predicted] = torques(twin, samples)?;
    let unknown = JointSeries::zeros(twin.robot.dof(), samples.len());
    Ok(Comparison {
        title: recording.provenance.source.clone(),
        time: (0..samples.len()).map(|k| k as f64 * samples.dt).collect(),
        torque: viewer::Torque { predicted: while_moving(&predicted, samples), measured },
        recorded: viewer::Motion { q: samples.q.clone(), qd: samples.qd.clone() },
        simulated: viewer::Motion { q: unknown.clone(), qd: unknown },
        target_q: command(recording, samples)?,
        summary: String::new(),
        robot: twin.robot.clone(),
    })
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
        let moves = samples.qd.joint(j).iter().map(|v| threshold <= 0.0 || v.abs() > threshold);
        tau.iter().zip(moves).map(|(&t, moves)| if moves { t } else { f64::NAN }).collect()
    })
}

/// What the drive holds of effects, and the values of all effects the twin knows.
fn values(twin: &Twin, fitted: &[&str]) -> Vec<Value> {
    let of_drive = of_drive().map(|(effect, part, _)| Value {
        parameter: effect.about().parameters[0].name,
        unit: effect.about().parameters[0].unit,
        fitted: fitted.contains(&effect.about().name),
        values: twin.drive.part(part).clone(),
    });
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
    of_drive.chain(twin.known().flat_map(of_effect).map(value)).collect()
}
