//! Walks Thrift's compact protocol (github.com/apache/thrift, doc/specs/thrift-compact-protocol.md) and
//! holds it against the shape it should have, before a decoder that believes lengths sees it.

use std::io::Read;

use crate::limits::NESTING;

/// What a value should be.
pub enum Shape {
    Bool,
    /// Integer of 1, 2, 4 or 8 bytes.
    Int(u8),
    Double,
    Bytes,
    List(&'static Shape),
    Struct(&'static [(i16, Shape)]),
}

/// What the walk comes by, with the numbers of the fields that lead there.
pub enum Found {
    Whole(i64),
    /// An element of a list has ended.
    Element,
}

/// Types on the wire.
mod wire {
    pub const TRUE: u8 = 1;
    pub const FALSE: u8 = 2;
    pub const BYTE: u8 = 3;
    pub const I16: u8 = 4;
    pub const I64: u8 = 6;
    pub const DOUBLE: u8 = 7;
    pub const BYTES: u8 = 8;
    pub const LIST: u8 = 9;
    pub const SET: u8 = 10;
    pub const MAP: u8 = 11;
    pub const STRUCT: u8 = 12;
}

impl Shape {
    fn fits(&self, kind: u8) -> bool {
        match self {
            Self::Bool => kind == wire::TRUE || kind == wire::FALSE,
            Self::Int(bytes) => u32::from(kind) == u32::from(wire::BYTE) + bytes.trailing_zeros(),
            Self::Double => kind == wire::DOUBLE,
            Self::Bytes => kind == wire::BYTES,
            Self::List(_) => kind == wire::LIST,
            Self::Struct(_) => kind == wire::STRUCT,
        }
    }
}

/// Walks over one struct that takes at most `most` bytes; returns how many it takes.
///
/// # Errors
/// Says what is wrong.
pub fn walk(
    from: impl Read,
    most: u64,
    fields: &'static [(i16, Shape)],
    visit: impl FnMut(&[i16], Found),
) -> Result<u64, String> {
    let mut walk = Walk { from, left: most, path: Vec::new(), visit };
    walk.structure(Some(fields))?;
    Ok(most - walk.left)
}

struct Walk<R, V> {
    from: R,
    /// Bytes that may still come.
    left: u64,
    path: Vec<i16>,
    visit: V,
}

impl<R: Read, V: FnMut(&[i16], Found)> Walk<R, V> {
    fn structure(&mut self, shapes: Option<&'static [(i16, Shape)]>) -> Result<(), String> {
        NESTING.allow(self.path.len() as u64).map_err(|e| e.to_string())?;
        let mut field = 0i16;
        loop {
            let head = self.byte()?;
            let (step, kind) = (head >> 4, head & 0x0f);
            if kind == 0 {
                return Ok(());
            }
            field = match step {
                0 => i16::try_from(self.whole()?).map_err(|_| damage())?,
                _ => field.checked_add(step.into()).ok_or_else(damage)?,
            };
            let shape = shapes.and_then(|all| all.iter().find(|(id, _)| *id == field));
            let shape = shape.map(|(_, shape)| shape);
            self.path.push(field);
            if kind != wire::TRUE && kind != wire::FALSE {
                self.value(kind, shape)?;
            } else if shape.is_some_and(|s| !s.fits(kind)) {
                return Err(damage());
            }
            self.path.pop();
        }
    }

    fn value(&mut self, kind: u8, shape: Option<&'static Shape>) -> Result<(), String> {
        if shape.is_some_and(|s| !s.fits(kind)) {
            return Err(damage());
        }
        match kind {
            wire::TRUE | wire::FALSE | wire::BYTE => self.byte().map(drop),
            wire::I16..=wire::I64 => {
                let value = self.whole()?;
                (self.visit)(&self.path, Found::Whole(value));
                Ok(())
            }
            wire::DOUBLE => self.skip(8),
            wire::BYTES => {
                let length = self.varint()?;
                self.skip(length)
            }
            wire::LIST | wire::SET => self.list(shape),
            wire::MAP => self.map(),
            wire::STRUCT => self.structure(match shape {
                Some(Shape::Struct(fields)) => Some(fields),
                _ => None,
            }),
            _ => Err(damage()),
        }
    }

    fn list(&mut self, shape: Option<&'static Shape>) -> Result<(), String> {
        let head = self.byte()?;
        let kind = head & 0x0f;
        let count = if head >> 4 == 15 { self.varint()? } else { u64::from(head >> 4) };
        let element = match shape {
            Some(Shape::List(element)) => Some(*element),
            _ => None,
        };
        self.refuse_more_than_left(count)?;
        self.path.push(0);
        for _ in 0..count {
            self.value(kind, element)?;
            self.path.pop();
            (self.visit)(&self.path, Found::Element);
            self.path.push(0);
        }
        self.path.pop();
        Ok(())
    }

    fn map(&mut self) -> Result<(), String> {
        let count = self.varint()?;
        self.refuse_more_than_left(count)?;
        let kinds = if count == 0 { 0 } else { self.byte()? };
        self.path.push(0);
        for _ in 0..count {
            self.value(kinds >> 4, None)?;
            self.value(kinds & 0x0f, None)?;
        }
        self.path.pop();
        Ok(())
    }

    /// Every element takes a byte at least.
    fn refuse_more_than_left(&self, count: u64) -> Result<(), String> {
        match count > self.left {
            true => Err(format!("{count} elements in {} bytes", self.left)),
            false => Ok(()),
        }
    }

    fn byte(&mut self) -> Result<u8, String> {
        let mut byte = [0];
        self.take(1)?;
        self.from.read_exact(&mut byte).map_err(|_| damage())?;
        Ok(byte[0])
    }

    fn skip(&mut self, length: u64) -> Result<(), String> {
        self.take(length)?;
        let skipped = std::io::copy(&mut (&mut self.from).take(length), &mut std::io::sink());
        match skipped.is_ok_and(|n| n == length) {
            true => Ok(()),
            false => Err(damage()),
        }
    }

    fn take(&mut self, length: u64) -> Result<(), String> {
        self.left = self.left.checked_sub(length).ok_or_else(damage)?;
        Ok(())
    }

    fn varint(&mut self) -> Result<u64, String> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(damage())
    }

    /// Zigzag.
    fn whole(&mut self) -> Result<i64, String> {
        let value = self.varint()?;
        Ok((value >> 1) as i64 ^ -((value & 1) as i64))
    }
}

fn damage() -> String {
    "its metadata are damaged".into()
}

#[cfg(test)]
mod tests {
    use super::*;

