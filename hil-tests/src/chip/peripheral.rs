//! Peripheral: what every block of the chip can be asked.

use super::{bank::Bank, clocks::Clocks, map::Register, misuse::Misuse, time::Time};

/// When something happens, and how the clocks run then.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Virtual time.
    pub now: Time,
    /// The clocks.
    pub clocks: Clocks,
}

/// One block of the chip.
pub trait Peripheral {
    /// Its registers.
    fn bank(&self) -> &Bank;
    /// Its registers, to change.
    fn bank_mut(&mut self) -> &mut Bank;
    /// Whether the model knows what this register does.
    fn models(&self, register: &Register) -> bool;

    /// Whether a write only clears flags: drivers write whole words there, and silicon ignores the
    /// bits that mean nothing. (Registers that cannot be read are taken for such.)
    fn clears_flags(&self, register: &Register) -> bool {
        !register.readable
    }

    /// Whether its registers can only be written by words.
    fn words_only(&self) -> bool {
        false
    }

    /// Whether its registers cannot be read or written by words.
    fn halves_only(&self) -> bool {
        false
    }

    /// The CPU or the DMA reads a register.
    fn read(&mut self, register: &Register, _at: Moment) -> u32 {
        self.bank().value(register)
    }

    /// Whether reading a register changes anything that others see.
    fn read_changes(&self, _register: &Register) -> bool {
        false
    }

    /// The CPU or the DMA writes a register.
    fn write(&mut self, register: &Register, value: u32, _at: Moment) -> Result<(), Misuse> {
        self.bank_mut().store(register, value);
        Ok(())
    }

    /// When it does something by itself next.
    fn next_event(&self) -> Time {
        Time::NEVER
    }

    /// Does what is due by now.
    fn advance(&mut self, _at: Moment) -> Result<(), Misuse> {
        Ok(())
    }

    /// Whether one of its interrupt signals is raised.
    fn interrupts(&self, _signal: &str) -> bool {
        false
    }

    /// Whether one of its DMA signals asks for a transfer.
    fn requests(&self, _signal: &str) -> bool {
        false
    }

    /// The DMA has served a request.
    fn acknowledge(&mut self, _signal: &str) {}

    /// The DMA has come to the end of the buffer that one of its signals asks for.
    fn transfers_ended(&mut self, _signal: &str) {}

    /// Back to the state after reset.
    fn reset(&mut self) {
        self.bank_mut().reset();
    }
}

/// Implements the two accessors for a model with a field `bank`.
macro_rules! has_bank {
    () => {
        fn bank(&self) -> &Bank {
            &self.bank
        }
        fn bank_mut(&mut self) -> &mut Bank {
            &mut self.bank
        }
    };
}
pub(super) use has_bank;
