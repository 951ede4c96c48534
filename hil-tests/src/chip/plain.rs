//! Plain: blocks of which the firmware only sets options that nothing modelled here depends on.

use super::{
    bank::Bank,
    map::Register,
    peripheral::{Peripheral, has_bank},
};

/// Registers that keep what is written, of a block whose named registers do nothing else that matters.
#[derive(Clone, Debug)]
pub struct Plain {
    bank: Bank,
    known: &'static [&'static str],
}

impl Plain {
    /// System configuration (RM0440 chapter 10): only what selects interrupt pins and booting.
    #[must_use]
    pub fn syscfg() -> Self {
        Self { bank: Bank::new("SYSCFG", &[]), known: &["MEMRMP", "CFGR1", "EXTICR", "CFGR2"] }
    }

    /// Debug support (RM0440 chapter 47): what keeps running when the core is halted.
    #[must_use]
    pub fn dbgmcu() -> Self {
        let bank = Bank::new("DBGMCU", &[("IDCODE", 0x2003_6469)]);
        Self { bank, known: &["IDCODE", "CR", "APB1LFZR", "APB1HFZR", "APB2FZR"] }
    }
}

impl Peripheral for Plain {
    has_bank!();

    fn models(&self, register: &Register) -> bool {
        self.known.contains(&register.name.as_str())
    }
}
