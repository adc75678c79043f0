//! Parquet files of many layouts, by the official writer; changes go into their pages (which stand
//! unpacked in some) and into their footers.

use std::sync::Arc;

use arrow::array::{ArrayRef, Float32Array, Float64Array, Int32Array, Int64Array, StringArray};
use arrow::datatypes::{Field, Schema};
use arrow::record_batch::RecordBatch;
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, Encoding, ZstdLevel};
use parquet::file::properties::{WriterProperties, WriterVersion};

use crate::bytes::{Random, havoc};
use crate::targets::Corpus;

const LAYOUTS: u64 = 96;

pub fn seeds() -> Vec<Vec<u8>> {
    let other = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/bags/pyarrow.parquet");
    let mut all = vec![std::fs::read(other).expect("a seed")];
    all.extend((0..LAYOUTS).map(|k| file(&mut Random(k))));
    all
}

pub fn make(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    let mut file = corpus.pick(random);
    let Some(end) = file.len().checked_sub(8) else { return file };
    let said =
        u32::from_le_bytes([file[end], file[end + 1], file[end + 2], file[end + 3]]) as usize;
    let Some(footer) = end.checked_sub(said).filter(|_| !random.one_in(6)) else {
        havoc(random, &mut file, &corpus.words, &corpus.seeds);
        return file;
    };
    let mut changed = file[footer..end].to_vec();
    if random.one_in(2) {
        // Offsets stay where they are.
        let mut pages = file[4.min(footer)..footer].to_vec();
        let length = pages.len();
        havoc(random, &mut pages, &[], &[]);
        pages.resize(length, 0);
        file[4.min(footer)..footer].copy_from_slice(&pages);
    } else {
        havoc(random, &mut changed, &corpus.words, &[]);
    }
    file.truncate(footer);
    file.extend(&changed);
    file.extend((changed.len() as u32).to_le_bytes());
    file.extend(b"PAR1");
    file
}

fn file(random: &mut Random) -> Vec<u8> {
    let rows = 10 + random.below(60);
    let mut columns: Vec<(String, ArrayRef)> = vec![(
        "timestamp".into(),
        match random.below(3) {
            0 => Arc::new(Int64Array::from_iter_values((0..rows).map(|k| k as i64))),
            _ => Arc::new(Float64Array::from_iter_values((0..rows).map(|k| 0.008 * k as f64))),
        },
    )];
    for joint in 0..1 + random.below(3) {
        let constant = random.one_in(3);
        let value = |k: usize| if constant { 1.0 } else { (k % 7) as f64 };
        let column: ArrayRef = match random.below(6) {
            0 => Arc::new(Int32Array::from_iter_values((0..rows).map(|k| value(k) as i32))),
            1 => Arc::new(Float32Array::from_iter_values((0..rows).map(|k| value(k) as f32))),
            2 => Arc::new((0..rows).map(|k| Some(value(k))).collect::<Float64Array>()),
            3 => Arc::new(Int64Array::from_iter_values((0..rows).map(|k| value(k) as i64 * 1_000))),
            _ => Arc::new(Float64Array::from_iter_values((0..rows).map(value))),
        };
        columns.push((format!("actual_q_{joint}"), column));
    }
    if random.one_in(4) {
        let words: StringArray = (0..rows).map(|k| Some(format!("note {}", k % 3))).collect();
        columns.push(("note".into(), Arc::new(words)));
    }
    let (nullable, whole) = (random.one_in(2), columns[1].1.data_type().is_integer());
    let fields = columns.iter().map(|(n, c)| Field::new(n, c.data_type().clone(), nullable));
    let schema = Arc::new(Schema::new(fields.collect::<Vec<_>>()));
    let arrays = columns.into_iter().map(|(_, column)| column).collect();
    let batch = RecordBatch::try_new(schema.clone(), arrays).expect("columns of one length");
    let mut file = Vec::new();
    let properties = properties(random, whole);
    let written = ArrowWriter::try_new(&mut file, schema, Some(properties)).and_then(|mut out| {
        out.write(&batch)?;
        out.close()
    });
    written.map_or_else(|_| b"PAR1".to_vec(), |_| file)
}

/// Are the numbers of the first joint `whole`?
fn properties(random: &mut Random, whole: bool) -> WriterProperties {
    let dictionary = random.one_in(2);
    let version = [WriterVersion::PARQUET_1_0, WriterVersion::PARQUET_2_0];
    let packing = [
        Compression::UNCOMPRESSED,
        Compression::UNCOMPRESSED,
        Compression::SNAPPY,
        Compression::ZSTD(ZstdLevel::default()),
    ];
    let builder = WriterProperties::builder()
        .set_writer_version(*random.of(&version))
        .set_compression(*random.of(&packing))
        .set_dictionary_enabled(dictionary)
        .set_data_page_row_count_limit(*random.of(&[5, 1_000]))
        .set_write_batch_size(4)
        .set_max_row_group_row_count(Some(*random.of(&[20, 1_000])));
    let encoding = match whole {
        true => Encoding::DELTA_BINARY_PACKED,
        false => Encoding::BYTE_STREAM_SPLIT,
    };
    match !dictionary && random.one_in(2) {
        true => builder.set_column_encoding("actual_q_0".into(), encoding),
        false => builder,
    }
    .build()
}
