//! Server: one port for the page and for the WebSocket behind it.

use crate::{
    client,
    foxglove::{Channel, Service},
    gate::{Gate, random_text},
    http::{self, Head},
    room::{Call, Room},
};
use dermatome_messages::{Packed, Topic, clock::now_ns};
use std::{
    io::{self, ErrorKind},
    net::{SocketAddr, TcpListener, TcpStream},
    sync::{
        Arc,
        atomic::Ordering,
        mpsc::{Receiver, channel},
    },
    thread::{self, JoinHandle},
    time::Duration,
};

/// Connections at a time: some pages, each with its files.
const MOST_CONNECTIONS: usize = 64;
/// How often it is looked whether somebody comes.
const LOOK: Duration = Duration::from_millis(10);

/// How a server is to be.
#[derive(Clone, Debug)]
pub struct Options {
    /// Who may come in, and where; port 0 takes a free one.
    pub gate: Gate,
    /// What programs show as its name.
    pub name: String,
    /// What clients can ask for, of each space.
    pub services: &'static [Service],
    /// A space for each skin, which its topics and services are named after: `dermatome` for a single one.
    pub spaces: Vec<String>,
    /// Whether the first space also tells of a whole robot.
    pub is_robot: bool,
}

/// Why there is no server.
#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    /// Somebody else listens there.
    #[error("cannot listen at {0}: the port is in use by another program")]
    PortInUse(SocketAddr),
    /// The system does not let it, for another reason.
    #[error("cannot listen at {0}: {1}")]
    Listen(SocketAddr, io::Error),
    /// An address that others reach, without a token.
    #[error("{0} is an address that other computers reach; allowed with a token")]
    NoToken(SocketAddr),
}

/// A running server. Dropping it ends it, and cuts all clients off.
pub struct Server {
    gate: Gate,
    room: Arc<Room>,
    calls: Receiver<Call>,
    acceptor: Option<JoinHandle<()>>,
}

/// Tells those who look on what is so in one space, as long as its server runs.
#[derive(Clone)]
pub struct Speaker {
    room: Arc<Room>,
    space: usize,
}

impl Speaker {
    /// Sends a message to all that subscribe to its topic; those who come later get the last one of a lasting topic.
    pub fn publish(&self, packed: Packed) {
        self.room.publish(self.space, packed);
    }

    /// Whether somebody subscribes to a topic.
    #[must_use]
    pub fn wants(&self, topic: Topic) -> bool {
        self.room.wants(Channel::new(self.space, topic))
    }
}

impl Server {
    /// Starts to listen.
    pub fn start(options: Options) -> Result<Self, ServerError> {
        let Options { mut gate, name, services, spaces, is_robot } = options;
        let at = gate.listen;
        if !at.ip().is_loopback() && gate.token.is_none() {
            return Err(ServerError::NoToken(at));
        }
        let failed = |error: io::Error| match error.kind() {
            ErrorKind::AddrInUse => ServerError::PortInUse(at),
            _ => ServerError::Listen(at, error),
        };
        let listener = TcpListener::bind(at).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        gate.listen = listener.local_addr().map_err(failed)?;
        let (sender, calls) = channel();
        // Without the system's randomness a session is told from the one before by time alone.
        let session = random_text().unwrap_or_else(|| now_ns().to_string());
        let room = Arc::new(Room::new(name, session, services, spaces, is_robot, sender));
        let (guarded, open_room) = (gate.clone(), room.clone());
        let acceptor = thread::Builder::new().name("page".to_owned());
        let acceptor = acceptor.spawn(move || accept_all(&listener, &guarded, &open_room)).map_err(failed)?;
        Ok(Self { gate, room, calls, acceptor: Some(acceptor) })
    }

    /// The page's address, with the token.
    #[must_use]
    pub fn url(&self) -> String {
        let token = self.gate.token.as_ref().map_or(String::new(), |token| format!("?token={token}"));
        format!("http://{}/{token}", self.gate.listen)
    }

    /// Tells what is to be told in a space, by its number.
    ///
    /// # Panics
    ///
    /// If there is no such space.
    #[must_use]
    pub fn speaker(&self, space: usize) -> Speaker {
        assert!(space < self.room.spaces.len(), "space {space}");
        Speaker { room: self.room.clone(), space }
    }

    /// What clients ask for, in order; none if nobody asks.
    #[must_use]
    pub fn call(&self) -> Option<Call> {
        self.calls.try_recv().ok()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.room.close();
        if let Some(acceptor) = self.acceptor.take() {
            // What it panicked with has been printed.
            let _ = acceptor.join();
        }
    }
}

fn accept_all(listener: &TcpListener, gate: &Gate, room: &Arc<Room>) {
    while !room.is_closed.load(Ordering::Relaxed) {
        match listener.accept() {
            Ok((stream, _)) if room.connections.load(Ordering::Relaxed) < MOST_CONNECTIONS => {
                room.connections.fetch_add(1, Ordering::Relaxed);
                let (gate, inside) = (gate.clone(), room.clone());
                let started = thread::Builder::new().name("visitor".to_owned()).spawn(move || {
                    if let Err(error) = receive(stream, &gate, &inside) {
                        log::debug!("a visitor has gone: {error}");
                    }
                    inside.connections.fetch_sub(1, Ordering::Relaxed);
                });
                if started.is_err() {
                    room.connections.fetch_sub(1, Ordering::Relaxed);
                }
            }
            // Too many are there: this one is cut off.
            Ok(_) => {}
            Err(_) => thread::sleep(LOOK),
        }
    }
}

/// Looks who comes, and serves them.
fn receive(mut stream: TcpStream, gate: &Gate, room: &Arc<Room>) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    let head = http::peek(&stream)?;
    if let Err(refused) = gate.check(&head.visitor)
        && !is_harmless(&head)
    {
        discard(&mut stream, &head)?;
        room.tell_refused(&refused);
        return http::refuse(&mut stream, "403 Forbidden", &refused.to_string());
    }
    if head.is_websocket {
        return client::serve(stream, room);
    }
    discard(&mut stream, &head)?;
    http::serve(&mut stream, &head)
}

/// Script and style are no secret, and a page does not repeat its token for them.
fn is_harmless(head: &Head) -> bool {
    !head.is_websocket && head.path != "/"
}

/// Takes a head that was looked at from the stream.
fn discard(stream: &mut TcpStream, head: &Head) -> io::Result<()> {
    io::Read::read_exact(stream, &mut vec![0; head.length])
}
