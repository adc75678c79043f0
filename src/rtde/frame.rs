//! Packages out of a stream of bytes, in whatever pieces it comes.

use std::fmt;

use bytes::{Buf, Bytes, BytesMut};

use super::RtdeError;

/// Size and kind.
const HEAD: usize = 3;

/// What a package is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    ProtocolVersion,
    ControllerVersion,
    Text,
    Data,
    SetupOutputs,
    SetupInputs,
    Start,
    Pause,
}

impl Kind {
    const ALL: [(Self, u8); 8] = [
        (Self::ProtocolVersion, b'V'),
        (Self::ControllerVersion, b'v'),
        (Self::Text, b'M'),
        (Self::Data, b'U'),
        (Self::SetupOutputs, b'O'),
        (Self::SetupInputs, b'I'),
        (Self::Start, b'S'),
        (Self::Pause, b'P'),
    ];

    fn byte(self) -> u8 {
        Self::ALL.iter().find(|(kind, _)| *kind == self).map_or(0, |(_, byte)| *byte)
    }

    fn of(byte: u8) -> Option<Self> {
        Self::ALL.iter().find(|(_, b)| *b == byte).map(|(kind, _)| *kind)
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::ProtocolVersion => "a protocol version",
            Self::ControllerVersion => "the controller's version",
            Self::Text => "a text message",
            Self::Data => "a data package",
            Self::SetupOutputs => "a set-up of outputs",
            Self::SetupInputs => "a set-up of inputs",
            Self::Start => "a start",
            Self::Pause => "a pause",
        })
    }
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    pub kind: Kind,
    pub body: Bytes,
}

/// Adds a package to `out`. Bodies are at most 65 532 bytes long, which is for the caller to see to.
pub fn put(kind: Kind, body: &[u8], out: &mut Vec<u8>) {
    out.extend(((HEAD + body.len()) as u16).to_be_bytes());
    out.push(kind.byte());
    out.extend(body);
}

/// Bytes that came and are no whole package yet: fewer than 65 536, for the size has two bytes, beside
/// what was pushed last.
#[derive(Debug, Default)]
pub struct Framer(BytesMut);

impl Framer {
    pub fn push(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    /// The next whole package.
    ///
    /// # Errors
    /// If what comes is no package; it will be none later either.
    pub fn next_frame(&mut self) -> Result<Option<Frame>, RtdeError> {
        let Some(&[high, low, kind]) = self.0.first_chunk::<HEAD>() else { return Ok(None) };
        let size = usize::from(u16::from_be_bytes([high, low]));
        if size < HEAD {
            return Err(RtdeError::Length(size));
        }
        let kind = Kind::of(kind).ok_or(RtdeError::Kind(kind))?;
        if self.0.len() < size {
            return Ok(None);
        }
        let mut whole = self.0.split_to(size).freeze();
        whole.advance(HEAD);
        Ok(Some(Frame { kind, body: whole }))
    }

    /// Bytes that wait for the rest of their package.
    pub fn waiting(&self) -> usize {
        self.0.len()
    }
}
