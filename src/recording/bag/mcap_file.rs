//! MCAP files: chunked or not, packed by lz4 or zstd; read as a stream, so that size does not matter.

use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::path::Path;

use mcap::records::MessageHeader;
use mcap::{Compression, McapError};

use super::bad;
use super::mcap_records::{self, Broken, Record};
use super::message::definition;
use super::outgoing::Outgoing;
use super::topics::Topics;
use crate::recording::RecordingError;
use crate::recording::file::{cannot, unwritten};

const BYTES_PER_READ: usize = 1 << 16;

/// What ends the reading of a file: its own damage, or what it says of the arm.
enum Stop {
    Broken(Broken),
    Content(RecordingError),
}

impl From<Broken> for Stop {
    fn from(broken: Broken) -> Self {
        Self::Broken(broken)
    }
}

pub fn read(path: &Path, topics: &mut Topics) -> Result<(), RecordingError> {
    let file = File::open(path).map_err(cannot(path, "read"))?;
    let file = BufReader::with_capacity(BYTES_PER_READ, file);
    let mut schemas = HashMap::new();
    let done = mcap_records::read(file, |record| take(record, &mut schemas, topics));
    done.map_err(|stop| match stop {
        Stop::Content(error) => error,
        Stop::Broken(broken) => refusal(broken, path, topics.joint_states()),
    })
}

fn take(
    record: Record,
    schemas: &mut HashMap<u16, String>,
    topics: &mut Topics,
) -> Result<(), Stop> {
    match record {
        Record::Schema { id, name } => {
            schemas.insert(id, name.into());
            Ok(())
        }
        Record::Channel { id, schema, topic, encoding } => {
            let kind = schemas.get(&schema).map_or("", String::as_str);
            topics.add(id.into(), topic, kind, encoding)
        }
        Record::Message { channel, logged, data } if topics.wants(channel.into()) => {
            topics.message(channel.into(), logged as i64, data)
        }
        Record::Message { .. } => Ok(()),
    }
    .map_err(Stop::Content)
}

/// After `count` joint states.
fn refusal(broken: Broken, path: &Path, count: usize) -> RecordingError {
    let file = path.display().to_string();
    let mend = "copy it again, or mend it with `mcap recover`";
    match broken {
        Broken::Magic => {
            bad(&file, "it does not begin or end as an MCAP file does".into(), "copy it again")
        }
        Broken::CutOff => {
            bad(&file, format!("the bag is cut off after {count} joint states"), mend)
        }
        Broken::Damaged(what) => {
            bad(&file, format!("the bag is damaged after {count} joint states ({what})"), mend)
        }
        Broken::TooMuch(limit) => RecordingError::TooMuch { file, limit },
        Broken::Io(error) => cannot(path, "read")(error),
    }
}

/// Writes messages in the order given; `file` is a new file.
pub fn write(bag: &Outgoing, file: File, path: &Path) -> Result<(), RecordingError> {
    let wrong = |e: McapError| unwritten(path, e);
    let options = mcap::WriteOptions::new()
        .compression(Some(Compression::Zstd))
        .profile("ros2")
        .library(concat!("armtwin ", env!("CARGO_PKG_VERSION")));
    let mut out = options.create(BufWriter::new(file)).map_err(wrong)?;
    let mut channels = Vec::new();
    for (topic, kind) in bag.topics() {
        let schema = out.add_schema(kind, "ros2msg", definition(kind).as_bytes()).map_err(wrong)?;
        channels.push(out.add_channel(schema, topic, "cdr", &BTreeMap::new()).map_err(wrong)?);
    }
    for sequence in 0..bag.samples() {
        let log_time = bag.stamp(sequence) as u64;
        for (topic, channel_id) in channels.iter().enumerate() {
            let (channel_id, sequence_number) = (*channel_id, sequence as u32);
            let header = MessageHeader {
                channel_id,
                sequence: sequence_number,
                log_time,
                publish_time: log_time,
            };
            out.write_to_known_channel(&header, &bag.message(topic, sequence)).map_err(wrong)?;
        }
    }
    out.finish().map(drop).map_err(wrong)
}
