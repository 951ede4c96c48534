//! Server: one port for the page and for the WebSocket behind it.

use crate::{
    client,
    foxglove::{self, Service},
    gate::{Gate, random_text},
    http::{self, Head},
    outbox::{Letter, Outbox},
};
use dermatome_messages::{Packed, Topic, clock::now_ns};
use serde_json::{Value, json};
use std::{
    collections::HashMap,
    io::{self, ErrorKind},
    net::{Shutdown, SocketAddr, TcpListener, TcpStream},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicUsize, Ordering},
        mpsc::{Receiver, Sender, channel},
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
    /// What clients can ask for.
    pub services: &'static [Service],
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

/// What a client asks for. Whoever takes it answers it; dropped, it is answered with an error.
#[derive(Debug)]
pub struct Call {
    /// Name of the service.
    pub service: &'static str,
    /// What was sent along.
    pub request: Value,
    pub(crate) answer: Answer,
}

impl Call {
    /// Answers: with what there is to say, or why it was not done.
    pub fn answer(mut self, result: Result<Value, String>) {
        self.answer.send(result);
    }
}

/// Where an answer goes.
#[derive(Debug)]
pub(crate) struct Answer {
    outbox: Arc<Outbox>,
    service: u32,
    call: u32,
    is_sent: bool,
}

impl Answer {
    pub(crate) fn new(outbox: Arc<Outbox>, service: u32, call: u32) -> Self {
        Self { outbox, service, call, is_sent: false }
    }

    fn send(&mut self, result: Result<Value, String>) {
        self.is_sent = true;
        let content = match result {
            Ok(Value::Object(mut content)) => {
                content.insert("ok".to_owned(), true.into());
                Value::Object(content)
            }
            Ok(_) => json!({ "ok": true }),
            Err(error) => json!({ "ok": false, "error": error }),
        };
        let payload = content.to_string();
        self.outbox.put(Letter::Binary(foxglove::response(self.service, self.call, payload.as_bytes())));
    }
}

impl Drop for Answer {
    fn drop(&mut self) {
        if !self.is_sent {
            self.send(Err("nobody does that now".to_owned()));
        }
    }
}

/// A running server. Dropping it ends it, and cuts all clients off.
pub struct Server {
    gate: Gate,
    room: Arc<Room>,
    calls: Receiver<Call>,
    acceptor: Option<JoinHandle<()>>,
}

impl Server {
    /// Starts to listen.
    pub fn start(options: Options) -> Result<Self, ServerError> {
        let Options { mut gate, name, services } = options;
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
        let room = Arc::new(Room::new(name, session, services, sender));
        let (guarded, open_room) = (gate.clone(), room.clone());
        let acceptor = thread::Builder::new().name("page".to_owned());
        let acceptor = acceptor.spawn(move || accept_all(&listener, &guarded, &open_room)).map_err(failed)?;
        Ok(Self { gate, room, calls, acceptor: Some(acceptor) })
    }

