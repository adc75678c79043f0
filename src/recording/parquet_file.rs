//! Parquet: one column per signal and joint, under RTDE names or as a column map says. Columns of
//! any number type are read; others are left out unless asked for.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use arrow::array::{ArrayRef, AsArray, Float64Array, RecordBatch};
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
use super::file::{cannot, open, replace, unwritten};
use super::format::{Format, WriteOptions};
use super::guard::guarded;
use super::parquet_sizes::{self as sizes, Refused};
use super::rtde_csv::TIME;
use super::{Channel, ColumnMap, Provenance, Recording, RecordingError};
use crate::limits::{Expansion, ROWS, TooMuch, allow_numbers};

/// No quantity of an arm is larger, nor are nanoseconds since 1970.
const LARGEST: f64 = 1e20;
/// Copied at once while writing.
const ROWS_PER_BATCH: usize = 1 << 16;
/// Bytes of a decimal.
const LONGEST_NUMBER: i32 = 32;

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
        replace(path, |file, _| write(recording, file).map_err(|e| unwritten(path, e)))
    }
}

/// A column to read, and what it becomes.
struct Wanted {
    /// Position in the file.
    at: usize,
    name: String,
    scale: f64,
}

/// The file and what reads it, its footer looked at.
pub(super) fn reader(
    path: &Path,
) -> Result<(File, ParquetRecordBatchReaderBuilder<File>), RecordingError> {
    let opened = open(path)?;
    sizes::footer(&opened).map_err(|e| refusal(path, e))?;
    let again = opened.try_clone().map_err(cannot(path, "read"))?;
    let builder = ParquetRecordBatchReaderBuilder::try_new(again)
        .map_err(|e| damaged(path, e.to_string()))?;
    Ok((opened, builder))
}

fn read(path: &Path, map: Option<&ColumnMap>) -> Result<Recording, RecordingError> {
    let file = path.display().to_string();
    let (opened, builder) = reader(path)?;
    let schema = builder.schema().clone();
    let mut notes = Vec::new();
    let (time, wanted) = match map {
        Some(map) => mapped(&schema, map, &file)?,
        None => named(&schema, &file, &mut notes)?,
    };
    let mut roots: Vec<usize> = wanted.iter().map(|w| w.at).chain([time.at]).collect();
    roots.sort_unstable();
    roots.dedup();
    let mut columns = take(path, &opened, builder, &roots)?;
    let rows = columns[time.at].len();
    allow(path, &opened, rows * (wanted.len() + 1))?;
    let format = match map {
        Some(map) => format!("Parquet, columns by {}", map.file),
        None => "Parquet".into(),
    };
    let mut channels = Vec::with_capacity(wanted.len());
    for (k, Wanted { at, name, scale }) in wanted.iter().enumerate() {
        let needed = *at == time.at || wanted[k + 1..].iter().any(|w| w.at == *at);
        let column = &mut columns[*at];
        let values = if needed { column.clone() } else { std::mem::take(column) };
        channels.push(Channel { name: name.clone(), values: scaled(values, *scale) });
    }
    let mut recording = Recording {
        time: scaled(std::mem::take(&mut columns[time.at]), time.scale),
        channels,
        provenance: Provenance { source: file, format, notes },
    };
    let mut lines: Vec<usize> = (1..=rows).collect();
    recording.mend(&mut lines)?;
    refuse_bad(&recording, schema.field(time.at).name(), &lines)?;
    Ok(recording)
}

fn scaled(mut values: Vec<f64>, scale: f64) -> Vec<f64> {
    values.iter_mut().for_each(|v| *v *= scale);
    values
}

