//! Recordings on their way to a viewer while the work goes on.
//!
//! The work never waits: it puts what is to be shown into a queue and leaves it to a thread. What
//! the viewer is too slow for is left out and counted.

mod address;
mod comparing;
mod moving;
mod watching;

use std::thread;
use std::time::Duration;

use crossbeam::channel::{Receiver, Sender, bounded};
use rerun::{RecordingStream, RecordingStreamBuilder};

pub use address::{Address, Server};
pub use comparing::Comparing;
pub use moving::Moving;
pub use watching::{Watched, Watching};

use super::blueprint::{self, Node};
use super::scene::APPLICATION;
use super::{Error, log_error};

/// Stretches that may wait for the viewer.
const QUEUE: usize = 256;
/// Simulated time in one message, s.
const STRETCH_S: f64 = 0.5;
/// Longest wait until a viewer that is still connected has taken what it was sent.
const PATIENCE: Duration = Duration::from_secs(10);

type Job = Box<dyn FnOnce(&RecordingStream) -> Result<(), Error> + Send>;

/// One recording being sent.
pub struct Live {
    jobs: Sender<Job>,
    ended: Receiver<Result<(), Error>>,
    left_out: usize,
}

/// A recording of which all is sent, but not all may have arrived.
pub struct Delivery {
    ended: Receiver<Result<(), Error>>,
    left_out: usize,
}

impl Live {
    /// Begins a recording under the name `title` at the viewer that listens at `address`.
    ///
    /// # Errors
    /// If the system has no thread left.
    fn begin(
        address: &Address,
        title: String,
        arrangement: impl FnOnce() -> Node + Send + 'static,
    ) -> Result<Self, Error> {
        let (jobs, queue) = bounded(QUEUE);
        let (end, ended) = bounded(1);
        let url = address.url();
        thread::Builder::new()
            .name("live".into())
            .spawn(move || {
                // Nobody may be waiting any more.
                let _ = end.send(deliver(url, title, arrangement, queue));
            })
            .map_err(log_error)?;
        Ok(Self { jobs, ended, left_out: 0 })
    }

    /// Queues what `job` logs, or leaves it out if the queue is full.
    fn send(&mut self, job: impl FnOnce(&RecordingStream) -> Result<(), Error> + Send + 'static) {
        if self.jobs.try_send(Box::new(job)).is_err() {
            self.left_out += 1;
        }
    }

    fn end(self) -> Delivery {
        Delivery { ended: self.ended, left_out: self.left_out }
    }
}

impl Delivery {
    /// Waits until the viewer has all that was sent, [`PATIENCE`] at most; how many messages were
    /// left out because it was slow.
    ///
    /// # Errors
    /// If the viewer went away or takes no more.
    pub fn wait(self) -> Result<usize, Error> {
        match self.ended.recv_timeout(PATIENCE) {
            Ok(Ok(())) => Ok(self.left_out),
            Ok(Err(error)) => Err(error),
            Err(_) => Err(Error::Stuck(PATIENCE.as_secs())),
        }
    }
}

/// Runs until the other end of `queue` is dropped, or the viewer is gone.
fn deliver(
    url: String,
    title: String,
    arrangement: impl FnOnce() -> Node,
    queue: Receiver<Job>,
) -> Result<(), Error> {
    let stream = RecordingStreamBuilder::new(APPLICATION)
        .enabled(true)
        .recording_name(title)
        .connect_grpc_opts(url)
        .map_err(log_error)?;
    blueprint::send(&stream, APPLICATION, &arrangement())?;
    for job in queue {
        job(&stream)?;
    }
    stream.flush_with_timeout(PATIENCE).map_err(|e| Error::Gone(e.to_string()))
}
