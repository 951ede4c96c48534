//! Client: one WebSocket, read and written on a thread each.

use crate::{
    foxglove::{self, SUBPROTOCOLS, Said},
    outbox::{Letter, Outbox},
    room::{Answer, Call, Room},
};
use std::{
    io::{self, Read, Write},
    net::{Shutdown, TcpStream},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
};
use tungstenite::{
    Message, WebSocket,
    handshake::server::{Request, Response},
    http::{HeaderValue, StatusCode},
    protocol::{Role, WebSocketConfig},
};

/// Longest message of a client, bytes: a service's request.
const LONGEST_MESSAGE: usize = 1 << 20;

/// The half of a connection that is read. What the library would answer by itself is not written: the writer does.
struct ReadHalf {
    stream: TcpStream,
    is_mute: Arc<AtomicBool>,
}

impl Read for ReadHalf {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.stream.read(bytes)
    }
}

impl Write for ReadHalf {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.is_mute.load(Ordering::Relaxed) {
            return Ok(bytes.len());
        }
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

/// Serves one client until it goes, or the server ends.
pub(crate) fn serve(stream: TcpStream, room: &Arc<Room>) -> io::Result<()> {
    stream.set_nodelay(true)?;
    let is_mute = Arc::new(AtomicBool::new(false));
    let half = ReadHalf { stream: stream.try_clone()?, is_mute: is_mute.clone() };
    let config = WebSocketConfig::default()
        .max_message_size(Some(LONGEST_MESSAGE))
        .max_frame_size(Some(LONGEST_MESSAGE));
    let accepted = tungstenite::accept_hdr_with_config(half, choose_subprotocol, Some(config));
    let mut reader = accepted.map_err(|error| io::Error::other(error.to_string()))?;
    is_mute.store(true, Ordering::Relaxed);
    // A client may be silent for as long as it likes.
    stream.set_read_timeout(None)?;
    let outbox = Arc::new(Outbox::default());
    for text in [
        foxglove::server_info(&room.name, &room.session),
        foxglove::advertise(&room.spaces, room.is_robot),
        foxglove::advertise_services(room.services, &room.spaces),
    ] {
        outbox.put(Letter::Text(text));
    }
    let client = room.enter(outbox.clone(), &stream)?;
    let written = outbox.clone();
    let writer = thread::Builder::new().name("client".to_owned()).spawn(move || {
        let _ = write_all(&stream, &written);
        written.close();
        let _ = stream.shutdown(Shutdown::Both);
    })?;
    read_all(&mut reader, room, client, &outbox);
    outbox.close();
    room.leave(client);
    let _ = writer.join();
    Ok(())
}

#[expect(clippy::result_large_err, reason = "the library's type")]
fn choose_subprotocol(
    request: &Request,
    mut response: Response,
) -> Result<Response, tungstenite::handshake::server::ErrorResponse> {
    let name = "sec-websocket-protocol";
    let offered: Vec<&str> = request
        .headers()
        .get_all(name)
        .iter()
        .filter_map(|header| header.to_str().ok())
        .flat_map(|header| header.split(',').map(str::trim))
        .collect();
    let Some(chosen) = SUBPROTOCOLS.into_iter().find(|name| offered.contains(name)) else {
        let mut refusal =
            tungstenite::handshake::server::ErrorResponse::new(Some(format!("speak {}\n", SUBPROTOCOLS[0])));
        *refusal.status_mut() = StatusCode::BAD_REQUEST;
        return Err(refusal);
    };
    response.headers_mut().insert(name, HeaderValue::from_static(chosen));
    Ok(response)
}

fn write_all(stream: &TcpStream, outbox: &Outbox) -> Result<(), tungstenite::Error> {
    let mut socket = WebSocket::from_raw_socket(stream, Role::Server, None);
    while let Some(letters) = outbox.take() {
        for letter in letters {
            socket.write(match letter {
                Letter::Message { subscription, log_time, bytes, .. } => {
                    let head = foxglove::message_head(subscription, log_time);
                    Message::binary([&head[..], &bytes].concat())
                }
                Letter::Text(text) => Message::text(text),
                Letter::Binary(bytes) => Message::binary(bytes),
                Letter::Pong(bytes) => Message::Pong(bytes.into()),
            })?;
        }
        socket.flush()?;
    }
    Ok(())
}

fn read_all(reader: &mut WebSocket<ReadHalf>, room: &Room, client: u64, outbox: &Arc<Outbox>) {
    loop {
        match reader.read() {
            Ok(Message::Text(text)) => match serde_json::from_str(&text) {
                Ok(said) => hear(said, room, client, outbox),
                Err(error) => {
                    outbox.put(Letter::Text(foxglove::warning(&format!("not understood: {error}"))));
                }
            },
            Ok(Message::Binary(bytes)) => call(&bytes, room, outbox),
            Ok(Message::Ping(bytes)) => outbox.put(Letter::Pong(bytes.to_vec())),
            Ok(Message::Pong(_) | Message::Frame(_)) => {}
            Ok(Message::Close(_)) | Err(_) => return,
        }
    }
}

fn hear(said: Said, room: &Room, client: u64, outbox: &Outbox) {
    match said {
        Said::Subscribe { subscriptions } => {
            for subscription in subscriptions {
                match foxglove::channel_of(subscription.channel_id, room.spaces.len()) {
                    Some(channel) => room.subscribe(client, subscription.id, channel),
                    None => {
                        let words = format!("there is no channel {}", subscription.channel_id);
                        outbox.put(Letter::Text(foxglove::warning(&words)));
                    }
                }
            }
        }
        Said::Unsubscribe { subscription_ids } => {
            subscription_ids.into_iter().for_each(|id| room.unsubscribe(client, id));
        }
        Said::Other => {}
    }
}

fn call(bytes: &[u8], room: &Room, outbox: &Arc<Outbox>) {
    let Some(request) = foxglove::request(bytes) else {
        outbox.put(Letter::Text(foxglove::warning("a binary message was not understood")));
        return;
    };
    let refuse = |words: &str| {
        outbox.put(Letter::Text(foxglove::failure(request.service, request.call, words)));
    };
    let service = room.services.get(request.service as usize % room.services.len().max(1));
    let space = request.service as usize / room.services.len().max(1);
    let Some(service) = service.filter(|_| space < room.spaces.len()) else {
        return refuse("there is no such service");
    };
    let payload = if request.payload.is_empty() { b"{}" } else { request.payload.as_slice() };
    let content = match serde_json::from_slice(payload) {
        Ok(content) if request.encoding == "json" => content,
        Ok(_) => return refuse("allowed: the encoding `json`"),
        Err(error) => return refuse(&format!("the request is no JSON: {error}")),
    };
    let answer = Answer::new(outbox.clone(), request.service, request.call);
    room.call(Call { space, service: service.name, request: content, answer });
}
