//! One set of answers beside those by the criteria as they are.

use std::collections::BTreeSet;

use serde::Serialize;

use super::Moved;
use crate::trials::{Figure, Judged, figures};

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// `None`: the criteria as they are.
    pub moved: Option<Moved>,
    pub figures: Vec<Figure>,
    /// Cases whose causes are others than by the criteria as they are.
    pub differs: Vec<String>,
}

impl Row {
    pub fn new(moved: Option<Moved>, judged: &[Judged], base: &[Judged]) -> Self {
        let pairs = judged.iter().zip(base);
        let others = pairs.filter(|(j, base)| causes(j) != causes(base));
        let differs = others.map(|(j, _)| j.case.clone()).collect();
        Self { moved, figures: figures(judged), differs }
    }
}

/// Causes of an answer, in whatever order they were named.
fn causes(judged: &Judged) -> BTreeSet<(&str, &[usize])> {
    judged.causes.iter().map(|n| (n.effect.as_str(), n.joints.as_slice())).collect()
}
