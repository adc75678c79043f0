//! RTDE, the Real-Time Data Exchange of Universal Robots: packages, recipes, and both ends of a talk as
//! state machines that see bytes and make bytes, and know no socket and no clock.
//!
//! After the manufacturer's *Real-Time Data Exchange (RTDE) Guide*: TCP, port 30004, big-endian; every
//! package is its size (2 bytes, itself included), its kind (1 byte) and a body. A client asks for a
//! protocol version, names the quantities it wants (the recipe), is told their types, and starts; from then
//! on the controller sends one data package per cycle.

mod arm;
mod client;
mod error;
mod fields;
mod frame;
mod message;
mod recipe;
mod session;
mod types;

#[cfg(test)]
mod tests;

pub use arm::{CONTROLLER, Offer};
pub use client::{Client, Event, Wish};
pub use error::RtdeError;
pub use fields::{Field, is_known, type_of};
pub use frame::{Frame, Framer, Kind};
pub use message::{Level, Text, Version};
pub use recipe::Recipe;
pub use session::{Heard, Session};
pub use types::Type;

/// Where a controller listens.
pub const PORT: u16 = 30004;
