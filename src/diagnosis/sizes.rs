//! How large what a model leaves out is, as steps on grids.

use super::discrepancy::{GROUPS, KNOWN};

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sizes {
    /// Of the discrepancy, joint by joint and group by group.
    pub joints: Vec<Vec<u8>>,
    /// Of what the twin states within limits, which is the same at all joints.
    pub tolerances: u8,
}

impl Sizes {
    /// Nothing is left out.
    pub fn nothing(joints: usize) -> Self {
        Self { joints: vec![vec![0; GROUPS.len()]; joints], tolerances: 0 }
    }

    /// Only what is known to be no larger than so much.
    pub fn within_limits(&self) -> Self {
        let known = |(g, step): (usize, &u8)| if KNOWN.contains(&GROUPS[g]) { *step } else { 0 };
        let joints = self.joints.iter().map(|steps| steps.iter().enumerate().map(known).collect());
        Self { joints: joints.collect(), tolerances: self.tolerances }
    }

    /// All that is there smaller by so many steps.
    pub fn smaller(&self, by: u8) -> Self {
        let less = |step: &u8| step.saturating_sub(by);
        let joints = self.joints.iter().map(|groups| groups.iter().map(less).collect()).collect();
        Self { joints, tolerances: less(&self.tolerances) }
    }

    /// How many sizes the discrepancy has.
    pub fn count(&self) -> usize {
        self.joints.iter().map(Vec::len).sum()
    }
}
