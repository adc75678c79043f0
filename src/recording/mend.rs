//! Rows that say nothing: without a number, or with a stamp seen before. Few of them are left out and said.

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
/// few others. What it did, in a sentence.
pub fn drop_repeated(columns: &mut [Vec<f64>], lines: &mut Vec<usize>) -> Option<String> {
    let time = columns.first()?;
    let repeated: Vec<usize> = (1..time.len()).filter(|k| time[*k] == time[*k - 1]).collect();
    let whole = |k: &&usize| columns.iter().all(|c| c[**k] == c[**k - 1]);
    let others = repeated.len() - repeated.iter().filter(whole).count();
    let first = *repeated.first().filter(|_| others <= most_without(time.len()))?;
    let said = format!(
        "dropped {} row(s) with the time stamp of the row before, the first in line {}",
        repeated.len(),
        lines[first]
    );
    drop_rows(columns, lines, &repeated);
    Some(said)
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
        let said = drop_repeated(&mut columns, &mut lines).unwrap();
        assert!(said.contains("2 row(s)") && said.contains("line 4"), "{said}");
        assert_eq!((columns[0].len(), columns[1][3], lines[3]), (4, 8.0, 7));
        let mut other = [time, vec![5.0, 6.0, 6.5, 7.0, 7.5, 8.0]];
        assert_eq!(drop_repeated(&mut other, &mut (2..8).collect()), None);
        assert_eq!(other[0].len(), 6);
    }
}