/// The numbers of the columns `roots` (sorted) under their places in the file; the others stay empty.
fn take(
    path: &Path,
    opened: &File,
    builder: ParquetRecordBatchReaderBuilder<File>,
    roots: &[usize],
) -> Result<Vec<Vec<f64>>, RecordingError> {
    let file = path.display().to_string();
    let wrong = |e: &dyn std::error::Error| damaged(path, e.to_string());
    let schema = builder.schema().clone();
    let mask = ProjectionMask::roots(builder.parquet_schema(), roots.iter().copied());
    look_at_pages(opened, &builder, &mask).map_err(|e| refusal(path, e))?;
    let mut columns = vec![Vec::new(); schema.fields().len()];
    let mut rows = 0;
    for batch in builder.with_projection(mask).build().map_err(|e| wrong(&e))? {
        let batch = batch.map_err(|e| wrong(&e))?;
        if batch.num_columns() != roots.len() {
            return Err(damaged(path, "columns are missing".into()));
        }
        rows += batch.num_rows();
        ROWS.allow(rows as u64).map_err(|limit| too_much(path, limit))?;
        allow(path, opened, rows * roots.len())?;
        for (at, values) in roots.iter().zip(batch.columns()) {
            extend(&mut columns[*at], values, schema.field(*at).name(), &file)?;
        }
    }
    Ok(columns)
}

/// Names and values of all columns, empty where they hold no numbers; time stamps in s.
///
/// # Errors
/// If it is no Parquet file, or too large.
pub fn columns(path: &Path) -> Result<(Vec<String>, Vec<Vec<f64>>), RecordingError> {
    let read = || {
        let (opened, builder) = reader(path)?;
        let schema = builder.schema().clone();
        let kinds: Vec<&DataType> = schema.fields().iter().map(|f| f.data_type()).collect();
        let number = |kind: &DataType| kind.is_numeric() || seconds_per_unit(kind) != 1.0;
        let roots: Vec<usize> = (0..kinds.len()).filter(|c| number(kinds[*c])).collect();
        let mut values = take(path, &opened, builder, &roots)?;
        for (column, kind) in values.iter_mut().zip(kinds) {
            let scale = seconds_per_unit(kind);
            column.iter_mut().for_each(|v| *v *= scale);
        }
        Ok((schema.fields().iter().map(|f| f.name().clone()).collect(), values))
    };
    guarded(read).unwrap_or_else(|why| Err(damaged(path, why)))
}

pub(super) fn look_at_pages(
    file: &File,
    builder: &ParquetRecordBatchReaderBuilder<File>,
    mask: &ProjectionMask,
) -> Result<(), Refused> {
    let mut expansion = Expansion::default();
    expansion.take(file.metadata()?.len());
    for group in builder.metadata().row_groups() {
        for (leaf, column) in group.columns().iter().enumerate() {
            if !mask.leaf_included(leaf) {
                continue;
            }
            if column.column_descr().type_length() > LONGEST_NUMBER {
                return Err(Refused::Damaged("a number of more than 32 bytes".into()));
            }
            sizes::pages(file, column.byte_range(), &mut expansion)?;
        }
    }
    Ok(())
}

pub(super) fn allow(path: &Path, file: &File, numbers: usize) -> Result<(), RecordingError> {
    let length = file.metadata().map_err(cannot(path, "read"))?.len();
    allow_numbers(numbers as u64, length).map_err(|limit| too_much(path, limit))
}

pub(super) fn too_much(path: &Path, limit: TooMuch) -> RecordingError {
    RecordingError::TooMuch { file: path.display().to_string(), limit }
}

pub(super) fn refusal(path: &Path, refused: Refused) -> RecordingError {
    match refused {
        Refused::Damaged(what) => damaged(path, what),
        Refused::TooMuch(limit) => too_much(path, limit),
    }
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
        if schema.index_of(&name).is_ok_and(|first| first != at) {
            let what = format!("the name {name:?} stands over two columns");
            let remedy = "rename one, or map the columns by number (--columns)";
            return Err(RecordingError::Container { file: file.into(), what, remedy });
        }
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
    refuse_other_than_numbers(schema, [&time], file)?;
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
    let channels: Vec<Wanted> = channels.collect::<Result<_, _>>()?;
    let time = Wanted { at, name: TIME.into(), scale };
    refuse_other_than_numbers(schema, channels.iter().chain([&time]), file)?;
    Ok((time, channels))
}

