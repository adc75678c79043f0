//! What a Parquet file says of its sizes, looked at before its decoder, which makes room for whatever
//! they say. Shapes are those of `parquet.thrift` (github.com/apache/parquet-format, 2.12).

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};

use super::thrift::{Found, Shape, walk};
use crate::limits::{COLUMNS, Expansion, FOOTER, NESTING, TooMuch};

use Shape::{Bool, Bytes, Double, Int, List, Struct};

const MAGIC: &[u8] = b"PAR1";
/// Length and magic.
const TAIL: u64 = 8;
/// A dictionary holds no shorter values (BOOLEAN has none).
const SHORTEST_VALUE: u64 = 4;
/// Elements of a schema per column: groups and lists around it.
const ELEMENTS_PER_COLUMN: u64 = 4;

static EMPTY: &[(i16, Shape)] = &[];
static TIME: &[(i16, Shape)] =
    &[(1, Bool), (2, Struct(&[(1, Struct(EMPTY)), (2, Struct(EMPTY)), (3, Struct(EMPTY))]))];
static LOGICAL: &[(i16, Shape)] = &[
    (1, Struct(EMPTY)),
    (2, Struct(EMPTY)),
    (3, Struct(EMPTY)),
    (4, Struct(EMPTY)),
    (5, Struct(&[(1, Int(4)), (2, Int(4))])),
    (6, Struct(EMPTY)),
    (7, Struct(TIME)),
    (8, Struct(TIME)),
    (10, Struct(&[(1, Int(1)), (2, Bool)])),
    (11, Struct(EMPTY)),
    (12, Struct(EMPTY)),
    (13, Struct(EMPTY)),
    (14, Struct(EMPTY)),
    (15, Struct(EMPTY)),
    (16, Struct(&[(1, Int(1))])),
    (17, Struct(&[(1, Bytes)])),
    (18, Struct(&[(1, Bytes), (2, Int(4))])),
];
static ELEMENT: Shape = Struct(&[
    (1, Int(4)),
    (2, Int(4)),
    (3, Int(4)),
    (4, Bytes),
    (5, Int(4)),
    (6, Int(4)),
    (7, Int(4)),
    (8, Int(4)),
    (9, Int(4)),
    (10, Struct(LOGICAL)),
]);
static STATISTICS: &[(i16, Shape)] = &[
    (1, Bytes),
    (2, Bytes),
    (3, Int(8)),
    (4, Int(8)),
    (5, Bytes),
    (6, Bytes),
    (7, Bool),
    (8, Bool),
];
static KEY_VALUE: Shape = Struct(&[(1, Bytes), (2, Bytes)]);
static GEOSPATIAL: &[(i16, Shape)] = &[
    (
        1,
        Struct(&[
            (1, Double),
            (2, Double),
            (3, Double),
            (4, Double),
            (5, Double),
            (6, Double),
            (7, Double),
            (8, Double),
        ]),
    ),
    (2, List(&Int(4))),
];
static COLUMN: Shape = Struct(&[
    (1, Bytes),
    (2, Int(8)),
    (
        3,
        Struct(&[
            (1, Int(4)),
            (2, List(&Int(4))),
            (3, List(&Bytes)),
            (4, Int(4)),
            (5, Int(8)),
            (6, Int(8)),
            (7, Int(8)),
            (8, List(&KEY_VALUE)),
            (9, Int(8)),
            (10, Int(8)),
            (11, Int(8)),
            (12, Struct(STATISTICS)),
            (13, List(&Struct(&[(1, Int(4)), (2, Int(4)), (3, Int(4))]))),
            (14, Int(8)),
            (15, Int(4)),
            (16, Struct(&[(1, Int(8)), (2, List(&Int(8))), (3, List(&Int(8)))])),
            (17, Struct(GEOSPATIAL)),
        ]),
    ),
    (4, Int(8)),
    (5, Int(4)),
    (6, Int(8)),
    (7, Int(4)),
]);
static ROW_GROUP: Shape = Struct(&[
    (1, List(&COLUMN)),
    (2, Int(8)),
    (3, Int(8)),
    (4, List(&Struct(&[(1, Int(4)), (2, Bool), (3, Bool)]))),
    (5, Int(8)),
    (6, Int(8)),
    (7, Int(2)),
]);
static FILE: &[(i16, Shape)] = &[
    (1, Int(4)),
    (2, List(&ELEMENT)),
    (3, Int(8)),
    (4, List(&ROW_GROUP)),
    (5, List(&KEY_VALUE)),
    (6, Bytes),
    (7, List(&Struct(&[(1, Struct(EMPTY))]))),
];
static PAGE: &[(i16, Shape)] = &[
    (1, Int(4)),
    (2, Int(4)),
    (3, Int(4)),
    (4, Int(4)),
    (5, Struct(&[(1, Int(4)), (2, Int(4)), (3, Int(4)), (4, Int(4)), (5, Struct(STATISTICS))])),
    (6, Struct(EMPTY)),
    (7, Struct(&[(1, Int(4)), (2, Int(4)), (3, Bool)])),
    (
        8,
        Struct(&[
            (1, Int(4)),
            (2, Int(4)),
            (3, Int(4)),
            (4, Int(4)),
            (5, Int(4)),
            (6, Int(4)),
            (7, Bool),
            (8, Struct(STATISTICS)),
        ]),
    ),
];

