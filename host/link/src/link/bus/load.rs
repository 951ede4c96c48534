//! Load: how much of a bus boards take, and what of their streams fits.

use super::super::transport::BAUD;
use crate::error::Overload;
use dermatome_shared::{
    contact::{Contact, Evidence, track},
    drive::Drive,
    frame::FrameFlags,
    health::{ElectrodeSet, Health, Vitals},
    limits::MAX_PIXELS,
    protocol::{
        BoardPacket, Event, FrameStamp, MAX_PACKET_BYTES, MAX_SCOPE_SAMPLES, PackedImage, PatchInfo,
        Selection,
        bus::{ADDRESSES, TURN_BYTES},
        can::{DATA_RATE, FRAME_BYTES, NOMINAL_RATE},
        encode,
    },
};
use std::{
    ops::{Add, Mul},
    time::Duration,
};

/// Contacts of a frame for which there is room; where there are more, long events wait, and then come late or not at all.
const CONTACTS: usize = 3;
/// Share of the bus that is given away.
const ROOM: f64 = 0.8;
/// Turns that a board gets at least, per second.
const LEAST_TURNS: f64 = 20.0;
/// Bytes on the line for a turn and its end.
const TURN_AND_END: f64 = 6.0;
/// Seconds of a line that a byte takes: ten bits.
pub(super) const BYTE: f64 = 10.0 / BAUD as f64;
/// Bytes on it before a packet: a zero byte, the mark and its complement.
const HEAD: f64 = 3.0;
/// Bits of a CAN FD frame before the bit rate switches and after it has switched back, the pause behind it included; 4 more
/// at most that stuff the first 17 (ISO 11898-1).
const NOMINAL_BITS: f64 = (17 + 4 + 13) as f64;
/// Bits between the two: error state, length and data, stuffed with one in four at most; the count of stuff bits, the
/// checksum and its own stuff bits.
const DATA_BITS: f64 = (1 + 4 + 8 * FRAME_BYTES) as f64 * 1.25 + (4 + 21 + 7) as f64;
/// Longest that a frame with 64 bytes takes, s.
const FRAME: f64 = NOMINAL_BITS / NOMINAL_RATE as f64 + DATA_BITS / DATA_RATE as f64;
/// Postcard's longest code of a step, and index in a scope; bytes.
const CODE_BYTES: usize = 4;
const SAMPLE_BYTES: usize = 2;
/// How long a board takes to answer before one has, s.
const USUAL_ANSWER: f64 = 1e-3;
/// What one answer counts at most, s: the host may have had something else to do.
const LONGEST_ANSWER: f64 = 20e-3;

/// What the stream of one board can take of a bus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::link) struct Demand {
    frame_rate: f64,
    pixels: usize,
    steps: usize,
    electrodes: usize,
}

/// What a board says in a second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Flow {
    packets: f64,
    /// Of packets.
    bytes: f64,
    /// Of [`FRAME_BYTES`] at most, none with bytes of two packets.
    frames: f64,
}

impl Flow {
    /// Packets with so many bytes, so often in a second.
    fn of(rate: f64, bytes: usize) -> Self {
        Self { packets: 1.0, bytes: bytes as f64, frames: bytes.div_ceil(FRAME_BYTES) as f64 } * rate
    }
}

impl Add for Flow {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            packets: self.packets + other.packets,
            bytes: self.bytes + other.bytes,
            frames: self.frames + other.frames,
        }
    }
}

impl Mul<f64> for Flow {
    type Output = Self;

    fn mul(self, by: f64) -> Self {
        Self { packets: self.packets * by, bytes: self.bytes * by, frames: self.frames * by }
    }
}

impl Demand {
    /// Of a board with this patch, whose skin is driven like this.
    pub(in crate::link) fn of(patch: &PatchInfo, drive: &Drive) -> Self {
        Self {
            frame_rate: f64::from(drive.frame_rate),
            pixels: patch.pixels.into(),
            steps: patch.steps.into(),
            electrodes: patch.electrodes.into(),
        }
    }

    /// What is short: contacts and health.
    fn short(&self, selection: &Selection) -> Flow {
        self.flow(selection.contacts, || packet_bytes(&contacts()))
            + self.flow(selection.health, || packet_bytes(&health(self.electrodes)))
    }

