//! A simulated arm for clients of RTDE: a thread per connection reads, another one writes, and nobody
//! waits for a client that does not read.

use std::io::{ErrorKind, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crossbeam::channel::{Receiver, Sender, unbounded};

use super::LiveError;
use crate::limits::{CLIENTS, UNREAD};
use crate::rtde::{Heard, Level, Offer, Session};

/// What happened to a client.
#[derive(Debug, Clone, PartialEq)]
pub enum Served {
    Came(SocketAddr),
    Heard(SocketAddr, Heard),
    /// It went by itself, or why it was dropped.
    Went(SocketAddr, Option<String>),
}

/// Listens until it is dropped.
pub struct Server {
    pub address: SocketAddr,
    clients: Arc<Mutex<Vec<Client>>>,
    stop: Arc<AtomicBool>,
    events: Receiver<Served>,
    tell: Sender<Served>,
}

struct Client {
    peer: SocketAddr,
    session: Arc<Mutex<Session>>,
    socket: TcpStream,
    /// Bytes on their way to it.
    out: Sender<Vec<u8>>,
    unread: Arc<std::sync::atomic::AtomicUsize>,
}

fn held<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// How often threads look whether they are still wanted.
const LOOKS_UP: Duration = Duration::from_millis(50);
/// A client that takes nothing for so long is gone.
const PATIENCE: Duration = Duration::from_secs(5);

impl Server {
    /// Listens at `address`, for example `127.0.0.1:30004`; port 0 takes any.
    ///
    /// # Errors
    /// If the address cannot be had.
    pub fn start(address: &str, offer: Arc<Offer>) -> Result<Self, LiveError> {
        let cannot = |source| LiveError::Listen { address: address.into(), source };
        let listener = TcpListener::bind(address).map_err(cannot)?;
        listener.set_nonblocking(true).map_err(cannot)?;
        let (tell, events) = unbounded();
        let server = Self {
            address: listener.local_addr().map_err(cannot)?,
            clients: Arc::default(),
            stop: Arc::default(),
            events,
            tell: tell.clone(),
        };
        let (clients, stop) = (Arc::clone(&server.clients), Arc::clone(&server.stop));
        std::thread::Builder::new()
            .name("listens".into())
            .spawn(move || {
                while !stop.load(Ordering::Relaxed) {
                    match listener.accept() {
                        Ok((socket, peer)) => admit(socket, peer, &clients, &offer, &tell, &stop),
                        Err(_) => std::thread::sleep(LOOKS_UP),
                    }
                }
            })
            .map_err(LiveError::Thread)?;
        Ok(server)
    }

    /// Sends row `k` to every client that wants it.
    pub fn send(&self, k: u64, row: &[f64]) {
        held(&self.clients).retain(|client| {
            let mut session = held(&client.session);
            session.send(k, row);
            let bytes = session.outgoing();
            drop(session);
            client.deliver(bytes, &self.tell)
        });
    }

    /// Tells every client something.
    pub fn say(&self, level: Level, message: &str) {
        for client in held(&self.clients).iter() {
            held(&client.session).say(level, message);
        }
    }

    pub fn clients(&self) -> usize {
        held(&self.clients).len()
    }

    /// What happened since it was asked last.
    pub fn events(&self) -> Vec<Served> {
        self.events.try_iter().collect()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        for client in held(&self.clients).drain(..) {
            let _ = client.socket.shutdown(Shutdown::Both);
        }
    }
}

impl Client {
    /// Queues bytes; false where the client is to be forgotten.
    fn deliver(&self, bytes: Vec<u8>, tell: &Sender<Served>) -> bool {
        if bytes.is_empty() {
            return true;
        }
        let unread = self.unread.fetch_add(bytes.len(), Ordering::Relaxed) + bytes.len();
        if let Err(limit) = UNREAD.allow(unread as u64) {
            let _ = tell.send(Served::Went(self.peer, Some(limit.to_string())));
            let _ = self.socket.shutdown(Shutdown::Both);
            return false;
        }
        self.out.send(bytes).is_ok()
    }
}

fn admit(
    socket: TcpStream,
    peer: SocketAddr,
    clients: &Arc<Mutex<Vec<Client>>>,
    offer: &Arc<Offer>,
    tell: &Sender<Served>,
    stop: &Arc<AtomicBool>,
) {
    let mut all = held(clients);
    if let Err(limit) = CLIENTS.allow(all.len() as u64 + 1) {
        let _ = tell.send(Served::Went(peer, Some(limit.to_string())));
        return;
    }
    let Ok(client) = begin(socket, peer, offer, tell, stop, clients) else { return };
    let _ = tell.send(Served::Came(peer));
    all.push(client);
}

fn begin(
    socket: TcpStream,
    peer: SocketAddr,
    offer: &Arc<Offer>,
    tell: &Sender<Served>,
    stop: &Arc<AtomicBool>,
    clients: &Arc<Mutex<Vec<Client>>>,
) -> std::io::Result<Client> {
    socket.set_nonblocking(false)?;
    socket.set_nodelay(true)?;
    socket.set_read_timeout(Some(LOOKS_UP))?;
    socket.set_write_timeout(Some(PATIENCE))?;
    // Bounded by the bytes in it (`Client::deliver`).
    let (out, queue) = unbounded::<Vec<u8>>();
    let unread = Arc::new(std::sync::atomic::AtomicUsize::new(0));
    let session = Arc::new(Mutex::new(Session::new(Arc::clone(offer))));
    let mut writes = socket.try_clone()?;
    let taken = Arc::clone(&unread);
    std::thread::Builder::new().name("writes".into()).spawn(move || {
        for bytes in queue {
            if writes.write_all(&bytes).is_err() {
                let _ = writes.shutdown(Shutdown::Both);
                break;
            }
            taken.fetch_sub(bytes.len(), Ordering::Relaxed);
        }
    })?;
    let reader = Reader {
        peer,
        socket: socket.try_clone()?,
        session: Arc::clone(&session),
        tell: tell.clone(),
        stop: Arc::clone(stop),
        clients: Arc::clone(clients),
    };
    std::thread::Builder::new().name("reads".into()).spawn(move || reader.read())?;
    Ok(Client { peer, session, socket, out, unread })
}

struct Reader {
    peer: SocketAddr,
    socket: TcpStream,
    session: Arc<Mutex<Session>>,
    tell: Sender<Served>,
    stop: Arc<AtomicBool>,
    clients: Arc<Mutex<Vec<Client>>>,
}

impl Reader {
    fn read(mut self) {
        let why = self.listen();
        let _ = self.socket.shutdown(Shutdown::Both);
        let mut all = held(&self.clients);
        let before = all.len();
        all.retain(|client| client.peer != self.peer);
        // Who was dropped for not reading was told of already.
        if all.len() < before {
            let _ = self.tell.send(Served::Went(self.peer, why));
        }
    }

    /// Until the client goes, and why it had to.
    fn listen(&mut self) -> Option<String> {
        let mut buffer = [0; 4096];
        while !self.stop.load(Ordering::Relaxed) {
            let count = match self.socket.read(&mut buffer) {
                Ok(0) => return None,
                Ok(count) => count,
                Err(e) if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
                    continue;
                }
                Err(_) => return None,
            };
            // Held until the answer is queued: no row of the sender comes before it.
            let all = held(&self.clients);
            let mut session = held(&self.session);
            let heard = session.receive(&buffer[..count]);
            for one in session.heard() {
                let _ = self.tell.send(Served::Heard(self.peer, one));
            }
            if let Err(wrong) = heard {
                return Some(wrong.to_string());
            }
            let bytes = session.outgoing();
            if let Some(client) = all.iter().find(|client| client.peer == self.peer) {
                client.deliver(bytes, &self.tell);
            }
        }
        None
    }
}
