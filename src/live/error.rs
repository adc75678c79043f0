//! Why a source ends before its time.

use std::io;

use crate::recording::RecordingError;
use crate::rtde::RtdeError;

const WHERE: &str = "controllers have RTDE at port 30004, those of the e-series once it is enabled \
                     (Settings, Security, Services)";

/// What a person can do about it.
fn unanswered(source: &io::Error) -> String {
    match source.kind() {
        io::ErrorKind::ConnectionRefused => {
            format!("the machine is there, but nothing listens at this port: {WHERE}")
        }
        _ => format!("{source}; check the address, the cable, and that the arm is switched on"),
    }
}

#[derive(Debug, thiserror::Error)]
pub enum LiveError {
    #[error(
        "{address}: no machine of that name is known ({source}); give the address that the arm shows of itself, \
         for example rtde://192.168.0.10"
    )]
    Name { address: String, source: io::Error },
    #[error("{address}: no controller answers there: {}", unanswered(source))]
    Connect { address: String, source: io::Error },
    /// What answered ended the talk before it said anything of RTDE.
    #[error("{0}, and nothing of RTDE was heard: {WHERE}")]
    Stranger(Box<LiveError>),
    #[error("{address}: {source}")]
    Talk { address: String, source: RtdeError },
    #[error("{address}: the connection was closed by the other side")]
    Closed { address: String },
    #[error("{address}: nothing came for {seconds} s, though the connection stands")]
    Silent { address: String, seconds: u64 },
    #[error("{address}: the connection broke: {source}")]
    Broken { address: String, source: io::Error },
    #[error("{address}: after it came back it sends other quantities than before")]
    OtherColumns { address: String },
    #[error("cannot listen at {address}: {source}; another program may, so name another --port")]
    Listen { address: String, source: io::Error },
    #[error("the system has no thread left: {0}")]
    Thread(io::Error),
    #[error(transparent)]
    Recording(#[from] RecordingError),
    #[error("{0}")]
    Follow(String),
    #[error("{0}")]
    Record(String),
}
