//! Logs of one servo as Rhoban/bam records them (JSON, also packed by gzip): goal and position of every
//! sample, and once the gain register, the supply and the load.

use std::path::Path;

use serde::Deserialize;

use super::check::refuse_bad;
use super::format::{Format, refuse_map};
use super::whole::{ends_in, whole_text};
use super::{Channel, ColumnMap, Provenance, Recording, RecordingError};
use crate::limits::ROWS;

pub struct BamJson;

impl Format for BamJson {
    fn name(&self) -> &'static str {
        "bam log (JSON)"
    }

    fn reads(&self, path: &Path) -> bool {
        path.is_file() && ends_in(path, &[".json", ".json.gz"])
    }

    fn read(&self, path: &Path, map: Option<&ColumnMap>) -> Result<Recording, RecordingError> {
        refuse_map(map, || {
            format!("{} says itself what is in it; leave --columns out", path.display())
        })?;
        read(path)
    }
}

/// What is not named here is left out.
#[derive(Deserialize)]
struct Log {
    entries: Vec<Entry>,
    /// Gain register.
    kp: Option<f64>,
    /// V
    vin: Option<f64>,
    /// kg, m
    mass: Option<f64>,
    length: Option<f64>,
    motor: Option<String>,
    trajectory: Option<String>,
}

#[derive(Deserialize)]
struct Entry {
    /// s
    timestamp: f64,
    /// rad
    goal_position: f64,
    position: f64,
    /// rad/s
    speed: Option<f64>,
    torque_enable: Option<bool>,
    input_volts: Option<f64>,
    /// deg C
    temp: Option<f64>,
    /// Register, of no unit.
    load: Option<f64>,
}

fn read(path: &Path) -> Result<Recording, RecordingError> {
    let source = path.display().to_string();
    let damaged = |e: serde_json::Error| RecordingError::Container {
        file: source.clone(),
        what: format!("not a log of bam ({e})"),
        remedy: "give a JSON file with entries that have timestamp, goal_position and position",
    };
    let log: Log = serde_json::from_str(&whole_text(path)?).map_err(damaged)?;
    ROWS.allow(log.entries.len() as u64)
        .map_err(|limit| RecordingError::TooMuch { file: source.clone(), limit })?;
    let recording = Recording {
        time: log.entries.iter().map(|e| e.timestamp).collect(),
        channels: channels(&log),
        provenance: Provenance { source, format: BamJson.name().into(), notes: notes(&log) },
    };
    let lines: Vec<usize> = (1..=recording.time.len()).collect();
    refuse_bad(&recording, "timestamp", &lines)?;
    Ok(recording)
}

/// Those that every entry has.
fn channels(log: &Log) -> Vec<Channel> {
    let on = |e: &Entry| e.torque_enable.map(|on| if on { 1.0 } else { 0.0 });
    type Pick<'a> = &'a dyn Fn(&Entry) -> Option<f64>;
    let picks: [(&str, Pick<'_>); 8] = [
        ("target_q_0", &|e| Some(e.goal_position)),
        ("actual_q_0", &|e| Some(e.position)),
        ("actual_qd_0", &|e| e.speed),
        ("joint_temperatures_0", &|e| e.temp),
        ("servo_powered_0", &on),
        ("servo_gain_0", &|_| log.kp),
        ("servo_volts_0", &|e| e.input_volts),
        ("servo_load_0", &|e| e.load),
    ];
    let column = |(name, pick): (&str, Pick<'_>)| {
        let values = log.entries.iter().map(pick).collect::<Option<Vec<f64>>>()?;
        Some(Channel { name: name.into(), values })
    };
    picks.into_iter().filter_map(column).collect()
}

fn notes(log: &Log) -> Vec<String> {
    let number = |what: &str, v: Option<f64>, unit: &str| v.map(|v| format!("{what} {v}{unit}"));
    let said = [
        log.motor.as_ref().map(|m| format!("motor {m}")),
        log.trajectory.as_ref().map(|t| format!("motion {t}")),
        number("gain register", log.kp, ""),
        number("supply", log.vin, " V"),
        number("load", log.mass, " kg"),
        number("at", log.length, " m"),
    ];
    let said: Vec<String> = said.into_iter().flatten().collect();
    if said.is_empty() { Vec::new() } else { vec![format!("the log says: {}", said.join(", "))] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(text: &str) -> Result<Recording, RecordingError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.json");
        std::fs::write(&path, text).unwrap();
        super::super::read(&path, None)
    }

    fn log(rows: usize) -> String {
        let entry = |k: usize| {
            format!(
                "{{\"timestamp\": {}, \"goal_position\": 0.5, \"position\": {}, \"torque_enable\": {}}}",
                k as f64 * 0.005,
                k as f64 * 0.001,
                k.is_multiple_of(2)
            )
        };
        let entries: Vec<String> = (0..rows).map(entry).collect();
        format!("{{\"kp\": 400, \"motor\": \"xl330\", \"entries\": [{}]}}", entries.join(","))
    }

    #[test]
    fn a_log_becomes_command_position_and_settings() {
        let read = written(&log(12)).unwrap();
        assert_eq!(read.channel("actual_q_0").unwrap()[11], 0.011);
        assert_eq!(read.channel("servo_gain_0").unwrap()[3], 400.0);
        assert_eq!(read.channel("servo_powered_0").unwrap()[..3], [1.0, 0.0, 1.0]);
        assert!(read.channel("actual_qd_0").is_none(), "it is not recorded");
        assert!(read.provenance.notes[0].contains("motor xl330"), "{:?}", read.provenance.notes);
    }

    #[test]
    fn other_json_is_refused_in_one_line() {
        for text in
            ["{}", "[1, 2]", "{\"entries\": [{\"timestamp\": 1}]}", &log(12)[..200], &log(3)]
        {
            let message = written(text).unwrap_err().to_string();
            assert!(message.contains("log.json") && message.lines().count() == 1, "{message}");
        }
    }
}