    /// What is long: images, raw frames and the scope.
    fn long(&self, selection: &Selection) -> Flow {
        // The lists of the other two are added to what is around them.
        let around = |event| packet_bytes(&event);
        let codes = || Event::Measurements {
            at: stamp(),
            codes: heapless::Vec::new(),
            quadrature: heapless::Vec::new(),
        };
        self.flow(selection.images, || around(image(self.pixels)))
            + self.flow(selection.measurements, || around(codes()) + 2 * CODE_BYTES * self.steps)
            + self.flow(selection.scope, || {
                around(Event::Scope(Default::default())) + SAMPLE_BYTES * MAX_SCOPE_SAMPLES
            })
    }

    fn flow(&self, every: u16, bytes: impl FnOnce() -> usize) -> Flow {
        if every > 0 { Flow::of(self.frame_rate / f64::from(every), bytes()) } else { Flow::default() }
    }
}

/// What packets go over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Medium {
    /// A line whose boards are given turns.
    Rs485,
    /// A CAN FD bus.
    Can,
}

/// Who has been given how much of a bus.
#[derive(Clone, Debug)]
pub(super) struct Shares {
    medium: Medium,
    /// Boards that the bus is for.
    pub(super) boards: usize,
    given: [Option<Given>; ADDRESSES as usize],
    /// How long boards take to answer, s: the mean of late.
    answer: f64,
}

/// What one board says.
#[derive(Clone, Copy, Debug)]
struct Given {
    short: Flow,
    long: Flow,
}

impl Shares {
    /// Of a bus of this kind, all of it.
    pub(super) fn new(medium: Medium) -> Self {
        Self { medium, boards: 0, given: [None; ADDRESSES as usize], answer: USUAL_ANSWER }
    }

    /// A board has answered so long after it was given the line.
    pub(super) fn answered(&mut self, after: Duration) {
        self.answer += (after.as_secs_f64().min(LONGEST_ANSWER) - self.answer) / 128.0;
    }

    pub(super) fn leave(&mut self, address: u8) {
        self.given[usize::from(address)] = None;
    }

    /// What of a selection fits. What is short comes first, of boards that have not asked yet as well, which are taken to be
    /// alike; what is long shares the rest, and is left out of frames until it fits, but not for longer than a second.
    pub(super) fn fit(
        &mut self,
        address: u8,
        open: usize,
        selection: Selection,
        demand: &Demand,
    ) -> Result<Selection, Overload> {
        let (short, all) = (demand.short(&selection), demand.long(&selection));
        let others = (0..).zip(&self.given).filter(|(it, _)| *it != address).filter_map(|(_, given)| *given);
        let known = others.clone().count() + 1;
        let boards = self.boards.max(open).max(known);
        let taken: f64 = others.clone().map(|it| self.load(it.short + it.long)).sum();
        let fixed: f64 = others.map(|it| self.load(it.short)).sum::<f64>() + self.load(short);
        if fixed > ROOM {
            return Err(Overload { boards: known, load: fixed, allowed: ROOM });
        }
        let to_come = (boards - known) as f64 * self.load(short);
        let fair = (ROOM - fixed - to_come) / boards as f64;
        let left = ROOM - taken - self.load(short) - to_come;
        let load_of = |every: u16| self.load(short + all * f64::from(every).recip()) - self.load(short);
        let longest = demand.frame_rate.clamp(1.0, 1000.0) as u16;
        let every = (1..=longest).find(|&every| load_of(every) <= left.min(fair));
        // Who compares or looks for something does with little, and not with nothing.
        let every = every.or((selection.images == 0 && load_of(longest) <= left).then_some(longest));
        let of_each = |asked: u16| every.map_or(0, |every| asked.saturating_mul(every));
        let fitting = Selection {
            images: of_each(selection.images),
            measurements: of_each(selection.measurements),
            scope: of_each(selection.scope),
            ..selection
        };
        if selection.any() && !fitting.any() {
            return Err(Overload {
                boards: known,
                load: taken + self.load(short) + load_of(longest),
                allowed: ROOM,
            });
        }
        self.given[usize::from(address)] = Some(Given { short, long: demand.long(&fitting) });
        Ok(fitting)
    }

    /// Share of the bus' time that a board takes which says so much.
    fn load(&self, said: Flow) -> f64 {
        match self.medium {
            Medium::Rs485 => {
                let bytes = said.bytes + HEAD * said.packets;
                let turns = LEAST_TURNS.max(bytes / TURN_BYTES as f64);
                BYTE * (bytes + TURN_AND_END * turns) + self.answer * turns
            }
            Medium::Can => FRAME * said.frames,
        }
    }
}

