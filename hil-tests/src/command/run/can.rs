//! Boards on one CAN bus: a program at the other end of the TCP connection has the bus' adapter, which speaks slcan.

use super::{super::fingers::Fingers, program::Served};
use dermatome_hil::{
    bus::can::{
        CanBus, SLICE,
        slcan::{Slcan, shown},
    },
    chip::time::Time,
    machine::Halt,
};
use dermatome_shared::protocol::can::Carries;
/// Slices of the bus between two polls of the connection.
const SLICES: u64 = 10;

/// Boards on a bus, and what goes on beside it.
pub(super) struct Boards {
    bus: CanBus,
    /// Of each board, where somebody presses.
    fingers: Vec<Fingers>,
    slcan: Slcan,
}

impl Boards {
    /// Whose adapter is off until a program switches it on.
    pub(super) fn new(bus: CanBus, fingers: Vec<Fingers>) -> Self {
        bus.with(|wire| wire.host.is_on = false);
        Self { bus, fingers, slcan: Slcan::default() }
    }
}

impl Served for Boards {
    fn now(&self) -> Time {
        self.bus.with(|wire| wire.now())
    }

    /// An adapter that is unplugged acknowledges nothing.
    fn lose_host(&mut self) {
        self.slcan = Slcan::default();
        self.fingers.iter_mut().for_each(Fingers::lose_host);
        self.bus.with(|wire| {
            wire.host.is_on = false;
            wire.host.forget();
        });
    }

    /// A program's lines go to the adapter, and the adapter's to the program.
    fn pass(&mut self, asked: Vec<u8>) -> Result<(Time, Vec<u8>), Halt> {
        let mut slcan = std::mem::take(&mut self.slcan);
        let (slcan, now, mut told, sent, heard) = self.bus.with(move |wire| {
            let now = wire.now();
            let told = slcan.take(&asked, &mut wire.host, now);
            wire.run_until(now + SLICE * SLICES)?;
            let (sent, heard) = (wire.host.take_sent(), wire.host.take_heard());
            Ok::<_, Halt>((slcan, wire.now(), told, sent, heard))
        })?;
        self.slcan = slcan;
        // Fingers hear what their own boards are asked and say.
        for frame in sent.iter().chain(heard.iter().map(|(_, frame)| frame)) {
            let Some((carries, address)) = Carries::of(frame.identifier) else { continue };
            let Some(fingers) = self.fingers.get_mut(usize::from(address)) else { continue };
            match carries {
                Carries::Request => fingers.hear_host(&frame.data),
                Carries::Said => fingers.hear_board(&frame.data),
            }
        }
        told.extend(heard.iter().flat_map(|(_, frame)| shown(frame)));
        Ok((now, told))
    }
}
