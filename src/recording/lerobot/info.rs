//! `meta/info.json` of a data set: what its columns are and where its episodes lie.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::limits::{SETTINGS, read_small};
use crate::recording::RecordingError;
use crate::recording::file::cannot;

pub const INFO: &str = "meta/info.json";
pub const STATE: &str = "observation.state";
pub const ACTION: &str = "action";

#[derive(Debug, Deserialize)]
pub struct Info {
    pub codebase_version: String,
    #[serde(default)]
    pub robot_type: Option<String>,
    #[serde(default)]
    pub total_episodes: usize,
    /// Episodes in a folder.
    #[serde(default = "thousand")]
    chunks_size: usize,
    data_path: String,
    features: BTreeMap<String, Feature>,
}

#[derive(Debug, Deserialize)]
struct Feature {
    #[serde(default)]
    shape: Vec<usize>,
    #[serde(default)]
    names: serde_json::Value,
}

fn thousand() -> usize {
    1000
}

impl Info {
    /// # Errors
    /// If the file is missing or is none of LeRobot's.
    pub fn load(root: &Path) -> Result<Self, RecordingError> {
        let path = root.join(INFO);
        let bytes = read_small(&path, &SETTINGS).map_err(cannot(&path, "read"))?;
        serde_json::from_slice(&bytes).map_err(|e| RecordingError::Container {
            file: path.display().to_string(),
            what: format!("not the description of a LeRobot data set ({e})"),
            remedy: "copy the folder again, its meta/ with it",
        })
    }

    /// Does one file hold many episodes (v3)?
    pub fn shares_files(&self) -> bool {
        self.data_path.contains("{file_index")
    }

    /// The file of an episode where every one has its own (v2).
    pub fn file_of(&self, root: &Path, episode: usize) -> PathBuf {
        let name = fill(&self.data_path, "episode_chunk", episode / self.chunks_size.max(1));
        root.join(fill(&name, "episode_index", episode))
    }

    /// Names of the numbers of a feature, without `.pos`; `joint_1` .. where it has none.
    pub fn names(&self, feature: &str) -> Option<Vec<String>> {
        let Feature { shape, names } = self.features.get(feature)?;
        let mut found = Vec::new();
        texts(names, &mut found);
        let count = shape.first().copied().unwrap_or(found.len());
        if found.len() != count {
            found = (1..=count.min(1000)).map(|j| format!("joint_{j}")).collect();
        }
        Some(found.iter().map(|n| n.trim_end_matches(".pos").to_string()).collect())
    }
}

/// Names come as a list, or as a list under some key.
fn texts(value: &serde_json::Value, into: &mut Vec<String>) {
    match value {
        serde_json::Value::String(text) => into.push(text.clone()),
        serde_json::Value::Array(all) => all.iter().for_each(|v| texts(v, into)),
        serde_json::Value::Object(all) => all.values().for_each(|v| texts(v, into)),
        _ => {}
    }
}

/// `{key:03d}` of a path as Python fills it.
fn fill(path: &str, key: &str, value: usize) -> String {
    let Some((before, rest)) = path.split_once(&format!("{{{key}")) else { return path.into() };
    let Some((how, after)) = rest.split_once('}') else { return path.into() };
    let digits: String = how.chars().filter(char::is_ascii_digit).collect();
    let width = digits.parse::<usize>().unwrap_or(0).min(20);
    format!("{before}{value:0width$}{after}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn info(names: &str) -> Info {
        let text = format!(
            "{{\"codebase_version\": \"v2.1\", \"chunks_size\": 1000, \
             \"data_path\": \"data/chunk-{{episode_chunk:03d}}/episode_{{episode_index:06d}}.parquet\", \
             \"features\": {{\"action\": {{\"shape\": [2], \"names\": {names}}}}}}}"
        );
        serde_json::from_str(&text).unwrap()
    }

    #[test]
    fn paths_and_names_are_those_of_lerobot() {
        let found = info("[\"shoulder_pan.pos\", \"gripper.pos\"]");
        let path = found.file_of(Path::new("set"), 1234);
        assert_eq!(path, Path::new("set/data/chunk-001/episode_001234.parquet"));
        assert_eq!(found.names(ACTION).unwrap(), ["shoulder_pan", "gripper"]);
        assert_eq!(info("{\"motors\": [\"a\", \"b\"]}").names(ACTION).unwrap(), ["a", "b"]);
        assert_eq!(info("null").names(ACTION).unwrap(), ["joint_1", "joint_2"]);
        assert!(info("null").names(STATE).is_none());
    }
}
