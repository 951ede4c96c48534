//! Access: what every read and write of a register has to pass before its model sees it.

use super::{
    Chip,
    blocks::{Block, Blocks},
    core,
    map::{Map, PeripheralMap, Register},
    misuse::Misuse,
    peripheral::Peripheral,
};

/// A register and its peripheral.
pub(super) type Place = (&'static PeripheralMap, &'static Register);

impl Chip {
    /// Reads `size` bytes of a peripheral.
    pub fn read(&mut self, address: u32, size: u32) -> Result<u32, Misuse> {
        let (value, shift) = match self.place(address)? {
            None => (self.core.read(address & !3, self.core_moment())?, address & 3),
            Some((map, register)) => {
                self.check_access(map, register)?;
                let at = self.moment();
                let block = self.block_with(map, register)?;
                let model = self.model_mut(block);
                check_size(model, map, register, size)?;
                let value = model.read(register, at);
                if model.read_changes(register) {
                    self.touched.insert(block);
                }
                (value, address & 3)
            }
        };
        let mask = (u64::from(u32::MAX) >> (32 - 8 * size.min(4))) as u32;
        Ok(value >> (8 * shift) & mask)
    }

    /// Writes `size` bytes of a peripheral.
    pub fn write(&mut self, address: u32, size: u32, value: u32) -> Result<(), Misuse> {
        match self.place(address)? {
            None => self.core.write(address, size, value, self.core_moment()),
            Some((map, register)) => {
                self.check_access(map, register)?;
                let at = self.moment();
                let block = self.block_with(map, register)?;
                let model = self.model_mut(block);
                let old = model.bank().value(register);
                let value = merge_bytes(old, address & 3, size, value);
                check_write(model, map, register, size, value)?;
                model.bank_mut().is_in_use = true;
                model.write(register, value, at)?;
                self.follow_write(block, register)
            }
        }
    }

    /// What a written register changes in other peripherals.
    fn follow_write(&mut self, block: Block, register: &Register) -> Result<(), Misuse> {
        self.touched.insert(block);
        match block {
            Block::Rcc => {
                if register.name.contains("RSTR") {
                    self.reset_held();
                }
                self.follow_clocks();
                self.follow_wires();
                self.check_clocks()
            }
            Block::Pwr | Block::Flash => self.check_clocks(),
            Block::AdcCommon(_) | Block::Crs => {
                self.follow_clocks();
                Ok(())
            }
            Block::Port(_) if matches!(register.name.as_str(), "MODER" | "AFR") => {
                self.follow_wires();
                Ok(())
            }
            Block::Port(_) | Block::Syscfg => {
                self.follow_pins();
                Ok(())
            }
            // A channel that is new may find its request waiting.
            Block::Dma(_) | Block::Dmamux => {
                self.touched = Blocks::ALL;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Peripheral and register at an address; none for the core's own.
    fn place(&mut self, address: u32) -> Result<Option<Place>, Misuse> {
        // The DMA comes back to the same few registers.
        let seen = (address >> 2 ^ address >> 10) as usize % self.places.len();
        if let Some((known, place)) = self.places[seen]
            && known == address
        {
            return Ok(Some(place));
        }
        let place = find(address)?;
        if let Some(place) = place {
            self.places[seen] = Some((address, place));
        }
        Ok(place)
    }

    /// Peripherals that the RCC holds in reset start again (RM0440, RCC chapter, RCC_AHB1RSTR and on).
    fn reset_held(&mut self) {
        for map in Map::of_chip().peripherals() {
            if self.rcc.reset_of(map).is_some()
                && let Some(block) = Block::named(map.name)
            {
                self.model_mut(block).reset();
            }
        }
        self.touched = Blocks::ALL;
    }

    fn check_access(&self, map: &PeripheralMap, register: &Register) -> Result<(), Misuse> {
        if self.rcc.lets_run(map) {
            return Ok(());
        }
        let peripheral = || format!("{}.{}", map.name, register.name);
        self.rcc.clock_of(map).map_err(|enable| Misuse::NoClock { peripheral: peripheral(), enable })?;
        match self.rcc.reset_of(map) {
            Some(reset) => Err(Misuse::InReset { peripheral: peripheral(), reset }),
            None => Ok(()),
        }
    }

    fn block_with(&self, map: &PeripheralMap, register: &Register) -> Result<Block, Misuse> {
        match self.blocks[map.place] {
            Some(block) if self.model(block).models(register) => Ok(block),
            _ => Err(Misuse::unmodelled(map.name, register)),
        }
    }
}

fn find(address: u32) -> Result<Option<Place>, Misuse> {
    match Map::of_chip().at(address) {
        Some(peripheral) => {
            let offset = address - peripheral.base;
            let none = || Misuse::NoRegister { peripheral: peripheral.name.to_owned(), offset };
            Ok(Some((peripheral, peripheral.register_at(offset).ok_or_else(none)?)))
        }
        None if address >= core::START => Ok(None),
        None => Err(Misuse::NoRegister { peripheral: "address".to_owned(), offset: address }),
    }
}

/// A store of fewer than four bytes changes only its own.
fn merge_bytes(old: u32, place: u32, size: u32, value: u32) -> u32 {
    let mask = (u64::from(u32::MAX) >> (32 - 8 * size.min(4))) as u32;
    (old & !(mask << (8 * place))) | (value & mask) << (8 * place)
}

/// Whether a register takes this value, in a store of `size` bytes.
fn check_write(
    model: &dyn Peripheral,
    map: &PeripheralMap,
    register: &Register,
    size: u32,
    value: u32,
) -> Result<(), Misuse> {
    check_size(model, map, register, size)?;
    if size != 4 && model.words_only() {
        let rule = format!("{} is written by {size} bytes: its registers want words", register.name);
        return Err(Misuse::rule(map.name, rule));
    }
    if !register.writable {
        let (peripheral, register) = (map.name.to_owned(), register.name.clone());
        return Err(Misuse::ReadOnly { peripheral, register });
    }
    if model.clears_flags(register) {
        return Ok(());
    }
    check_bits(map, register, model.bank().value(register), value)
}

fn check_size(
    model: &dyn Peripheral,
    map: &PeripheralMap,
    register: &Register,
    size: u32,
) -> Result<(), Misuse> {
    if size == 4 && model.halves_only() {
        let rule = format!("{} is accessed by words: it wants half-words", register.name);
        return Err(Misuse::rule(map.name, rule));
    }
    Ok(())
}

/// Bits that mean nothing keep the value they have.
fn check_bits(map: &PeripheralMap, register: &Register, old: u32, value: u32) -> Result<(), Misuse> {
    match value & !register.known_bits & !old {
        0 => Ok(()),
        reserved => {
            let (peripheral, register) = (map.name.to_owned(), register.name.clone());
            Err(Misuse::ReservedBits { peripheral, register, value, reserved })
        }
    }
}
