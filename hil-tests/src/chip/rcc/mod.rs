//! RCC: clocks and resets (RM0440 chapter 7).
//!
//! Oscillators are ready as soon as they are on. The system clock follows the switch, and every
//! other clock follows from it.

use super::{
    bank::Bank,
    clocks::{Clocks, HSE, HSI, HSI48},
    map::{Field, Map, PeripheralMap, Register, Switch},
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
};

/// Why the chip started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResetCause {
    /// The supply came up.
    Power,
    /// The firmware asked for it.
    Software,
    /// The independent watchdog bit.
    Watchdog,
    /// The reset pin.
    Pin,
}

/// Kernel clock of the FDCANs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CanClock {
    /// Hz; 0 if it is off.
    pub hertz: u64,
    /// Whether the crystal makes it.
    pub is_crystal: bool,
    /// Clock of their bus, Hz.
    pub bus: u64,
}

/// Model of the RCC.
#[derive(Clone, Debug)]
pub struct Rcc {
    bank: Bank,
    /// Where the clock's and the reset's switch of each peripheral are, in the map's order.
    switches: Vec<[Option<Field>; 2]>,
}

impl Default for Rcc {
    fn default() -> Self {
        let bank = Bank::new(
            "RCC",
            &[
                ("CR", 0x500),
                ("CFGR", 1),
                ("PLLCFGR", 0x1000),
                ("ICSCR", 0x4000_0000),
                ("AHB1ENR", 0x100),
                ("AHB1SMENR", 0x130F),
                ("AHB2SMENR", 0x050F_667F),
                ("AHB3SMENR", 0x101),
                ("APB1SMENR1", 0xD2FE_CD3F),
                ("APB1SMENR2", 0x103),
                ("APB2SMENR", 0x0437_F801),
            ],
        );
        let find = |switch: &Switch| switch.as_ref().map(|(register, field)| bank.find(register, field));
        let switches = Map::of_chip().peripherals().map(|map| [find(&map.clock), find(&map.reset)]).collect();
        Self { bank, switches }
    }
}

impl Rcc {
    /// Whether a peripheral has its clock and is not held in reset.
    #[must_use]
    pub fn lets_run(&self, peripheral: &PeripheralMap) -> bool {
        let [clock, reset] = self.switches[peripheral.place];
        clock.is_none_or(|field| self.bank.at(field) == 1)
            && reset.is_none_or(|field| self.bank.at(field) == 0)
    }

    /// Whether a peripheral's clock is on; the name of its switch otherwise.
    pub fn clock_of(&self, peripheral: &PeripheralMap) -> Result<(), String> {
        match &peripheral.clock {
            Some((register, field)) if !self.bank.is_set(register, field) => {
                Err(format!("{register}.{field}"))
            }
            _ => Ok(()),
        }
    }

    /// What holds a peripheral in reset, if anything does.
    pub fn reset_of(&self, peripheral: &PeripheralMap) -> Option<String> {
        let (register, field) = peripheral.reset.as_ref()?;
        self.bank.is_set(register, field).then(|| format!("{register}.{field}"))
    }

    /// How fast everything runs.
    #[must_use]
    pub fn clocks(&self) -> Clocks {
        let system = match self.bank.get("CFGR", "SWS") {
            2 => HSE,
            3 => self.pll_r(),
            _ => HSI,
        };
        let core = system >> ahb_shift(self.bank.get("CFGR", "HPRE"));
        let bus = |field| core >> apb_shift(self.bank.get("CFGR", field));
        Clocks { system, core, apb1: bus("PPRE1"), apb2: bus("PPRE2") }
    }

    /// Kernel clock of a peripheral on this bus, by the value of its field in CCIPR where that means the bus, SYSCLK,
    /// HSI16 or LSE.
    #[must_use]
    pub fn uart_clock(&self, field: &str, bus: u64) -> u64 {
        match self.bank.get("CCIPR", field) {
            0 => bus,
            1 => self.clocks().system,
            2 => HSI,
            _ => 32_768,
        }
    }

    /// Kernel clock of a group of converters, Hz: none, PLL "P" or the system clock.
    #[must_use]
    pub fn adc_clock(&self, field: &str) -> u64 {
        match self.bank.get("CCIPR", field) {
            1 if self.bank.is_set("PLLCFGR", "PLLPEN") => self.pll_p(),
            2 => self.clocks().system,
            _ => 0,
        }
    }

    /// Kernel clock of the FDCANs: HSE, PLL "Q" or their bus.
    #[must_use]
    pub fn can_clock(&self) -> CanClock {
        let (bus, is_pll_exact) = (self.clocks().apb1, self.pll_is_exact());
        let (hertz, is_crystal) = match self.bank.get("CCIPR", "FDCANSEL") {
            0 if self.bank.is_set("CR", "HSERDY") => (HSE, true),
            1 if self.bank.is_set("PLLCFGR", "PLLQEN") => (self.pll_q(), is_pll_exact),
            2 => match self.bank.get("CFGR", "SWS") {
                2 => (bus, true),
                3 => (bus, is_pll_exact),
                _ => (bus, false),
            },
            _ => (0, false),
        };
        CanClock { hertz, is_crystal, bus }
    }

