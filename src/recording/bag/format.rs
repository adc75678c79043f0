//! The format: which files are read and written, and how their joint states become columns.

use std::path::{Path, PathBuf};

use super::joints::Sampled;
use super::outgoing::Outgoing;
use super::topics::{Numbers, Topics};
use super::{bad, effort, mcap_file, names, sqlite_file};
use crate::recording::bag_map::{BagMap, Effort};
use crate::recording::check::refuse_bad;
use crate::recording::file::{open, replace, unwritten};
use crate::recording::format::{Format, WriteOptions};
use crate::recording::{Channel, ColumnMap, Provenance, Recording, RecordingError};

/// Stamps from this time on (September 2001, ns) are of the calendar: time then counts from the first.
const CALENDAR: i64 = 1_000_000_000_000_000_000;

pub struct RosBag;

impl Format for RosBag {
    fn name(&self) -> &'static str {
        "ROS 2 bag"
    }

    fn reads(&self, path: &Path) -> bool {
        match path.is_dir() {
            true => path.join("metadata.yaml").exists() || !bags_in(path).is_empty(),
            false => is_bag(path),
        }
    }

    fn read(&self, path: &Path, map: Option<&ColumnMap>) -> Result<Recording, RecordingError> {
        let unsaid = BagMap::default();
        let map = match map {
            None => &unsaid,
            Some(columns) => columns.bag.as_ref().ok_or_else(|| RecordingError::ColumnMap {
                file: columns.file.clone(),
                what: format!("no [bag] table, which is what {} needs", path.display()),
            })?,
        };
        read(path, map)
    }

    fn extensions(&self) -> &'static [&'static str] {
        &[".mcap", ".db3"]
    }

    fn write(
        &self,
        recording: &Recording,
        path: &Path,
        _: &WriteOptions,
    ) -> Result<(), RecordingError> {
        let bag = Outgoing::new(recording, path)?;
        replace(path, |file, new| match path.extension() {
            Some(e) if e.eq_ignore_ascii_case("db3") => {
                sqlite_file::write(&bag, new).map_err(|e| unwritten(path, e))
            }
            _ => mcap_file::write(&bag, file, path),
        })
    }
}

fn is_bag(path: &Path) -> bool {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    ["mcap", "db3"].iter().any(|e| extension.eq_ignore_ascii_case(e))
}

/// rosbag2 splits long bags: `run_0.mcap`, `run_1.mcap`, ... `run_10.mcap`.
fn bags_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries.map(|e| e.path()).filter(|p| is_bag(p)).collect();
    files.sort_by_key(|p| {
        let stem = p.file_stem().and_then(|s| s.to_str()).unwrap_or_default().to_string();
        let number = stem.rsplit_once('_').and_then(|(_, n)| n.parse::<u64>().ok());
        (number, stem)
    });
    files
}

fn read(path: &Path, map: &BagMap) -> Result<Recording, RecordingError> {
    let source = path.display().to_string();
    let files = if path.is_dir() { bags_in(path) } else { vec![path.to_path_buf()] };
    let mut topics = Topics::new(source.clone(), map);
    for file in &files {
        open(file)?;
        topics.next_file();
        match file.extension() {
            Some(e) if e.eq_ignore_ascii_case("db3") => sqlite_file::read(file, &mut topics)?,
            _ => mcap_file::read(file, &mut topics)?,
        }
    }
    if files.is_empty() {
        let what = "a bag's folder without .mcap or .db3 files".into();
        return Err(bad(&source, what, "unpack them (zstd -d) or check the path"));
    }
    let (topic, joints, numbers) = topics.settle()?;
    let names = joints.names.clone();
    let sampled = joints.finish(map.time).map_err(|(message, what)| RecordingError::Message {
        file: source.clone(),
        topic: topic.clone(),
        message,
        what,
    })?;
    let kind = if path.is_dir() { "folder" } else { extension(path) };
    let format = format!("ROS 2 bag ({kind}), joint states of {topic}");
    assemble(sampled, &names, numbers, map, Provenance { source, format, notes: Vec::new() })
}

fn extension(path: &Path) -> &'static str {
    let sqlite = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("db3"));
    if sqlite { "SQLite" } else { "MCAP" }
}

