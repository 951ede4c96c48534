//! Fingers: on an emulated board they touch the skin while it streams, and begin their script anew with every stream,
//! as those of `dermatome simulate` do. So a tare always sees the untouched skin.
//!
//! Whether the board streams is overheard on its line: what its host asks for, and what it answers. The firmware is not
//! touched, and knows nothing of it.

use clap::Args;
use dermatome::{
    material::Material,
    simulate::{Press, Script},
};
use dermatome_hil::world::WorldHandle;
use dermatome_shared::protocol::{BoardPacket, Event, PacketReader, Reply, Request, RequestPacket};
use std::{collections::VecDeque, error::Error, path::PathBuf};

/// Requests without an answer that are remembered.
const MOST_ASKED: usize = 16;

/// Who presses the skin.
#[derive(Args)]
pub(super) struct Pressing {
    /// A finger that rests while the board streams: x,y,radius,depth (m, m, m, relative conductivity change). Can be
    /// repeated.
    #[arg(long = "press", conflicts_with = "path", allow_hyphen_values = true)]
    presses: Vec<Press>,
    /// Moving indenters, from the start of every stream on: CSV with the columns time_s,finger,x_m,y_m, a shape and a
    /// load (docs/cli.md).
    #[arg(long)]
    path: Option<PathBuf>,
    /// Material file of the sheet, for loads in kPa and N (models/materials).
    #[arg(long)]
    material: Option<PathBuf>,
}

impl Pressing {
    /// The fingers; none where nobody presses.
    pub(super) fn fingers(&self, world: Option<WorldHandle>) -> Result<Option<Fingers>, Box<dyn Error>> {
        if self.presses.is_empty() && self.path.is_none() && self.material.is_none() {
            return Ok(None);
        }
        let world = world.ok_or("the rig has no `[world]`, so that there is no skin to press")?;
        let skin = world.setup().skin.clone();
        let outline = skin.shape.from_above()?;
        let script = match &self.path {
            Some(path) => Script::load(path, &outline)?,
            None => Script::still(&self.presses, &outline)?,
        };
        match &self.material {
            Some(path) => world.set_material(Material::load(path)?),
            None if script.needs_material() => {
                return Err("the path presses with pressures or forces, which say nothing without a material: give `--material`".into());
            }
            None => {}
        }
        Ok(Some(Fingers { world, script, line: Overheard::default(), touch: false }))
    }
}

/// Fingers that follow a script while the board streams.
pub(super) struct Fingers {
    world: WorldHandle,
    script: Script,
    line: Overheard,
    touch: bool,
}

impl Fingers {
    /// Bytes on their way to the board.
    pub(super) fn hear_host(&mut self, bytes: &[u8]) {
        self.line.hear_host(bytes);
        self.follow();
    }

    /// Bytes that the board has sent.
    pub(super) fn hear_board(&mut self, bytes: &[u8]) {
        self.line.hear_board(bytes);
        self.follow();
    }

    /// The program at the other end is gone.
    pub(super) fn lose_host(&mut self) {
        self.line.lose_host();
        self.follow();
    }

    fn follow(&mut self) {
        let streams = self.line.streams();
        if std::mem::replace(&mut self.touch, streams) == streams {
            return;
        }
        if streams {
            self.world.run_script(self.script.clone());
        } else {
            self.world.press(&[]);
        }
    }
}

/// What a board's line tells of its state.
#[derive(Default)]
struct Overheard {
    to_board: PacketReader,
    from_board: PacketReader,
    /// Not answered yet.
    asked: VecDeque<RequestPacket>,
    is_streaming: bool,
    has_reference: bool,
    is_taring: bool,
}

impl Overheard {
    /// Whether the board streams what it sees against a reference; without one it makes that first.
    fn streams(&self) -> bool {
        self.is_streaming && self.has_reference && !self.is_taring
    }

    fn hear_host(&mut self, bytes: &[u8]) {
        let packets = bytes.iter().filter_map(|&byte| self.to_board.push::<RequestPacket>(byte));
        self.asked.extend(packets.flatten());
        let too_many = self.asked.len().saturating_sub(MOST_ASKED);
        self.asked.drain(..too_many);
        // A tare sees no finger, however soon it begins.
        self.is_taring |= self.asked.iter().any(|packet| matches!(packet.request, Request::Tare { .. }));
    }

