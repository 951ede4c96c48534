//! Desk: the thread that holds a board's link.
//!
//! The board is listened to whatever Python does meanwhile: it is shown that its host is there, and what it sends does not
//! pile up on its side. What Python asks is done between two frames. Frames wait in a [`Queue`] for whoever iterates;
//! of a real board's the oldest are dropped, and counted, once too many wait.

mod queue;

pub(crate) use queue::{Queue, WhenFull};

use crate::{
    error::raised,
    waiting::{receive, receive_until},
};
use dermatome_link::{
    Link, LinkError, LinkErrorKind, ScanFrame, Subscription, frame_timeout, silence_timeout,
};
use dermatome_shared::protocol::{PatchInfo, Selection};
use pyo3::prelude::*;
use std::{
    fmt::Display,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
        mpsc::{Receiver, Sender, TryRecvError, channel},
    },
    thread,
    time::{Duration, Instant},
};

/// How long whoever closes a port waits for it: longer than a board takes to end its stream.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(1);

/// What is done with the link.
enum Order {
    Ask(Box<dyn FnOnce(&mut Link) + Send>),
    Stream(Selection, PatchInfo, Arc<Queue>),
    /// The last one; whoever gave it hears when the port is free.
    Close(Sender<()>),
}

/// What gives orders to the thread. Dropped, it ends the thread.
pub(crate) struct Desk {
    orders: Mutex<Sender<Order>>,
    /// Orders that the thread has not looked at.
    waiting: Arc<AtomicUsize>,
    /// What a full queue does.
    when_full: WhenFull,
}

impl Desk {
    /// Opens a link on a thread of its own, which holds it.
    pub(crate) fn open<E: Display>(
        py: Python<'_>,
        when_full: WhenFull,
        open: impl FnOnce() -> Result<Link, E> + Send + 'static,
    ) -> PyResult<Self> {
        let (orders, given) = channel();
        let (opened, answer) = channel();
        let waiting = Arc::<AtomicUsize>::default();
        let worker = Worker { given, waiting: waiting.clone() };
        let thread = thread::Builder::new().name("dermatome".to_owned());
        thread
            .spawn(move || match open() {
                // Where Ctrl-C has ended the wait, the link goes at once.
                Ok(link) if opened.send(Ok(())).is_ok() => worker.run(link),
                Ok(_) => {}
                Err(error) => drop(opened.send(Err(error.to_string()))),
            })
            .map_err(raised)?;
        match receive(py, answer)? {
            Some(opened) => opened.map_err(raised)?,
            None => return Err(raised("opening the port has crashed")),
        }
        Ok(Self { orders: Mutex::new(orders), waiting, when_full })
    }

    /// Asks something of the board, and waits for it; Ctrl-C ends the wait.
    pub(crate) fn ask<T: Send + 'static>(
        &self,
        py: Python<'_>,
        ask: impl FnOnce(&mut Link) -> T + Send + 'static,
    ) -> PyResult<T> {
        let (sender, answer) = channel();
        self.order(Order::Ask(Box::new(move |link| drop(sender.send(ask(link))))))?;
        receive(py, answer)?.ok_or_else(closed)
    }

    /// Begins a stream, which ends one that goes on.
    pub(crate) fn stream(&self, selection: Selection, patch: PatchInfo) -> PyResult<Arc<Queue>> {
        let queue = Arc::new(Queue::new(self.when_full));
        self.order(Order::Stream(selection, patch, queue.clone()))?;
        Ok(queue)
    }

    /// Closes the port. A board that is still at something, whose answer nobody awaits, is left to it.
    pub(crate) fn close(&self, py: Python<'_>) -> PyResult<()> {
        let (sender, ended) = channel();
        if self.order(Order::Close(sender)).is_ok() {
            let asked = Instant::now();
            receive_until(py, ended, || asked.elapsed() > CLOSE_TIMEOUT)?;
        }
        Ok(())
    }

    fn order(&self, order: Order) -> PyResult<()> {
        self.waiting.fetch_add(1, Ordering::Relaxed);
        let orders = self.orders.lock().unwrap_or_else(PoisonError::into_inner);
        orders.send(order).map_err(|_| closed())
    }
}