/// Why a file is not given to the decoder.
#[derive(Debug)]
pub enum Refused {
    Damaged(String),
    TooMuch(TooMuch),
}

impl From<String> for Refused {
    fn from(what: String) -> Self {
        Self::Damaged(what)
    }
}

impl From<TooMuch> for Refused {
    fn from(limit: TooMuch) -> Self {
        Self::TooMuch(limit)
    }
}

impl From<std::io::Error> for Refused {
    fn from(error: std::io::Error) -> Self {
        Self::Damaged(error.to_string())
    }
}

/// Looks at the footer. What is no Parquet file at all is left to the decoder to say.
pub fn footer(mut file: &File) -> Result<(), Refused> {
    let length = file.metadata()?.len();
    let Some(end) = length.checked_sub(TAIL) else { return Ok(()) };
    let mut tail = [0; TAIL as usize];
    file.seek(SeekFrom::Start(end))?;
    file.read_exact(&mut tail)?;
    let size = u64::from(u32::from_le_bytes([tail[0], tail[1], tail[2], tail[3]]));
    if &tail[4..] != MAGIC || size > end {
        return Ok(());
    }
    FOOTER.allow(size)?;
    file.seek(SeekFrom::Start(end - size))?;
    let mut schema = Schema::default();
    walk(BufReader::new(file).take(size), size, FILE, |path, found| match (path, found) {
        ([2, 0, 5], Found::Whole(children)) => schema.children = children,
        ([2], Found::Element) => schema.end_element(),
        _ => {}
    })?;
    COLUMNS.allow(schema.elements / ELEMENTS_PER_COLUMN)?;
    schema.refuse_missing()?;
    Ok(NESTING.allow(schema.deepest as u64)?)
}

/// Groups of columns, which follow each other as one walks down a tree.
#[derive(Default)]
struct Schema {
    elements: u64,
    /// Number of children of the element that is being read.
    children: i64,
    /// Number of children still to come in each group that is open.
    open: Vec<i64>,
    deepest: usize,
}

impl Schema {
    fn end_element(&mut self) {
        self.elements += 1;
        while self.open.pop_if(|left| *left <= 0).is_some() {}
        if let Some(left) = self.open.last_mut() {
            *left -= 1;
        }
        let children = std::mem::take(&mut self.children);
        if children > 0 {
            self.open.push(children);
        }
        self.deepest = self.deepest.max(self.open.len());
    }

    /// The decoder makes room for as many children as a group says it has.
    fn refuse_missing(&self) -> Result<(), Refused> {
        match self.open.iter().fold(0, |sum: i64, left| sum.saturating_add((*left).max(0))) {
            0 => Ok(()),
            missing => Err(format!("{missing} columns of its schema do not follow").into()),
        }
    }
}

/// Looks at the pages of one column between `start` and `start + length`.
pub fn pages(
    mut file: &File,
    (start, length): (u64, u64),
    expansion: &mut Expansion,
) -> Result<(), Refused> {
    file.seek(SeekFrom::Start(start))?;
    let mut from = BufReader::new(file);
    let mut left = length;
    while left > 0 {
        let (mut unpacked, mut packed, mut words) = (-1, -1, 0);
        left -= walk(&mut from, left, PAGE, |path, found| match (path, found) {
            ([2], Found::Whole(size)) => unpacked = size,
            ([3], Found::Whole(size)) => packed = size,
            ([7, 1], Found::Whole(count)) => words = count,
            _ => {}
        })?;
        let size = |size: i64| u64::try_from(size).map_err(|_| "a page has no size".to_string());
        let (packed, unpacked, words) = (size(packed)?, size(unpacked)?, size(words)?);
        if words > unpacked / SHORTEST_VALUE {
            return Err(format!("a dictionary of {words} values in {unpacked} bytes").into());
        }
        left = left.checked_sub(packed).ok_or("a page is longer than its column".to_string())?;
        expansion.make(unpacked)?;
        from.seek_relative(i64::try_from(packed).unwrap_or(i64::MAX))?;
    }
    Ok(())
}
