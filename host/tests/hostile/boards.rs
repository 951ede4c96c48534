//! Boards that misbehave, and peers that are none.

use super::case::Case;
use super::testbench::{fake_board, hello, info};
use dermatome_shared::protocol::{Reply, Request, Version};
use std::{
    io::{Read, Write},
    net::{SocketAddr, TcpListener, TcpStream},
    thread,
    time::Duration,
};

/// Commands that talk to a board at `@`.
const COMMANDS: &[&[&str]] = &[
    &["devices", "--port", "@"],
    &["flash", "skin.dermatome", "--port", "@"],
    &["tare", "--port", "@"],
    &["stream", "--port", "@", "--frames", "3", "--give-up-after", "0"],
    &["calibrate", "skin.dermatome", "--port", "@", "--loads", "loads.csv", "--out", "new.dermatome"],
    &["check", "--port", "@"],
    &["scope", "--port", "@"],
    &["drive", "--port", "@"],
    &["drive", "--port", "@", "--gain", "2"],
    &["trim", "--port", "@"],
];

/// What a board does with a connection.
type Peer = fn(&mut TcpStream);

/// Peers that are no board: said in the order of what they do.
const PEERS: &[(&str, Peer)] = &[
    ("hangs up at once", |_| ()),
    ("says nothing", |_| thread::sleep(Duration::from_secs(20))),
    ("speaks HTTP", |stream| send(stream, b"HTTP/1.1 400 Bad Request\r\nConnection: close\r\n\r\n")),
    ("asks for a login for ever", |stream| {
        while stream.write_all(b"login: \r\n\0").is_ok() {
            thread::sleep(Duration::from_millis(2));
        }
    }),
    ("sends zeros for ever", |stream| while stream.write_all(&[0; 4096]).is_ok() {}),
    ("sends one endless packet", |stream| while stream.write_all(&[0x55; 4096]).is_ok() {}),
    ("sends noise for ever", |stream| {
        let mut state = 1_u32;
        let mut noise = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        while stream.write_all(&std::array::from_fn::<_, 512, _>(|_| noise())).is_ok() {}
    }),
    ("echoes", |stream| {
        let mut bytes = [0; 256];
        while let Ok(length @ 1..) = stream.read(&mut bytes) {
            if stream.write_all(&bytes[..length]).is_err() {
                return;
            }
        }
    }),
];

fn send(stream: &mut TcpStream, bytes: &[u8]) {
    // The other end may have gone.
    let _ = stream.write_all(bytes);
}

/// Listens for as long as the test runs.
fn peer(behave: Peer) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            thread::spawn(move || behave(&mut { stream }));
        }
    });
    address
}

/// Boards that say who they are, and then something else.
fn liars() -> Vec<(SocketAddr, &'static str)> {
    let old = Version { protocol: 1, ..Version::current() };
    let strange = Version { schema: [7; 8], ..Version::current() };
    vec![
        (fake_board(move |_| Some(hello(old))), "version 1"),
        (fake_board(move |_| Some(hello(strange))), "0707070707070707"),
        (fake_board(|_| None), "@"),
        (fake_board(|_| Some(Reply::Done)), "@"),
        (fake_board(|_| Some(info(8, 1000))), "@"),
        (fake_board(|request| matches!(request, Request::Hello(_)).then(|| hello(Version::current()))), "@"),
        // Whatever it is asked, it says who it is.
        (fake_board(|_| Some(hello(Version::current()))), "@"),
        // It knows of itself, has no patch, and has done whatever else it is asked.
        (
            fake_board(|request| match request {
                Request::Hello(_) => Some(hello(Version::current())),
                Request::Info => Some(info(0, 0)),
                _ => Some(Reply::Done),
            }),
            "@|patch",
        ),
    ]
}

pub(crate) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (_, behave) in PEERS {
        let address = format!("tcp:{}", peer(*behave));
        cases.extend(COMMANDS.iter().map(|command| case(command, &address, "@")));
    }
    for command in COMMANDS {
        // Each liar listens to one connection only.
        for (address, word) in liars() {
            let lies_about_itself = word != "@|patch";
            if lies_about_itself || command[0] != "devices" {
                cases.push(case(command, &format!("tcp:{address}"), word));
            }
        }
    }
    cases
}

fn case(command: &[&str], address: &str, word: &str) -> Case {
    let words: Vec<_> = command.iter().map(|word| if *word == "@" { address } else { word }).collect();
    Case::refused(&words, &[&word.replace('@', address)])
}
