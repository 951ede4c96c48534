//! Settings: what a timer's registers ask for, read once after each write, and what is refused.

use crate::chip::{bank::Bank, map::Register, misuse::Misuse};

/// Most channels of a timer here.
pub(super) const CHANNELS: usize = 4;

/// What the registers ask for.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Settings {
    /// CR1.CEN.
    pub(super) is_on: bool,
    /// CR1.UDIS is 0.
    pub(super) updates: bool,
    /// CR1.URS: only the counter itself raises UIF.
    pub(super) only_overflow: bool,
    /// CR1.OPM.
    pub(super) one_pulse: bool,
    /// CR1.ARPE.
    pub(super) preloads_top: bool,
    /// CR2.MMS.
    pub(super) trigger: TriggerMode,
    /// SMCR.
    pub(super) slave: Slave,
    /// DIER.
    pub(super) wanted: u32,
    /// DIER.UDE, then CCDE of each channel.
    pub(super) requests: [bool; CHANNELS + 1],
    /// CCMR.OCPE of each channel.
    pub(super) preloads: [bool; CHANNELS],
    /// What the pin of each channel shows, if its output is on.
    pub(super) outputs: [Option<Output>; CHANNELS],
}

/// What fires the trigger output (CR2.MMS).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum TriggerMode {
    #[default]
    Reset,
    Enable,
    Update,
    Compare,
}

/// What the trigger output of another timer, by its number, does (SMCR.SMS).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Slave {
    #[default]
    Off,
    /// Trigger mode: it starts the counter.
    Starts(u8),
    /// External clock mode 1: each one is a tick.
    Counts(u8),
}

/// Level of an output ("PWM mode", "Forced output mode").
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Output {
    /// This level while the counter is below the compare value, the other one after.
    Below(bool),
    /// Always this level.
    Always(bool),
}

impl Output {
    pub(super) fn level(self, count: u64, compare: u64) -> bool {
        match self {
            Self::Below(level) => level == (count < compare),
            Self::Always(level) => level,
        }
    }
}

impl Settings {
    /// Reads the registers of a timer with so many channels.
    pub(super) fn read(bank: &Bank, channels: usize) -> Self {
        let is_set = |register, field: &str| bank.is_set(register, field);
        let mut settings = Self {
            is_on: is_set("CR1", "CEN"),
            updates: !is_set("CR1", "UDIS"),
            only_overflow: is_set("CR1", "URS"),
            one_pulse: is_set("CR1", "OPM"),
            preloads_top: is_set("CR1", "ARPE"),
            trigger: trigger(bank.get("CR2", "MMS")),
            wanted: bank.word("DIER", 0),
            ..Self::default()
        };
        settings.requests[0] = is_set("DIER", "UDE");
        for channel in 0..channels {
            settings.requests[channel + 1] =
                of_channel(bank, bank.map.register("DIER"), "CCDE", channel) == 1;
            settings.preloads[channel] = of_mode(bank, "OCPE", channel) == 1;
            settings.outputs[channel] = output(bank, channel);
        }
        if channels > 0 {
            let register = bank.map.register("SMCR");
            settings.slave = slave(register, bank.value(register));
        }
        settings
    }
}

/// A field of a channel, which is no array where only the first channel has one; 0 where none has.
fn of_channel(bank: &Bank, register: &Register, field: &str, channel: usize) -> u32 {
    let names = [format!("{field}[{channel}]"), field.to_owned()];
    let known = names.iter().take(if channel == 0 { 2 } else { 1 }).find(|name| register.has_field(name));
    known.map_or(0, |name| register.get(bank.value(register), name))
}

/// A field of a channel in its CCMR.
fn of_mode(bank: &Bank, field: &str, channel: usize) -> u32 {
    of_channel(bank, bank.map.element("CCMR_INPUT", channel / 2), field, channel % 2)
}

fn trigger(code: u32) -> TriggerMode {
    [TriggerMode::Reset, TriggerMode::Enable, TriggerMode::Update, TriggerMode::Compare][code as usize & 3]
}

/// SMS 6 is trigger mode, 7 external clock mode 1.
fn slave(register: &Register, value: u32) -> Slave {
    match (register.get(value, "SMS"), master(register, value)) {
        (6, Some(timer)) => Slave::Starts(timer),
        (7, Some(timer)) => Slave::Counts(timer),
        _ => Slave::Off,
    }
}

