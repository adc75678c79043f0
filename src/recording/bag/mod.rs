//! ROS 2 bags with `sensor_msgs/JointState`: MCAP and SQLite files, and rosbag2's folders of them.
//!
//! Joints go by name, base to wrist. Effort becomes `actual_current` or `joint_torque` as the
//! column map says, else as gravity shows; if neither tells, it stays `effort`.

#[cfg(feature = "bags")]
mod cdr;
#[cfg_attr(not(feature = "bags"), allow(dead_code))]
mod effort;
#[cfg(feature = "bags")]
mod format;
#[cfg(feature = "bags")]
mod joints;
#[cfg(feature = "bags")]
mod mcap_file;
#[cfg(feature = "bags")]
mod mcap_records;
#[cfg(feature = "bags")]
mod message;
#[cfg(feature = "bags")]
mod names;
#[cfg(feature = "bags")]
mod outgoing;
#[cfg(feature = "bags")]
mod sqlite_file;
#[cfg(all(test, feature = "bags"))]
mod tests;
#[cfg(feature = "bags")]
mod topics;

pub use effort::settle as settle_effort;
#[cfg(feature = "bags")]
pub use format::RosBag;

/// Where columns are kept that have no place in a joint state.
#[cfg(feature = "bags")]
const OWN_TOPICS: &str = "/armtwin/";

#[cfg(feature = "bags")]
fn bad(file: &str, what: String, remedy: &'static str) -> super::RecordingError {
    super::RecordingError::Container { file: file.into(), what, remedy }
}
