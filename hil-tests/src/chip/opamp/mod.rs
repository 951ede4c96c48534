//! OPAMP: one operational amplifier (RM0440, "Operational amplifiers (OPAMP)"), as a follower or with its
//! programmable gain around the voltage at pin VINM0.
//!
//! What the world could not tell from that is refused: external feedback (VM_SEL 0 and 1), gains whose
//! network ends at ground or has a filter on a pin, user trimming, calibration, inputs that timers switch
//! (TCMR). An amplifier settles at once; the world may say otherwise.

use super::{
    bank::Bank,
    map::Register,
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
    world::OpampSetting,
};

/// CSR.VM_SEL: the feedback network, and the output itself.
const NETWORK: u32 = 2;
const OUTPUT: u32 = 3;

/// Model of one amplifier.
#[derive(Clone, Debug)]
pub struct Opamp {
    bank: Bank,
    setting: OpampSetting,
}

impl Opamp {
    /// The amplifier of that name.
    #[must_use]
    pub fn new(name: &str) -> Self {
        Self { bank: Bank::new(name, &[]), setting: OpampSetting::Off }
    }

    /// What it does.
    #[must_use]
    pub fn setting(&self) -> OpampSetting {
        self.setting
    }

    /// Whether its output goes to a converter inside the chip.
    #[must_use]
    pub fn reaches_converter(&self) -> bool {
        self.setting != OpampSetting::Off && self.bank.is_set("CSR", "OPAINTOEN")
    }

    /// Whether it is in its high-speed mode: 45 V/us; otherwise 6.5 V/us (DS12288, table 80).
    #[must_use]
    pub fn is_fast(&self) -> bool {
        self.bank.is_set("CSR", "OPAHSM")
    }
}

fn setting(register: &Register, value: u32) -> Result<OpampSetting, Misuse> {
    let get = |field| register.get(value, field);
    if let Some(field) = ["FORCE_VP", "CALON", "USERTRIM"].into_iter().find(|&field| get(field) != 0) {
        return Err(Misuse::rule("OPAMP", format!("CSR.{field} is not modelled")));
    }
    let gain = match get("VM_SEL") {
        OUTPUT => 1.0,
        NETWORK => gain(get("PGA_GAIN"))?,
        _ if get("OPAMPEN") == 0 => 1.0,
        other => {
            let rule = format!("external feedback (CSR.VM_SEL = {other}) is not modelled");
            return Err(Misuse::rule("OPAMP", rule));
        }
    };
    Ok(match get("OPAMPEN") {
        0 => OpampSetting::Off,
        _ => OpampSetting::Amplifier { input: get("VP_SEL") as usize, gain },
    })
}

/// The two upper bits of PGA_GAIN say where the network ends: 1 is VINM0 as input or bias.
fn gain(code: u32) -> Result<f64, Misuse> {
    match (code >> 3, code & 7) {
        (1, exponent @ 0..=5) => Ok(f64::from(2 << exponent)),
        (_, 6..) => Err(Misuse::rule("OPAMP", format!("CSR.PGA_GAIN = {code} is reserved"))),
        _ => {
            let rule = format!("CSR.PGA_GAIN = {code} is not modelled: 8 to 13, with the bias at VINM0, are");
            Err(Misuse::rule("OPAMP", rule))
        }
    }
}

impl Peripheral for Opamp {
    has_bank!();

    fn models(&self, _: &Register) -> bool {
        true
    }

    fn write(&mut self, register: &Register, value: u32, _: Moment) -> Result<(), Misuse> {
        if register.get(self.bank.value(register), "LOCK") == 1 {
            return Err(Misuse::rule("OPAMP", format!("{} is written while LOCK is 1", register.name)));
        }
        match register.name.as_str() {
            "TCMR" if value != 0 => {
                return Err(Misuse::rule("OPAMP", "inputs that timers switch (TCMR) are not modelled"));
            }
            "CSR" => self.setting = setting(register, value)?,
            _ => {}
        }
        self.bank.store(register, value);
        Ok(())
    }

    fn reset(&mut self) {
        *self = Self::new(self.bank.map.name);
    }
}

#[cfg(test)]
mod tests;
