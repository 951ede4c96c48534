//! Host: the computer at the other end of the cable. It sees the device by its pull-up, resets and enumerates it, and makes
//! a serial port of it; a frame of 1 ms has as many packets as its bits allow (USB 2.0, table 5-9).
//!
//! It asks again for what the device has not got yet every 10 us, after what it has to do for others.

mod control;
mod enumeration;
mod frames;
mod port;

pub use control::{Refused, Request};
pub use enumeration::Described;

use super::device::{Answer, Device, FRAME, Wires};
use crate::chip::{misuse::Misuse, time::Time, trace::Event};
use control::{Control, Packet};
use enumeration::{ADDRESS, Step};
use port::Port;
use std::collections::VecDeque;

/// From the pull-up to the first reset: contacts have ceased to bounce (USB 2.0, 7.1.7.3).
const DEBOUNCE: Time = Time::from_millis(100);
/// A reset, and the time that the device has afterwards.
const RESET: Time = Time::from_millis(50);
const RECOVERY: Time = Time::from_millis(10);
/// The device has this time to take its address.
const ADDRESSING: Time = Time::from_millis(2);
/// How long the host wakes a device.
const RESUME: Time = Time::from_millis(20);
/// The device is looked for anew so often if it cannot be enumerated.
const ATTEMPTS: u32 = 3;
/// A byte on the bus, and bytes of what a start of a frame and a packet take besides their data, with pauses.
const BYTE: Time = Time::from_nanos(667);
const START_BYTES: u64 = 6;
const OTHER_BYTES: u64 = 13;
/// A packet that is asked for and not there.
const REFUSAL_BYTES: u64 = 9;
/// Until it is asked for again.
const AGAIN: Time = Time::from_micros(10);

/// Endpoint of both bulk directions: our firmware's.
const BULK: u8 = 2;
const BULK_IN: u8 = 0x80 | BULK;

/// What the bus is in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    /// No device is seen.
    #[default]
    Apart,
    /// Until the first reset.
    Debounce(Time),
    /// Until the end of a reset.
    Reset(Time),
    /// Frames follow each other.
    Running,
    Asleep,
    /// Until frames start again.
    Waking(Time),
}

/// Whose packet it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pipe {
    Control,
    ToBoard,
    FromBoard,
}

/// Who asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum For {
    Enumeration,
    Driver,
    Case,
}

/// The host.
#[derive(Clone, Debug, Default)]
pub struct Host {
    is_plugged: bool,
    sees_device: bool,
    phase: Phase,
    /// When it looks at the cable, once.
    looks_at: Option<Time>,
    begins_to_wake: bool,
    now: Time,
    frame_started: Time,
    frame: u32,
    /// When the bus is free for the next packet, and the device has had the time that it may take.
    free_at: Time,
    quiet_until: Time,
    /// The packet on the bus, what was answered to its beginning, and when it ends.
    packet: Option<(Time, Pipe, Answer)>,
    /// When that began, and when the device's registers changed last.
    begun: Time,
    changed: Time,
    /// When each pipe asks again; never while the device has not changed its mind.
    again: [Time; 3],
    refused_at: [Time; 3],
    last: Option<Pipe>,
    address: u8,
    step: Option<Step>,
    attempts: u32,
    described: Described,
    /// The request that is carried out, and for whom; those that wait.
    control: Option<(For, Control)>,
    asked: VecDeque<(For, Request)>,
    answers: Vec<Result<Vec<u8>, Refused>>,
    problems: Vec<Refused>,
    port: Port,
    is_configured: bool,
    enumerations: usize,
    packets_in_frame: usize,
    most_packets: usize,
    carried: usize,
    passed: Vec<(Time, Event)>,
}

impl Host {
    /// The cable goes in.
    pub fn plug(&mut self, now: Time) {
        (self.is_plugged, self.looks_at) = (true, Some(now));
    }

    /// The cable comes out, in the middle of whatever goes on.
    pub fn unplug(&mut self, now: Time) {
        (self.is_plugged, self.looks_at) = (false, Some(now));
    }

    /// The host resets the port and enumerates the device again, as a program may ask it to.
    pub fn reset_bus(&mut self, now: Time) {
        if self.sees_device {
            self.lose_device();
            self.reset_for(Step::Address, now);
        }
    }

    /// The host goes to sleep: no more frames.
    pub fn suspend(&mut self) {
        if self.phase == Phase::Running {
            self.phase = Phase::Asleep;
            self.packet = None;
        }
    }

