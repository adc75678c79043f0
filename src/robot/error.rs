//! What can be wrong with an arm's description.

use std::path::PathBuf;

/// `file` names where the description came from.
#[derive(Debug, thiserror::Error)]
pub enum RobotError {
    #[error(
        "`{name}` is neither a built-in robot ({built_in}) nor an existing URDF file; \
         give one of those names or the path of a URDF"
    )]
    Unknown { name: String, built_in: String },
    #[error("{}: cannot read it: {cause}; give the path of a URDF file", file.display())]
    Read { file: PathBuf, cause: std::io::Error },
    #[error("{file}: not a valid URDF: {reason}; repair the XML")]
    Malformed { file: String, reason: String },
    #[error("{file}: {element} `{name}`: {problem}")]
    Element { file: String, element: &'static str, name: String, problem: String },
    #[error("{file}: {problem}")]
    Structure { file: String, problem: String },
    #[error("drive: {0}")]
    Drive(String),
    #[error("`[servo]`: {0}")]
    Servo(String),
}
