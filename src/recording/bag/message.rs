//! The two ROS messages a bag is read from and written with.

use std::borrow::Cow;
use std::io::Read;

use super::cdr::{Malformed, Reader, Writer};
use crate::limits::{Expansion, JOINTS, MESSAGE, TooMuch};

pub const JOINT_STATE: &str = "sensor_msgs/msg/JointState";
/// What of a recording has no place in a joint state.
pub const NUMBERS: &str = "std_msgs/msg/Float64MultiArray";

/// A message that rosbag2 compressed by itself begins so.
const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// Bytes of a message that may be compressed by itself, as rosbag2's compression mode "message" does.
pub fn unpacked<'m>(
    message: &'m [u8],
    expansion: &mut Expansion,
) -> Result<Cow<'m, [u8]>, Malformed> {
    let limited = |e: TooMuch| Malformed(e.to_string());
    MESSAGE.allow(message.len() as u64).map_err(limited)?;
    if !message.starts_with(&ZSTD) {
        return Ok(Cow::Borrowed(message));
    }
    let mut plain = Vec::new();
    let unpacker = zstd::stream::read::Decoder::with_buffer(message);
    let most = MESSAGE.most + 1;
    match unpacker.and_then(|unpacker| unpacker.take(most).read_to_end(&mut plain)) {
        Ok(length) => {
            MESSAGE.allow(length as u64).map_err(limited)?;
            expansion.make(length as u64).map_err(limited)?;
            Ok(Cow::Owned(plain))
        }
        Err(error) => Err(Malformed(format!("its compression is damaged ({error})"))),
    }
}

/// Written into MCAP files, so that others can decode them without ROS.
pub fn definition(kind: &str) -> &'static str {
    if kind == JOINT_STATE { JOINT_STATE_FIELDS } else { NUMBERS_FIELDS }
}

const JOINT_STATE_FIELDS: &str = "\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

const NUMBERS_FIELDS: &str = "\
std_msgs/MultiArrayLayout layout
float64[] data
================================================================================
MSG: std_msgs/MultiArrayLayout
std_msgs/MultiArrayDimension[] dim
uint32 data_offset
================================================================================
MSG: std_msgs/MultiArrayDimension
string label
uint32 size
uint32 stride
";

/// `sensor_msgs/msg/JointState`, its joints in any order.
#[derive(Debug)]
pub struct JointState<'a> {
    /// ns; 0 where the sender left it out.
    pub stamp: i64,
    pub names: Vec<&'a str>,
    /// rad, rad/s, and whatever the sender means by effort; empty or one number per name.
    pub position: Vec<f64>,
    pub velocity: Vec<f64>,
    pub effort: Vec<f64>,
}

impl<'a> JointState<'a> {
    pub fn decode(message: &'a [u8]) -> Result<Self, Malformed> {
        let mut fields = Reader::new(message)?;
        let seconds = fields.u32("stamp")? as i32;
        let nanoseconds = fields.u32("stamp")?;
        fields.text("frame_id")?;
        let state = Self {
            stamp: i64::from(seconds) * 1_000_000_000 + i64::from(nanoseconds),
            names: fields.texts("name")?,
            position: fields.numbers("position")?,
            velocity: fields.numbers("velocity")?,
            effort: fields.numbers("effort")?,
        };
        fields.finish()?;
        state.lengths_agree()?;
        Ok(state)
    }

    fn lengths_agree(&self) -> Result<(), Malformed> {
        let names = self.names.len();
        JOINTS.allow(names as u64).map_err(|e| Malformed(e.to_string()))?;
        let fields =
            [("position", &self.position), ("velocity", &self.velocity), ("effort", &self.effort)];
        match fields.iter().find(|(_, v)| !v.is_empty() && v.len() != names) {
            Some((field, v)) => {
                Err(Malformed(format!("its {field} has {} numbers for {names} names", v.len())))
            }
            None => Ok(()),
        }
    }
}

/// The bytes of a joint state.
pub fn joint_state(stamp: i64, names: &[String], signals: [&[f64]; 3]) -> Vec<u8> {
    let mut out = Writer::new();
    out.u32(stamp.div_euclid(1_000_000_000) as i32 as u32);
    out.u32(stamp.rem_euclid(1_000_000_000) as u32);
    out.text("");
    out.texts(names);
    signals.iter().for_each(|values| out.numbers(values));
    out.message()
}

/// `std_msgs/msg/Float64MultiArray` of one dimension: its label and its numbers.
pub fn decode_numbers(message: &[u8]) -> Result<(&str, Vec<f64>), Malformed> {
    let mut fields = Reader::new(message)?;
    let dimensions = fields.u32("layout")?;
    let mut label = "";
    for _ in 0..dimensions {
        label = fields.text("label")?;
        fields.u32("size")?;
        fields.u32("stride")?;
    }
    fields.u32("data_offset")?;
    let data = fields.numbers("data")?;
    fields.finish()?;
    Ok((label, data))
}

/// The bytes of such an array.
pub fn numbers(label: &str, data: &[f64]) -> Vec<u8> {
    let mut out = Writer::new();
    out.u32(1);
    out.text(label);
    out.u32(data.len() as u32);
    out.u32(data.len() as u32);
    out.u32(0);
    out.numbers(data);
    out.message()
}
