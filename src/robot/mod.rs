//! The rigid arm: tables -> URDF -> [`Robot`], its dynamics, and the drive that moves it.

mod drive;
pub mod dynamics;
mod error;
mod model;
pub mod plausible;
pub mod servo;
pub mod spatial;
pub mod tables;
#[cfg(test)]
mod tests;
pub mod urdf;

pub use drive::{Drive, DrivePart};
pub use dynamics::*;
pub use error::RobotError;
pub use model::{Body, Inertia, Joint, Limits, Placement, Robot};
pub use servo::{Servo, Told};
pub use tables::BUILT_IN;
pub use urdf::{Chain, Loaded};

/// m/s^2, along -z of the base: what the arms of this crate stand in unless told otherwise.
pub const GRAVITY: f64 = 9.81;

/// The built-in arm of that name.
pub fn builtin(name: &str) -> Option<Robot> {
    BUILT_IN.iter().find(|t| t.name == name).map(|t| t.robot())
}

/// A built-in arm by name, or an arm from a URDF file: the chain of it that is asked for.
///
/// # Errors
/// Unknown names list the built-in ones; a bad URDF is refused naming the link or joint.
pub fn load(name_or_path: &str, chain: &Chain) -> Result<Loaded, RobotError> {
    if let Some(robot) = builtin(name_or_path) {
        return match *chain == Chain::default() {
            true => Ok(Loaded::whole(robot)),
            false => urdf::read(&urdf::write(&robot), name_or_path, chain),
        };
    }
    let path = std::path::Path::new(name_or_path);
    let looks_like_path = path.extension().is_some() || path.components().count() > 1;
    if looks_like_path || path.exists() {
        crate::files::guard::reads(path);
        return urdf::read_file(path, chain);
    }
    let names: Vec<_> = BUILT_IN.iter().map(|t| t.name).collect();
    Err(RobotError::Unknown { name: name_or_path.into(), built_in: names.join(", ") })
}
