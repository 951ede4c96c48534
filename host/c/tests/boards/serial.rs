//! A board behind a serial port: a pseudo-terminal whose other end leads to a simulated board.

use super::{allocations::allocations, handle::Handle, paced_board, testbench::raw};
use dermatome_c::{codes::*, records::Options};
use serialport::{SerialPort, TTYPort};
use std::{
    io::{ErrorKind, Read, Write},
    mem::MaybeUninit,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
};

/// Copies bytes until an end is closed or `is_over`.
fn copy(
    mut from: impl Read + Send + 'static,
    mut to: impl Write + Send + 'static,
    is_over: Arc<AtomicBool>,
) -> JoinHandle<()> {
    thread::spawn(move || {
        let mut buffer = [0; 256];
        while !is_over.load(Ordering::SeqCst) {
            match from.read(&mut buffer) {
                Ok(length @ 1..) if to.write_all(&buffer[..length]).is_ok() => {}
                Err(error) if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock) => {}
                _ => return,
            }
        }
    })
}

#[test]
fn a_loop_over_a_serial_port_allocates_nothing_and_is_told_when_the_adapter_goes() {
    let board = paced_board(100.0);
    let (near, far) = TTYPort::pair().unwrap();
    let port = far.name().unwrap();
    let (line, is_over) = (raw(board.address()), Arc::new(AtomicBool::new(false)));
    let ends = [
        copy(near.try_clone_native().unwrap(), line.try_clone().unwrap(), is_over.clone()),
        copy(line, near, is_over.clone()),
    ];
    let handle = Handle::open(&port).unwrap();
    // It was there so that the near end was never hung up.
    drop(far);
    handle.start(Options { images_every: 1, ..Options::default() }).unwrap();
    let (mut frame, mut frames, mut image) = (MaybeUninit::uninit(), 0, [0.0; 196]);
    let inside = allocations(|| {
        while frames < 200 {
            match handle.poll(&mut frame) {
                DERMATOME_FRAME => {
                    frames += 1;
                    assert_eq!(handle.image(&mut image), 196);
                }
                code => assert_eq!(code, DERMATOME_OK),
            }
            thread::yield_now();
        }
    });
    let counts = handle.counts();
    assert_eq!((inside, counts.packets_damaged, counts.parts_missing), (0, 0, 0), "{counts:?}");
    is_over.store(true, Ordering::SeqCst);
    ends.into_iter().for_each(|end| end.join().unwrap());
    assert_eq!(handle.poll_until(|code| code < 0), DERMATOME_CUT);
}
