//! Scenario -> ground truth in rapier; controller, sensors; the RK4 reference it is measured against.

pub mod accuracy;
mod controller;
mod inject;
mod injection;
mod plant;
mod reference;
mod run;
mod scenario;
mod sensors;
mod setup;
mod sliding;
mod switch;
mod thermal;
mod truth;

pub use controller::{Command, ComputedTorque, ControllerSettings, Feedback, Target};
pub use injection::{Injection, Injections};
pub use plant::{Plant, PlantError};
pub use reference::Reference;
pub use run::{Exact, Glimpse, Run, Shown, Simulation, SimulationError};
pub use scenario::{Experiment, Moved, Scenario, ScenarioError};
pub use sensors::{Noise, Quantisation};
pub use setup::{Clock, ClockError, Setup};
pub use switch::Switch;
pub use thermal::Thermal;
pub use truth::Truth;

#[cfg(test)]
mod effect_tests;
#[cfg(test)]
mod tests;
