//! The records of an MCAP file one after the other, those of chunks unpacked. What the file says of
//! lengths bounds what is read and reserves nothing.

use std::io::{self, Read};

use crate::limits::{CHUNK, Expansion, TooMuch};

const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";
/// Unpacked at once, before it is counted.
const STEP: u64 = 1 << 20;

/// Operation codes of the specification (mcap.dev/spec).
mod op {
    pub const FOOTER: u8 = 0x02;
    pub const SCHEMA: u8 = 0x03;
    pub const CHANNEL: u8 = 0x04;
    pub const MESSAGE: u8 = 0x05;
    pub const CHUNK: u8 = 0x06;
}

/// What of a file matters here.
#[derive(Debug)]
pub enum Record<'a> {
    Schema {
        id: u16,
        name: &'a str,
    },
    Channel {
        id: u16,
        schema: u16,
        topic: &'a str,
        encoding: &'a str,
    },
    /// When it was logged, ns.
    Message {
        channel: u16,
        logged: u64,
        data: &'a [u8],
    },
}

/// Why reading stopped.
#[derive(Debug)]
pub enum Broken {
    /// No MCAP file.
    Magic,
    CutOff,
    Damaged(String),
    TooMuch(TooMuch),
    Io(io::Error),
}

/// Calls `each` with every record that matters; its error ends the reading.
pub fn read<E: From<Broken>>(
    file: impl Read,
    mut each: impl FnMut(Record) -> Result<(), E>,
) -> Result<(), E> {
    let mut source = Source { file, expansion: Expansion::default() };
    source.magic()?;
    let (mut record, mut chunk) = (Vec::new(), Vec::new());
    loop {
        let [opcode, length @ ..] = source.exactly::<9>()?;
        let length = u64::from_le_bytes(length);
        match opcode {
            op::FOOTER => {
                source.skip(length)?;
                return source.magic().map_err(E::from);
            }
            op::SCHEMA | op::CHANNEL | op::MESSAGE => {
                source.fill(&mut record, length)?;
                parse(opcode, &record)?.map_or(Ok(()), &mut each)?;
            }
            op::CHUNK => {
                source.fill(&mut record, length)?;
                let mut rest = unpacked(&record, &mut chunk, &mut source.expansion)?;
                while let Some((opcode, body)) = next_inside(&mut rest)? {
                    parse(opcode, body)?.map_or(Ok(()), &mut each)?;
                }
            }
            _ => source.skip(length)?,
        }
    }
}

struct Source<R> {
    file: R,
    expansion: Expansion,
}

impl<R: Read> Source<R> {
    fn exactly<const N: usize>(&mut self) -> Result<[u8; N], Broken> {
        let mut bytes = [0; N];
        self.file.read_exact(&mut bytes).map_err(|e| match e.kind() {
            io::ErrorKind::UnexpectedEof => Broken::CutOff,
            _ => Broken::Io(e),
        })?;
        self.expansion.take(N as u64);
        Ok(bytes)
    }

    fn magic(&mut self) -> Result<(), Broken> {
        match self.exactly()? == MAGIC {
            true => Ok(()),
            false => Err(Broken::Magic),
        }
    }

    /// The next `length` bytes in place of what `record` held.
    fn fill(&mut self, record: &mut Vec<u8>, length: u64) -> Result<(), Broken> {
        CHUNK.allow(length).map_err(Broken::TooMuch)?;
        record.clear();
        let read = (&mut self.file).take(length).read_to_end(record).map_err(Broken::Io)? as u64;
        self.expansion.take(read);
        if read == length { Ok(()) } else { Err(Broken::CutOff) }
    }

    fn skip(&mut self, length: u64) -> Result<(), Broken> {
        let read = io::copy(&mut (&mut self.file).take(length), &mut io::sink());
        let read = read.map_err(Broken::Io)?;
        self.expansion.take(read);
        if read == length { Ok(()) } else { Err(Broken::CutOff) }
    }
}

