//! Room: what all connections share, and what clients ask for.

use crate::{
    foxglove::{self, Channel, Service},
    gate::Refused,
    outbox::{Letter, Outbox},
};
use dermatome_messages::{Packed, Topic};
use serde_json::{Value, json};
use std::{
    collections::{BTreeSet, HashMap},
    io::{self, ErrorKind, Write},
    net::{Shutdown, TcpStream},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicUsize, Ordering},
        mpsc::Sender,
    },
};

/// Most that are told of who did not come in.
const MOST_REFUSED: usize = 16;

/// What a client asks for. Whoever takes it answers it; dropped, it is answered with an error.
#[derive(Debug)]
pub struct Call {
    /// Number of the skin's space.
    pub space: usize,
    /// Name of the service, as of a single skin.
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

/// What all connections share.
pub(crate) struct Room {
    pub(crate) name: String,
    pub(crate) session: String,
    pub(crate) services: &'static [Service],
    calls: Mutex<Sender<Call>>,
    inside: Mutex<Inside>,
    /// Names of the skins' spaces.
    pub(crate) spaces: Vec<String>,
    /// Whether there are topics of a whole robot.
    pub(crate) is_robot: bool,
    /// Subscriptions: `[channel]`.
    subscribers: Vec<AtomicUsize>,
    pub(crate) connections: AtomicUsize,
    /// Who was refused, in words.
    refused: Mutex<BTreeSet<String>>,
    pub(crate) is_closed: AtomicBool,
}

#[derive(Default)]
struct Inside {
    clients: HashMap<u64, Inhabitant>,
    next: u64,
    lasting: HashMap<Channel, (u64, Arc<[u8]>)>,
}

struct Inhabitant {
    outbox: Arc<Outbox>,
    stream: TcpStream,
    /// By the client's numbers.
    subscriptions: HashMap<u32, Channel>,
}

impl Room {
    pub(crate) fn new(
        name: String,
        session: String,
        services: &'static [Service],
        spaces: Vec<String>,
        is_robot: bool,
        calls: Sender<Call>,
    ) -> Self {
        Self {
            subscribers: (0..spaces.len() * Topic::ALL.len()).map(|_| AtomicUsize::new(0)).collect(),
            spaces,
            is_robot,
            name,
            session,
            services,
            calls: Mutex::new(calls),
            inside: Mutex::default(),
            refused: Mutex::default(),
            connections: AtomicUsize::new(0),
            is_closed: AtomicBool::new(false),
        }
    }

    fn lock(&self) -> MutexGuard<'_, Inside> {
        self.inside.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn publish(&self, space: usize, packed: Packed) {
        let Packed { topic, log_time, bytes, .. } = packed;
        let channel = Channel::new(space, topic);
        if !self.wants(channel) && !topic.is_lasting() {
            return;
        }
        let mut inside = self.lock();
        if topic.is_lasting() {
            inside.lasting.insert(channel, (log_time, bytes.clone()));
        }
        for client in inside.clients.values() {
            for (&subscription, _) in client.subscriptions.iter().filter(|(_, of)| **of == channel) {
                let bytes = bytes.clone();
                client.outbox.put(Letter::Message { channel, subscription, log_time, bytes });
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
            log::debug!("a client has gone; {} messages gave way to newer ones", gone.outbox.dropped());
            gone.subscriptions.values().for_each(|channel| self.count(*channel, false));
        }
    }

    pub(crate) fn subscribe(&self, client: u64, subscription: u32, channel: Channel) {
        let mut inside = self.lock();
        let latest = inside.lasting.get(&channel).cloned();
        let Some(client) = inside.clients.get_mut(&client) else { return };
        if let Some(before) = client.subscriptions.insert(subscription, channel) {
            self.count(before, false);
        }
        self.count(channel, true);
        if let Some((log_time, bytes)) = latest {
            client.outbox.put(Letter::Message { channel, subscription, log_time, bytes });
        }
    }

    pub(crate) fn unsubscribe(&self, client: u64, subscription: u32) {
        let mut inside = self.lock();
        let gone =
            inside.clients.get_mut(&client).and_then(|client| client.subscriptions.remove(&subscription));
        gone.into_iter().for_each(|channel| self.count(channel, false));
    }

    fn count(&self, channel: Channel, comes: bool) {
        let count = &self.subscribers[channel.index()];
        if comes {
            count.fetch_add(1, Ordering::Relaxed);
        } else {
            count.fetch_sub(1, Ordering::Relaxed);
        }
    }

    /// Whether somebody subscribes to a channel.
    pub(crate) fn wants(&self, channel: Channel) -> bool {
        self.subscribers[channel.index()].load(Ordering::Relaxed) > 0
    }

    /// Says once that somebody did not come in: what a browser says to that does not tell why.
    pub(crate) fn tell_refused(&self, refused: &Refused) {
        let words = refused.to_string();
        let mut told = self.refused.lock().unwrap_or_else(PoisonError::into_inner);
        if told.len() < MOST_REFUSED && told.insert(words.clone()) {
            // Where nobody can be told, that is no reason to end.
            let _ = writeln!(io::stderr(), "warning: {words}");
        }
    }

    pub(crate) fn close(&self) {
        self.is_closed.store(true, Ordering::Relaxed);
        for client in self.lock().clients.values() {
            client.outbox.close();
            let _ = client.stream.shutdown(Shutdown::Both);
        }
    }
}
