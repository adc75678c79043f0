//! What can be wrong with a recording: each message names the file, where in it, and what to do.

use std::io;

use crate::limits::TooMuch;

/// Rows are counted from 1 as an editor shows them, header and blank lines included.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    #[error("{file}: no such file or folder; check the path")]
    NotFound { file: String },
    #[error("{file}: cannot be {action}: {source}")]
    Io { file: String, action: &'static str, source: io::Error },
    #[error("{file}: the gzip data are damaged ({source}); copy or download the file again")]
    Gzip { file: String, source: io::Error },
    #[error("{file}: the file is empty; record again or check the path")]
    Empty { file: String },
    #[error(
        "{folder}: a folder without log_q_actual.csv, so not a movement folder with one log per \
         signal; name a file in it, or a folder that holds that log"
    )]
    NotAMovement { folder: String },
    #[error("{file}: not UTF-8 text ({why}); save it as UTF-8 CSV")]
    NotText { file: String, why: &'static str },
    #[error(
        "{file}: row {row} holds one column only ({start:?}); columns must be separated by comma, \
         blank or tab, or name another delimiter in a column map (--columns)"
    )]
    Delimiter { file: String, row: usize, start: String },
    #[error(
        "{file}: row {row} holds {columns} numbers where column names are expected; say what the \
         columns are in a column map (--columns, examples in scenarios/columns)"
    )]
    NoHeader { file: String, row: usize, columns: usize },
    #[error(
        "{file}: row {row}: the name {name:?} stands in columns {first} and {second}; rename one"
    )]
    DuplicateColumn { file: String, row: usize, name: String, first: usize, second: usize },
    #[error("{file}: no column {column} (columns there: {found}); {remedy}")]
    MissingColumn { file: String, column: String, found: String, remedy: &'static str },
    #[error("{file}: row {row}, column {column}: {what}; {remedy}")]
    Cell { file: String, row: usize, column: String, what: String, remedy: &'static str },
    #[error(
        "{file}: row {row} has {found} columns where {expected} are expected; mend or delete the row"
    )]
    Ragged { file: String, row: usize, found: usize, expected: usize },
    #[error(
        "{file}: row {row}, column {column}: time {what} ({before} s, then {after} s); sort the \
         rows, delete the repeated ones, or cut the file there"
    )]
    Time { file: String, row: usize, column: String, what: &'static str, before: f64, after: f64 },
    #[error("{file}: {samples} samples, at least {needed} are needed; record for longer")]
    TooFew { file: String, samples: usize, needed: usize },
    #[error(
        "{file}: no column {column} although {next} is there: one joint is missing; add it, or \
         leave {stem} out for all joints"
    )]
    JointGap { file: String, stem: String, column: String, next: String },
    #[error(
        "{file}: {stem} has {joints} joints but {other} has {other_joints}: no column {column}; \
         every joint needs every signal"
    )]
    JointCount {
        file: String,
        stem: String,
        joints: usize,
        other: String,
        other_joints: usize,
        column: String,
    },
    /// Message counted from 1 on its topic.
    #[error("{file}: message {message} of {topic}: {what}")]
    Message { file: String, topic: String, message: usize, what: String },
    /// A bag or another file that is no text.
    #[error("{file}: {what}; {remedy}")]
    Container { file: String, what: String, remedy: &'static str },
    #[error("{file}: this armtwin was built without the feature `{feature}`, which reads it")]
    LeftOut { file: String, feature: &'static str },
    #[error("{file}: {column} has {given} samples, time has {needed}: give equally many")]
    Length { file: String, column: String, given: usize, needed: usize },
    /// Rows counted from 1.
    #[error(
        "{file}: {count} rows hold something that is no number (NaN or infinite), the first is row {row}, in \
         {column}: fill them, or leave these rows out"
    )]
    NoNumber { file: String, column: String, row: usize, count: usize },
    #[error("{second}: holds the same samples as {first}; name another recording")]
    Same { first: String, second: String },
    #[error("{file}: {what}")]
    ColumnMap { file: String, what: String },
    #[error("{file}: {limit}")]
    TooMuch { file: String, limit: TooMuch },
    #[error("{file}: a recording cannot be written under this extension; known are {known}")]
    UnknownExtension { file: String, known: String },
}
