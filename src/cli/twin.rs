//! The twin a command is given.

use std::path::Path;

use super::out;
use crate::twin::{Twin, TwinError};

/// The twin of a file, or the UR5; what was assumed about its robot is said.
pub fn load(path: Option<&Path>) -> Result<Twin, TwinError> {
    let twin = path.map_or_else(|| Ok(Twin::default()), Twin::load)?;
    out::notes(&twin.source, &twin.notes);
    Ok(twin)
}
