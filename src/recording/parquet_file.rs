//! Parquet: one column per signal and joint, under RTDE names or as a column map says. Columns of
//! any number type are read; others are left out unless asked for.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use arrow::array::{Array, ArrayRef, Float64Array, RecordBatch};
use arrow::compute::cast;
use arrow::datatypes::{DataType, Field, Float64Type, Schema, TimeUnit};
use parquet::arrow::ArrowWriter;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::basic::{Compression, Encoding, ZstdLevel};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;

use super::check::refuse_bad;
use super::columns::Column;
use super::file::{open, replace};
use super::format::{Format, WriteOptions};
use super::guard::guarded;
use super::rtde_csv::TIME;
use super::{Channel, ColumnMap, Provenance, Recording, RecordingError};

pub struct Parquet;

impl Format for Parquet {
    fn name(&self) -> &'static str {
        "Parquet"
    }

    fn reads(&self, path: &Path) -> bool {
        path.is_file()
            && path
                .extension()
                .is_some_and(|e| e.eq_ignore_ascii_case("parquet") || e.eq_ignore_ascii_case("pq"))
    }

    fn read(&self, path: &Path, map: Option<&ColumnMap>) -> Result<Recording, RecordingError> {
        let what = |why: String| Err(damaged(path, why));
        guarded(|| read(path, map)).unwrap_or_else(what)
    }

    fn extensions(&self) -> &'static [&'static str] {
        &[".parquet"]
    }

    fn write(
        &self,
        recording: &Recording,
        path: &Path,
        _: &WriteOptions,
    ) -> Result<(), RecordingError> {
        replace(path, |file, _| write(recording, file).map_err(|e| damaged(path, e.to_string())))
    }
}

/// A column to read, and what it becomes.
struct Wanted {
    /// Position in the file.
    at: usize,
    name: String,
    scale: f64,
}

fn read(path: &Path, map: Option<&ColumnMap>) -> Result<Recording, RecordingError> {
    let file = path.display().to_string();
    let wrong = |e: &dyn std::error::Error| damaged(path, e.to_string());
    let builder = ParquetRecordBatchReaderBuilder::try_new(open(path)?).map_err(|e| wrong(&e))?;
    let schema = builder.schema().clone();
    let mut notes = Vec::new();
    let (time, wanted) = match map {
        Some(map) => mapped(&schema, map, &file)?,
        None => named(&schema, &file, &mut notes)?,
    };
    let roots: Vec<usize> = wanted.iter().map(|w| w.at).chain([time.at]).collect();
    let columns = load(builder, &roots, path)?;
    let scaled = |w: &Wanted| columns[w.at].iter().map(|v| v * w.scale).collect::<Vec<f64>>();
    let format = match map {
        Some(map) => format!("Parquet, columns by {}", map.file),
        None => "Parquet".into(),
    };
    let recording = Recording {
        time: scaled(&time),
        channels: wanted
            .iter()
            .map(|w| Channel { name: w.name.clone(), values: scaled(w) })
            .collect(),
        provenance: Provenance { source: file, format, notes },
    };
    let lines: Vec<usize> = (1..=recording.time.len()).collect();
    refuse_bad(&recording, schema.field(time.at).name(), &lines)?;
    Ok(recording)
}

/// The columns `roots` of a file, by their positions in it; the others are empty.
fn load(
    builder: ParquetRecordBatchReaderBuilder<File>,
    roots: &[usize],
    path: &Path,
) -> Result<Vec<Vec<f64>>, RecordingError> {
    let wrong = |e: &dyn std::error::Error| damaged(path, e.to_string());
    let schema = builder.schema().clone();
    let mask = ProjectionMask::roots(builder.parquet_schema(), roots.iter().copied());
    let mut columns = vec![Vec::new(); schema.fields().len()];
    for batch in builder.with_projection(mask).build().map_err(|e| wrong(&e))? {
        let batch = batch.map_err(|e| wrong(&e))?;
        for (field, values) in batch.schema().fields().iter().zip(batch.columns()) {
            let at = schema.index_of(field.name()).map_err(|e| wrong(&e))?;
            extend(&mut columns[at], values, field.name(), &path.display().to_string())?;
        }
    }
    Ok(columns)
}

/// Names and values of all columns, empty where they hold no numbers; time stamps in s.
///
/// # Errors
/// If it is no Parquet file.
pub fn columns(path: &Path) -> Result<(Vec<String>, Vec<Vec<f64>>), RecordingError> {
    let read = || {
        let builder = ParquetRecordBatchReaderBuilder::try_new(open(path)?)
            .map_err(|e| damaged(path, e.to_string()))?;
        let schema = builder.schema().clone();
        let kinds: Vec<&DataType> = schema.fields().iter().map(|f| f.data_type()).collect();
        let number = |kind: &DataType| kind.is_numeric() || seconds_per_unit(kind) != 1.0;
        let roots: Vec<usize> = (0..kinds.len()).filter(|c| number(kinds[*c])).collect();
        let mut values = load(builder, &roots, path)?;
        for (column, kind) in values.iter_mut().zip(kinds) {
            let scale = seconds_per_unit(kind);
            column.iter_mut().for_each(|v| *v *= scale);
        }
        Ok((schema.fields().iter().map(|f| f.name().clone()).collect(), values))
    };
    guarded(read).unwrap_or_else(|why| Err(damaged(path, why)))
}

