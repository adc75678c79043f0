//! From what is shown to a whole file.

use std::io;
use std::path::Path;

use rerun::external::re_log_encoding::Encoder;
use rerun::{RecordingStream, RecordingStreamBuilder, TextDocument, ViewCoordinates};

use super::blueprint::{self, Node};
use super::{Comparison, Error, arm, layout, log_error, plots};

pub const APPLICATION: &str = "armtwin";

/// What a file can be made of.
pub trait Shown {
    /// The recording's name.
    fn title(&self) -> &str;
    /// Checks that all series fit the arm and their times.
    ///
    /// # Errors
    /// The first one that does not.
    fn check(&self) -> Result<(), Error>;
    /// How the views are arranged.
    fn arrangement(&self) -> Node;
    /// # Errors
    /// If the library refuses the data.
    fn log(&self, stream: &RecordingStream) -> Result<(), Error>;
}

/// Writes `shown` to `path` as an `.rrd`, whole or not at all.
///
/// # Errors
/// Series that do not fit the arm or the time base, or a path that cannot be written.
pub fn write_rrd(shown: &impl Shown, path: &Path) -> Result<(), Error> {
    let bytes = encode(shown)?;
    crate::files::write_whole(path, |out| out.write_all(&bytes))
        .map_err(|source: io::Error| Error::Write { path: path.display().to_string(), source })
}

/// The bytes of the file: blueprint first, then what it shows.
fn encode(shown: &impl Shown) -> Result<Vec<u8>, Error> {
    shown.check()?;
    let (stream, storage) = RecordingStreamBuilder::new(APPLICATION)
        .enabled(true)
        .recording_name(shown.title())
        .memory()
        .map_err(log_error)?;
    blueprint::send(&stream, APPLICATION, &shown.arrangement())?;
    shown.log(&stream)?;
    Encoder::encode(storage.take().into_iter().map(Ok)).map_err(log_error)
}

/// The text panel and which way is up.
pub fn log_frame(stream: &RecordingStream, summary: &str) -> Result<(), Error> {
    let summary = TextDocument::from_markdown(summary);
    stream.log_static(layout::SUMMARY, &summary).map_err(log_error)?;
    log_up(stream)
}

pub fn log_up(stream: &RecordingStream) -> Result<(), Error> {
    stream.log_static("arm", &ViewCoordinates::RIGHT_HAND_Z_UP()).map_err(log_error)
}

impl Shown for Comparison {
    fn title(&self) -> &str {
        &self.title
    }

    fn check(&self) -> Result<(), Error> {
        self.check_shapes()
    }

    fn arrangement(&self) -> Node {
        layout::root(self)
    }

    fn log(&self, stream: &RecordingStream) -> Result<(), Error> {
        log_frame(stream, &self.summary)?;
        for (look, motion) in [(arm::RECORDED, &self.recorded), (arm::SIMULATED, &self.simulated)] {
            arm::log(stream, &self.robot, &look, &self.time, &motion.q)?;
        }
        plots::log(stream, self, &plots::QUANTITIES)
    }
}