/// Text and lists are not read: how long they are, no page says.
fn refuse_other_than_numbers<'w>(
    schema: &Schema,
    wanted: impl IntoIterator<Item = &'w Wanted>,
    file: &str,
) -> Result<(), RecordingError> {
    let simple = |kind: &DataType| kind.is_primitive() || *kind == DataType::Boolean;
    let fits = |kind: &DataType| match kind {
        DataType::Dictionary(_, value) => simple(value),
        kind => simple(kind),
    };
    let fields = wanted.into_iter().map(|w| schema.field(w.at));
    let mut others = fields.filter(|field| !fits(field.data_type()));
    others.next().map_or(Ok(()), |field| {
        let (name, kind) = (field.name(), field.data_type());
        let what = format!("column {name} holds {kind}, no numbers");
        let remedy = "write it as numbers, or leave it out of the column map";
        Err(RecordingError::Container { file: file.into(), what, remedy })
    })
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

/// The numbers of a column; what is no number, or beyond anything an arm does, is not a number.
pub(super) fn extend(
    column: &mut Vec<f64>,
    values: &ArrayRef,
    name: &str,
    file: &str,
) -> Result<(), RecordingError> {
    // Calendar types go by way of whole numbers.
    let whole = match values.data_type() {
        DataType::Timestamp(..) | DataType::Duration(_) => cast(values, &DataType::Int64),
        _ => Ok(values.clone()),
    };
    let row = column.len() + 1;
    let numbers = whole.and_then(|v| cast(&v, &DataType::Float64)).map_err(|e| {
        let (file, column, what) = (file.into(), name.into(), e.to_string());
        let remedy = "take columns of numbers only";
        RecordingError::Cell { file, row, column, what, remedy }
    })?;
    let numbers = numbers.as_primitive::<Float64Type>();
    let sound = |v: &f64| v.abs() <= LARGEST;
    column.extend(numbers.iter().map(|value| value.filter(sound).unwrap_or(f64::NAN)));
    Ok(())
}

fn write(recording: &Recording, file: File) -> parquet::errors::Result<()> {
    let names: Vec<&str> = recording.channels.iter().map(|c| c.name.as_str()).collect();
    let mut out = Batches::new(file, &names, &recording.provenance.source)?;
    for first in (0..recording.time.len()).step_by(ROWS_PER_BATCH) {
        let rows = first..recording.time.len().min(first + ROWS_PER_BATCH);
        let values =
            std::iter::once(&recording.time).chain(recording.channels.iter().map(|c| &c.values));
        out.add(values.map(|v| v[rows.clone()].to_vec()).collect())?;
    }
    out.end()
}

/// A Parquet file that is written stretch by stretch.
pub struct Batches {
    schema: Arc<Schema>,
    out: ArrowWriter<File>,
}

impl Batches {
    /// `names` are those of the channels, beside time.
    pub fn new(file: File, names: &[&str], source: &str) -> parquet::errors::Result<Self> {
        let column = |name: &str| Field::new(name, DataType::Float64, false);
        let names = std::iter::once(TIME).chain(names.iter().copied());
        let schema = Arc::new(Schema::new(names.map(column).collect::<Vec<_>>()));
        let note =
            |key: &str, value: &str| KeyValue::new(format!("armtwin.{key}"), value.to_string());
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(ZstdLevel::default()))
            .set_dictionary_enabled(false)
            .set_encoding(Encoding::BYTE_STREAM_SPLIT)
            .set_key_value_metadata(Some(vec![
                note("version", env!("CARGO_PKG_VERSION")),
                note("source", source),
            ]))
            .build();
        let out = ArrowWriter::try_new(file, schema.clone(), Some(properties))?;
        Ok(Self { schema, out })
    }

    /// Adds rows, column by column, time first.
    pub fn add(&mut self, columns: Vec<Vec<f64>>) -> parquet::errors::Result<()> {
        let columns = columns.into_iter().map(|c| Arc::new(Float64Array::from(c)) as ArrayRef);
        self.out.write(&RecordBatch::try_new(self.schema.clone(), columns.collect())?)
    }

    /// Writes what makes it a whole file.
    pub fn end(self) -> parquet::errors::Result<()> {
        self.out.close().map(drop)
    }
}

/// The refusal of a file that is not as its format wants it.
pub fn damaged(path: &Path, what: String) -> RecordingError {
    RecordingError::Container {
        file: path.display().to_string(),
        what: format!("not a Parquet file that can be read here ({what})"),
        remedy: "copy it again, or write it with snappy, zstd or no compression",
    }
}
