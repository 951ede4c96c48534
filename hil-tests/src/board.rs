//! Board: an emulated board that runs in a thread of its own, and a line to it for the host's link.
//!
//! The thread owns the machine, and virtual time only passes while somebody reads from the line or
//! asks the board to run: what happens depends on what was asked and on nothing else.

use crate::{
    chip::{Chip, flash::Flash, time::Time, usart::Symbol},
    machine::{Halt, Machine, Options},
    world::WorldHandle,
};
use dermatome::link::{Link, LinkError, Transport};
use std::{
    collections::VecDeque,
    io::{self, ErrorKind, Read, Write},
    sync::{
        Arc, Mutex, PoisonError,
        mpsc::{Receiver, Sender, channel},
    },
    thread,
    time::Duration,
};

/// How long a board may take to start: it checks both of its patches first.
pub const START_TIME: Time = Time::from_millis(200);
/// Longest that one read of the line waits, in virtual time.
const READ_TIME: Time = Time::from_millis(20);
/// A line hands over what came in this time together, as a USB adapter does.
const BATCH_TIME: Time = Time::from_micros(125);

/// Longest that a host takes to make a port of a board on USB.
const PORT_TIME: Time = Time::from_millis(1000);

type Job = Box<dyn FnOnce(&mut Machine) + Send>;

/// An emulated board. It ends when the last of its handles and lines is dropped.
#[derive(Clone, Debug)]
pub struct VirtualBoard {
    jobs: Sender<Job>,
    halt: Arc<Mutex<Option<Halt>>>,
}

impl VirtualBoard {
    /// Switches a board with this in its flash on.
    pub fn start(flash: Flash, options: Options) -> Result<Self, Halt> {
        let (jobs, queue): (Sender<Job>, Receiver<Job>) = channel();
        let (started, start) = channel();
        thread::spawn(move || match Machine::new(flash, options) {
            Err(halt) => drop(started.send(Err(halt))),
            Ok(mut machine) => {
                let _ = started.send(Ok(()));
                queue.into_iter().for_each(|job| job(&mut machine));
            }
        });
        match start.recv() {
            Ok(Ok(())) => Ok(Self { jobs, halt: Arc::default() }),
            Ok(Err(halt)) => Err(halt),
            Err(_) => unreachable!("the thread says how it started"),
        }
    }

    /// Lets the board's thread do something with the machine, and waits for the result.
    pub fn with<T: Send + 'static>(&self, work: impl FnOnce(&mut Machine) -> T + Send + 'static) -> T {
        let (done, result) = channel();
        let job: Job = Box::new(move |machine| {
            let _ = done.send(work(machine));
        });
        let _ = self.jobs.send(job);
        result.recv().expect("the board's thread panicked, and has said why")
    }

    /// Lets virtual time pass.
    pub fn run(&self, time: Time) -> Result<(), Halt> {
        self.keep(self.with(move |machine| machine.run_until(machine.now() + time)))
    }

    /// A new end of its link. Over USB that is a program which opens the port, as soon as there is one, and closes it when
    /// this is dropped.
    #[must_use]
    pub fn line(&self) -> Line {
        self.open_port();
        Line { board: self.clone(), waiting: VecDeque::new() }
    }

    /// Over USB, opens the serial port once the host has made one. It waits for a second at most; without a port, whoever
    /// reads finds silence.
    pub fn open_port(&self) {
        let _ = self.keep(self.with(|machine| {
            if machine.options().usb {
                machine.run_while(machine.now() + PORT_TIME, |chip| !chip.usb.host().has_port())?;
                machine.chip(|chip| chip.usb.host_mut().open());
            }
            Ok(())
        }));
    }

    /// A new link to it. Its requests have the same numbers each time, so that a run leaves the same trace.
    pub fn link(&self) -> Result<Link, LinkError> {
        Ok(Link::connect("virtual", self.line())?.counting_from(0))
    }

    /// The skin and the front end before it, if its rig has them.
    #[must_use]
    pub fn world(&self) -> Option<WorldHandle> {
        self.with(|machine| machine.world().cloned())
    }

    /// The program at the other end of its link is gone.
    pub fn hang_up(&self) {
        self.with(|machine| {
            machine.chip(|chip| {
                chip.uart.unplug();
                chip.usb.host_mut().close();
            });
        });
    }

    /// Whether its link goes over USB, and nobody has a port of it open: the one that there was went with the device.
    #[must_use]
    pub fn has_lost_port(&self) -> bool {
        self.with(|machine| machine.options().usb && !machine.chip(|chip| chip.usb.host().is_open()))
    }

    /// Why the board stopped, if it has.
    #[must_use]
    pub fn halt(&self) -> Option<Halt> {
        self.halt.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn keep<T>(&self, result: Result<T, Halt>) -> Result<T, Halt> {
        result.inspect_err(|halt| {
            let mut kept = self.halt.lock().unwrap_or_else(PoisonError::into_inner);
            kept.get_or_insert_with(|| halt.clone());
        })
    }

    /// Sends bytes over the line, some of them damaged; over USB, none is.
    pub fn send(&self, symbols: Vec<Symbol>) {
        self.with(move |machine| {
            let (now, is_usb) = (machine.now(), machine.options().usb);
            machine.chip(|chip| {
                if is_usb {
                    let bytes: Vec<u8> = symbols.iter().map(|symbol| symbol.byte).collect();
                    chip.usb.host_mut().write(&bytes);
                } else {
                    chip.uart.receive(symbols, now);
                }
            });
        });
    }

    /// What the board sends within `time`, or as soon as it has sent something.
    pub fn receive(&self, time: Time) -> Result<Vec<u8>, Halt> {
        self.keep(self.with(move |machine| {
            let is_usb = machine.options().usb;
            let has_sent =
                move |chip: &Chip| if is_usb { chip.usb.host().has_read() } else { chip.uart.has_sent() };
            machine.run_while(machine.now() + time, |chip| !has_sent(chip))?;
            // The host's driver hands over what came by USB at once.
            if !is_usb && machine.chip(|chip| has_sent(chip)) {
                machine.run_until(machine.now() + BATCH_TIME)?;
            }
            Ok(take_sent(machine))
        }))
    }
}

/// What the board has sent since this was asked last.
pub fn take_sent(machine: &mut Machine) -> Vec<u8> {
    let is_usb = machine.options().usb;
    let sent =
        machine.chip(|chip| if is_usb { chip.usb.host_mut().take_read() } else { chip.uart.take_sent() });
    sent.into_iter().map(|(_, byte)| byte).collect()
}

/// The host's end of an emulated board's link.
#[derive(Debug)]
pub struct Line {
    board: VirtualBoard,
    /// Sent, and not read yet.
    waiting: VecDeque<u8>,
}

impl Read for Line {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.waiting.is_empty() {
            self.waiting = self.board.receive(READ_TIME).map_err(io::Error::other)?.into();
            if self.waiting.is_empty() && self.board.has_lost_port() {
                return Err(io::Error::new(ErrorKind::BrokenPipe, "the device is gone"));
            }
        }
        match self.waiting.read(buffer)? {
            0 => Err(ErrorKind::TimedOut.into()),
            length => Ok(length),
        }
    }
}

impl Write for Line {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.board.send(Symbol::undamaged(bytes));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Transport for Line {
    fn time(&self) -> Option<Duration> {
        Some(self.board.with(|machine| machine.now()).into())
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        // Nobody waits for it, as whoever drops this may be on the way out of a failure.
        let close = |machine: &mut Machine| machine.chip(|chip| chip.usb.host_mut().close());
        let _ = self.board.jobs.send(Box::new(close));
    }
}
