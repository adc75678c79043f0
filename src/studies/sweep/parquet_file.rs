//! Tables as Parquet files: the only place that knows arrow.
//!
//! The 32 bytes before the footer are the SHA-256 of all others. No reader of Parquet looks there,
//! and what is damaged is told before it is decoded.

use std::path::Path;
use std::sync::Arc;

use arrow::array::{
    Array, ArrayRef, BooleanArray, Float64Array, RecordBatch, StringArray, UInt64Array,
};
use arrow::datatypes::DataType;
use bytes::Bytes;
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::basic::{Compression, ZstdLevel};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use sha2::{Digest, Sha256};

use super::table::{Column, Table};
use crate::files::{write_own, write_whole};
use crate::studies::StudyError;

/// Length of the footer (u32, little endian) and "PAR1": how every Parquet file ends.
const END: usize = 8;
const MAGIC: &[u8] = b"PAR1";
const DIGEST: usize = 32;

/// Writes a table with `notes` beside it; the same table and notes make the same bytes.
///
/// # Errors
/// If the file cannot be written whole.
pub fn write(path: &Path, table: &Table, notes: &[(&str, String)]) -> Result<(), StudyError> {
    let bytes = bytes(path, table, notes)?;
    write_whole(path, |out| out.write_all(&bytes)).map_err(StudyError::io(path, "written"))
}

/// Writes a table as [`write`] does, into a folder whose owner knows what lies there.
///
/// # Errors
/// As [`write`].
pub fn keep(path: &Path, table: &Table, notes: &[(&str, String)]) -> Result<(), StudyError> {
    let bytes = bytes(path, table, notes)?;
    write_own(path, |out| out.write_all(&bytes)).map_err(StudyError::io(path, "written"))
}

fn bytes(path: &Path, table: &Table, notes: &[(&str, String)]) -> Result<Vec<u8>, StudyError> {
    let bytes = encoded(table, notes).map_err(|e| StudyError::file(path, e))?;
    sealed(&bytes).ok_or_else(|| StudyError::file(path, "no footer was made"))
}

fn encoded(table: &Table, notes: &[(&str, String)]) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let arrays = table.names.iter().zip(&table.columns).map(|(name, c)| (name, array(c)));
    let batch = RecordBatch::try_from_iter(arrays)?;
    let note = |(key, value): &(&str, String)| KeyValue::new(key.to_string(), value.clone());
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_created_by(concat!("armtwin ", env!("CARGO_PKG_VERSION")).into())
        .set_key_value_metadata(Some(notes.iter().map(note).collect()))
        .build();
    let mut bytes = Vec::new();
    let mut writer = ArrowWriter::try_new(&mut bytes, batch.schema(), Some(properties))?;
    writer.write(&batch)?;
    writer.close()?;
    Ok(bytes)
}

/// Where the footer begins; `None` in what does not end as Parquet does.
fn footer(bytes: &[u8]) -> Option<usize> {
    let end = bytes.len().checked_sub(END)?;
    let (length, magic) = bytes[end..].split_first_chunk::<4>()?;
    let start = end.checked_sub(u32::from_le_bytes(*length) as usize)?;
    (magic == MAGIC).then_some(start)
}

fn digest(before: &[u8], footer: &[u8]) -> [u8; DIGEST] {
    Sha256::new().chain_update(before).chain_update(footer).finalize().into()
}

fn sealed(bytes: &[u8]) -> Option<Vec<u8>> {
    let (before, footer) = bytes.split_at(footer(bytes)?);
    Some([before, &digest(before, footer), footer].concat())
}

/// Are these the bytes that were written?
fn whole(bytes: &[u8]) -> bool {
    let parts = footer(bytes).and_then(|at| Some((at.checked_sub(DIGEST)?, at)));
    parts.is_some_and(|(seal, at)| bytes[seal..at] == digest(&bytes[..seal], &bytes[at..]))
}

