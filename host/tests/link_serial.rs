//! Links over a serial port: a pseudo-terminal whose other end leads to a simulated board.
#![cfg(unix)]

mod testbench;

use dermatome::link::{self, LinkErrorKind, Port, Totals, tare, upload};
use dermatome_shared::protocol::{BoardPacket, PacketReader, RequestPacket, Selection, Version, encode};
use serialport::{SerialPort, TTYPort};
use std::{
    io::{Read, Write},
    thread,
    time::Duration,
};
use testbench::{empty_board, hello, raw, square_patch};

/// Both ends of a cable; the second one is kept so that the first is never hung up.
fn cable() -> (TTYPort, TTYPort, Port) {
    let (near, far) = TTYPort::pair().unwrap();
    let port = Port::Serial(far.name().unwrap());
    (near, far, port)
}

/// Copies bytes until an end is closed.
fn copy(mut from: impl Read + Send + 'static, mut to: impl Write + Send + 'static) {
    thread::spawn(move || {
        let mut buffer = [0; 256];
        loop {
            match from.read(&mut buffer) {
                Ok(length) if length > 0 => {
                    if to.write_all(&buffer[..length]).is_err() {
                        return;
                    }
                }
                Err(error) if matches!(error.kind(), std::io::ErrorKind::TimedOut) => {}
                Err(error) if matches!(error.kind(), std::io::ErrorKind::WouldBlock) => {}
                _ => return,
            }
        }
    });
}

#[test]
fn upload_tare_and_stream_work_over_a_serial_port() {
    let board = empty_board();
    let (near, _far, port) = cable();
    let stream_to_board = raw(board.address());
    copy(near.try_clone_native().unwrap(), stream_to_board.try_clone().unwrap());
    copy(stream_to_board, near);
    let mut link = link::open(&port).unwrap();
    assert_eq!(link.port(), port.to_string());
    upload(&mut link, &square_patch("serial", 16, 10, 50.0), |_| ()).unwrap();
    tare(&mut link, 5, Duration::from_secs(2)).unwrap();
    let mut stream =
        link.subscribe(Selection { images: 1, measurements: 1, ..Selection::default() }).unwrap();
    for _ in 0..100 {
        stream.next(Duration::from_secs(2)).unwrap().expect("a frame");
    }
    assert_eq!(stream.totals(), Totals { frames: 100, ..Totals::default() });
    let link = stream.link();
    assert_eq!((link.events_lost(), link.packets_damaged()), (0, 0));
}

#[test]
fn a_serial_port_that_another_program_holds_is_in_use() {
    let (_near, _far, port) = cable();
    let _held = serialport::new(port.to_string(), 2_000_000).open().unwrap();
    let error = link::open(&port).map(drop).unwrap_err();
    assert!(matches!(error.kind, LinkErrorKind::InUse), "{error}");
    assert!(error.to_string().contains(&port.to_string()), "{error}");
}

/// Answers the first request, a Hello, at the near end of a cable, and gives the end back.
fn answer_hello(mut near: TTYPort) -> TTYPort {
    let mut reader = PacketReader::default();
    let mut byte = [0];
    loop {
        let received = near.read(&mut byte).is_ok_and(|length| length == 1);
        if received && reader.push::<RequestPacket>(byte[0]).is_some() {
            break;
        }
    }
    let reply = BoardPacket::Reply { sequence: 0, reply: hello(Version::current()) };
    near.write_all(encode(&reply, &mut [0; 256]).unwrap()).unwrap();
    near
}

#[test]
fn a_cable_pulled_in_the_middle_cuts_the_link() {
    let (near, far, port) = cable();
    let board = thread::spawn(move || answer_hello(near));
    let mut link = link::open(&port).unwrap();
    drop((far, board.join().unwrap()));
    let error = link.info().unwrap_err();
    assert!(matches!(error.kind, LinkErrorKind::Cut), "{error}");
}
