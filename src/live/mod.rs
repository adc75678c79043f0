//! Rows as they come: from a controller, from a file that is being written, or from a recording that is
//! played again. A thread reads, whoever works takes from a queue; what does not fit in it is counted.

mod arm;
mod error;
mod file;
mod gaps;
mod recorder;
mod rtde;
mod server;
#[cfg(test)]
mod tests;

pub use arm::{Arm, ArmError};
pub use error::LiveError;
pub use file::{Pace, follow, replay};
pub use gaps::{Gaps, Step};
pub use recorder::{Recorded, Recorder};
pub use rtde::{Reconnect, RtdeSource, WELCOME};
pub use server::{Served, Server};

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crossbeam::channel::{Receiver, RecvTimeoutError, Sender, TrySendError, bounded};

/// Rows that may wait: a minute at 500 Hz, 20 MB of what is usually recorded. A disk that is slower than
/// that for longer loses rows in any case.
const QUEUE: usize = 1 << 15;

/// What a source tells.
#[derive(Debug)]
pub enum News {
    /// Names of the numbers of the rows that follow, time (s) first.
    Columns(Vec<String>),
    Row(Vec<f64>),
    /// For people, one sentence without its full stop.
    Note(String),
    /// Nothing more comes; why, where the source did not come to its end.
    End(Result<(), LiveError>),
}

/// A source that is being read.
pub struct Feed {
    news: Receiver<News>,
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    stop: AtomicBool,
    paused: AtomicBool,
    lost: AtomicU64,
}

/// The reading end.
struct Outbox {
    news: Sender<News>,
    shared: Arc<Shared>,
    /// Whether the source can wait.
    patient: bool,
}

impl Feed {
    /// Reads in a thread of its own; a source that is not `patient` loses rows rather than to wait.
    fn start(
        patient: bool,
        read: impl FnOnce(&Outbox) -> Result<(), LiveError> + Send + 'static,
    ) -> Result<Self, LiveError> {
        let (send, news) = bounded(QUEUE);
        let shared = Arc::new(Shared::default());
        let outbox = Outbox { news: send, shared: Arc::clone(&shared), patient };
        std::thread::Builder::new()
            .name("source".into())
            .spawn(move || {
                let ended = read(&outbox);
                // Nobody may be listening any more.
                let _ = outbox.news.send(News::End(ended));
            })
            .map_err(LiveError::Thread)?;
        Ok(Self { news, shared })
    }

    /// Waits at most so long; `None` where nothing came.
    pub fn next(&self, wait: std::time::Duration) -> Option<News> {
        match self.news.recv_timeout(wait) {
            Ok(news) => Some(news),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => Some(News::End(Ok(()))),
        }
    }

    /// Asks the source to come to its end.
    pub fn stop(&self) {
        self.shared.stop.store(true, Ordering::Relaxed);
    }

    /// Asks the source to be silent, or to go on.
    pub fn pause(&self, paused: bool) {
        self.shared.paused.store(paused, Ordering::Relaxed);
    }

    /// Rows that found no room in the queue so far.
    pub fn lost(&self) -> u64 {
        self.shared.lost.load(Ordering::Relaxed)
    }

    /// Rows that wait.
    pub fn waiting(&self) -> usize {
        self.news.len()
    }
}

impl Drop for Feed {
    fn drop(&mut self) {
        self.stop();
    }
}

impl Outbox {
    fn stopped(&self) -> bool {
        self.shared.stop.load(Ordering::Relaxed)
    }

    fn paused(&self) -> bool {
        self.shared.paused.load(Ordering::Relaxed)
    }

    fn row(&self, row: Vec<f64>) {
        if self.patient {
            self.tell(News::Row(row));
        } else if let Err(TrySendError::Full(_)) = self.news.try_send(News::Row(row)) {
            self.shared.lost.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Rows can be lost, what belongs to them cannot.
    fn tell(&self, news: News) {
        if self.news.send(news).is_err() {
            self.shared.stop.store(true, Ordering::Relaxed);
        }
    }
}
