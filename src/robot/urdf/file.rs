//! Where messages about a URDF point to.

use crate::robot::RobotError;

/// The file's name in messages.
#[derive(Debug, Clone, Copy)]
pub(super) struct File<'a>(pub &'a str);

impl File<'_> {
    pub fn link(&self, name: &str, problem: impl Into<String>) -> RobotError {
        self.element("link", name, problem.into())
    }

    pub fn structure(&self, problem: impl Into<String>) -> RobotError {
        RobotError::Structure { file: self.0.into(), problem: problem.into() }
    }

    pub fn malformed(&self, reason: &str) -> RobotError {
        RobotError::Malformed { file: self.0.into(), reason: reason.into() }
    }

    pub fn element(&self, element: &'static str, name: &str, problem: String) -> RobotError {
        RobotError::Element { file: self.0.into(), element, name: name.into(), problem }
    }
}
