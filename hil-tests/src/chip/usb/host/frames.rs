//! Frames: one packet after the other, as long as they fit.

use super::{
    AGAIN, BULK, BYTE, Control, FRAME, Host, OTHER_BYTES, Packet, Pipe, REFUSAL_BYTES, Refused, port::PACKET,
};
use crate::chip::{
    misuse::Misuse,
    time::Time,
    trace::Event,
    usb::device::{Answer, Device},
};

const PIPES: [Pipe; 3] = [Pipe::Control, Pipe::ToBoard, Pipe::FromBoard];

impl Host {
    /// What is due in a frame.
    pub(super) fn run(&mut self, device: &mut Device, now: Time) -> Result<(), Misuse> {
        if let Some((end, pipe, answer)) = self.packet.take() {
            if now < end {
                self.packet = Some((end, pipe, answer));
                return Ok(());
            }
            self.end_packet(device, pipe, answer, now)?;
        }
        if now >= self.frame_started + FRAME {
            self.start_frame(device, now);
        }
        if self.control.is_none()
            && self.step.is_none()
            && let Some((asker, request)) = self.asked.pop_front()
        {
            self.control = Some((asker, Control::new(request, now)));
        }
        if now >= self.free_at.max(self.quiet_until)
            && let Some(pipe) = self.next_pipe(now)
        {
            self.begin_packet(device, pipe, now);
        }
        Ok(())
    }

    /// When the next packet begins.
    pub(super) fn next_packet(&self) -> Time {
        let is_asked = self.control.is_none() && self.step.is_none() && !self.asked.is_empty();
        let first =
            PIPES.into_iter().filter(|&pipe| self.wants(pipe)).map(|pipe| self.again[pipe as usize]).min();
        let first = if is_asked { Some(Time::ZERO) } else { first };
        first.map_or(Time::NEVER, |first| first.max(self.free_at).max(self.quiet_until))
    }

    fn wants(&self, pipe: Pipe) -> bool {
        match pipe {
            Pipe::Control => self.control.is_some(),
            Pipe::ToBoard => self.is_configured && !self.port.to_board.is_empty(),
            Pipe::FromBoard => self.is_configured && self.port.wants_packet(),
        }
    }

    /// Requests first; both directions in turn.
    fn next_pipe(&self, now: Time) -> Option<Pipe> {
        let mut ready =
            PIPES.into_iter().filter(|&pipe| self.wants(pipe) && self.again[pipe as usize] <= now);
        let first = ready.next()?;
        if Some(first) == self.last && first != Pipe::Control {
            ready.next().or(Some(first))
        } else {
            Some(first)
        }
    }

    fn begin_packet(&mut self, device: &Device, pipe: Pipe, now: Time) {
        let frame_ends = self.frame_started + FRAME;
        if now + BYTE * (OTHER_BYTES + PACKET as u64) > frame_ends {
            self.free_at = frame_ends;
            return;
        }
        (self.last, self.begun) = (Some(pipe), now);
        let (answer, length) = match (pipe, self.control.as_ref().map(|(_, control)| control.packet())) {
            (Pipe::FromBoard, _) => (device.asked(self.address, BULK), 0),
            (Pipe::ToBoard, _) => (Answer::Silence, self.port.packet().len()),
            (Pipe::Control, Some(Packet::In)) => (device.asked(self.address, 0), 0),
            (Pipe::Control, Some(Packet::Out(_, bytes))) => (Answer::Silence, bytes.len()),
            (Pipe::Control, _) => (Answer::Silence, 8),
        };
        let bytes = match &answer {
            Answer::Data(_, bytes) => OTHER_BYTES + bytes.len() as u64,
            Answer::Silence => OTHER_BYTES + length as u64,
            _ => REFUSAL_BYTES,
        };
        self.packet = Some((now + BYTE * bytes, pipe, answer));
    }

    /// A packet has been on the bus as a whole: what the host sent comes to the device, and what it got is its own.
    fn end_packet(
        &mut self,
        device: &mut Device,
        pipe: Pipe,
        begun: Answer,
        now: Time,
    ) -> Result<(), Misuse> {
        self.free_at = now;
        let packet = self.control.as_ref().map(|(_, control)| control.packet());
        let (address, bulk) = (self.address, self.port.packet());
        let answer = match (pipe, packet) {
            (Pipe::ToBoard, _) => device.out(address, BULK, self.port.out_toggle, &bulk)?,
            (Pipe::Control, Some(Packet::Setup(bytes))) => device.setup(address, bytes)?,
            (Pipe::Control, Some(Packet::Out(toggle, bytes))) => device.out(address, 0, toggle, &bytes)?,
            (Pipe::FromBoard, _) | (Pipe::Control, _) => begun,
        };
        if let Answer::Data(..) = answer {
            device.sent(address, if pipe == Pipe::FromBoard { BULK } else { 0 });
        }
        self.again[pipe as usize] = match answer {
            // The device may have changed its mind while it refused.
            Answer::Nak if self.changed >= self.begun => now + AGAIN,
            Answer::Nak => Time::NEVER,
            Answer::Stall if pipe != Pipe::Control => {
                self.problems.push(Refused::Stall);
                Time::NEVER
            }
            Answer::Silence => now + AGAIN,
            _ => Time::ZERO,
        };
        self.refused_at[pipe as usize] = now;
        match (pipe, answer) {
            (Pipe::Control, answer) => {
                let ended = self
                    .control
                    .as_mut()
                    .and_then(|(asker, control)| Some((*asker, control.take(answer, now)?)));
                if let Some((asker, result)) = ended {
                    self.end_request(asker, result, now);
                }
            }
            (Pipe::ToBoard, Answer::Ack) => {
                self.packets_in_frame += 1;
                self.passed.extend(bulk.iter().map(|&byte| (now, Event::Received(byte))));
                self.port.packet_taken();
            }
            (Pipe::FromBoard, Answer::Data(toggle, bytes)) => {
                self.packets_in_frame += 1;
                if self.port.take(toggle, &bytes, now) {
                    self.carried += bytes.len();
                    self.passed.extend(bytes.iter().map(|&byte| (now, Event::Sent(byte))));
                }
            }
            _ => {}
        }
        Ok(())
    }
}
