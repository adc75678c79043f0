//! MCAP files taken apart into records, changed there, and put together again with right lengths,
//! compression and checksums, so that changes get past those.

use std::io::{Read, Write};

use crate::bytes::{MOST, Random, havoc};
use crate::targets::Corpus;

const MAGIC: &[u8] = b"\x89MCAP0\r\n";
const CHUNK: u8 = 6;
/// Unpacked more than this a seed is no small file.
const ROOM: u64 = 1 << 18;

type Record = (u8, Vec<u8>);

pub fn make(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    let mut file = corpus.pick(random);
    match records(&file) {
        Some(records) if !random.one_in(3) => {
            let records = changed(random, records, corpus);
            file = packed(random, &records);
            if random.one_in(4) {
                havoc(random, &mut file, &corpus.words, &[]);
            }
        }
        _ => havoc(random, &mut file, &corpus.words, &corpus.seeds),
    }
    file
}

/// The records of a file, those of chunks as if there were none.
fn records(file: &[u8]) -> Option<Vec<Record>> {
    let mut all = Vec::new();
    for (opcode, body) in split(file.strip_prefix(MAGIC)?) {
        if opcode != CHUNK {
            all.push((opcode, body.to_vec()));
            continue;
        }
        let length = u32::from_le_bytes(body.get(28..32)?.try_into().ok()?) as usize;
        let compression = body.get(32..32_usize.checked_add(length)?)?;
        let data = body.get(32 + length + 8..)?;
        let mut plain = Vec::new();
        let unpacked = match compression {
            b"zstd" => zstd::Decoder::new(data).ok()?.take(ROOM).read_to_end(&mut plain),
            b"lz4" => lz4::Decoder::new(data).ok()?.take(ROOM).read_to_end(&mut plain),
            _ => data.take(ROOM).read_to_end(&mut plain),
        };
        unpacked.ok()?;
        all.extend(split(&plain).map(|(opcode, body)| (opcode, body.to_vec())));
    }
    Some(all).filter(|all| !all.is_empty())
}

fn split(mut rest: &[u8]) -> impl Iterator<Item = (u8, &[u8])> {
    std::iter::from_fn(move || {
        let (head, body) = rest.split_first_chunk::<9>()?;
        let length = u64::from_le_bytes(head[1..].try_into().ok()?);
        let (body, after) = body.split_at_checked(usize::try_from(length).ok()?)?;
        rest = after;
        Some((head[0], body))
    })
}

fn changed(random: &mut Random, mut records: Vec<Record>, corpus: &Corpus) -> Vec<Record> {
    for _ in 0..1 + random.below(3) {
        let at = random.below(records.len());
        match random.below(6) {
            0 if records.len() > 1 => drop(records.remove(at)),
            1 => {
                let copy = records[at].clone();
                let to = random.below(records.len());
                records.splice(to..to, std::iter::repeat_n(copy, 1 + random.below(3)));
            }
            2 => {
                let other = random.below(records.len());
                records.swap(at, other);
            }
            _ => havoc(random, &mut records[at].1, &corpus.words, &[]),
        }
    }
    records
}

fn packed(random: &mut Random, records: &[Record]) -> Vec<u8> {
    let mut file = MAGIC.to_vec();
    let per_chunk = 1 + random.below(records.len() + 1);
    let compression = *random.of(&["", "zstd", "lz4", "none"]);
    for part in records.chunks(per_chunk) {
        let mut plain = Vec::new();
        part.iter().for_each(|(opcode, body)| put(&mut plain, *opcode, body));
        match compression {
            "none" => file.extend(plain),
            _ => put(&mut file, CHUNK, &chunk(random, compression, &plain)),
        }
    }
    put(&mut file, 15, &[0; 4]);
    put(&mut file, 2, &[0; 20]);
    file.extend(MAGIC);
    file.truncate(4 * MOST);
    file
}

fn put(file: &mut Vec<u8>, opcode: u8, body: &[u8]) {
    file.push(opcode);
    file.extend((body.len() as u64).to_le_bytes());
    file.extend(body);
}

fn chunk(random: &mut Random, compression: &str, plain: &[u8]) -> Vec<u8> {
    let data = match compression {
        "zstd" => zstd::encode_all(plain, 1).expect("packs"),
        "lz4" => {
            let mut out = lz4::EncoderBuilder::new().build(Vec::new()).expect("packs");
            out.write_all(plain).expect("packs");
            out.finish().0
        }
        _ => plain.to_vec(),
    };
    // Now and then the sizes lie.
    let lie = |random: &mut Random, size: usize| match random.below(24) {
        0 => (size as u64) << random.below(40),
        1 => size as u64 ^ (1 << random.below(64)),
        _ => size as u64,
    };
    let mut body = vec![0; 16];
    body.extend(lie(random, plain.len()).to_le_bytes());
    body.extend(if random.one_in(4) { 0 } else { crc32fast::hash(plain) }.to_le_bytes());
    body.extend((compression.len() as u32).to_le_bytes());
    body.extend(compression.as_bytes());
    body.extend(lie(random, data.len()).to_le_bytes());
    body.extend(data);
    body
}