    /// And wakes up.
    pub fn resume(&mut self, now: Time) {
        if self.phase == Phase::Asleep {
            self.phase = Phase::Waking(now + RESUME);
            (self.looks_at, self.begins_to_wake) = (Some(now), true);
        }
    }

    /// Whether the device is configured, and so there is a serial port.
    #[must_use]
    pub fn has_port(&self) -> bool {
        self.is_configured
    }

    /// How often a device was enumerated.
    #[must_use]
    pub fn enumerations(&self) -> usize {
        self.enumerations
    }

    /// What the device has said of itself.
    #[must_use]
    pub fn described(&self) -> &Described {
        &self.described
    }

    /// What went wrong as it was enumerated.
    #[must_use]
    pub fn problems(&self) -> &[Refused] {
        &self.problems
    }

    /// A program opens the port; says whether there is one.
    pub fn open(&mut self) -> bool {
        if self.is_configured && !self.port.is_open {
            let requests = self.port.open();
            self.asked.extend(requests.map(|request| (For::Driver, request)));
        }
        self.is_configured
    }

    /// A program opens it that does not set DTR, as some do.
    pub fn open_quietly(&mut self) {
        self.port.open();
    }

    /// The program closes it.
    pub fn close(&mut self) {
        if self.port.is_open {
            let request = self.port.close();
            self.asked.push_back((For::Driver, request));
        }
    }

