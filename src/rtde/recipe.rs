//! What was agreed on: which quantities, of which types, in which order.

use super::{RtdeError, Type};

/// Quantities of a data package, in order.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Recipe {
    /// 0 in protocol 1, whose packages have none.
    pub id: u8,
    pub fields: Vec<(String, Type)>,
}

impl Recipe {
    /// Bytes of a data package's body, without the recipe's number.
    pub fn bytes(&self) -> usize {
        self.fields.iter().map(|(_, t)| t.bytes()).sum()
    }

    /// Numbers of a row.
    pub fn width(&self) -> usize {
        self.fields.iter().map(|(_, t)| t.width()).sum()
    }

    /// Names of the numbers of a row: `actual_q_0`, ..; of scalars their own.
    pub fn columns(&self) -> Vec<String> {
        let names = |(name, t): &(String, Type)| -> Vec<String> {
            match t.width() {
                1 => vec![name.clone()],
                n => (0..n).map(|i| format!("{name}_{i}")).collect(),
            }
        };
        self.fields.iter().flat_map(names).collect()
    }

    /// The numbers of a data package.
    ///
    /// # Errors
    /// If it is of another recipe or length.
    pub fn row(&self, body: &[u8]) -> Result<Vec<f64>, RtdeError> {
        let (kind, expected) = (super::Kind::Data, self.bytes() + 1);
        let Some((id, mut rest)) = body.split_first().filter(|_| body.len() == expected) else {
            return Err(RtdeError::Body { kind, bytes: body.len(), expected });
        };
        if *id != self.id {
            return Err(RtdeError::OtherRecipe { given: *id, expected: self.id });
        }
        let mut row = Vec::with_capacity(self.width());
        for (_, t) in &self.fields {
            let (own, others) = rest.split_at(t.bytes());
            t.read(own, &mut row);
            rest = others;
        }
        Ok(row)
    }
}
