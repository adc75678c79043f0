//! From a comparison to a whole file.

use std::io;
use std::path::Path;

use rerun::external::re_log_encoding::Encoder;
use rerun::{RecordingStream, RecordingStreamBuilder, TextDocument, ViewCoordinates};

use super::{Comparison, Error, arm, layout, log_error, plots};

const APPLICATION: &str = "armtwin";
/// Entity path of the text panel.
pub const SUMMARY: &str = "summary";

/// Writes `comparison` to `path` as an `.rrd`, whole or not at all.
///
/// # Errors
/// Series that do not fit the arm or the time base, or a path that cannot be written.
pub fn write_rrd(comparison: &Comparison, path: &Path) -> Result<(), Error> {
    let bytes = encode(comparison)?;
    crate::files::write_whole(path, |out| out.write_all(&bytes))
        .map_err(|source: io::Error| Error::Write { path: path.display().to_string(), source })
}

/// The bytes of the file: blueprint first, then what it shows.
fn encode(comparison: &Comparison) -> Result<Vec<u8>, Error> {
    comparison.check()?;
    let (stream, storage) = RecordingStreamBuilder::new(APPLICATION)
        .enabled(true)
        .recording_name(comparison.title.as_str())
        .memory()
        .map_err(log_error)?;
    layout::send(&stream, APPLICATION, comparison)?;
    log(&stream, comparison)?;
    Encoder::encode(storage.take().into_iter().map(Ok)).map_err(log_error)
}

fn log(stream: &RecordingStream, c: &Comparison) -> Result<(), Error> {
    let summary = TextDocument::from_markdown(c.summary.as_str());
    stream.log_static(SUMMARY, &summary).map_err(log_error)?;
    stream.log_static("arm", &ViewCoordinates::RIGHT_HAND_Z_UP()).map_err(log_error)?;
    for (look, motion) in [(arm::RECORDED, &c.recorded), (arm::SIMULATED, &c.simulated)] {
        arm::log(stream, &c.robot, &look, &c.time, &motion.q)?;
    }
    plots::log(stream, c)
}
