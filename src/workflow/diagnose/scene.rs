//! A diagnosis for the viewer.

use super::Diagnosed;
use crate::diagnosis::{Cause, JointTraces, words};
use crate::report::{markdown_table, to_uncertainty};
use crate::viewer::{JointMending, Mending};

impl Diagnosed {
    /// The recorded arm beside the twin as given and mended.
    pub fn scene(&self) -> Mending {
        scene(self)
    }
}

fn scene(done: &Diagnosed) -> Mending {
    let samples = &done.check.samples;
    let mended = !done.diagnosis.causes.is_empty();
    let joint = |t: &JointTraces| JointMending {
        time: t.time.clone(),
        step: done.traces.step,
        measured: t.torque.clone(),
        residual: std::iter::once(&t.before).chain(mended.then_some(&t.after)).cloned().collect(),
        reversal: t.held("reversal").map_or(Vec::new(), <[bool]>::to_vec),
        contact: t.contact.clone(),
    };
    Mending {
        title: done.check.provenance.source.clone(),
        robot: done.twin.robot.clone(),
        time: (0..samples.len()).map(|k| samples.time(k)).collect(),
        recorded: samples.q.clone(),
        simulated: done.simulated.clone(),
        joints: done.traces.joints.iter().map(joint).collect(),
        summary: summary(done),
    }
}

/// Markdown: the answer, the accepted effects, the gap per joint, what it was made from.
fn summary(done: &Diagnosed) -> String {
    let d = &done.diagnosis;
    let mut text = format!("{}\n", words::sentence(d));
    d.causes.iter().for_each(|c| text += &cause(c));
    let after = |joint: usize| d.shrink.torque.joints.iter().find(|j| j.joint == joint);
    let rows: Vec<Vec<String>> = d
        .gap
        .joints
        .iter()
        .map(|j| {
            vec![
                j.joint.to_string(),
                format!("{:.3}", j.rms_nm),
                after(j.joint).map_or("-".into(), |a| format!("{:.3}", a.after_nm)),
                format!("{:.3}", j.noise_floor_nm),
            ]
        })
        .collect();
    let header = ["joint", "as given / N.m", "mended / N.m", "noise / N.m"];
    text += &format!("\n## Gap\n\n{}", markdown_table(&header, 1, &rows));
    text += "\nRecorded torque less the twin's, rms where the joint slides. In the plots of \
             residuals the thick line at zero marks the moments after a reversal, and contacts.\n";
    text += "\n## Made from\n\n";
    for (what, said) in done.facts() {
        text += &format!("- {what} {said}\n");
    }
    text
}

fn cause(c: &Cause) -> String {
    let rows: Vec<Vec<String>> = c
        .read()
        .into_iter()
        .map(|v| {
            let [value, low, high] = to_uncertainty(v.value, v.low, v.high);
            vec![words::parameter(v), v.unit.clone(), value, format!("{low} .. {high}")]
        })
        .collect();
    format!(
        "\n## {} at {} ({})\n\n{}\n\n{}\n",
        c.effect,
        words::place(&c.joints),
        words::percent(c.probability),
        c.cause,
        markdown_table(&["parameter", "unit", "value", "90 %"], 2, &rows)
    )
}
