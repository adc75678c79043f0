//! A designed motion as files that somebody can run; the extension of a name says which.

mod csv;
mod joint_trajectory;
mod scenario;
mod urscript;

#[cfg(test)]
mod tests;

use std::io;
use std::path::Path;

use super::Design;
use crate::files::write_whole;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// RTDE names: `target_q_0`, ...
    Csv,
    /// ROS 2: `trajectory_msgs/msg/JointTrajectory`.
    JointTrajectory,
    UrScript,
    /// For `armtwin simulate`.
    Scenario,
}

#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    #[error(
        "{0}: name the file .csv (RTDE names), .yaml (ROS 2 JointTrajectory), .script (URScript) or \
         .toml (scenario)"
    )]
    Extension(String),
    #[error("{file}: URScript is for six joints, this arm has {joints}")]
    Joints { file: String, joints: usize },
    #[error("{file}: cannot write it: {source}")]
    Io { file: String, source: io::Error },
}

impl Format {
    /// # Errors
    /// For other extensions.
    pub fn of(path: &Path) -> Result<Self, WriteError> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        match extension.to_ascii_lowercase().as_str() {
            "csv" => Ok(Self::Csv),
            "yaml" | "yml" => Ok(Self::JointTrajectory),
            "script" => Ok(Self::UrScript),
            "toml" => Ok(Self::Scenario),
            _ => Err(WriteError::Extension(path.display().to_string())),
        }
    }
}

/// The text of the file.
pub fn text(design: &Design, format: Format) -> String {
    match format {
        Format::Csv => csv::text(design),
        Format::JointTrajectory => joint_trajectory::text(design),
        Format::UrScript => urscript::text(design),
        Format::Scenario => scenario::text(design),
    }
}

/// Writes every file, each whole or not at all, after all of them were made.
///
/// # Errors
/// If a name has another extension, the arm does not fit the format, or a file cannot be written.
pub fn files(design: &Design, paths: &[impl AsRef<Path>]) -> Result<(), WriteError> {
    let made = |path: &_| {
        let path: &Path = AsRef::as_ref(path);
        let format = Format::of(path)?;
        let joints = design.trajectory.dof();
        if format == Format::UrScript && joints != 6 {
            return Err(WriteError::Joints { file: path.display().to_string(), joints });
        }
        Ok((path.to_path_buf(), text(design, format)))
    };
    let all: Vec<_> = paths.iter().map(made).collect::<Result<_, _>>()?;
    for (path, text) in all {
        write_whole(&path, |out| out.write_all(text.as_bytes()))
            .map_err(|source| WriteError::Io { file: path.display().to_string(), source })?;
    }
    Ok(())
}

/// `[0.1, -0.2]`, shortest numbers that read back as the same to a nanoradian.
fn list(values: &[f64]) -> String {
    let rounded = |v: &f64| (v * 1e9).round() / 1e9 + 0.0;
    let all: Vec<String> = values.iter().map(|v| format!("{:?}", rounded(v))).collect();
    format!("[{}]", all.join(", "))
}