    fn hear_board(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            match self.from_board.push::<BoardPacket>(byte) {
                Some(Ok(BoardPacket::Reply { sequence, reply })) => self.answer(sequence, &reply),
                Some(Ok(BoardPacket::Event { event: Event::Tared { .. }, .. })) => {
                    (self.has_reference, self.is_taring) = (true, false);
                }
                _ => {}
            }
        }
    }

    fn lose_host(&mut self) {
        let Self { has_reference, .. } = *self;
        *self = Self { has_reference, ..Self::default() };
    }

    fn answer(&mut self, sequence: u16, reply: &Reply) {
        let Some(place) = self.asked.iter().position(|packet| packet.sequence == sequence) else { return };
        let Some(RequestPacket { request, .. }) = self.asked.drain(..=place).next_back() else { return };
        match (request, reply) {
            (Request::Tare { .. }, Reply::Refused(_)) => self.is_taring = false,
            (_, Reply::Refused(_)) => {}
            (Request::Stream(selection), _) => self.is_streaming = selection.any(),
            // Each begins the scan anew, and with it the reference.
            (Request::Drive(_) | Request::CommitUpload | Request::Trim(_), _) => self.has_reference = false,
            (_, Reply::Info(info)) => {
                (self.is_streaming, self.has_reference) = (info.streaming.any(), info.tared);
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::protocol::{MAX_PACKET_BYTES, Refusal, Selection, encode};

    /// A board's line as a host and a board use it.
    #[derive(Default)]
    struct Talk {
        line: Overheard,
        sequence: u16,
    }

    impl Talk {
        fn ask(&mut self, request: Request, reply: Reply) -> bool {
            self.send(request);
            self.reply(reply)
        }

        fn send(&mut self, request: Request) -> bool {
            self.sequence += 1;
            let mut buffer = [0; MAX_PACKET_BYTES];
            let packet = RequestPacket { sequence: self.sequence, request };
            self.line.hear_host(encode(&packet, &mut buffer).unwrap());
            self.line.streams()
        }

        fn reply(&mut self, reply: Reply) -> bool {
            self.hear(&BoardPacket::Reply { sequence: self.sequence, reply })
        }

        fn tared(&mut self) -> bool {
            self.hear(&BoardPacket::Event { number: 1, event: Event::Tared { frames: 20 } })
        }

        fn hear(&mut self, packet: &BoardPacket) -> bool {
            let mut buffer = [0; MAX_PACKET_BYTES];
            // In pieces, as a line gives them.
            let bytes = encode(packet, &mut buffer).unwrap();
            bytes.chunks(3).for_each(|piece| self.line.hear_board(piece));
            self.line.streams()
        }
    }

    const CONTACTS: Request = Request::Stream(Selection {
        images: 0,
        contacts: 1,
        measurements: 0,
        health: 0,
        scope: 0,
        scope_slot: 0,
    });
    const STREAMING: Reply = Reply::Streaming { first_sequence: 7 };
    const TARE: Request = Request::Tare { frames: 20 };

    #[test]
    fn fingers_touch_while_the_board_streams_and_has_its_reference() {
        let mut talk = Talk::default();
        assert!(!talk.ask(CONTACTS, STREAMING), "it makes its reference first");
        assert!(talk.tared());
        assert!(!talk.ask(Request::Stream(Selection::default()), STREAMING), "the stream has ended");
        assert!(talk.ask(CONTACTS, STREAMING), "the next one");
        talk.line.lose_host();
        assert!(!talk.line.streams(), "nobody is there");
    }

    #[test]
    fn a_tare_in_a_stream_sees_no_finger() {
        let mut talk = Talk::default();
        talk.tared();
        assert!(talk.ask(CONTACTS, STREAMING));
        assert!(!talk.send(TARE), "before the board has answered");
        assert!(!talk.reply(Reply::Done));
        assert!(talk.tared());
        assert!(!talk.send(TARE));
        assert!(talk.reply(Reply::Refused(Refusal::NoPatch)), "there is no tare");
    }

    #[test]
    fn a_new_drive_or_patch_takes_the_reference_away() {
        for request in [Request::Drive(None), Request::CommitUpload] {
            let mut talk = Talk::default();
            talk.tared();
            assert!(talk.ask(CONTACTS, STREAMING));
            assert!(!talk.ask(request, Reply::Done));
            assert!(talk.tared());
        }
    }

    #[test]
    fn noise_on_the_line_is_passed_over() {
        let mut talk = Talk::default();
        talk.tared();
        talk.line.hear_host(&[1, 2, 3, 0, 0]);
        talk.line.hear_board(&[9, 9, 0]);
        assert!(talk.ask(CONTACTS, STREAMING));
    }
}
