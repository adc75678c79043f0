//! Where a viewer listens, and a listener of our own for viewers that join later.

use std::fmt;
use std::io;
use std::net::{SocketAddr, TcpListener, TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

use rerun::ServerOptions;
use rerun::grpc_server::GrpcServerSink;

use crate::viewer::Error;

/// A host and a port: `127.0.0.1:9876`, where the viewer listens unless told otherwise.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Address(String);

/// A viewer on this machine answers at once, one in the same network soon.
const ANSWERS_WITHIN: Duration = Duration::from_millis(500);
const STARTS_WITHIN: Duration = Duration::from_secs(5);

impl Address {
    pub fn new(host_and_port: &str) -> Self {
        Self(host_and_port.into())
    }

    /// As the viewer takes it.
    pub fn url(&self) -> String {
        format!("rerun+http://{self}/proxy")
    }

    /// Whether anybody listens there.
    ///
    /// # Errors
    /// Why not.
    pub fn reach(&self) -> Result<(), Error> {
        let try_one = |to: SocketAddr| TcpStream::connect_timeout(&to, ANSWERS_WITHIN).map(drop);
        let reached = self.resolved().and_then(|all| first_success(all, try_one));
        reached.map_err(|source| Error::Unreachable { address: self.0.clone(), source })
    }

    fn resolved(&self) -> io::Result<Vec<SocketAddr>> {
        Ok(self.0.to_socket_addrs()?.collect())
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

fn first_success<T>(
    all: Vec<SocketAddr>,
    mut attempt: impl FnMut(SocketAddr) -> io::Result<T>,
) -> io::Result<T> {
    let mut last = io::Error::from(io::ErrorKind::AddrNotAvailable);
    for address in all {
        match attempt(address) {
            Ok(done) => return Ok(done),
            Err(error) => last = error,
        }
    }
    Err(last)
}

/// Takes what is sent to its address, keeps it, and gives it to every viewer that joins; ends when
/// dropped.
pub struct Server {
    _sink: GrpcServerSink,
    pub address: Address,
}

impl Server {
    /// # Errors
    /// If the address cannot be had.
    pub fn start(address: &Address) -> Result<Self, Error> {
        let cannot = |source| Error::Serve { address: address.0.clone(), source };
        // The library only logs that a port is taken: asked here first.
        let at = address.resolved().and_then(|all| {
            first_success(all, |at| TcpListener::bind(at).and_then(|l| l.local_addr()))
        });
        let at = at.map_err(cannot)?;
        let sink = GrpcServerSink::new(&host(at), at.port(), ServerOptions::default())
            .map_err(|e| cannot(io::Error::other(e)))?;
        let server = Self { _sink: sink, address: Address(at.to_string()) };
        let begun = Instant::now();
        while let Err(error) = server.address.reach() {
            if begun.elapsed() > STARTS_WITHIN {
                return Err(error);
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        Ok(server)
    }
}

/// With the brackets an IPv6 address has before a port.
fn host(at: SocketAddr) -> String {
    match at {
        SocketAddr::V4(at) => at.ip().to_string(),
        SocketAddr::V6(at) => format!("[{}]", at.ip()),
    }
}