/// The records of a chunk, in `room` if they were packed.
fn unpacked<'a>(
    chunk: &'a [u8],
    room: &'a mut Vec<u8>,
    expansion: &mut Expansion,
) -> Result<&'a [u8], Broken> {
    let mut fields = Fields(chunk);
    fields.bytes(16)?;
    let size = fields.u64()?;
    let checksum = fields.u32()?;
    let compression = fields.text()?;
    let length = fields.u64()?;
    let packed = fields.bytes(length)?;
    let wrong = |e: io::Error| Broken::Damaged(format!("a chunk cannot be unpacked: {e}"));
    let records = match compression {
        "" => packed,
        "zstd" => {
            let from = zstd::stream::read::Decoder::with_buffer(packed).map_err(wrong)?;
            unpack(from, size, room, expansion)?
        }
        "lz4" => unpack(lz4::Decoder::new(packed).map_err(wrong)?, size, room, expansion)?,
        other => {
            let other: String = other.chars().take(40).collect();
            return Err(Broken::Damaged(format!("a chunk is packed by {other:?}")));
        }
    };
    let calculated = crc32fast::hash(records);
    if checksum != 0 && checksum != calculated {
        return Err(Broken::Damaged("the checksum of a chunk is wrong".into()));
    }
    Ok(records)
}

/// The first `size` bytes that come `from` a decoder.
fn unpack<'a>(
    mut from: impl Read,
    size: u64,
    room: &'a mut Vec<u8>,
    expansion: &mut Expansion,
) -> Result<&'a [u8], Broken> {
    CHUNK.allow(size).map_err(Broken::TooMuch)?;
    room.clear();
    while (room.len() as u64) < size {
        let step = STEP.min(size - room.len() as u64);
        let read = (&mut from).take(step).read_to_end(room);
        let read = read.map_err(|e| Broken::Damaged(format!("a chunk cannot be unpacked: {e}")))?;
        expansion.make(read as u64).map_err(Broken::TooMuch)?;
        if read == 0 {
            let held = room.len();
            return Err(Broken::Damaged(format!("a chunk of {size} bytes holds {held}")));
        }
    }
    Ok(room)
}

/// Takes the next record of a chunk off its front.
fn next_inside<'a>(records: &mut &'a [u8]) -> Result<Option<(u8, &'a [u8])>, Broken> {
    if records.is_empty() {
        return Ok(None);
    }
    let mut fields = Fields(records);
    let opcode = fields.array::<1>()?[0];
    let length = fields.u64()?;
    let body = fields.bytes(length)?;
    *records = fields.0;
    Ok(Some((opcode, body)))
}

fn parse(opcode: u8, body: &[u8]) -> Result<Option<Record<'_>>, Broken> {
    let mut fields = Fields(body);
    Ok(Some(match opcode {
        op::SCHEMA => Record::Schema { id: fields.u16()?, name: fields.text()? },
        op::CHANNEL => Record::Channel {
            id: fields.u16()?,
            schema: fields.u16()?,
            topic: fields.text()?,
            encoding: fields.text()?,
        },
        op::MESSAGE => {
            let channel = fields.u16()?;
            fields.u32()?;
            let logged = fields.u64()?;
            fields.u64()?;
            Record::Message { channel, logged, data: fields.0 }
        }
        _ => return Ok(None),
    }))
}

/// Fields of a record, little endian, taken off its front.
struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    fn bytes(&mut self, length: u64) -> Result<&'a [u8], Broken> {
        let split = usize::try_from(length).ok().and_then(|n| self.0.split_at_checked(n));
        let (bytes, rest) = split
            .ok_or_else(|| Broken::Damaged("a record is shorter than its fields say".into()))?;
        self.0 = rest;
        Ok(bytes)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Broken> {
        let mut array = [0; N];
        array.copy_from_slice(self.bytes(N as u64)?);
        Ok(array)
    }

    fn u16(&mut self) -> Result<u16, Broken> {
        self.array().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Result<u32, Broken> {
        self.array().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Result<u64, Broken> {
        self.array().map(u64::from_le_bytes)
    }

    fn text(&mut self) -> Result<&'a str, Broken> {
        let length = self.u32()?;
        let bytes = self.bytes(length.into())?;
        std::str::from_utf8(bytes)
            .map_err(|_| Broken::Damaged("a name in it is not UTF-8 text".into()))
    }
}