/// Bytes of an event's packet.
fn packet_bytes(event: &Event) -> usize {
    let packet = BoardPacket::Event { number: u32::MAX, event: event.clone() };
    // What is too long for a packet is not sent.
    encode(&packet, &mut [0; MAX_PACKET_BYTES]).map_or(MAX_PACKET_BYTES, <[u8]>::len)
}

/// The latest frame that there can be: numbers take the more bytes the larger they are.
fn stamp() -> FrameStamp {
    FrameStamp { sequence: u32::MAX, timestamp_us: u64::MAX, flags: FrameFlags(u16::MAX) }
}

fn contacts() -> Event {
    let evidence = Evidence { significance: 1.0, position_deviation: 1.0, strength_deviation: 1.0 };
    let identity = track::Identity {
        number: u32::MAX,
        velocity: [1.0; 3],
        merged: Some(u32::MAX),
        split_from: Some(u32::MAX),
    };
    let contact = Contact {
        position: [1.0; 3],
        normal: [1.0; 3],
        area: 1.0,
        strength: 1.0,
        peak: 1.0,
        pressure: Some(1.0),
        load_area: Some(1.0),
        evidence: Some(evidence),
        identity: Some(identity),
    };
    Event::Contacts { at: stamp(), contacts: (0..CONTACTS).map(|_| contact).collect() }
}

fn health(electrodes: usize) -> Event {
    let all = ElectrodeSet(u16::MAX);
    let health = Health {
        contact_impedance: (0..electrodes).map(|_| 1.0).collect(),
        open: all,
        shorted: all,
        worse: all,
        reciprocity_error: Some(1.0),
    };
    let vitals = Vitals { temperature: Some(1.0), load: 1.0, free_stack: u32::MAX };
    Event::Health { at: stamp(), health, vitals, drift: 1.0, missed: u32::MAX }
}

