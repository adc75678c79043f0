//! Plain CDR (OMG CORBA 3.4, 9.3) as ROS 2 writes its messages: four bytes that say the byte order,
//! then fields, each aligned to its own size counted from there.

/// Where in a message reading stopped, and why.
#[derive(Debug, PartialEq)]
pub struct Malformed(pub String);

/// Takes fields off a message one after the other.
pub struct Reader<'a> {
    body: &'a [u8],
    at: usize,
    little: bool,
}

impl<'a> Reader<'a> {
    pub fn new(message: &'a [u8]) -> Result<Self, Malformed> {
        let little = match message {
            [0, 0, _, _, ..] => false,
            [0, 1, _, _, ..] => true,
            [] | [_] | [_, _] | [_, _, _] => return Err(cut("its header", message.len())),
            [a, b, ..] => {
                let what = format!("its encoding is {a:#04x} {b:#04x}, plain CDR is 0x00 0x01");
                return Err(Malformed(what));
            }
        };
        Ok(Self { body: &message[4..], at: 0, little })
    }

    pub fn u32(&mut self, field: &str) -> Result<u32, Malformed> {
        let bytes = self.take::<4>(field)?;
        Ok(if self.little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) })
    }

    pub fn text(&mut self, field: &str) -> Result<&'a str, Malformed> {
        let length = self.u32(field)? as usize;
        let bytes = self.bytes(length, field)?;
        // A terminating zero is counted.
        let bytes = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        std::str::from_utf8(bytes).map_err(|_| Malformed(format!("its {field} is not UTF-8")))
    }

    pub fn texts(&mut self, field: &str) -> Result<Vec<&'a str>, Malformed> {
        let count = self.u32(field)? as usize;
        // Each takes four bytes at least: a wrong count must not ask for memory.
        let mut all = Vec::with_capacity(count.min(self.left() / 4));
        for _ in 0..count {
            all.push(self.text(field)?);
        }
        Ok(all)
    }

    pub fn numbers(&mut self, field: &str) -> Result<Vec<f64>, Malformed> {
        let count = self.u32(field)? as usize;
        if count == 0 {
            return Ok(Vec::new());
        }
        self.align(8);
        let length = count.checked_mul(8).ok_or_else(|| cut(field, self.body.len() + 4))?;
        let little = self.little;
        let number = |b: &[u8]| {
            let mut bytes = [0; 8];
            bytes.copy_from_slice(b);
            if little { f64::from_le_bytes(bytes) } else { f64::from_be_bytes(bytes) }
        };
        Ok(self.bytes(length, field)?.chunks_exact(8).map(number).collect())
    }

    /// What is left must be padding.
    pub fn finish(self) -> Result<(), Malformed> {
        if self.left() < 8 {
            return Ok(());
        }
        let (has, takes) = (self.body.len() + 4, self.at + 4);
        Err(Malformed(format!("it has {has} bytes where its fields take {takes}")))
    }

    fn left(&self) -> usize {
        self.body.len().saturating_sub(self.at)
    }

    fn align(&mut self, size: usize) {
        self.at = self.at.next_multiple_of(size);
    }

    fn take<const N: usize>(&mut self, field: &str) -> Result<[u8; N], Malformed> {
        self.align(N);
        let mut bytes = [0; N];
        bytes.copy_from_slice(self.bytes(N, field)?);
        Ok(bytes)
    }

    fn bytes(&mut self, length: usize, field: &str) -> Result<&'a [u8], Malformed> {
        let end = self.at.checked_add(length).filter(|end| *end <= self.body.len());
        let end = end.ok_or_else(|| cut(field, self.body.len() + 4))?;
        let bytes = &self.body[self.at..end];
        self.at = end;
        Ok(bytes)
    }
}

fn cut(field: &str, length: usize) -> Malformed {
    Malformed(format!("its {length} bytes end within {field}"))
}

/// Puts a message together, little endian.
pub struct Writer(Vec<u8>);

impl Writer {
    pub fn new() -> Self {
        Self(vec![0, 1, 0, 0])
    }

    pub fn u32(&mut self, value: u32) {
        self.align(4);
        self.0.extend(value.to_le_bytes());
    }

    pub fn text(&mut self, text: &str) {
        self.u32(text.len() as u32 + 1);
        self.0.extend(text.as_bytes());
        self.0.push(0);
    }

    pub fn texts(&mut self, texts: &[String]) {
        self.u32(texts.len() as u32);
        texts.iter().for_each(|text| self.text(text));
    }

    pub fn numbers(&mut self, numbers: &[f64]) {
        self.u32(numbers.len() as u32);
        if !numbers.is_empty() {
            self.align(8);
        }
        numbers.iter().for_each(|x| self.0.extend(x.to_le_bytes()));
    }

    pub fn message(self) -> Vec<u8> {
        self.0
    }

    fn align(&mut self, size: usize) {
        let length = (self.0.len() - 4).next_multiple_of(size) + 4;
        self.0.resize(length, 0);
    }
}
