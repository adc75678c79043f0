//! Results as rows of named values, columns typed by their first row.

use crate::studies::StudyError;

#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    Text(String),
    /// NaN where there is none.
    Number(f64),
    Whole(u64),
    Flag(bool),
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.into())
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<usize> for Value {
    fn from(number: usize) -> Self {
        Self::Whole(number as u64)
    }
}

impl From<bool> for Value {
    fn from(flag: bool) -> Self {
        Self::Flag(flag)
    }
}

/// Names and values; all rows of a table have the same names in the same order.
pub type Row = Vec<(&'static str, Value)>;

#[derive(Debug, Clone, PartialEq)]
pub enum Column {
    Text(Vec<String>),
    Number(Vec<f64>),
    Whole(Vec<u64>),
    Flag(Vec<bool>),
}

impl Column {
    fn of(value: &Value) -> Self {
        match value {
            Value::Text(_) => Self::Text(vec![]),
            Value::Number(_) => Self::Number(vec![]),
            Value::Whole(_) => Self::Whole(vec![]),
            Value::Flag(_) => Self::Flag(vec![]),
        }
    }

    /// Is the value of this column's type?
    fn push(&mut self, value: &Value) -> bool {
        match (self, value) {
            (Self::Text(all), Value::Text(x)) => all.push(x.clone()),
            (Self::Number(all), Value::Number(x)) => all.push(*x),
            (Self::Whole(all), Value::Whole(x)) => all.push(*x),
            (Self::Flag(all), Value::Flag(x)) => all.push(*x),
            _ => return false,
        }
        true
    }

    fn extend(&mut self, more: &Self) -> bool {
        match (self, more) {
            (Self::Text(all), Self::Text(more)) => all.extend_from_slice(more),
            (Self::Number(all), Self::Number(more)) => all.extend_from_slice(more),
            (Self::Whole(all), Self::Whole(more)) => all.extend_from_slice(more),
            (Self::Flag(all), Self::Flag(more)) => all.extend_from_slice(more),
            _ => return false,
        }
        true
    }

    fn len(&self) -> usize {
        match self {
            Self::Text(all) => all.len(),
            Self::Number(all) => all.len(),
            Self::Whole(all) => all.len(),
            Self::Flag(all) => all.len(),
        }
    }
}

#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    pub names: Vec<String>,
    pub columns: Vec<Column>,
}

impl Table {
    /// # Errors
    /// If rows differ in names or types.
    pub fn of(rows: &[Row]) -> Result<Self, StudyError> {
        let Some(first) = rows.first() else { return Ok(Self::default()) };
        let mut table = Self {
            names: first.iter().map(|(name, _)| name.to_string()).collect(),
            columns: first.iter().map(|(_, value)| Column::of(value)).collect(),
        };
        for row in rows {
            let same = row.iter().map(|(name, _)| name).eq(&table.names);
            let fits = |(column, (_, value)): (&mut Column, &(&str, Value))| column.push(value);
            if !same || !table.columns.iter_mut().zip(row).all(fits) {
                return Err(StudyError::Table("rows of one table differ".into()));
            }
        }
        Ok(table)
    }

    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, Column::len)
    }

    /// Adds the rows of another table with the same columns.
    ///
    /// # Errors
    /// If the columns differ.
    pub fn append(&mut self, more: &Self) -> Result<(), StudyError> {
        if more.rows() == 0 {
            return Ok(());
        }
        if self.columns.is_empty() {
            self.clone_from(more);
            return Ok(());
        }
        let mut both = self.columns.iter_mut().zip(&more.columns);
        match self.names == more.names && both.all(|(all, more)| all.extend(more)) {
            true => Ok(()),
            false => Err(StudyError::Table("the tables of two cells have other columns".into())),
        }
    }

    fn column(&self, name: &str) -> Option<&Column> {
        self.names.iter().position(|n| n == name).map(|i| &self.columns[i])
    }

    /// Values of a column of texts; empty for one that is not there or no text.
    pub fn texts(&self, name: &str) -> &[String] {
        match self.column(name) {
            Some(Column::Text(all)) => all,
            _ => &[],
        }
    }

    /// Values of a column of numbers; empty for others.
    pub fn numbers(&self, name: &str) -> &[f64] {
        match self.column(name) {
            Some(Column::Number(all)) => all,
            _ => &[],
        }
    }

    pub fn wholes(&self, name: &str) -> &[u64] {
        match self.column(name) {
            Some(Column::Whole(all)) => all,
            _ => &[],
        }
    }

    pub fn flags(&self, name: &str) -> &[bool] {
        match self.column(name) {
            Some(Column::Flag(all)) => all,
            _ => &[],
        }
    }

    /// All values, bit by bit.
    pub fn bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for (name, column) in self.names.iter().zip(&self.columns) {
            bytes.extend(name.as_bytes());
            match column {
                Column::Text(all) => all.iter().for_each(|x| {
                    bytes.extend((x.len() as u64).to_le_bytes());
                    bytes.extend(x.as_bytes());
                }),
                Column::Number(all) => all.iter().for_each(|x| bytes.extend(x.to_le_bytes())),
                Column::Whole(all) => all.iter().for_each(|x| bytes.extend(x.to_le_bytes())),
                Column::Flag(all) => bytes.extend(all.iter().map(|x| u8::from(*x))),
            }
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_become_columns_and_tables_are_joined() {
        let row = |n: usize, x: f64| -> Row { vec![("n", n.into()), ("x", x.into())] };
        let mut table = Table::of(&[row(1, 0.5), row(2, f64::NAN)]).unwrap();
        table.append(&Table::of(&[row(3, 1.5)]).unwrap()).unwrap();
        assert_eq!((table.rows(), table.wholes("n")), (3, &[1, 2, 3][..]));
        assert_eq!((table.numbers("x")[2], table.numbers("n").len()), (1.5, 0));
        assert!(Table::of(&[row(1, 0.5), vec![("n", 1.0.into()), ("x", 1.0.into())]]).is_err());
        assert!(table.append(&Table::of(&[vec![("n", 1usize.into())]]).unwrap()).is_err());
    }
}