fn image(pixels: usize) -> Event {
    let mantissas = (0..pixels.min(MAX_PIXELS)).map(|_| i16::MAX).collect();
    Event::Image { at: stamp(), image: PackedImage { exponent: 20, mantissas } }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEMAND: Demand = Demand { frame_rate: 100.0, pixels: 812, steps: 208, electrodes: 16 };
    const BOTH: Selection =
        Selection { images: 1, contacts: 1, measurements: 0, health: 0, scope: 0, scope_slot: 0 };

    fn line(boards: usize) -> Shares {
        Shares { boards, ..Shares::new(Medium::Rs485) }
    }

    #[test]
    fn a_board_alone_has_more_images_than_each_of_four_and_contacts_of_every_frame() {
        let alone = line(1).fit(0, 0, BOTH, &DEMAND).unwrap();
        let mut shared = line(4);
        let four: Vec<_> = (0..4).map(|address| shared.fit(address, 0, BOTH, &DEMAND).unwrap()).collect();
        assert!(four.iter().all(|it| *it == Selection { images: four[0].images, ..BOTH }), "{four:?}");
        assert!((2..5).contains(&alone.images) && four[0].images > 4 * alone.images, "{alone:?}, {four:?}");
    }

    #[test]
    fn boards_that_are_alike_and_known_never_have_more_than_the_line_in_whatever_order_they_ask_and_leave() {
        for (boards, medium) in
            (1..=16_u8).flat_map(|boards| [(boards, Medium::Rs485), (boards, Medium::Can)])
        {
            let mut shares = Shares { boards: boards.into(), ..Shares::new(medium) };
            let demand = Demand { frame_rate: 40.0, ..DEMAND };
            let mut refused = 0;
            for turn in 0..200_usize {
                let address = ((turn * 7 + turn / 16) % usize::from(boards)) as u8;
                match turn % 5 {
                    0 if turn < 150 => shares.leave(address),
                    _ => refused += usize::from(shares.fit(address, 0, BOTH, &demand).is_err()),
                }
                let given = shares.given.iter().flatten();
                let total: f64 = given.map(|it| shares.load(it.short + it.long)).sum();
                assert!(total <= ROOM + 1e-9, "{total} of {boards} after {turn}");
            }
            let all = f64::from(boards) * shares.load(demand.short(&BOTH));
            assert_eq!(refused > 0, all > ROOM, "{boards}: {refused}");
        }
    }

    #[test]
    fn contacts_of_boards_that_nobody_spoke_of_still_fit_or_are_refused() {
        let (mut shares, slow) = (line(0), Demand { frame_rate: 20.0, ..DEMAND });
        for address in 0..ADDRESSES {
            let demand = if address % 3 == 0 { slow } else { DEMAND };
            let _ = shares.fit(address, 0, BOTH, &demand);
            let fixed: f64 = shares.given.iter().flatten().map(|it| shares.load(it.short)).sum();
            assert!(fixed <= ROOM, "{fixed} after {address}");
        }
        assert!(shares.given.iter().flatten().count() < 16);
    }

    #[test]
    fn contacts_that_do_not_fit_are_refused_with_the_load() {
        let fast = Demand { frame_rate: 400.0, ..DEMAND };
        let mut shares = line(2);
        assert!(shares.fit(0, 0, BOTH, &fast).is_ok());
        let error = shares.fit(1, 0, BOTH, &fast).unwrap_err();
        assert!(error.load > ROOM && error.boards == 2, "{error}");
        assert!(error.to_string().contains("allowed are 80 %"), "{error}");
        // Where nobody answers faster than in 20 ms, a line is for few.
        let mut slow = line(1);
        (0..1000).for_each(|_| slow.answered(Duration::from_millis(20)));
        assert!(slow.fit(0, 0, BOTH, &fast).is_err());
    }

    #[test]
    fn raw_frames_and_the_scope_are_thinned_out_like_images_and_refused_where_not_one_a_second_fits() {
        let all = Selection { measurements: 1, scope: 2, scope_slot: 5, ..BOTH };
        let given = line(2).fit(0, 0, all, &DEMAND).unwrap();
        let every = given.images;
        assert_eq!(given, Selection { images: every, measurements: every, scope: 2 * every, ..all });
        assert!(every > line(2).fit(0, 0, BOTH, &DEMAND).unwrap().images, "{given:?}");
        let raw = Selection { measurements: 1, ..Selection::default() };
        let beside = |frame_rate: f64| {
            let mut full = line(4);
            for address in 0..3 {
                full.fit(address, 0, BOTH, &Demand { frame_rate, ..DEMAND }).unwrap();
            }
            full.fit(3, 0, raw, &DEMAND)
        };
        assert_eq!(beside(140.0), Ok(Selection { measurements: 100, ..raw }), "once a second");
        let error = beside(146.0).unwrap_err();
        assert!(error.load > ROOM && error.boards == 4, "{error}");
    }

    #[test]
    fn nothing_is_given_that_was_not_asked_for() {
        let quiet = Selection { images: 0, ..BOTH };
        assert_eq!(line(1).fit(3, 0, quiet, &DEMAND), Ok(quiet));
        let seldom = Selection { images: 50, ..BOTH };
        assert_eq!(line(1).fit(3, 0, seldom, &DEMAND), Ok(seldom));
    }

    /// Of 64 bytes, all bits alike: a stuff bit after the first five, and after four more each.
    #[test]
    fn a_frame_on_a_can_bus_takes_as_long_as_its_bits() {
        let seconds = FRAME;
        assert!((372e-6..374e-6).contains(&seconds), "{seconds}");
        let alone = Shares::new(Medium::Can).load(Flow::of(100.0, 65));
        assert!((alone - 200.0 * FRAME).abs() < 1e-12, "two frames a packet: {alone}");
    }

    /// The tables of docs/bus.md.
    #[test]
    fn the_tables_in_the_documentation_are_true() {
        let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/bus.md");
        let page = std::fs::read_to_string(page).unwrap();
        let on_line = [(1, 100.0), (2, 100.0), (4, 100.0), (5, 100.0), (4, 50.0), (8, 50.0), (9, 50.0)];
        let on_can = [(1, 100.0), (2, 100.0), (3, 100.0), (4, 100.0), (5, 100.0), (8, 50.0), (9, 50.0)];
        for (medium, cases) in [(Medium::Rs485, on_line), (Medium::Can, on_can)] {
            let mut rows = String::new();
            for (boards, frame_rate) in cases {
                let mut shares = Shares { boards, ..Shares::new(medium) };
                let demand = Demand { frame_rate, ..DEMAND };
                let given: Result<Vec<_>, _> =
                    (0..boards as u8).map(|at| shares.fit(at, 0, BOTH, &demand)).collect();
                let images = match given {
                    Err(error) => format!("refused: {:.0} %", 100.0 * error.load),
                    Ok(given) if given[0].images == 0 => "none".to_owned(),
                    Ok(given) => format!("1 in {}", given[0].images),
                };
                rows += &format!("| {boards} | {frame_rate} | {images} |\n");
            }
            assert!(page.contains(&rows), "{medium:?}\n{rows}");
        }
    }
}