fn assemble(
    mut sampled: Sampled,
    names: &[String],
    numbers: Vec<Numbers>,
    map: &BagMap,
    mut provenance: Provenance,
) -> Result<Recording, RecordingError> {
    provenance.notes.push(format!("joints 1 to {}: {}", names.len(), names.join(", ")));
    provenance.notes.append(&mut sampled.notes);
    let time = seconds(&sampled.stamps, &mut provenance.notes);
    let own = own_channels(numbers, &sampled.logged, &mut provenance.notes);
    let named = |stem: &str| own.iter().any(|c| c.name == format!("{stem}_0"));
    let measured_twice = named("actual_current") || named("joint_torque");
    let mut channels = Vec::new();
    let signals = std::mem::take(&mut sampled.signals);
    let q = signals.iter().find(|(s, _)| *s == "actual_q").map(|(_, q)| q.clone());
    for (stem, mut columns) in signals {
        let mut stem = stem;
        if stem == "effort" {
            if measured_twice {
                continue;
            }
            let q = q.as_deref().unwrap_or_default();
            stem = name_effort(q, &mut columns, names, map, &mut provenance)?;
        }
        let named = columns.into_iter().enumerate();
        channels.extend(named.map(|(j, values)| Channel { name: format!("{stem}_{j}"), values }));
    }
    channels.extend(own);
    let lines: Vec<usize> = (1..=time.len()).collect();
    let recording = Recording { time, channels, provenance };
    refuse_bad(&recording, "stamp", &lines)?;
    Ok(recording)
}

/// From ns; calendar time counts from the first sample.
fn seconds(stamps: &[i64], notes: &mut Vec<String>) -> Vec<f64> {
    let origin = stamps.first().copied().filter(|s| *s >= CALENDAR).unwrap_or(0);
    if origin > 0 {
        let (s, ns) = (origin / 1_000_000_000, origin % 1_000_000_000);
        notes.push(format!("time counts from the first stamp, {s}.{ns:09} s since 1970"));
    }
    stamps.iter().map(|s| (s - origin) as f64 / 1e9).collect()
}

/// What effort is, by the column map or by gravity; scaled as the map says.
fn name_effort(
    q: &[Vec<f64>],
    effort: &mut [Vec<f64>],
    names: &[String],
    map: &BagMap,
    provenance: &mut Provenance,
) -> Result<&'static str, RecordingError> {
    let scales = map.effort_scale.expand(effort.len()).map_err(|e| {
        bad(&provenance.source, format!("bag.effort_scale: {e}"), "correct the column map")
    })?;
    for (column, scale) in effort.iter_mut().zip(scales) {
        column.iter_mut().for_each(|v| *v *= scale);
    }
    if let Some(said) = map.effort {
        let what = said.words();
        provenance.notes.push(format!("effort taken as {what}, as the column map says"));
        return Ok(said.stem());
    }
    let arms = effort::arms(map, names::of_universal_robots(names));
    let (arms, assumed) =
        arms.map_err(|e| bad(&provenance.source, e, "correct robot in the column map"))?;
    provenance.notes.extend(assumed.into_iter().map(|note| format!("robot: {note}")));
    let evidence = effort::by_gravity(q, effort, &arms);
    let why = evidence.why;
    provenance.notes.push(match evidence.effort {
        Some(found) => format!("effort taken as {}, by gravity: {why}", found.words()),
        None => format!(
            "effort may be current or torque, gravity does not tell ({why}): say so in a column \
             map, [bag] effort = \"current\" or \"torque\", or name the arm, robot = \"ur5e\""
        ),
    });
    Ok(evidence.effort.map_or("effort", Effort::stem))
}

/// Columns written by this program, where they belong to the same samples.
fn own_channels(all: Vec<Numbers>, logged: &[i64], notes: &mut Vec<String>) -> Vec<Channel> {
    let mut channels = Vec::new();
    for Numbers { label, logged: own, columns } in all {
        let names: Vec<&str> = label.split(',').collect();
        if own == logged && names.len() == columns.len() {
            let named = names.into_iter().zip(columns);
            channels.extend(named.map(|(name, values)| Channel { name: name.into(), values }));
        } else {
            notes.push(format!("left out {label}: not at the times of the joint states"));
        }
    }
    channels
}
