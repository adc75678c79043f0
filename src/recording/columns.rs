//! Column maps: a small TOML that says what the columns of a foreign CSV are.
//!
//! ```toml
//! time = 1                                       # column number from 1, or a header name
//! [channels]
//! actual_q = { first = 2, count = 6 }
//! actual_qd = { columns = [8, 9, 10, 11, 12, 13], scale = 0.0174532925199433 }
//! ```

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use super::RecordingError;
use super::bag_map::BagMap;
use super::file::cannot;
use super::lerobot_map::LerobotMap;
use super::scale::{Scale, is_factor};
use super::text::{Delimiter, Layout};
use crate::limits::{COLUMNS, read_settings};

/// What the columns of a foreign CSV are.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColumnMap {
    /// Found out if left out.
    pub delimiter: Option<Delimiter>,
    /// Lines in front of the header or the first row.
    #[serde(default)]
    pub skip_rows: usize,
    #[serde(default)]
    pub decimal: Decimal,
    /// Columns every row must have; not checked if left out.
    pub file_columns: Option<usize>,
    /// Needed for files with columns.
    time: Option<Column>,
    /// Seconds per unit of the time column.
    #[serde(default = "one")]
    pub time_scale: f64,
    /// By RTDE stem; joint j becomes `stem_j`.
    #[serde(default)]
    pub channels: BTreeMap<String, Channels>,
    /// For ROS 2 bags, which have names instead of columns.
    pub bag: Option<BagMap>,
    /// For LeRobot data sets, which do not say what their numbers are.
    pub lerobot: Option<LerobotMap>,
    /// Where the map came from, for messages.
    #[serde(skip)]
    pub file: String,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
pub enum Decimal {
    #[default]
    #[serde(rename = ".")]
    Point,
    #[serde(rename = ",")]
    Comma,
}

/// One column of the file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged, expecting = "a column number from 1 or a name of the header")]
pub enum Column {
    Number(usize),
    Name(String),
}

/// The columns of one signal, base to wrist.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Channels {
    /// One by one; or `first` and `count`.
    columns: Option<Vec<Column>>,
    first: Option<usize>,
    count: Option<usize>,
    /// SI units per unit of the file.
    #[serde(default)]
    scale: Scale,
}

fn one() -> f64 {
    1.0
}

/// One column to read and what it becomes.
#[derive(Debug, PartialEq)]
pub struct Mapped {
    pub name: String,
    pub column: Column,
    pub scale: f64,
}

impl ColumnMap {
    pub fn load(path: &Path) -> Result<Self, RecordingError> {
        let file = path.display().to_string();
        let text = read_settings(path).map_err(cannot(path, "read"))?;
        Self::parse(&text, &file)
    }

    pub fn parse(text: &str, file: &str) -> Result<Self, RecordingError> {
        let wrong = |what: String| RecordingError::ColumnMap { file: file.into(), what };
        let mut map: ColumnMap = toml::from_str(text).map_err(|e| {
            wrong(format!("{} (keys are explained in scenarios/columns)", e.to_string().trim()))
        })?;
        map.file = file.into();
        match &map.bag {
            Some(bag) => bag.check().map_err(wrong)?,
            None if map.lerobot.is_some() => {}
            None => drop(map.time()?),
        }
        if map.bag.is_none() && map.lerobot.is_none() || map.time.is_some() {
            map.mapped()?;
        }
        Ok(map)
    }

    /// The time column.
    ///
    /// # Errors
    /// If there is none: the map is for bags.
    pub fn time(&self) -> Result<&Column, RecordingError> {
        self.time.as_ref().ok_or_else(|| RecordingError::ColumnMap {
            file: self.file.clone(),
            what: "missing field `time`; name the time column (keys are explained in \
                   scenarios/columns)"
                .into(),
        })
    }

    /// A column of the map, for messages.
    pub fn describe(&self, column: &Column) -> String {
        match column {
            Column::Number(n) => format!("{n} (named in {})", self.file),
            Column::Name(name) => format!("{name:?} (named in {})", self.file),
        }
    }

    pub fn layout(&self) -> Layout {
        Layout {
            delimiter: self.delimiter,
            skip_rows: self.skip_rows,
            decimal_comma: self.decimal == Decimal::Comma,
        }
    }

    /// Every column to read besides time.
    pub fn mapped(&self) -> Result<Vec<Mapped>, RecordingError> {
        let wrong = |what: String| RecordingError::ColumnMap { file: self.file.clone(), what };
        let mut all = Vec::new();
        if self.channels.is_empty() {
            return Err(wrong("[channels] is empty; name at least one signal".into()));
        }
        if !(is_factor(self.time_scale) && self.time_scale > 0.0) {
            let scale = self.time_scale;
            return Err(wrong(format!("time_scale is {scale}, must be positive and 1e15 at most")));
        }
        if self.delimiter == Some(Delimiter::Comma) && self.decimal == Decimal::Comma {
            return Err(wrong(
                "decimal and delimiter are both a comma; name another delimiter".into(),
            ));
        }
        for (stem, channels) in &self.channels {
            let columns = channels.columns().map_err(|e| wrong(format!("channels.{stem}: {e}")))?;
            let scales = channels.scale.expand(columns.len());
            let scales = scales.map_err(|e| wrong(format!("channels.{stem}: {e}")))?;
            all.extend(
                columns.into_iter().zip(scales).enumerate().map(|(j, (column, scale))| Mapped {
                    name: format!("{stem}_{j}"),
                    column,
                    scale,
                }),
            );
        }
        COLUMNS.allow(all.len() as u64).map_err(|e| wrong(e.to_string()))?;
        Ok(all)
    }
}

impl Channels {
    fn columns(&self) -> Result<Vec<Column>, String> {
        let columns: Vec<Column> = match (&self.columns, self.first, self.count) {
            (Some(columns), None, None) => columns.clone(),
            (None, Some(first), Some(count)) => {
                (first..first.saturating_add(count.min(1000))).map(Column::Number).collect()
            }
            _ => return Err("give either columns = [...] or first = ... and count = ...".into()),
        };
        if columns.is_empty() {
            return Err("no columns; name at least one".into());
        }
        if columns.contains(&Column::Number(0)) {
            return Err("column 0; columns count from 1".into());
        }
        Ok(columns)
    }
}
