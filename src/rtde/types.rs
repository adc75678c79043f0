//! The types of RTDE: their names, their bytes, and numbers made of them.

/// Type of a quantity on the wire, big-endian.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Type {
    Bool,
    Uint8,
    Uint32,
    Uint64,
    Int32,
    Double,
    Vector3d,
    Vector6d,
    Vector6Int32,
    Vector6Uint32,
}

impl Type {
    const ALL: [Self; 10] = [
        Self::Bool,
        Self::Uint8,
        Self::Uint32,
        Self::Uint64,
        Self::Int32,
        Self::Double,
        Self::Vector3d,
        Self::Vector6d,
        Self::Vector6Int32,
        Self::Vector6Uint32,
    ];

    /// As packages name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bool => "BOOL",
            Self::Uint8 => "UINT8",
            Self::Uint32 => "UINT32",
            Self::Uint64 => "UINT64",
            Self::Int32 => "INT32",
            Self::Double => "DOUBLE",
            Self::Vector3d => "VECTOR3D",
            Self::Vector6d => "VECTOR6D",
            Self::Vector6Int32 => "VECTOR6INT32",
            Self::Vector6Uint32 => "VECTOR6UINT32",
        }
    }

    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|t| t.name() == name)
    }

    /// How many numbers it has.
    pub fn width(self) -> usize {
        match self {
            Self::Vector3d => 3,
            Self::Vector6d | Self::Vector6Int32 | Self::Vector6Uint32 => 6,
            _ => 1,
        }
    }

    /// How many bytes it has.
    pub fn bytes(self) -> usize {
        self.width() * self.bytes_each()
    }

    fn bytes_each(self) -> usize {
        match self {
            Self::Bool | Self::Uint8 => 1,
            Self::Uint32 | Self::Int32 | Self::Vector6Int32 | Self::Vector6Uint32 => 4,
            Self::Uint64 | Self::Double | Self::Vector3d | Self::Vector6d => 8,
        }
    }

    /// Adds the numbers of `body`, which has [`Type::bytes`], to `out`. Those of UINT64 are exact up to 2^53.
    pub fn read(self, body: &[u8], out: &mut Vec<f64>) {
        for each in body.chunks_exact(self.bytes_each()) {
            out.push(match (self, each) {
                (Self::Int32 | Self::Vector6Int32, &[a, b, c, d]) => {
                    f64::from(i32::from_be_bytes([a, b, c, d]))
                }
                (_, &[a, b, c, d]) => f64::from(u32::from_be_bytes([a, b, c, d])),
                (_, &[one]) => f64::from(one),
                (Self::Uint64, long) => {
                    long.iter().fold(0, |n: u64, b| n << 8 | u64::from(*b)) as f64
                }
                (_, long) => {
                    f64::from_bits(long.iter().fold(0, |n: u64, b| n << 8 | u64::from(*b)))
                }
            });
        }
    }

    /// Adds the bytes of `values`, [`Type::width`] of them, to `out`; whole numbers are cut to their range.
    pub fn write(self, values: &[f64], out: &mut Vec<u8>) {
        for value in values {
            match self {
                Self::Bool => out.push(u8::from(*value != 0.0)),
                Self::Uint8 => out.push(*value as u8),
                Self::Uint32 | Self::Vector6Uint32 => out.extend((*value as u32).to_be_bytes()),
                Self::Int32 | Self::Vector6Int32 => out.extend((*value as i32).to_be_bytes()),
                Self::Uint64 => out.extend((*value as u64).to_be_bytes()),
                Self::Double | Self::Vector3d | Self::Vector6d => out.extend(value.to_be_bytes()),
            }
        }
    }
}