    /// Kernel clock of the USB, Hz, and whether that is the HSI48; 0 where it has none.
    #[must_use]
    pub fn usb_clock(&self) -> (u64, bool) {
        match self.bank.get("CCIPR", "CLK48SEL") {
            0 if self.bank.is_set("CRRCR", "HSI48RDY") => (HSI48, true),
            2 if self.bank.is_set("PLLCFGR", "PLLQEN") && self.bank.is_set("CR", "PLLRDY") => {
                (self.pll_q(), false)
            }
            _ => (0, false),
        }
    }

    /// Whether the PLL follows the crystal.
    #[must_use]
    pub fn pll_is_exact(&self) -> bool {
        self.bank.get("PLLCFGR", "PLLSRC") == 3
    }

    /// PLLPDIV divides (the field PLLP of the crate's map), or at 0 the bit PLLP: by 7 or 17.
    fn pll_p(&self) -> u64 {
        let divisor = match (self.bank.get("PLLCFGR", "PLLP"), self.bank.get("PLLCFGR", "PLLPBIT")) {
            (0, 0) => 7,
            (0, _) => 17,
            (divisor, _) => divisor.into(),
        };
        self.pll_vco() / divisor
    }

    /// Notes why the chip started: flags of CSR add up until the firmware removes them (7.4.24).
    pub fn restart(&mut self, cause: ResetCause) {
        let (csr, map) = (self.bank.word("CSR", 0), self.bank.map);
        self.bank.reset();
        let kept = if cause == ResetCause::Power { 0 } else { csr & 0xFE00_0000 };
        let csr = map.register("CSR");
        let flag = match cause {
            ResetCause::Power => csr.mask("BORRSTF"),
            ResetCause::Software => csr.mask("SFTRSTF"),
            ResetCause::Watchdog => csr.mask("IWDGRSTF"),
            ResetCause::Pin => 0,
        };
        // Every reset pulls the pin low as well (7.1.2).
        self.bank.store(csr, kept | flag | csr.mask("PINRSTF"));
    }

    fn pll_q(&self) -> u64 {
        self.pll_vco() / (2 * (u64::from(self.bank.get("PLLCFGR", "PLLQ")) + 1))
    }

    fn pll_r(&self) -> u64 {
        self.pll_vco() / (2 * (u64::from(self.bank.get("PLLCFGR", "PLLR")) + 1))
    }

    fn pll_vco(&self) -> u64 {
        let get = |field| u64::from(self.bank.get("PLLCFGR", field));
        let source = if get("PLLSRC") == 3 { HSE } else { HSI };
        source * get("PLLN") / (get("PLLM") + 1)
    }

    fn follow_switches(&mut self) {
        for (register, on, ready) in [
            ("CR", "HSION", "HSIRDY"),
            ("CR", "HSEON", "HSERDY"),
            ("CR", "PLLON", "PLLRDY"),
            ("CSR", "LSION", "LSIRDY"),
            ("BDCR", "LSEON", "LSERDY"),
            ("CRRCR", "HSI48ON", "HSI48RDY"),
        ] {
            let value = self.bank.get(register, on);
            self.bank.set(register, ready, value);
        }
        let switch = self.bank.get("CFGR", "SW");
        self.bank.set("CFGR", "SWS", switch);
    }

    fn check_switch(&self) -> Result<(), Misuse> {
        let ready = match self.bank.get("CFGR", "SW") {
            1 => self.bank.is_set("CR", "HSIRDY"),
            2 => self.bank.is_set("CR", "HSERDY"),
            3 => self.bank.is_set("CR", "PLLRDY") && self.bank.is_set("PLLCFGR", "PLLREN"),
            _ => return Err(Misuse::rule("RCC", "CFGR.SW = 0 selects no clock (7.4.3)")),
        };
        if ready {
            Ok(())
        } else {
            Err(Misuse::rule("RCC", "CFGR.SW selects a clock that is not ready (7.4.3)"))
        }
    }
}

fn ahb_shift(prescaler: u32) -> u32 {
    [1, 2, 3, 4, 6, 7, 8, 9].get(prescaler.wrapping_sub(8) as usize).copied().unwrap_or(0)
}

fn apb_shift(prescaler: u32) -> u32 {
    if prescaler < 4 { 0 } else { prescaler - 3 }
}

impl Peripheral for Rcc {
    has_bank!();

    fn models(&self, register: &Register) -> bool {
        !matches!(register.name.as_str(), "CIER" | "CIFR" | "CICR")
    }

    fn write(&mut self, register: &Register, value: u32, _: Moment) -> Result<(), Misuse> {
        let old = self.bank.value(register);
        if register.name == "PLLCFGR" && self.bank.is_set("CR", "PLLON") {
            let running =
                ["PLLSRC", "PLLM", "PLLN"].iter().any(|field| register.get(old ^ value, field) != 0);
            if running {
                return Err(Misuse::rule("RCC", "PLLCFGR changes while the PLL runs (7.4.4)"));
            }
        }
        if register.name == "CSR" {
            let removes = register.get(value, "RMVF") != 0;
            let flags = if removes { 0 } else { old & 0xFE00_0000 };
            self.bank.store(register, flags | (value & 0x0000_0003));
        } else {
            self.bank.store(register, value);
        }
        self.follow_switches();
        self.check_switch()
    }

    fn reset(&mut self) {
        self.restart(ResetCause::Pin);
    }
}

#[cfg(test)]
mod tests;
