//! The flag that says by which method an arm is explained.

use crate::diagnosis::By;

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Method {
    /// Inverse dynamics of the recorded motion against the recorded torque
    Torque,
    /// Position servos led along the recorded command, against the recorded position
    Simulation,
}

#[derive(clap::Args, Clone, Default)]
pub struct ByArgs {
    /// Against recorded torque, or by simulating command to position [default: what is recorded decides]
    #[arg(long, value_enum, value_name = "METHOD")]
    by: Option<Method>,
}

impl ByArgs {
    pub fn asked(&self) -> Option<By> {
        self.by.map(|method| match method {
            Method::Torque => By::Torque,
            Method::Simulation => By::Simulation,
        })
    }
}
