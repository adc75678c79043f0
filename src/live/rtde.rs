//! Rows from a controller.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

use super::{Feed, LiveError, News, Outbox};
use crate::rtde::{Client, Event, RtdeError, Wish};

/// What is asked for where nobody says: what a diagnosis takes, and what says what the arm was doing. A
/// controller that lacks one of them is recorded without.
pub const WELCOME: [&str; 13] = [
    "target_q",
    "target_qd",
    "target_qdd",
    "target_current",
    "target_moment",
    "actual_q",
    "actual_qd",
    "actual_current",
    "joint_temperatures",
    "actual_TCP_force",
    "robot_mode",
    "safety_mode",
    "speed_scaling",
];

const ANSWERS_WITHIN: Duration = Duration::from_secs(5);
/// Controllers send at least once a second, and answer at once.
const SILENCE: Duration = Duration::from_secs(3);
/// How soon it is noticed that somebody wants to stop.
const LOOKS_UP: Duration = Duration::from_millis(50);
/// Between two attempts to come back.
const AGAIN: Duration = Duration::from_secs(1);
/// Text messages that are passed on; the rest is counted.
const TEXTS: u64 = 20;

/// Whether a broken connection is made again, until somebody stops it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reconnect {
    Never,
    Always,
}

/// A controller and what is wanted of it.
#[derive(Debug, Clone, PartialEq)]
pub struct RtdeSource {
    /// Host and port.
    pub address: String,
    pub wish: Wish,
    pub reconnect: Reconnect,
}

impl RtdeSource {
    /// # Errors
    /// If the system has no thread left; all else comes as [`News::End`].
    pub fn open(self) -> Result<Feed, LiveError> {
        Feed::start(false, move |out| {
            let mut talks = Talks::default();
            loop {
                let ended = self.talk(out, &mut talks);
                match (ended, self.reconnect) {
                    (Ok(()), _) => return Ok(()),
                    // Who never answered is not waited for: the address is probably wrong.
                    (Err(error), Reconnect::Always) if talks.columns.is_some() => {
                        out.tell(News::Note(format!("{error}; trying again")));
                    }
                    (Err(error), _) => return Err(error),
                }
                let begun = Instant::now();
                while begun.elapsed() < AGAIN {
                    if out.stopped() {
                        return Ok(());
                    }
                    std::thread::sleep(LOOKS_UP);
                }
            }
        })
    }

    fn connect(&self) -> Result<TcpStream, LiveError> {
        let wrong = |source| LiveError::Connect { address: self.address.clone(), source };
        let mut last = std::io::Error::from(ErrorKind::AddrNotAvailable);
        for address in self.address.to_socket_addrs().map_err(wrong)? {
            match TcpStream::connect_timeout(&address, ANSWERS_WITHIN) {
                Ok(socket) => {
                    socket.set_nodelay(true).map_err(wrong)?;
                    socket.set_read_timeout(Some(LOOKS_UP)).map_err(wrong)?;
                    socket.set_write_timeout(Some(SILENCE)).map_err(wrong)?;
                    return Ok(socket);
                }
                Err(error) => last = error,
            }
        }
        Err(wrong(last))
    }

    /// One connection, until somebody stops it or it breaks.
    fn talk(&self, out: &Outbox, talks: &mut Talks) -> Result<(), LiveError> {
        let address = || self.address.clone();
        let mut socket = self.connect()?;
        let mut client = Client::new(self.wish.clone());
        let mut buffer = vec![0; 1 << 16];
        let mut heard = Instant::now();
        let mut leaving = None;
        loop {
            if out.stopped() && leaving.is_none() {
                // A controller that is told to pause ends in order; one that does not answer is left.
                client.pause();
                leaving = Some(Instant::now());
            } else if leaving.is_none() && out.paused() != client.is_paused() {
                if out.paused() { client.pause() } else { client.resume() }
            }
            let asked = client.outgoing();
            socket
                .write_all(&asked)
                .map_err(|source| LiveError::Broken { address: address(), source })?;
            match socket.read(&mut buffer) {
                Ok(0) if leaving.is_some() => return Ok(()),
                Ok(0) => return Err(LiveError::Closed { address: address() }),
                Ok(count) => {
                    heard = Instant::now();
                    let talk = |source: RtdeError| LiveError::Talk { address: address(), source };
                    client.receive(&buffer[..count]).map_err(talk)?;
                }
                Err(e) if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(source) => return Err(LiveError::Broken { address: address(), source }),
            }
            while let Some(event) = client.next_event() {
                if matches!(event, Event::Paused) && leaving.is_some() {
                    return Ok(());
                }
                talks.tell(event, out, self)?;
            }
            if leaving.is_some_and(|since| since.elapsed() > LOOKS_UP * 4) {
                return Ok(());
            }
            if heard.elapsed() > SILENCE && !client.is_paused() {
                return Err(LiveError::Silent { address: address(), seconds: SILENCE.as_secs() });
            }
        }
    }
}

/// What outlasts a connection.
#[derive(Default)]
struct Talks {
    columns: Option<Vec<String>>,
    texts: u64,
}

impl Talks {
    fn tell(&mut self, event: Event, out: &Outbox, source: &RtdeSource) -> Result<(), LiveError> {
        match event {
            Event::Row(row) => out.row(row),
            Event::Controller(version) => {
                out.tell(News::Note(format!("{}: controller {version}", source.address)));
            }
            Event::Missing(names) => out.tell(News::Note(format!(
                "the controller does not know {}: recorded without",
                names.join(", ")
            ))),
            Event::Started(recipe) => {
                let columns = recipe.columns();
                if self.columns.as_ref().is_some_and(|before| *before != columns) {
                    return Err(LiveError::OtherColumns { address: source.address.clone() });
                }
                self.columns = Some(columns.clone());
                out.tell(News::Columns(columns));
            }
            Event::Text(text) => {
                self.texts += 1;
                let said = format!(
                    "the controller: {}: {} {}",
                    text.level.word(),
                    text.source,
                    text.message
                );
                match self.texts {
                    n if n < TEXTS => out.tell(News::Note(said)),
                    TEXTS => {
                        out.tell(News::Note(format!("{said} (further messages are not shown)")))
                    }
                    _ => {}
                }
            }
            Event::Paused => out.tell(News::Note("paused".into())),
            Event::Resumed => out.tell(News::Note("resumed".into())),
        }
        Ok(())
    }
}