    /// Whether a program has it open.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.port.is_open
    }

    /// Whether the program reads: it may stop, and go on.
    pub fn set_reading(&mut self, reads: bool) {
        self.port.reads = reads;
    }

    /// The program sends bytes; without an open port they are lost.
    pub fn write(&mut self, bytes: &[u8]) {
        if self.port.is_open {
            self.port.to_board.extend(bytes);
        }
    }

    /// What the program has got since it was asked last.
    pub fn take_read(&mut self) -> Vec<(Time, u8)> {
        self.port.take_came()
    }

    /// Whether it has got anything.
    #[must_use]
    pub fn has_read(&self) -> bool {
        self.port.has_come()
    }

    /// Packets that were dropped, as their toggle said that they had come before.
    #[must_use]
    pub fn repeated(&self) -> usize {
        self.port.repeated
    }

    /// Most bulk packets in a frame since this was asked last.
    pub fn take_most_packets(&mut self) -> usize {
        std::mem::take(&mut self.most_packets)
    }

    /// Bytes that the board has sent since this was asked last.
    pub fn take_carried(&mut self) -> usize {
        std::mem::take(&mut self.carried)
    }

    /// Asks something of the device.
    pub fn ask(&mut self, request: Request) {
        self.asked.push_back((For::Case, request));
    }

    /// What came of it, since this was asked last.
    pub fn take_answers(&mut self) -> Vec<Result<Vec<u8>, Refused>> {
        std::mem::take(&mut self.answers)
    }

    pub(super) fn take_passed(&mut self) -> Vec<(Time, Event)> {
        std::mem::take(&mut self.passed)
    }

    /// The device's registers have changed.
    pub(super) fn look(&mut self, device: &Device, now: Time) {
        self.now = self.now.max(now);
        self.changed = now;
        self.look_again(device);
        for (again, refused_at) in self.again.iter_mut().zip(self.refused_at) {
            if *again == Time::NEVER {
                *again = refused_at + AGAIN * (1 + now.since(refused_at).periods(AGAIN));
            }
        }
    }

    /// The device may have come or gone.
    pub(super) fn look_again(&mut self, device: &Device) {
        if self.sees_device != (self.is_plugged && device.pulls_up()) {
            self.looks_at = Some(self.now);
        }
    }

    pub(super) fn next_event(&self) -> Time {
        let looks_at = self.looks_at.unwrap_or(Time::NEVER);
        let next = match self.phase {
            Phase::Apart | Phase::Asleep => Time::NEVER,
            Phase::Debounce(at) | Phase::Reset(at) | Phase::Waking(at) => at,
            Phase::Running => {
                let packet = self.packet.as_ref().map_or_else(|| self.next_packet(), |&(end, ..)| end);
                packet.min(self.frame_started + FRAME)
            }
        };
        looks_at.min(next)
    }

    pub(super) fn advance(&mut self, device: &mut Device, now: Time) -> Result<(), Misuse> {
        self.now = self.now.max(now);
        if self.looks_at.is_some_and(|at| at <= now) {
            self.looks_at = None;
            self.see(device, now);
        }
        match self.phase {
            Phase::Debounce(at) if at <= now => {
                device.check_clocks()?;
                device.see(Wires::Low, now);
                self.phase = Phase::Reset(now + RESET);
            }
            Phase::Reset(at) if at <= now => {
                self.begin_frames(device, now);
                self.enter(now);
            }
            Phase::Waking(at) if at <= now => self.begin_frames(device, now),
            Phase::Running => self.run(device, now)?,
            _ => {}
        }
        Ok(())
    }

    /// Looks whether a device is there.
    fn see(&mut self, device: &mut Device, now: Time) {
        if std::mem::take(&mut self.begins_to_wake) && matches!(self.phase, Phase::Waking(_)) {
            device.see(Wires::K, now);
        }
        let sees_device = self.is_plugged && device.pulls_up();
        if std::mem::replace(&mut self.sees_device, sees_device) == sees_device {
            return;
        }
        self.lose_device();
        if sees_device {
            self.attempts = 0;
            self.reset_for(Step::Look, now + DEBOUNCE);
        } else {
            if matches!(self.phase, Phase::Reset(_) | Phase::Waking(_)) {
                // Its own pull-up is all that is left.
                device.see(Wires::J, now);
            }
            self.phase = Phase::Apart;
        }
    }

    /// The serial port is gone, and with it what was under way.
    fn lose_device(&mut self) {
        (self.packet, self.control, self.step) = (None, None, None);
        (self.is_configured, self.address) = (false, 0);
        self.again = [Time::ZERO; 3];
        self.asked.clear();
        self.port.begin();
    }

    fn reset_for(&mut self, step: Step, at: Time) {
        (self.step, self.phase) = (Some(step), Phase::Debounce(at));
    }

    fn begin_frames(&mut self, device: &mut Device, now: Time) {
        device.see(Wires::J, now);
        self.phase = Phase::Running;
        self.quiet_until = now + RECOVERY;
        self.start_frame(device, now);
    }

    fn start_frame(&mut self, device: &mut Device, now: Time) {
        self.frame = (self.frame + 1) % 2048;
        (self.frame_started, self.free_at) = (now, now + BYTE * START_BYTES);
        self.most_packets = self.most_packets.max(std::mem::take(&mut self.packets_in_frame));
        device.start_of_frame(self.frame, now);
    }

    /// Begins what the enumeration does next.
    fn enter(&mut self, now: Time) {
        match self.step {
            Some(Step::Done) => {
                self.step = None;
                self.is_configured = true;
                self.enumerations += 1;
            }
            Some(Step::Reset) => {
                self.address = 0;
                self.reset_for(Step::Address, now);
            }
            Some(step) => {
                let request = step.request(&self.described);
                self.control = request.map(|request| (For::Enumeration, Control::new(request, now)));
            }
            None => {}
        }
    }

    /// Where a request has both ends begin with DATA0 again, the host does.
    fn begin_toggles(&mut self, setup: [u8; 8]) {
        match setup {
            [0x00, 9, ..] => (self.port.out_toggle, self.port.in_toggle) = (false, false),
            [0x02, 1, _, _, BULK, ..] => self.port.out_toggle = false,
            [0x02, 1, _, _, BULK_IN, ..] => self.port.in_toggle = false,
            _ => {}
        }
    }

    /// A request has come to its end.
    fn end_request(&mut self, asker: For, result: Result<Vec<u8>, Refused>, now: Time) {
        let Some((_, Control { request, .. })) = self.control.take() else { return };
        match (asker, self.step) {
            (For::Case, _) => {
                if result.is_ok() {
                    self.begin_toggles(request.setup);
                }
                self.answers.push(result);
            }
            (For::Driver, _) => self.problems.extend(result.err()),
            (For::Enumeration, Some(step)) => {
                match result.and_then(|brought| step.take(brought, &mut self.described)) {
                    Ok(next) => {
                        if step == Step::Address {
                            (self.address, self.quiet_until) = (ADDRESS, now + ADDRESSING);
                        }
                        self.step = Some(next);
                        self.enter(now);
                    }
                    Err(problem) => {
                        self.problems.push(problem);
                        self.attempts += 1;
                        self.lose_device();
                        if self.attempts < ATTEMPTS {
                            self.reset_for(Step::Look, now);
                        }
                    }
                }
            }
            (For::Enumeration, None) => {}
        }
    }
}

#[cfg(test)]
mod tests;
