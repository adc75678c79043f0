//! Tables as Parquet files: the only place that knows arrow.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use arrow::array::{
    Array, ArrayRef, BooleanArray, Float64Array, RecordBatch, StringArray, UInt64Array,
};
use arrow::datatypes::DataType;
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::basic::{Compression, ZstdLevel};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;

use super::table::{Column, Table};
use crate::files::write_whole;
use crate::studies::StudyError;
use crate::trials::sha256;

/// SHA-256 of the values: damage that Parquet would not notice.
const DIGEST: &str = "armtwin.sha256";

/// Writes a table with `notes` beside it; the same table and notes make the same bytes.
///
/// # Errors
/// If the file cannot be written whole.
pub fn write(path: &Path, table: &Table, notes: &[(&str, String)]) -> Result<(), StudyError> {
    let bytes = encoded(table, notes).map_err(|e| StudyError::file(path, e))?;
    write_whole(path, |out| out.write_all(&bytes)).map_err(StudyError::io(path, "written"))
}

fn encoded(table: &Table, notes: &[(&str, String)]) -> Result<Vec<u8>, Box<dyn std::error::Error>> {
    let arrays = table.names.iter().zip(&table.columns).map(|(name, c)| (name, array(c)));
    let batch = RecordBatch::try_from_iter(arrays)?;
    let digest = (DIGEST, sha256(&table.bytes()));
    let note = |(key, value): &(&str, String)| KeyValue::new(key.to_string(), value.clone());
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_created_by(concat!("armtwin ", env!("CARGO_PKG_VERSION")).into())
        .set_key_value_metadata(Some([digest].iter().chain(notes).map(note).collect()))
        .build();
    let mut bytes = Vec::new();
    let mut writer = ArrowWriter::try_new(&mut bytes, batch.schema(), Some(properties))?;
    writer.write(&batch)?;
    writer.close()?;
    Ok(bytes)
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
/// If the file cannot be read, is no Parquet file of ours, or its values are not those written.
pub fn read(path: &Path) -> Result<(Table, Vec<(String, String)>), StudyError> {
    let file = File::open(path).map_err(StudyError::io(path, "read"))?;
    // The crate panics on some damaged footers.
    let outcome = std::panic::catch_unwind(move || decoded(file));
    let outcome = outcome.unwrap_or_else(|_| Err("its footer makes no sense".into()));
    let (table, notes) = outcome.map_err(|e| damaged(path, &e.to_string()))?;
    match notes.iter().find(|(key, _)| key == DIGEST) {
        Some((_, digest)) if *digest == sha256(&table.bytes()) => Ok((table, notes)),
        _ => Err(damaged(path, "its values are not those that were written")),
    }
}

fn damaged(path: &Path, why: &str) -> StudyError {
    let todo = "remove this file and run the same command again; the other parts are kept";
    StudyError::file(path, format!("damaged ({why}): {todo}"))
}

type Decoded = (Table, Vec<(String, String)>);

fn decoded(file: File) -> Result<Decoded, Box<dyn std::error::Error>> {
    let builder = ParquetRecordBatchReaderBuilder::try_new(file)?;
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
        for at in (0..first.len()).step_by(97) {
            let mut broken = first.clone();
            broken[at] ^= 0x15;
            std::fs::write(&path, &broken).unwrap();
            if let Ok((other, _)) = read(&path) {
                assert_eq!(other.bytes(), table.bytes(), "byte {at}");
            }
        }
        std::fs::write(&path, &first[..first.len() / 2]).unwrap();
        assert!(read(&path).unwrap_err().to_string().contains("damaged"));
    }
}