    /// Where it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.gate.listen
    }

    /// The page's address, with the token.
    #[must_use]
    pub fn url(&self) -> String {
        let token = self.gate.token.as_ref().map_or(String::new(), |token| format!("?token={token}"));
        format!("http://{}/{token}", self.gate.listen)
    }

    /// Sends a message to all that subscribe to its topic; those who come later get the last one of a lasting topic.
    pub fn publish(&self, packed: Packed) {
        self.room.publish(packed);
    }

    /// Whether somebody subscribes to a topic.
    #[must_use]
    pub fn wants(&self, topic: Topic) -> bool {
        self.room.subscribers[topic.index()].load(Ordering::Relaxed) > 0
    }

    /// What clients ask for, in order; none if nobody asks.
    #[must_use]
    pub fn call(&self) -> Option<Call> {
        self.calls.try_recv().ok()
    }

    /// Clients that are there.
    #[must_use]
    pub fn clients(&self) -> usize {
        self.room.lock().clients.len()
    }

    /// Messages that clients did not get, because they were too slow.
    #[must_use]
    pub fn dropped(&self) -> u64 {
        let inside = self.room.lock();
        inside.dropped + inside.clients.values().map(|client| client.outbox.dropped()).sum::<u64>()
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

/// What all connections share.
pub(crate) struct Room {
    pub(crate) name: String,
    pub(crate) session: String,
    pub(crate) services: &'static [Service],
    calls: Mutex<Sender<Call>>,
    inside: Mutex<Inside>,
    /// Subscriptions: `[topic]`.
    subscribers: [AtomicUsize; Topic::ALL.len()],
    connections: AtomicUsize,
    is_closed: AtomicBool,
}

#[derive(Default)]
struct Inside {
    clients: HashMap<u64, Inhabitant>,
    next: u64,
    lasting: HashMap<Topic, (u64, Arc<[u8]>)>,
    dropped: u64,
}

struct Inhabitant {
    outbox: Arc<Outbox>,
    stream: TcpStream,
    /// By the client's numbers.
    subscriptions: HashMap<u32, Topic>,
}

impl Room {
    fn new(name: String, session: String, services: &'static [Service], calls: Sender<Call>) -> Self {
        Self {
            name,
            session,
            services,
            calls: Mutex::new(calls),
            inside: Mutex::default(),
            subscribers: Default::default(),
            connections: AtomicUsize::new(0),
            is_closed: AtomicBool::new(false),
        }
    }

    fn lock(&self) -> MutexGuard<'_, Inside> {
        self.inside.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn publish(&self, packed: Packed) {
        let Packed { topic, log_time, bytes, .. } = packed;
        let is_wanted = self.subscribers[topic.index()].load(Ordering::Relaxed) > 0;
        if !is_wanted && !topic.is_lasting() {
            return;
        }
        let mut inside = self.lock();
        if topic.is_lasting() {
            inside.lasting.insert(topic, (log_time, bytes.clone()));
        }
        for client in inside.clients.values() {
            for (&subscription, _) in client.subscriptions.iter().filter(|(_, of)| **of == topic) {
                let bytes = bytes.clone();
                client.outbox.put(Letter::Message { topic, subscription, log_time, bytes });
            }
        }
    }

    pub(crate) fn call(&self, call: Call) {
        let calls = self.calls.lock().unwrap_or_else(PoisonError::into_inner);
        // Where nobody takes calls any more it is dropped, and so answered.
        let _ = calls.send(call);
    }

    /// Lets a client in; gives its number.
    pub(crate) fn enter(&self, outbox: Arc<Outbox>, stream: &TcpStream) -> io::Result<u64> {
        let stream = stream.try_clone()?;
        let mut inside = self.lock();
        if self.is_closed.load(Ordering::Relaxed) {
            return Err(ErrorKind::ConnectionAborted.into());
        }
        inside.next += 1;
        let number = inside.next;
        inside.clients.insert(number, Inhabitant { outbox, stream, subscriptions: HashMap::new() });
        Ok(number)
    }

    pub(crate) fn leave(&self, client: u64) {
        let mut inside = self.lock();
        if let Some(gone) = inside.clients.remove(&client) {
            inside.dropped += gone.outbox.dropped();
            gone.subscriptions.values().for_each(|topic| self.count(*topic, false));
        }
    }

    pub(crate) fn subscribe(&self, client: u64, subscription: u32, topic: Topic) {
        let mut inside = self.lock();
        let latest = inside.lasting.get(&topic).cloned();
        let Some(client) = inside.clients.get_mut(&client) else { return };
        if let Some(before) = client.subscriptions.insert(subscription, topic) {
            self.count(before, false);
        }
        self.count(topic, true);
        if let Some((log_time, bytes)) = latest {
            client.outbox.put(Letter::Message { topic, subscription, log_time, bytes });
        }
    }

    pub(crate) fn unsubscribe(&self, client: u64, subscription: u32) {
        let mut inside = self.lock();
        let gone =
            inside.clients.get_mut(&client).and_then(|client| client.subscriptions.remove(&subscription));
        gone.into_iter().for_each(|topic| self.count(topic, false));
    }

    fn count(&self, topic: Topic, comes: bool) {
        let count = &self.subscribers[topic.index()];
        if comes {
            count.fetch_add(1, Ordering::Relaxed);
        } else {
            count.fetch_sub(1, Ordering::Relaxed);
        }
    }

    fn close(&self) {
        self.is_closed.store(true, Ordering::Relaxed);
        for client in self.lock().clients.values() {
            client.outbox.close();
            let _ = client.stream.shutdown(Shutdown::Both);
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