/// All columns of numbers under their own names.
fn named(
    schema: &Schema,
    file: &str,
    notes: &mut Vec<String>,
) -> Result<(Wanted, Vec<Wanted>), RecordingError> {
    let mut wanted = Vec::new();
    let mut left_out = Vec::new();
    for (at, field) in schema.fields().iter().enumerate() {
        let name = field.name().clone();
        match field.data_type().is_numeric() || name == TIME {
            true => wanted.push(Wanted { at, name, scale: 1.0 }),
            false => left_out.push(name),
        }
    }
    if !left_out.is_empty() {
        notes.push(format!("left out columns that hold no numbers: {}", left_out.join(", ")));
    }
    let Some(time) = wanted.iter().position(|w| w.name == TIME) else {
        return Err(RecordingError::MissingColumn {
            file: file.into(),
            column: TIME.into(),
            found: found(schema),
            remedy: "rename the time column, or map the columns by name (--columns)",
        });
    };
    let time = wanted.remove(time);
    let scale = seconds_per_unit(schema.field(time.at).data_type());
    Ok((Wanted { scale, ..time }, wanted))
}

fn mapped(
    schema: &Schema,
    map: &ColumnMap,
    file: &str,
) -> Result<(Wanted, Vec<Wanted>), RecordingError> {
    let locate = |column: &Column| {
        let at = match column {
            Column::Number(n) => n.checked_sub(1).filter(|c| *c < schema.fields().len()),
            Column::Name(name) => schema.index_of(name).ok(),
        };
        at.ok_or_else(|| RecordingError::MissingColumn {
            file: file.into(),
            column: map.describe(column),
            found: found(schema),
            remedy: "correct the column map",
        })
    };
    let at = locate(map.time()?)?;
    let scale = map.time_scale * seconds_per_unit(schema.field(at).data_type());
    let channels = map
        .mapped()?
        .into_iter()
        .map(|m| Ok(Wanted { at: locate(&m.column)?, name: m.name, scale: m.scale }));
    Ok((Wanted { at, name: TIME.into(), scale }, channels.collect::<Result<_, _>>()?))
}

fn found(schema: &Schema) -> String {
    let names: Vec<_> = schema.fields().iter().take(8).map(|f| f.name().as_str()).collect();
    let more = if schema.fields().len() > 8 { ", ..." } else { "" };
    format!("{}{more}", names.join(", "))
}

fn seconds_per_unit(kind: &DataType) -> f64 {
    match kind {
        DataType::Timestamp(unit, _) | DataType::Duration(unit) => match unit {
            TimeUnit::Second => 1.0,
            TimeUnit::Millisecond => 1e-3,
            TimeUnit::Microsecond => 1e-6,
            TimeUnit::Nanosecond => 1e-9,
        },
        _ => 1.0,
    }
}

fn extend(
    column: &mut Vec<f64>,
    values: &ArrayRef,
    name: &str,
    file: &str,
) -> Result<(), RecordingError> {
    let wrong = |row: usize, what: String, remedy| RecordingError::Cell {
        file: file.into(),
        row,
        column: name.into(),
        what,
        remedy,
    };
    let first = column.len();
    // Calendar types go by way of whole numbers.
    let whole = match values.data_type() {
        DataType::Timestamp(..) | DataType::Duration(_) => cast(values, &DataType::Int64),
        _ => Ok(values.clone()),
    };
    let numbers = whole
        .and_then(|v| cast(&v, &DataType::Float64))
        .map_err(|e| wrong(first + 1, e.to_string(), "take columns of numbers only"))?;
    let numbers = arrow::array::AsArray::as_primitive::<Float64Type>(&numbers);
    for (k, value) in numbers.iter().enumerate() {
        match value {
            Some(v) if v.is_finite() => column.push(v),
            Some(v) => {
                return Err(wrong(
                    first + k + 1,
                    format!("the value is {v}"),
                    "mend or delete the row",
                ));
            }
            None => {
                return Err(wrong(
                    first + k + 1,
                    "the cell is empty".into(),
                    "mend or delete the row",
                ));
            }
        }
    }
    Ok(())
}

fn write(recording: &Recording, file: File) -> parquet::errors::Result<()> {
    let column = |name: &str| Field::new(name, DataType::Float64, false);
    let names = std::iter::once(TIME).chain(recording.channels.iter().map(|c| c.name.as_str()));
    let schema = Arc::new(Schema::new(names.map(column).collect::<Vec<_>>()));
    let values =
        std::iter::once(&recording.time).chain(recording.channels.iter().map(|c| &c.values));
    let arrays: Vec<ArrayRef> =
        values.map(|v| Arc::new(Float64Array::from(v.clone())) as ArrayRef).collect();
    let batch = RecordBatch::try_new(schema.clone(), arrays)?;
    let note = |key: &str, value: &str| KeyValue::new(format!("armtwin.{key}"), value.to_string());
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_dictionary_enabled(false)
        .set_encoding(Encoding::BYTE_STREAM_SPLIT)
        .set_key_value_metadata(Some(vec![
            note("version", env!("CARGO_PKG_VERSION")),
            note("source", &recording.provenance.source),
        ]))
        .build();
    let mut out = ArrowWriter::try_new(file, schema, Some(properties))?;
    out.write(&batch)?;
    out.close().map(drop)
}

fn damaged(path: &Path, what: String) -> RecordingError {
    RecordingError::Container {
        file: path.display().to_string(),
        what: format!("not a Parquet file that can be read here ({what})"),
        remedy: "copy it again, or write it with snappy, zstd or no compression",
    }
}
