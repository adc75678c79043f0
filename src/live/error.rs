//! Why a source ends before its time.

use std::io;

use crate::recording::RecordingError;
use crate::rtde::RtdeError;

#[derive(Debug, thiserror::Error)]
pub enum LiveError {
    #[error(
        "{address}: no controller answers there ({source}); check the address, that the arm is switched on, \
         and that its RTDE service is enabled (on e-series: Settings, Security, Services)"
    )]
    Connect { address: String, source: io::Error },
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
}
