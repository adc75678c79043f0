//! Causes as an answer prints them, each with its probability, and whether it is true.

use serde::Serialize;

use super::Judged;
use crate::diagnosis::Named;
use crate::trials::Kind;

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Printed {
    pub named: Named,
    /// What the answer calls the same in these data.
    pub equivalent: Vec<Named>,
    pub probability: f64,
    /// Is it hidden in the case? `None` where nobody knows.
    pub holds: Option<bool>,
    /// Is it told to some untouched pair of the same arm, so that it may be there though nobody hid it?
    pub may_be_the_arms: bool,
}

impl Printed {
    /// `None` of holds for what an arm may lack that nobody built.
    pub fn new(named: Named, equivalent: Vec<Named>, probability: f64, kind: Kind) -> Self {
        let unknown = kind == Kind::Untouched;
        let holds = (!unknown).then_some(false);
        Self { named, equivalent, probability, holds, may_be_the_arms: false }
    }

    /// The cause, then what is called the same.
    pub fn set(&self) -> impl Iterator<Item = &Named> {
        std::iter::once(&self.named).chain(&self.equivalent)
    }

    pub fn is_one_of(&self, names: &[Named]) -> bool {
        self.set().any(|n| names.contains(n))
    }
}

impl Judged {
    /// Everything the answer names, equivalents too.
    pub fn all_names(&self) -> Vec<Named> {
        self.printed.iter().flat_map(Printed::set).cloned().collect()
    }
}
