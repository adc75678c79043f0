//! What can be wrong with a recording or with the choices made for it.

/// A message says what is missing or impossible and what to do about it. Joints count from 1.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SignalError {
    #[error(
        "channel {channel} is missing (needed for {purpose}): {remedy}; the recording has {found}"
    )]
    MissingChannel { channel: String, purpose: &'static str, remedy: &'static str, found: String },
    #[error(
        "the recording has {joints} joints and the arm {dof}: name the arm it is of (--robot, --twin), or \
         its joints in a column map (--columns)"
    )]
    JointCount { joints: usize, dof: usize },
    #[error(
        "the drive describes {drive} joints but the robot has {dof}: give one gear ratio and \
         torque constant per joint, or record joint_torque_*"
    )]
    DriveMismatch { drive: usize, dof: usize },
    #[error(
        "{samples} samples over {seconds:.3} s are too few: {needed_s:.3} s are needed with \
         margin_s = {margin_s}; record longer or lower margin_s"
    )]
    TooShort { samples: usize, seconds: f64, needed_s: f64, margin_s: f64 },
    #[error(
        "a low-pass at {cutoff_hz} Hz is impossible at a sample rate of {rate_hz:.3} Hz: choose \
         a cutoff above 0 and below {limit_hz:.3} Hz, or 0 for none"
    )]
    Cutoff { cutoff_hz: f64, rate_hz: f64, limit_hz: f64 },
    #[error("filter_order = {order} is outside 1 to 12")]
    FilterOrder { order: usize },
    #[error("{key} = {value} is not usable: {remedy}")]
    Setting { key: &'static str, value: f64, remedy: &'static str },
}
