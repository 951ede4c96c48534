//! Owner: a thread that owns emulated machines, and does with them what it is asked to.

use crate::machine::Halt;
use std::{
    fmt,
    sync::mpsc::{Receiver, Sender, channel},
    thread,
};

type Job<T> = Box<dyn FnOnce(&mut T) + Send>;

/// A handle to what a thread owns, which ends when the last of them is dropped.
pub(super) struct Owner<T>(Sender<Job<T>>);

impl<T> Clone for Owner<T> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

impl<T> fmt::Debug for Owner<T> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Owner")
    }
}

impl<T: 'static> Owner<T> {
    /// Makes it in a thread of its own, and waits until it is there.
    pub(super) fn start(make: impl FnOnce() -> Result<T, Halt> + Send + 'static) -> Result<Self, Halt> {
        let (jobs, queue): (Sender<Job<T>>, Receiver<Job<T>>) = channel();
        let (started, start) = channel();
        thread::spawn(move || match make() {
            Err(halt) => drop(started.send(Err(halt))),
            Ok(mut owned) => {
                let _ = started.send(Ok(()));
                queue.into_iter().for_each(|job| job(&mut owned));
            }
        });
        match start.recv() {
            Ok(Ok(())) => Ok(Self(jobs)),
            Ok(Err(halt)) => Err(halt),
            Err(_) => unreachable!("the thread says how it started"),
        }
    }

    /// Lets the thread do something with it, and waits for the result.
    pub(super) fn with<R: Send + 'static>(&self, work: impl FnOnce(&mut T) -> R + Send + 'static) -> R {
        let (done, result) = channel();
        let job: Job<T> = Box::new(move |owned| {
            let _ = done.send(work(owned));
        });
        let _ = self.0.send(job);
        result.recv().expect("the thread panicked, and has said why")
    }
}
