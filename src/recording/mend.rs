//! Rows that say nothing: without a number, or with a stamp seen before. Few of them are left out and said.

use super::{Channel, Recording, RecordingError};

/// Rows without a number that may be left out, as a share of all (and one in any case): more is not an
/// accident, and what is wrong is for its owner to say.
const MOST_WITHOUT: f64 = 0.01;
/// Rows at the start that may be left out, as a share of all (and [`MOST_LEADING_ROWS`] in any case).
const MOST_LEADING: f64 = 0.05;
/// Recorders start with memory garbage for a few rows.
const MOST_LEADING_ROWS: usize = 100;

/// How many rows in the midst of so many may be left out.
pub fn most_without(rows: usize) -> usize {
    ((MOST_WITHOUT * rows as f64) as usize).max(1)
}

/// How many rows at the start of so many may be left out.
pub fn most_leading(rows: usize) -> usize {
    ((MOST_LEADING * rows as f64) as usize).max(MOST_LEADING_ROWS)
}

/// Leaves out the rows `out` (rising) of all columns.
pub fn drop_rows(columns: &mut [Vec<f64>], lines: &mut Vec<usize>, out: &[usize]) {
    let mut keep = vec![true; lines.len()];
    out.iter().for_each(|row| keep[*row] = false);
    let kept = |row: &mut usize| {
        *row += 1;
        keep[*row - 1]
    };
    for column in columns {
        let mut row = 0;
        column.retain(|_| kept(&mut row));
    }
    let mut row = 0;
    lines.retain(|_| kept(&mut row));
}

/// Leaves out rows whose time, the first column, is that of the row before: those that repeat it whole, and
/// few others. What it did, in a sentence; `what` the numbers in `lines` count.
pub fn drop_repeated(
    columns: &mut [Vec<f64>],
    lines: &mut Vec<usize>,
    what: &str,
) -> Option<String> {
    let time = columns.first()?;
    let repeated: Vec<usize> = (1..time.len()).filter(|k| time[*k] == time[*k - 1]).collect();
    let whole = |k: &&usize| columns.iter().all(|c| c[**k] == c[**k - 1]);
    let others = repeated.len() - repeated.iter().filter(whole).count();
    // A clock that stands still is for the reader to refuse.
    let runs = repeated.len() + 1 < time.len();
    let first = *repeated.first().filter(|_| runs && others <= most_without(time.len()))?;
    let said = format!(
        "dropped {} row(s) with the time stamp of the row before, the first in {what} {}",
        repeated.len(),
        lines[first]
    );
    drop_rows(columns, lines, &repeated);
    Some(said)
}

impl Recording {
    /// Leaves out rows with something that is no number, at the start and a few others, and rows that repeat
    /// a stamp. `rows` are their numbers for people.
    pub(super) fn mend(&mut self, rows: &mut Vec<usize>) -> Result<(), RecordingError> {
        let empty = self.empty_rows()?;
        let mut columns = vec![std::mem::take(&mut self.time)];
        columns.extend(self.channels.iter_mut().map(|c| std::mem::take(&mut c.values)));
        if let Some(first) = empty.first() {
            let (count, first) = (empty.len(), first + 1);
            let note = format!("dropped {count} row(s) without a number, the first is row {first}");
            self.provenance.notes.push(note);
            drop_rows(&mut columns, rows, &empty);
        }
        self.provenance.notes.extend(drop_repeated(&mut columns, rows, "row"));
        let mut columns = columns.into_iter();
        self.time = columns.next().unwrap_or_default();
        self.channels.iter_mut().zip(columns).for_each(|(c, values)| c.values = values);
        Ok(())
    }

    /// Rows, from 0, with something that is no number; refused where they are not few.
    fn empty_rows(&self) -> Result<Vec<usize>, RecordingError> {
        let mut empty = vec![false; self.time.len()];
        for column in std::iter::once(&self.time).chain(self.channels.iter().map(|c| &c.values)) {
            empty.iter_mut().zip(column).for_each(|(e, v)| *e |= !v.is_finite());
        }
        let out: Vec<usize> = (0..empty.len()).filter(|k| empty[*k]).collect();
        let leading = empty.iter().take_while(|e| **e).count().min(most_leading(empty.len()));
        let count = out.len() - leading;
        if count <= most_without(empty.len()) {
            return Ok(out);
        }
        let row = out[leading];
        let is_bad = |c: &&Channel| !c.values[row].is_finite();
        let column = self.channels.iter().find(is_bad).map_or("time", |c| &c.name).to_string();
        Err(RecordingError::NoNumber {
            file: self.provenance.source.clone(),
            column,
            row: row + 1,
            count,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_repeat_a_stamp_go_where_they_are_few_or_repeat_all() {
        let time = vec![0.0, 1.0, 1.0, 2.0, 2.0, 3.0];
        let same = vec![5.0, 6.0, 6.0, 7.0, 7.0, 8.0];
        let mut columns = [time.clone(), same];
        let mut lines: Vec<usize> = (2..8).collect();
        let said = drop_repeated(&mut columns, &mut lines, "line").unwrap();
        assert!(said.contains("2 row(s)") && said.contains("line 4"), "{said}");
        assert_eq!((columns[0].len(), columns[1][3], lines[3]), (4, 8.0, 7));
        let mut other = [time, vec![5.0, 6.0, 6.5, 7.0, 7.5, 8.0]];
        assert_eq!(drop_repeated(&mut other, &mut (2..8).collect(), "line"), None);
        assert_eq!(other[0].len(), 6);
    }
    /// As in a text table: few are dropped and said, more are refused by name.
    #[test]
    #[cfg(feature = "parquet")]
    fn rows_of_parquet_without_a_number() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.parquet");
        let with = |bad: &[(usize, f64)]| {
            let mut values: Vec<f64> = (0..200).map(f64::from).collect();
            let time = values.clone();
            bad.iter().for_each(|(row, value)| values[*row] = *value);
            let channels = vec![Channel { name: "actual_q_0".into(), values }];
            let provenance = crate::recording::Provenance::default();
            let recording = Recording { time, channels, provenance };
            crate::recording::write(&recording, &path, &Default::default()).unwrap();
            crate::recording::read(&path, None)
        };
        let few = with(&[(120, f64::NAN), (150, 1e30)]).unwrap();
        assert_eq!((few.time.len(), few.channels[0].values[120]), (198, 121.0));
        let notes = &few.provenance.notes;
        assert!(notes.iter().any(|n| n.contains("2 row(s)") && n.contains("row 121")), "{notes:?}");
        let many: Vec<_> = (120..140).map(|row| (row, f64::NAN)).collect();
        let refused = with(&many).unwrap_err().to_string();
        assert!(refused.contains("20 rows hold something that is no number"), "{refused}");
        assert!(refused.contains("row 121, in actual_q_0"), "{refused}");
    }
}
