//! Misuse: what the firmware does that the chip does not do, or this model does not know.

use super::map::Register;

/// One misuse. It ends the run: on silicon it would fail silently, or not be known to work.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Misuse {
    /// No peripheral, or no register of it, lies there.
    #[error("{peripheral} + {offset:#x} is no register of this chip")]
    NoRegister {
        /// The peripheral, or "address" with the whole address as offset.
        peripheral: String,
        /// Bytes from its first address.
        offset: u32,
    },
    /// The chip has it and this model does not.
    #[error("{peripheral}.{register} (offset {offset:#x}) is not modelled")]
    Unmodelled {
        /// The peripheral.
        peripheral: String,
        /// The register.
        register: String,
        /// Bytes from the peripheral's first address.
        offset: u32,
    },
    /// A bit that means nothing was set.
    #[error("{peripheral}.{register} = {value:#010x} sets reserved bits {reserved:#010x}")]
    ReservedBits {
        /// The peripheral.
        peripheral: String,
        /// The register.
        register: String,
        /// The value written.
        value: u32,
        /// Its bits that mean nothing.
        reserved: u32,
    },
    /// A register that can only be read was written.
    #[error("{peripheral}.{register} cannot be written")]
    ReadOnly {
        /// The peripheral.
        peripheral: String,
        /// The register.
        register: String,
    },
    /// The peripheral's clock is off: silicon would read zeros and lose writes.
    #[error("{peripheral} is used while RCC.{enable} is 0: it has no clock")]
    NoClock {
        /// The peripheral.
        peripheral: String,
        /// Register and field of the RCC.
        enable: String,
    },
    /// The peripheral is held in reset: silicon would lose writes.
    #[error("{peripheral} is used while RCC.{reset} is 1: it is held in reset")]
    InReset {
        /// The peripheral.
        peripheral: String,
        /// Register and field of the RCC.
        reset: String,
    },
    /// A rule of the reference manual is broken.
    #[error("{peripheral}: {rule}")]
    Rule {
        /// The peripheral.
        peripheral: &'static str,
        /// The rule, with its section of RM0440 where it has one.
        rule: String,
    },
}

impl Misuse {
    pub(super) fn unmodelled(peripheral: &str, register: &Register) -> Self {
        Self::Unmodelled {
            peripheral: peripheral.to_owned(),
            register: register.name.clone(),
            offset: register.offset,
        }
    }

    pub(super) fn rule(peripheral: &'static str, rule: impl Into<String>) -> Self {
        Self::Rule { peripheral, rule: rule.into() }
    }
}