fn array(column: &Column) -> ArrayRef {
    match column {
        Column::Text(all) => Arc::new(StringArray::from_iter_values(all)),
        Column::Number(all) => Arc::new(Float64Array::from(all.clone())),
        Column::Whole(all) => Arc::new(UInt64Array::from(all.clone())),
        Column::Flag(all) => Arc::new(BooleanArray::from(all.clone())),
    }
}

/// A table and its notes.
///
/// # Errors
/// If the file cannot be read, or its bytes are not those written.
pub fn read(path: &Path) -> Result<Decoded, StudyError> {
    let bytes = std::fs::read(path).map_err(StudyError::io(path, "read"))?;
    if !whole(&bytes) {
        let todo = "remove this file and run the same command again; the other parts are kept";
        let why = format!("damaged (its bytes are not those that were written): {todo}");
        return Err(StudyError::file(path, why));
    }
    decoded(bytes).map_err(|e| StudyError::file(path, e))
}

type Decoded = (Table, Vec<(String, String)>);

fn decoded(bytes: Vec<u8>) -> Result<Decoded, Box<dyn std::error::Error>> {
    let builder = ParquetRecordBatchReaderBuilder::try_new(Bytes::from(bytes))?;
    let notes = builder.metadata().file_metadata().key_value_metadata();
    let note = |n: &KeyValue| (n.key.clone(), n.value.clone().unwrap_or_default());
    let notes = notes.map(|all| all.iter().map(note).collect()).unwrap_or_default();
    let mut table = Table::default();
    for batch in builder.build()? {
        let batch = batch?;
        let schema = batch.schema();
        let names = schema.fields().iter().map(|f| f.name().clone()).collect();
        let columns = batch.columns().iter().map(column).collect::<Option<_>>();
        let columns = columns.ok_or("a column of a type that is never written")?;
        table.append(&Table { names, columns })?;
    }
    Ok((table, notes))
}

fn column(array: &ArrayRef) -> Option<Column> {
    let any = array.as_any();
    Some(match array.data_type() {
        DataType::Utf8 => {
            let all = any.downcast_ref::<StringArray>()?;
            Column::Text((0..all.len()).map(|i| all.value(i).to_string()).collect())
        }
        DataType::Float64 => Column::Number(any.downcast_ref::<Float64Array>()?.values().to_vec()),
        DataType::UInt64 => Column::Whole(any.downcast_ref::<UInt64Array>()?.values().to_vec()),
        DataType::Boolean => {
            let all = any.downcast_ref::<BooleanArray>()?;
            Column::Flag((0..all.len()).map(|i| all.value(i)).collect())
        }
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_comes_back_to_the_last_bit_and_damage_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.parquet");
        let rows = (0..40usize).map(|n| {
            let x = if n == 3 { f64::NAN } else { 1.0 / n as f64 };
            vec![("n", n.into()), ("x", x.into()), ("t", "a b".into()), ("f", (n > 7).into())]
        });
        let table = Table::of(&rows.collect::<Vec<_>>()).unwrap();
        write(&path, &table, &[("study", "abc".into())]).unwrap();
        let first = std::fs::read(&path).unwrap();
        let (back, notes) = read(&path).unwrap();
        assert_eq!(back.bytes(), table.bytes());
        assert!(notes.contains(&("study".into(), "abc".into())));
        write(&path, &table, &[("study", "abc".into())]).unwrap();
        assert_eq!(first, std::fs::read(&path).unwrap());
        for at in (0..first.len()).step_by(7) {
            let mut broken = first.clone();
            broken[at] ^= 0x15;
            assert!(!whole(&broken), "byte {at}");
        }
        std::fs::write(&path, &first[..first.len() / 2]).unwrap();
        assert!(read(&path).unwrap_err().to_string().contains("damaged"));
        std::fs::write(&path, b"").unwrap();
        assert!(read(&path).unwrap_err().to_string().contains("damaged"));
    }
}
