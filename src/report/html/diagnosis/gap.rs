//! The gap by joint and by regime, as numbers.

use maud::{Markup, html};

use super::super::table::table;
use crate::diagnosis::{Diagnosis, JointGap, JointTraces, Regime, Traces, words};
use crate::report::diagnosis as rows;

pub fn tables(d: &Diagnosis, traces: &Traces) -> Markup {
    html! {
        (table(&rows::GAP, 1, d.gap.joints.iter().map(rows::gap)))
        p.legend {
            "Recorded torque less the twin's on the check recording, root mean square where the joint "
            "slides; what the twin leaves open is fitted first."
        }
        @for joint in &d.gap.joints {
            details open[joint.share > 0.3] {
                summary { "Joint " (joint.joint) " by kind of motion" }
                (regimes(joint, traces.joints.iter().find(|t| t.joint == joint.joint)))
            }
        }
    }
}

fn regimes(joint: &JointGap, traces: Option<&JointTraces>) -> Markup {
    let row = |r: &Regime| {
        let after = traces.and_then(|t| left(t, &r.regime));
        vec![
            r.regime.replace('_', " "),
            format!("{:.3}", r.rms_nm),
            format!("{:.3}", r.low_nm),
            format!("{:.3}", r.high_nm),
            after.map_or("-".into(), |nm| format!("{nm:.3}")),
            format!("{:.3}", r.noise_floor_nm),
            words::percent(r.time_fraction),
        ]
    };
    let header = [
        "kind of motion",
        "before N.m",
        "90 % low",
        "high",
        "after N.m",
        "noise floor N.m",
        "of the time",
    ];
    table(&header, 1, joint.regimes.iter().map(row))
}

/// Root mean square of what the causes leave where a regime holds, N.m.
fn left(traces: &JointTraces, regime: &str) -> Option<f64> {
    let held = traces.held(regime)?.iter().zip(&traces.after).filter(|(held, _)| **held);
    let (sum, count) = held.fold((0.0, 0usize), |(sum, n), (_, r)| (sum + r * r, n + 1));
    (count > 0).then(|| (sum / count as f64).sqrt())
}
