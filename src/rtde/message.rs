//! Bodies of packages that are no data.

use bytes::Bytes;

use super::RtdeError;
use super::frame::{Frame, Kind};

/// Version of a controller's software.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Version(pub [u32; 4]);

impl std::fmt::Display for Version {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [major, minor, bugfix, build] = self.0;
        write!(f, "{major}.{minor}.{bugfix}.{build}")
    }
}

impl Version {
    pub fn read(frame: &Frame) -> Result<Self, RtdeError> {
        let body = sized(frame, 16)?;
        let mut numbers = [0; 4];
        for (number, bytes) in numbers.iter_mut().zip(body.chunks_exact(4)) {
            *number = bytes.iter().fold(0, |n, b| n << 8 | u32::from(*b));
        }
        Ok(Self(numbers))
    }

    pub fn body(self) -> Vec<u8> {
        self.0.iter().flat_map(|n| n.to_be_bytes()).collect()
    }
}

/// How grave a text message is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    Exception,
    Error,
    Warning,
    Info,
}

impl Level {
    fn of(byte: u8) -> Self {
        match byte {
            0 => Self::Exception,
            1 => Self::Error,
            2 => Self::Warning,
            _ => Self::Info,
        }
    }

    pub fn word(self) -> &'static str {
        match self {
            Self::Exception => "exception",
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Info => "says",
        }
    }
}

/// A message for people.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Text {
    pub level: Level,
    pub source: String,
    pub message: String,
}

impl Text {
    /// Protocol 2: lengths before message and source, the level last. Protocol 1: level, message.
    pub fn read(body: &[u8], protocol: u16) -> Result<Self, RtdeError> {
        if protocol < 2 {
            let (level, message) = body.split_first().ok_or(RtdeError::Text)?;
            return Ok(Self {
                level: Level::of(*level),
                source: String::new(),
                message: shown(message),
            });
        }
        let (message, rest) = counted(body)?;
        let (source, rest) = counted(rest)?;
        let [level] = rest else { return Err(RtdeError::Text) };
        Ok(Self { level: Level::of(*level), source: shown(source), message: shown(message) })
    }

    pub fn body(&self, protocol: u16) -> Vec<u8> {
        let cut = |text: &str| text.bytes().take(255).collect::<Vec<u8>>();
        let (message, source, level) = (cut(&self.message), cut(&self.source), self.level as u8);
        if protocol < 2 {
            return [&[level], &message[..]].concat();
        }
        let lengths = [message.len() as u8, source.len() as u8];
        [&lengths[..1], &message, &lengths[1..], &source, &[level]].concat()
    }
}

/// Text of a peer, without what could steer a terminal.
fn shown(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// What a length of one byte announces, and what is behind it.
fn counted(body: &[u8]) -> Result<(&[u8], &[u8]), RtdeError> {
    let (length, rest) = body.split_first().ok_or(RtdeError::Text)?;
    rest.split_at_checked(usize::from(*length)).ok_or(RtdeError::Text)
}

/// The body, if it has so many bytes.
pub fn sized(frame: &Frame, expected: usize) -> Result<&Bytes, RtdeError> {
    let (kind, bytes) = (frame.kind, frame.body.len());
    if bytes == expected { Ok(&frame.body) } else { Err(RtdeError::Body { kind, bytes, expected }) }
}

/// Whether a request was granted.
pub fn granted(frame: &Frame) -> Result<bool, RtdeError> {
    Ok(sized(frame, 1)?[0] != 0)
}

/// Names or types with commas between them.
pub fn listed(body: &[u8]) -> Result<Vec<&str>, RtdeError> {
    let text = std::str::from_utf8(body).map_err(|_| RtdeError::Text)?;
    Ok(text.split(',').map(str::trim).filter(|part| !part.is_empty()).collect())
}

/// An answer of one bit.
pub fn answer(kind: Kind, yes: bool, out: &mut Vec<u8>) {
    super::frame::put(kind, &[u8::from(yes)], out);
}
