//! A recording with fewer rows than were recorded: low-passed before rows are left out.

use super::{Decimator, LowPass};
use crate::recording::inspection::step;
use crate::recording::{Channel, JOINT_SIGNALS, Provenance, Recording};

/// Rate from which on rows are left out down to it: six times the 20 Hz up to which motion is followed, and
/// the rate of the controllers on whose recordings all of this was measured.
pub const USUAL_HZ: f64 = 125.0;
/// Longer recordings are thinned further, ...
const MOST_ROWS: usize = 300_000;
/// ... but not below what a low-pass at 20 Hz needs.
const SLOWEST_HZ: f64 = 50.0;
/// Cutoff over the rate that is kept. What folds back from beyond half the rate onto frequencies up to
/// a sixth of it passes two fourth-order low-passes by less than 1/300.
const CUTOFF: f64 = 0.4;
const ORDER: usize = 4;
/// Steps that are longer than this many usual ones are gaps, which no filter runs across.
const GAP: f64 = 5.0;
/// Rates are measured: one that is this much short of a multiple counts as it.
const SLACK: f64 = 0.02;

/// The recording with one row in n, a note says which; `None` where all rows are worth keeping.
/// `floor_hz` is the least rate that whoever asks can do with.
pub fn thin(recording: &Recording, floor_hz: f64) -> Option<Recording> {
    let rows = recording.time.len();
    let usual = step(&recording.time);
    let rate = 1.0 / usual;
    let times = |hz: f64| ((1.0 + SLACK) * rate / hz.max(floor_hz)).floor().max(1.0) as usize;
    let n = times(USUAL_HZ).max(rows.div_ceil(MOST_ROWS).min(times(SLOWEST_HZ)));
    if n < 2 {
        return None;
    }
    let kept = rate / n as f64;
    let filter = Decimator::new(&LowPass::new(CUTOFF * kept, rate, ORDER).ok()?);
    let pieces = pieces(&recording.time, GAP * usual);
    let starts: Vec<Vec<usize>> =
        pieces.iter().map(|p| (0..p.len()).step_by(n).collect()).collect();
    let carry = |values: &[f64], smooth: bool| -> Vec<f64> {
        let piece = |(piece, rows): (&std::ops::Range<usize>, &Vec<usize>)| match smooth {
            true => filter.at(rows, &values[piece.clone()]),
            false => rows.iter().map(|k| values[piece.start + k]).collect(),
        };
        pieces.iter().zip(&starts).flat_map(piece).collect()
    };
    let channel = |c: &Channel| Channel {
        name: c.name.clone(),
        values: carry(&c.values, is_signal(&c.name)),
    };
    use rayon::prelude::*;
    let time = carry(&recording.time, false);
    let mut provenance: Provenance = recording.provenance.clone();
    provenance.notes.push(format!(
        "{rows} rows at {rate:.0} Hz are thinned to {} at {kept:.0} Hz after a low-pass at {:.0} Hz: what \
         is worked out needs 20 Hz (--every-row keeps all)",
        time.len(),
        CUTOFF * kept,
    ));
    let channels = recording.channels.par_iter().map(channel).collect();
    Some(Recording { time, channels, provenance })
}

/// What is measured or commanded, rather than a mode, a counter or a flag.
fn is_signal(name: &str) -> bool {
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('_');
    JOINT_SIGNALS.contains(&stem) || stem.starts_with("actual_TCP")
}

/// Rows without a gap between them.
fn pieces(time: &[f64], gap: f64) -> Vec<std::ops::Range<usize>> {
    let mut pieces = Vec::new();
    let mut start = 0;
    for k in 1..time.len() {
        if time[k] - time[k - 1] > gap {
            pieces.push(start..k);
            start = k;
        }
    }
    pieces.push(start..time.len());
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 20 s of a slow swing with a shake at `shake_hz` on it.
    fn recording(rate: f64, shake_hz: f64) -> Recording {
        let turn = std::f64::consts::TAU;
        let time: Vec<f64> = (0..(20.0 * rate) as usize).map(|k| k as f64 / rate).collect();
        let swing = |t: &f64| (turn * 0.5 * t).sin() + (turn * shake_hz * t).sin();
        let q = Channel { name: "actual_q_0".into(), values: time.iter().map(swing).collect() };
        let mode = time.iter().map(|t| if *t < 10.0 { 1.0 } else { 7.0 }).collect();
        let mode = Channel { name: "robot_mode".into(), values: mode };
        Recording { time, channels: vec![q, mode], provenance: Provenance::default() }
    }

    #[test]
    fn a_fast_recording_keeps_its_motion_and_loses_what_would_fold_onto_it() {
        let thinned = thin(&recording(1000.0, 120.0), 0.0).unwrap();
        assert_eq!(thinned.time.len(), 2500);
        let swing = |t: f64| (std::f64::consts::TAU * 0.5 * t).sin();
        for k in 100..2400 {
            let off = thinned.channels[0].values[k] - swing(thinned.time[k]);
            assert!(off.abs() < 2e-3, "{k}: {off}");
        }
        assert!(thinned.channels[1].values.iter().all(|m| *m == 1.0 || *m == 7.0));
        assert!(thinned.provenance.notes[0].contains("20000 rows at 1000 Hz"));
    }

    #[test]
    fn usual_recordings_and_higher_wishes_keep_every_row() {
        assert!(thin(&recording(125.0, 1.0), 0.0).is_none());
        assert!(thin(&recording(1000.0, 1.0), 1000.0).is_none());
        assert_eq!(thin(&recording(1000.0, 1.0), 250.0).unwrap().time.len(), 5000);
    }

    #[test]
    fn gaps_stay_gaps() {
        let mut gappy = recording(500.0, 1.0);
        gappy.time.iter_mut().skip(4003).for_each(|t| *t += 3.0);
        let thinned = thin(&gappy, 0.0).unwrap();
        let gaps = thinned.time.windows(2).filter(|w| w[1] - w[0] > 2.0).count();
        assert_eq!(gaps, 1);
        assert!(thinned.time.windows(2).all(|w| w[1] > w[0]));
    }
}
