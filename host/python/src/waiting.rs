//! Waiting: for a board, or for what takes long, without the interpreter's lock; Ctrl-C ends it.

use crate::error::raised;
use pyo3::prelude::*;
use std::{
    sync::mpsc::{Receiver, RecvTimeoutError, channel},
    thread,
    time::Duration,
};

/// How often whoever waits looks for Ctrl-C.
pub(crate) const POLL: Duration = Duration::from_millis(50);

/// Waits for what another thread sends; none if that has ended without it.
pub(crate) fn receive<T: Send>(py: Python<'_>, from: Receiver<T>) -> PyResult<Option<T>> {
    receive_until(py, from, || false)
}

/// The same, and none as well once `is_enough`.
pub(crate) fn receive_until<T: Send>(
    py: Python<'_>,
    mut from: Receiver<T>,
    is_enough: impl Fn() -> bool,
) -> PyResult<Option<T>> {
    loop {
        let received;
        (from, received) = py.detach(move || {
            let received = from.recv_timeout(POLL);
            (from, received)
        });
        match received {
            Ok(received) => return Ok(Some(received)),
            Err(RecvTimeoutError::Timeout) if !is_enough() => py.check_signals()?,
            Err(_) => return Ok(None),
        }
    }
}

/// Does on another thread what takes long. Where Ctrl-C comes first, it goes on there and nobody hears of it.
pub(crate) fn compute<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, receiver) = channel();
    let worker = thread::Builder::new().name("dermatome".to_owned());
    worker.spawn(move || sender.send(work())).map_err(raised)?;
    receive(py, receiver)?.ok_or_else(|| raised("the computation has crashed"))
}
