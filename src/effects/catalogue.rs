//! The one list: command line, docs, scenario keys and tests follow from it.

use super::Effect;

/// Every effect armtwin knows, in the order of the docs.
pub static CATALOGUE: &[&dyn Effect] = &[&super::coulomb::Coulomb, &super::stribeck::Stribeck];

pub fn find(name: &str) -> Option<&'static dyn Effect> {
    CATALOGUE.iter().copied().find(|e| e.about().name == name)
}
