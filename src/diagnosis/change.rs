//! A change of a twin: an effect at some joints, with values.

use super::candidate::Candidate;
use super::{Cause, Value, links};
use crate::effects::{Scope, find};
use crate::twin::Twin;

/// What makes another twin of a twin.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    pub effect: String,
    /// From 1; none for the whole arm.
    pub joints: Vec<usize>,
    pub parameters: Vec<Value>,
    /// Do the values stand in place of those the twin has, or are they added to them?
    pub replaces: bool,
}

impl Change {
    /// `values` of a candidate, which are added to what the twin states of them.
    pub fn of(candidate: Candidate, values: &[Value], twin: &Twin) -> Self {
        let mut parameters = values.to_vec();
        let stated = candidate.stated(twin);
        for (value, has) in parameters.iter_mut().zip(&stated).take(candidate.linear()) {
            value.value += has;
            value.low += has;
            value.high += has;
        }
        let joints = links::told(candidate, &parameters);
        Self { effect: candidate.name().into(), joints, parameters, replaces: !stated.is_empty() }
    }

    /// Is one in the whole arm what the other is at some joints?
    pub fn overlaps(&self, other: &Self) -> bool {
        self.effect == other.effect && self.joints.is_empty() != other.joints.is_empty()
    }

    /// Do both change the torque of some joint?
    pub fn meets(&self, other: &Self) -> bool {
        let several = |c: &Self| find(&c.effect).is_none_or(|e| e.about().scope != Scope::Joint);
        let both = |j: &usize| other.joints.contains(j);
        let whole = self.joints.is_empty() || other.joints.is_empty();
        whole || several(self) || several(other) || self.joints.iter().any(both)
    }
}

impl From<&Cause> for Change {
    fn from(cause: &Cause) -> Self {
        let Cause { effect, joints, parameters, .. } = cause.clone();
        Self { effect, joints, parameters, replaces: cause.replaces.is_some() }
    }
}
