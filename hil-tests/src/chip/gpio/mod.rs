//! GPIO: pins of one port (RM0440 chapter 9).

use super::{
    bank::Bank,
    map::Register,
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
};

/// Model of one port.
#[derive(Clone, Debug)]
pub struct Gpio {
    bank: Bank,
    /// Levels that the world puts on the pins, where it drives them.
    pub driven: [Option<bool>; 16],
    /// What each pin does, by MODER and AFR.
    modes: [PinMode; 16],
    /// Pins that are outputs, and pins that belong to a peripheral's output with its level.
    outputs: u16,
    carrying: u16,
    carried: u16,
    /// Pins whose outputs are open-drain, so that others make their high level; and pins that are pulled up.
    open_drain: u16,
    pulled_up: u16,
}

/// What a pin does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PinMode {
    /// Reads its level.
    Input,
    /// Gives the level of ODR.
    Output,
    /// Belongs to a peripheral: its alternate function.
    Alternate(u8),
    /// Belongs to a converter, or to nothing.
    Analogue,
}

impl Gpio {
    /// A port after reset: all analogue, but for the debug pins of ports A and B.
    #[must_use]
    pub fn new(port: char) -> Self {
        let name = format!("GPIO{port}");
        let (mode, pull) = match port {
            'A' => (0xABFF_FFFF, 0x6400_0000),
            'B' => (0xFFFF_FEBF, 0x0000_0100),
            _ => (0xFFFF_FFFF, 0),
        };
        let bank = Bank::new(&name, &[("MODER", mode), ("PUPDR", pull)]);
        let modes = [PinMode::Analogue; 16];
        let mut port = Self {
            bank,
            driven: [None; 16],
            modes,
            outputs: 0,
            carrying: 0,
            carried: 0,
            open_drain: 0,
            pulled_up: 0,
        };
        port.follow_modes();
        port.follow_types();
        port
    }

    /// What a pin does.
    #[must_use]
    pub fn mode(&self, pin: usize) -> PinMode {
        self.modes[pin]
    }

    fn follow_modes(&mut self) {
        let (modes, functions) = (self.bank.word("MODER", 0), [0, 1].map(|half| self.bank.word("AFR", half)));
        self.modes = std::array::from_fn(|pin| match modes >> (2 * pin) & 3 {
            0 => PinMode::Input,
            1 => PinMode::Output,
            2 => PinMode::Alternate((functions[pin / 8] >> (4 * (pin % 8)) & 15) as u8),
            _ => PinMode::Analogue,
        });
        self.outputs = (0..16).map(|pin| u16::from(self.modes[pin] == PinMode::Output) << pin).sum();
        self.carrying = 0;
    }

    /// A peripheral that has a pin as its alternate function gives it this level; none: it lets it go.
    /// Says whether that changes the pin.
    pub fn carry(&mut self, pin: usize, level: Option<bool>) -> bool {
        let (bit, before) = (1 << pin, (self.carrying, self.carried));
        self.carrying = if level.is_some() { self.carrying | bit } else { self.carrying & !bit };
        self.carried = if level == Some(true) { self.carried | bit } else { self.carried & !bit };
        before != (self.carrying, self.carried)
    }

    /// Levels of the output register.
    #[must_use]
    pub fn outputs(&self) -> u16 {
        self.bank.word("ODR", 0) as u16
    }

    /// Levels of the pins that the chip drives, by the output register or a peripheral; the others' are 0.
    #[must_use]
    pub fn driven_levels(&self) -> u16 {
        (self.outputs() & self.outputs | self.carried & self.carrying) & (!self.open_drain | self.pulled_up)
    }

    fn follow_types(&mut self) {
        let pulls = self.bank.word("PUPDR", 0);
        self.open_drain = self.bank.word("OTYPER", 0) as u16;
        self.pulled_up = (0..16).map(|pin| u16::from(pulls >> (2 * pin) & 3 == 1) << pin).sum();
    }

    /// Level that a pin reads.
    #[must_use]
    pub fn level(&self, pin: usize) -> bool {
        let is_high = |levels: u16| levels >> pin & 1 == 1;
        match self.mode(pin) {
            PinMode::Analogue => false,
            PinMode::Output if !(is_high(self.outputs()) && is_high(self.open_drain)) => {
                is_high(self.outputs())
            }
            PinMode::Alternate(_) if is_high(self.carrying) && !is_high(self.carried & self.open_drain) => {
                is_high(self.carried)
            }
            _ => self.driven[pin].unwrap_or(is_high(self.pulled_up)),
        }
    }
}

impl Peripheral for Gpio {
    has_bank!();

    fn models(&self, register: &Register) -> bool {
        register.name != "LCKR"
    }

    fn read(&mut self, register: &Register, _: Moment) -> u32 {
        match register.name.as_str() {
            "IDR" => (0..16).map(|pin| u32::from(self.level(pin)) << pin).sum(),
            _ => self.bank.value(register),
        }
    }

    fn write(&mut self, register: &Register, value: u32, _: Moment) -> Result<(), Misuse> {
        let outputs = self.bank.word("ODR", 0);
        match register.name.as_str() {
            // Setting wins over resetting (9.4.7).
            "BSRR" => self.bank.set_word("ODR", 0, (outputs & !(value >> 16)) | (value & 0xFFFF)),
            "MODER" | "AFR" => {
                self.bank.store(register, value);
                self.follow_modes();
            }
            "OTYPER" | "PUPDR" => {
                self.bank.store(register, value);
                self.follow_types();
            }
            _ => self.bank.store(register, value),
        }
        Ok(())
    }

    fn reset(&mut self) {
        self.bank.reset();
        self.follow_modes();
        self.follow_types();
    }
}

#[cfg(test)]
mod tests;