fn closed() -> PyErr {
    raised("the board is closed")
}

/// What runs on the thread.
struct Worker {
    given: Receiver<Order>,
    waiting: Arc<AtomicUsize>,
}

/// Whether there is more to do.
enum Next {
    Order(Order),
    Nothing,
    End,
}

impl Worker {
    fn run(self, mut link: Link) {
        let mut next = self.given.recv().ok();
        while let Some(order) = next.take() {
            self.waiting.fetch_sub(1, Ordering::Relaxed);
            next = match order {
                Order::Ask(ask) => {
                    ask(&mut link);
                    None
                }
                Order::Stream(selection, patch, queue) => {
                    let (ended, order) = self.stream(&mut link, selection, &patch, &queue);
                    queue.end(ended);
                    order
                }
                Order::Close(ended) => {
                    drop(link);
                    let _ = ended.send(());
                    return;
                }
            };
            if next.is_none() {
                next = self.given.recv().ok();
            }
        }
    }

    /// Streams until it ends: why, and the order that ended it.
    fn stream(
        &self,
        link: &mut Link,
        selection: Selection,
        patch: &PatchInfo,
        queue: &Queue,
    ) -> (Result<(), LinkError>, Option<Order>) {
        let mut subscription = match link.subscribe(selection) {
            Ok(subscription) => subscription,
            Err(error) => return (Err(error), None),
        };
        if let Some(words) = subscription.thinned_out(selection) {
            queue.warn(words);
        }
        let mut heard = Instant::now();
        loop {
            match self.next() {
                Next::Order(Order::Ask(ask)) => {
                    self.waiting.fetch_sub(1, Ordering::Relaxed);
                    ask(subscription.link());
                    continue;
                }
                Next::Order(order) => return (subscription.stop().map(drop), Some(order)),
                Next::End => return (subscription.stop().map(drop), None),
                Next::Nothing if queue.is_left() => return (subscription.stop().map(drop), None),
                Next::Nothing => {}
            }
            match self.frame(&mut subscription, patch, queue, heard) {
                Ok(Came::Frame(frame)) => {
                    heard = Instant::now();
                    queue.put(*frame, subscription.totals().frames_missing);
                }
                Ok(Came::Nothing) => {}
                Ok(Came::End) => return (Ok(()), None),
                Err(error) => return (Err(error), None),
            }
        }
    }

    fn next(&self) -> Next {
        match self.given.try_recv() {
            Ok(order) => Next::Order(order),
            Err(TryRecvError::Empty) => Next::Nothing,
            Err(TryRecvError::Disconnected) => Next::End,
        }
    }

    /// The next frame; a board that is silent is asked whether it still streams.
    fn frame(
        &self,
        subscription: &mut Subscription<'_>,
        patch: &PatchInfo,
        queue: &Queue,
        heard: Instant,
    ) -> Result<Came, LinkError> {
        let go_on = || self.waiting.load(Ordering::Relaxed) == 0 && !queue.is_left();
        match subscription.next_while(frame_timeout(patch), go_on) {
            Ok(frame) => Ok(frame.map_or(Came::Nothing, |frame| Came::Frame(Box::new(frame)))),
            Err(error @ LinkError { kind: LinkErrorKind::NoAnswer { .. }, .. }) => {
                if !subscription.link().info()?.streaming.any() {
                    return Ok(Came::End);
                }
                if heard.elapsed() < silence_timeout(patch) { Ok(Came::Nothing) } else { Err(error) }
            }
            Err(error) => Err(error),
        }
    }
}

enum Came {
    Frame(Box<ScanFrame>),
    Nothing,
    /// The board has ended its stream.
    End,
}
