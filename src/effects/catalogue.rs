//! The one list: command line, docs, scenario keys and tests follow from it.

use super::Effect;

/// Every effect armtwin knows, in the order of the docs.
pub static CATALOGUE: &[&dyn Effect] = &[
    &super::coulomb::Coulomb,
    &super::viscous::Viscous,
    &super::viscous_quadratic::ViscousQuadratic,
    &super::viscous_cubic::ViscousCubic,
    &super::stribeck::Stribeck,
    &super::load_friction::LoadFriction,
    &super::rotor_inertia::RotorInertia,
    &super::current_offset::CurrentOffset,
    &super::payload::Payload,
];

/// By the name in its `about`.
pub fn find(name: &str) -> Option<&'static dyn Effect> {
    CATALOGUE.iter().copied().find(|e| e.about().name == name)
}

/// All names, in the order of the docs, for messages: `coulomb, viscous, ...`.
pub fn names() -> String {
    let names: Vec<_> = CATALOGUE.iter().map(|e| e.about().name).collect();
    names.join(", ")
}
