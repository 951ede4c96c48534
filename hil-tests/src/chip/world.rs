//! World: what is outside the chip, and what the chip tells it.
//!
//! The chip tells each change of a DAC, of a pin and of an amplifier once, in order of time, and asks
//! for a voltage at the instant at which a converter ends its sampling.

use super::time::Time;
use std::fmt::Debug;

/// What is outside the chip.
pub trait World: Debug + Send {
    /// A channel (0 or 1) of a DAC (1 to 4) puts out this code from now on; none: it is off.
    fn dac(&mut self, dac: usize, channel: usize, code: Option<u16>, at: Time);
    /// The pins of a port that the chip drives have these levels from now on, alternate functions
    /// included.
    fn pins(&mut self, port: char, levels: u16, at: Time);
    /// An operational amplifier (1 to 6) works like this from now on.
    fn opamp(&mut self, number: usize, setting: OpampSetting, at: Time);
    /// Volts at a channel of a converter (1 to 5) at an instant.
    fn voltage(&mut self, adc: usize, channel: usize, at: Time) -> f64;
    /// The board's power has failed, and comes back.
    fn lose_power(&mut self, _at: Time) {}
    /// Another that goes on from here in the same way, if this kind of world can be copied.
    fn copy(&self) -> Option<Box<dyn World>> {
        None
    }
}

/// What an operational amplifier does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum OpampSetting {
    /// Nothing.
    #[default]
    Off,
    /// Amplifies.
    Amplifier {
        /// Which input is on its positive side (CSR.VP_SEL).
        input: usize,
        /// Its gain; 1.0 is a follower. Higher ones are around the voltage at its pin VINM0.
        gain: f64,
    },
}

/// The world, and what it was told last.
#[derive(Debug, Default)]
pub(super) struct Outside {
    world: Option<Box<dyn World>>,
    dacs: [[Option<u16>; 2]; 4],
    pins: [u16; 7],
    opamps: [OpampSetting; 6],
}

impl Clone for Outside {
    /// The world as well, if it can be copied.
    fn clone(&self) -> Self {
        let world = self.world.as_ref().and_then(|world| world.copy());
        Self { world, ..*self }
    }
}

impl Outside {
    /// A world takes the place of the one before, and is told how everything is.
    pub(super) fn connect(&mut self, mut world: Box<dyn World>, at: Time) {
        for (place, channels) in self.dacs.iter().enumerate() {
            for (channel, &code) in channels.iter().enumerate() {
                world.dac(place + 1, channel, code, at);
            }
        }
        for (port, &levels) in ('A'..).zip(&self.pins) {
            world.pins(port, levels, at);
        }
        for (place, &setting) in self.opamps.iter().enumerate() {
            world.opamp(place + 1, setting, at);
        }
        self.world = Some(world);
    }

    /// The world, to be asked.
    pub(super) fn world(&mut self) -> Option<&mut dyn World> {
        match &mut self.world {
            Some(world) => Some(world.as_mut()),
            None => None,
        }
    }

    /// Tells a DAC's channel (both from 0 on) if it is not as it was told last.
    pub(super) fn show_dac(&mut self, dac: usize, channel: usize, code: Option<u16>, at: Time) {
        if std::mem::replace(&mut self.dacs[dac][channel], code) != code
            && let Some(world) = &mut self.world
        {
            world.dac(dac + 1, channel, code, at);
        }
    }

    /// Tells a port (from 0 on) if it is not as it was told last, and says so.
    pub(super) fn show_pins(&mut self, port: usize, levels: u16, at: Time) -> bool {
        let changes = std::mem::replace(&mut self.pins[port], levels) != levels;
        if changes && let Some(world) = &mut self.world {
            world.pins((b'A' + port as u8).into(), levels, at);
        }
        changes
    }

    /// Tells an amplifier (from 0 on) if it is not as it was told last.
    pub(super) fn show_opamp(&mut self, opamp: usize, setting: OpampSetting, at: Time) {
        if std::mem::replace(&mut self.opamps[opamp], setting) != setting
            && let Some(world) = &mut self.world
        {
            world.opamp(opamp + 1, setting, at);
        }
    }
}
