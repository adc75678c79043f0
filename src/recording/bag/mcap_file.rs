//! MCAP: chunked or not, compressed by lz4 or zstd; read as a stream, so that size does not matter.

use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{BufWriter, Read};
use std::path::Path;

use mcap::records::{MessageHeader, Record};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{Compression, McapError};

use super::message::definition;
use super::topics::Topics;
use super::{Outgoing, bad, cannot, unwritten};
use crate::recording::RecordingError;

const BYTES_PER_READ: usize = 1 << 18;
/// Longer records are damage: the joints of an arm take some hundred bytes.
const LARGEST_RECORD: usize = 1 << 30;

pub fn read(path: &Path, topics: &mut Topics) -> Result<(), RecordingError> {
    let mut file = File::open(path).map_err(cannot(path, "read"))?;
    let options = LinearReaderOptions::default()
        .with_validate_chunk_crcs(true)
        .with_record_length_limit(LARGEST_RECORD);
    let mut reader = LinearReader::new_with_options(options);
    let mut schemas = HashMap::from([(0, String::new())]);
    while let Some(event) = reader.next_event() {
        match event.map_err(|e| broken(e, path, topics))? {
            LinearReadEvent::ReadRequest(wanted) => {
                let room = reader.insert(wanted.max(BYTES_PER_READ));
                let count = file.read(room).map_err(cannot(path, "read"))?;
                reader.notify_read(count);
            }
            LinearReadEvent::Record { data, opcode } => {
                let record = mcap::parse_record(opcode, data);
                take(record.map_err(|e| broken(e, path, topics))?, &mut schemas, topics)?;
            }
        }
    }
    Ok(())
}

fn take(
    record: Record,
    schemas: &mut HashMap<u16, String>,
    topics: &mut Topics,
) -> Result<(), RecordingError> {
    match record {
        Record::Schema { header, .. } => drop(schemas.insert(header.id, header.name)),
        Record::Channel(channel) => {
            let kind = schemas.get(&channel.schema_id).map_or("", String::as_str);
            topics.add(channel.id.into(), &channel.topic, kind, &channel.message_encoding)?;
        }
        Record::Message { header, data } if topics.wants(header.channel_id.into()) => {
            topics.message(header.channel_id.into(), header.log_time as i64, &data)?;
        }
        _ => {}
    }
    Ok(())
}

fn broken(error: McapError, path: &Path, topics: &Topics) -> RecordingError {
    let file = path.display().to_string();
    let count = topics.joint_states();
    match error {
        McapError::BadMagic => {
            bad(&file, "it does not begin or end as an MCAP file does".into(), "copy it again")
        }
        McapError::UnexpectedEof => bad(
            &file,
            format!("the bag is cut off after {count} joint states"),
            "copy it again, or mend it with `mcap recover`",
        ),
        error => bad(
            &file,
            format!("the bag is damaged after {count} joint states ({error})"),
            "copy it again, or mend it with `mcap recover`",
        ),
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