/// Timer that SMCR.TS selects ("TIMx internal trigger connection"), the same for all: ITR0 to ITR3 are codes 0
/// to 3, ITR4 and on begin at 8. TIM1 and TIM8 are not modelled.
fn master(register: &Register, value: u32) -> Option<u8> {
    match register.get(value, "TS") | register.get(value, "TS.1") << 3 {
        1 => Some(2),
        2 => Some(3),
        3 => Some(4),
        8 => Some(5),
        10 => Some(15),
        _ => None,
    }
}

/// OCM: 4 and 5 force a level, 6 and 7 are PWM modes 1 and 2; CCP turns it round.
fn output(bank: &Bank, channel: usize) -> Option<Output> {
    let switch = |field| of_channel(bank, bank.map.register("CCER"), field, channel) == 1;
    if !switch("CCE") {
        return None;
    }
    let turned = switch("CCP");
    match of_mode(bank, "OCM", channel) {
        4 => Some(Output::Always(turned)),
        5 => Some(Output::Always(!turned)),
        6 => Some(Output::Below(!turned)),
        7 => Some(Output::Below(turned)),
        _ => None,
    }
}

/// Refuses what the model does not do; `bank` holds what was there before.
pub(super) fn check(bank: &Bank, register: &Register, value: u32, number: u8) -> Result<(), Misuse> {
    let get = |field: &str| if register.has_field(field) { register.get(value, field) } else { 0 };
    let refuse = |rule: &str| Err(Misuse::rule("TIM", rule));
    match register.name.as_str() {
        "CR1" if ["DIR", "CMS", "DITHEN"].iter().any(|field| get(field) != 0) => {
            refuse("only counting up without dithering is modelled")
        }
        "CR2" if get("MMS") > 3 || get("MMS.1") != 0 => {
            refuse("of CR2.MMS reset, enable, update and compare are modelled")
        }
        "CR2" if get("CCDS") != 0 => refuse("requests of channels at the update (CR2.CCDS) are not modelled"),
        "DIER" if get("TDE") != 0 => refuse("requests of the trigger (DIER.TDE) are not modelled"),
        "SMCR" => check_slave(register, bank.value(register), value, number),
        "CCER" => (0..CHANNELS).try_for_each(|channel| check_output(bank, value, None, channel)),
        name if name.starts_with("CCMR") => {
            let both = [2 * register.index, 2 * register.index + 1];
            both.into_iter()
                .try_for_each(|channel| check_output(bank, bank.word("CCER", 0), Some(value), channel))
        }
        _ => Ok(()),
    }
}

fn check_slave(register: &Register, old: u32, value: u32, number: u8) -> Result<(), Misuse> {
    let get = |field| register.get(value, field);
    let selection = |value| register.get(value, "TS") | register.get(value, "TS.1") << 3;
    let refuse = |rule: String| Err(Misuse::rule("TIM", rule));
    let known = ["SMS", "TS", "TS.1", "MSM"].iter().fold(0, |bits, field| bits | register.mask(field));
    if value & !known != 0 || !matches!(get("SMS"), 0 | 6 | 7) {
        return refuse("of the slave modes (SMCR) trigger and external clock mode 1 are modelled".to_owned());
    }
    if get("SMS") != 0 && register.get(old, "SMS") != 0 && selection(old) != selection(value) {
        return refuse("SMCR.TS changes while SMS is not 0".to_owned());
    }
    match master(register, value) {
        _ if get("SMS") == 0 => Ok(()),
        Some(master) if master != number => Ok(()),
        _ => {
            let code = selection(value);
            refuse(format!("trigger {code} (SMCR.TS) of timer {number} is not modelled"))
        }
    }
}

/// A channel that is on (CCER) has to be an output in a mode that is modelled.
fn check_output(bank: &Bank, enables: u32, written: Option<u32>, channel: usize) -> Result<(), Misuse> {
    let switches = bank.map.register("CCER");
    if bank.map.registers().any(|register| register.name == "BDTR") && enables != 0 {
        return Err(Misuse::rule("TIM", "outputs behind BDTR.MOE are not modelled"));
    }
    let switch = format!("CCE[{channel}]");
    if !switches.has_field(&switch) || switches.get(enables, &switch) == 0 {
        return Ok(());
    }
    let modes = bank.map.element("CCMR_INPUT", channel / 2);
    let value = written.unwrap_or(bank.value(modes));
    let get = |field| modes.get(value, &format!("{field}[{}]", channel % 2));
    let upper = modes.get(value, &format!("OCM[{}].1", channel % 2));
    if get("CCS") != 0 || upper != 0 || get("OCM") < 4 || get("OCFE") != 0 || get("OCCE") != 0 {
        let rule = format!("of channel {}'s modes PWM 1 and 2 and forced levels are modelled", channel + 1);
        return Err(Misuse::rule("TIM", rule));
    }
    Ok(())
}
