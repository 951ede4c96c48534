//! Bytes to the port of a simulated board: it goes on to serve hosts that know how to ask.

use super::program::Desk;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use std::{
    io::Write,
    net::{Shutdown, TcpStream},
    time::{Duration, Instant},
};

/// What strangers send, in how many ways.
fn messages() -> Vec<Vec<u8>> {
    let mut random = Pcg32::seed_from_u64(1);
    let mut messages = vec![
        Vec::new(),
        vec![0],
        vec![0; 100_000],
        vec![0xff; 100_000],
        vec![0x55; 1_000_000],
        b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n".to_vec(),
        b"SSH-2.0-OpenSSH_9.6\r\n".to_vec(),
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03".to_vec(),
        b"'; DROP TABLE skins; --\r\n".to_vec(),
        "\u{1b}[2J\u{202e}\u{0}".as_bytes().to_vec(),
    ];
    // Of every length that a short packet may have, whole in its frame of zeros or not.
    for length in 1..25 {
        let noise: Vec<u8> = (0..length).map(|_| random.random()).collect();
        messages.push([&noise[..], &[0]].concat());
    }
    for length in [50, 500, 5000, 50_000, 500_000, 1000] {
        messages.push((0..length).map(|_| random.random()).collect());
    }
    messages
}

/// How many messages were sent, and the longest time that the board took to answer a host after one.
pub(crate) fn try_port() -> (usize, Duration) {
    let desk = Desk::empty();
    desk.write("skin.toml", super::program::TINY);
    let (mut board, port) = desk.board("skin.toml", &[]);
    let address = port.strip_prefix("tcp:").unwrap().to_owned();
    let mut longest = Duration::ZERO;
    let messages = messages();
    for message in &messages {
        let mut stream = TcpStream::connect(&address).unwrap();
        stream.set_write_timeout(Some(Duration::from_secs(2))).unwrap();
        // A board that hangs up on nonsense does well.
        let _ = stream.write_all(message);
        let _ = stream.shutdown(Shutdown::Write);
        drop(stream);
        let start = Instant::now();
        let said = desk.run(&["devices", "--port", &port]).success();
        assert!(said.out.contains("simulated") || said.out.contains(&port), "{}", said.out);
        longest = longest.max(start.elapsed());
        assert!(board.is_running(), "the board ended after {} bytes", message.len());
    }
    board.interrupt();
    let done = board.finish().success();
    assert!(!done.err.to_lowercase().contains("panicked"), "{}", done.err);
    (messages.len(), longest)
}