    static SHAPE: &[(i16, Shape)] =
        &[(1, Shape::Int(4)), (2, Shape::List(&Shape::Struct(&[(3, Shape::Bytes)])))];

    fn numbers(bytes: &[u8]) -> Result<(Vec<i64>, usize, u64), String> {
        let (mut numbers, mut elements) = (Vec::new(), 0);
        let used = walk(bytes, bytes.len() as u64, SHAPE, |path, found| match found {
            Found::Whole(n) if path == [1] => numbers.push(n),
            Found::Whole(_) => {}
            Found::Element => elements += 1,
        })?;
        Ok((numbers, elements, used))
    }

    #[test]
    fn what_fits_is_walked_and_what_does_not_is_refused() {
        // Field 1: i32 -3; field 2: two structs, one with field 3: two bytes; the rest is not walked.
        let sound = [0x15, 5, 0x19, 0x2c, 0x38, 2, 7, 7, 0, 0, 0, 99];
        assert_eq!(numbers(&sound), Ok((vec![-3], 2, 11)));
        let wrong_type = [0x16, 5, 0];
        assert!(numbers(&wrong_type).is_err());
        let long_list = [0x29, 0xfc, 0xff, 0xff, 0xff, 0xff, 0x07];
        assert!(numbers(&long_list).unwrap_err().contains("2147483647 elements in 0 bytes"));
        let long_bytes = [0x29, 0x1c, 0x38, 0xff, 0xff, 0x03, 1];
        assert!(numbers(&long_bytes).is_err());
        let deep = [0x7cu8; 300];
        assert!(numbers(&deep).unwrap_err().contains("levels of nesting"));
    }
}
