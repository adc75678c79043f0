//! The regression problems of all joints, and what they share.

use std::collections::BTreeMap;

use super::error::IdentificationError;
use super::problem::{JointProblem, Parameter};
use crate::effects::{self, Size};

/// Bounds that replace the catalogue's, by parameter name: lower and upper.
pub type BoundsByName = BTreeMap<String, [f64; 2]>;

/// All joints' problems, and what they share.
#[derive(Debug, Clone)]
pub struct ArmProblem {
    pub joints: Vec<JointProblem>,
    /// Parameters of the whole arm (payload); every joint has a column for each.
    pub shared: Vec<Parameter>,
    /// Per joint, the columns of the shared parameters.
    pub shared_columns: Vec<Vec<Vec<f64>>>,
}

impl ArmProblem {
    /// Replaces bounds by name, in every joint.
    pub(super) fn set_bounds(&mut self, by_name: &BoundsByName) -> Result<(), IdentificationError> {
        for (name, &[lower, upper]) in by_name {
            crate::regression::bounds::check(name, lower, upper)?;
            let mut found = false;
            let all = self.joints.iter_mut().flat_map(JointProblem::parameters_mut);
            for p in all.chain(&mut self.shared).filter(|p| p.name == *name) {
                (p.lower, p.upper, found) = (lower, upper, true);
            }
            if !found {
                let known = self.parameter_names().join(", ");
                return Err(IdentificationError::UnknownBound { name: name.clone(), known });
            }
        }
        Ok(())
    }

    fn parameter_names(&self) -> Vec<&str> {
        let joint = self.joints.first().map_or(vec![], JointProblem::parameters);
        joint.into_iter().chain(&self.shared).map(|p| p.name.as_str()).collect()
    }
}

/// A parameter that one joint has and all joints feel.
pub(super) fn at_joint(name: &str, joint: usize) -> String {
    format!("{name}_{}", joint + 1)
}

/// A parameter of the catalogue, with its bounds on an arm of this size.
pub(super) fn searched(p: &effects::Parameter, size: &Size) -> Parameter {
    let name = if p.name == "current_offset" { "offset" } else { p.name };
    let p = p.on(size);
    Parameter { name: name.into(), unit: p.unit.into(), lower: p.min, upper: p.max }
}
