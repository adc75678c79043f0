//! What a peer can do wrong.

use super::frame::Kind;
use crate::limits::TooMuch;

/// Why a talk ends. Nothing of it is the fault of who reports it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RtdeError {
    #[error("it announced a package of {0} bytes, where the shortest has 3: this is no RTDE")]
    Length(usize),
    #[error("it sent a package of the unknown kind {0}: this is no RTDE")]
    Kind(u8),
    #[error("its answer {kind} has {bytes} bytes, {expected} were expected")]
    Body { kind: Kind, bytes: usize, expected: usize },
    #[error("it sent {0} where that has no place")]
    Unexpected(Kind),
    #[error("it does not speak protocol 2 of RTDE (controllers before 3.2.19171 do not)")]
    Protocol,
    #[error("it does not know {0}: leave that out of --fields")]
    NotFound(String),
    #[error("it gave {given} types for {asked} quantities")]
    Types { asked: usize, given: usize },
    #[error("it gives {name} the type {given:?}, which is none of RTDE's")]
    UnknownType { name: String, given: String },
    #[error("it gives {name} as {given}, where RTDE has {expected}")]
    OtherType { name: String, given: &'static str, expected: &'static str },
    #[error("it refused to {0}")]
    Refused(&'static str),
    #[error("its data are of the recipe {given}, {expected} was agreed on")]
    OtherRecipe { given: u8, expected: u8 },
    #[error("it sent text that is cut off or no UTF-8")]
    Text,
    #[error("it asked for {0} Hz")]
    Rate(String),
    #[error(transparent)]
    TooMuch(#[from] TooMuch),
}
