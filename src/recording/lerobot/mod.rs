//! LeRobot data sets, v2 and v3: Parquet files beside `meta/info.json`. An episode is a recording:
//! `action` is the command, `observation.state` the position.
//!
//! What the numbers are (degrees, or percent of a calibrated range) no data set says: a column map must.

mod info;

use std::path::{Path, PathBuf};

use info::{ACTION, INFO, Info, STATE};

use super::check::refuse_bad;
use super::format::Format;
use super::guard::guarded;
use super::lerobot_map::{Angle, LerobotMap};
use super::parquet_file::damaged;
use super::parquet_lists::{self, Lists};
use super::{Channel, ColumnMap, Provenance, Recording, RecordingError};

const EPISODE: &str = "episode_index";
const TIME: &str = "timestamp";
/// Folders between a data set's root and its files, at most.
const DEEP: usize = 4;

pub struct Lerobot;

impl Format for Lerobot {
    fn name(&self) -> &'static str {
        "LeRobot data set"
    }

    fn reads(&self, path: &Path) -> bool {
        match path.is_dir() {
            true => path.join(INFO).is_file(),
            false => path.extension().is_some_and(|e| e == "parquet") && root_of(path).is_some(),
        }
    }

    fn read(&self, path: &Path, map: Option<&ColumnMap>) -> Result<Recording, RecordingError> {
        let what = |why: String| Err(damaged(path, why));
        guarded(|| read(path, map)).unwrap_or_else(what)
    }
}

/// The data set that a file of it belongs to.
fn root_of(file: &Path) -> Option<PathBuf> {
    let own = file.ancestors().skip(1).take(DEEP);
    own.map(|f| if f.as_os_str().is_empty() { Path::new(".") } else { f })
        .find(|folder| folder.join(INFO).is_file())
        .map(Path::to_path_buf)
}

fn read(path: &Path, map: Option<&ColumnMap>) -> Result<Recording, RecordingError> {
    let wrong = |what: String| RecordingError::ColumnMap {
        file: map.map_or_else(|| path.display().to_string(), |m| m.file.clone()),
        what,
    };
    let unsaid = LerobotMap::default();
    let said = match map {
        None => &unsaid,
        Some(map) => map.lerobot.as_ref().ok_or_else(|| wrong("no [lerobot] table".into()))?,
    };
    let root = match path.is_dir() {
        true => path.to_path_buf(),
        false => root_of(path).unwrap_or_default(),
    };
    let info = Info::load(&root)?;
    let names = info.names(STATE).ok_or_else(|| wrong(format!("the data set has no {STATE}")))?;
    let joints = said.joints.clone().unwrap_or_else(|| names.clone());
    let joints: Vec<String> =
        joints.iter().map(|j| j.trim_end_matches(".pos").to_string()).collect();
    let angles = said.angles(&joints).map_err(&wrong)?;
    let whole_file = !path.is_dir() && !info.shares_files();
    let (file, table) = episode(path, &root, &info, said.episode)?;
    let mut channels = Vec::new();
    for (feature, stem) in [(ACTION, "target_q"), (STATE, "actual_q")] {
        let Some(all) = info.names(feature) else { continue };
        let places: Option<Vec<usize>> =
            joints.iter().map(|j| all.iter().position(|n| n == j)).collect();
        let Some(places) = places else {
            let (joints, all) = (joints.join(", "), all.join(", "));
            return Err(wrong(format!("{feature} has {all}; lerobot.joints asks for {joints}")));
        };
        channels.extend(in_radians(stem, &table, feature, &places, &angles)?);
    }
    let mut notes = vec![format!(
        "{} {}, joints {}, command and position of action and observation.state",
        info.robot_type.as_deref().unwrap_or("a robot"),
        info.codebase_version,
        joints.join(", ")
    )];
    if !whole_file {
        let (episode, all) = (said.episode, info.total_episodes);
        notes.push(format!(
            "episode {episode} of {all} (from 0); [lerobot] episode in a column map says which"
        ));
    }
    let mut recording = Recording {
        time: table.numbers(TIME).to_vec(),
        channels,
        provenance: Provenance { source: file, format: Lerobot.name().into(), notes },
    };
    let mut rows: Vec<usize> = (1..=recording.time.len()).collect();
    recording.mend(&mut rows)?;
    refuse_bad(&recording, TIME, &rows)?;
    Ok(recording)
}

fn in_radians(
    stem: &str,
    table: &Lists,
    feature: &str,
    places: &[usize],
    angles: &[Angle],
) -> Result<Vec<Channel>, RecordingError> {
    let columns = table.lists(feature);
    let column = |(j, (place, angle)): (usize, (&usize, &Angle))| {
        let values = columns.get(*place).ok_or_else(|| table.short(feature))?;
        let values = values.iter().map(|v| angle.offset + angle.slope * v).collect();
        Ok(Channel { name: format!("{stem}_{j}"), values })
    };
    places.iter().zip(angles).enumerate().map(column).collect()
}

/// The rows of an episode, and the file they came from.
fn episode(
    path: &Path,
    root: &Path,
    info: &Info,
    wanted: usize,
) -> Result<(String, Lists), RecordingError> {
    let read = |file: &Path| parquet_lists::lists(file, &[TIME, EPISODE], &[ACTION, STATE]);
    let own = match (path.is_dir(), info.shares_files()) {
        (false, _) => vec![path.to_path_buf()],
        (true, false) => vec![info.file_of(root, wanted)],
        (true, true) => files_below(&root.join("data")),
    };
    let only = own.len() == 1 && !info.shares_files();
    for file in &own {
        let table = read(file)?;
        let index = table.numbers(EPISODE).to_vec();
        let rows: Vec<usize> =
            (0..index.len()).filter(|&k| only || index[k] == wanted as f64).collect();
        if !rows.is_empty() {
            return Ok((file.display().to_string(), table.only(&rows)));
        }
    }
    Err(RecordingError::Container {
        file: path.display().to_string(),
        what: format!(
            "there is no episode {wanted}; the data set says it has {}",
            info.total_episodes
        ),
        remedy: "name another one in a column map: [lerobot] episode = 0",
    })
}

/// Parquet files of a folder and the folders in it, in the order of their names.
fn files_below(folder: &Path) -> Vec<PathBuf> {
    let inside = |folder: &Path| -> Vec<PathBuf> {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        let mut paths: Vec<PathBuf> = entries.map(|e| e.path()).collect();
        paths.sort();
        paths
    };
    let chunks = inside(folder);
    let all = chunks.iter().flat_map(|p| if p.is_dir() { inside(p) } else { vec![p.clone()] });
    all.filter(|p| p.extension().is_some_and(|e| e == "parquet")).collect()
}

#[cfg(test)]
mod tests;
