//! Plan: what a converter's registers ask of its conversions, read once after each write.

use super::{SAMPLING, TRIGGERS, VREF_VOLTS};
use crate::chip::{bank::Bank, time::Time};

/// Ranks of a sequence at most.
const RANKS: usize = 16;

/// What the registers ask for.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Plan {
    ranks: [Rank; RANKS],
    /// Last rank of the sequence.
    pub(super) last: usize,
    /// Timer that starts each sequence, by its number; none: software does.
    pub(super) trigger: Option<u8>,
    /// CFGR.EXTEN is not 0.
    pub(super) is_triggered: bool,
    /// From a trigger to the start of sampling, and what the conversion may take longer for it: typical, and the
    /// rest up to the longest (DS12288, tLATR: 1.5 to 2.5 clocks).
    pub(super) latency: [Time; 2],
    /// CFGR.CONT.
    pub(super) is_continuous: bool,
    /// CFGR.DMAEN and DMACFG.
    pub(super) uses_dma: bool,
    pub(super) is_circular: bool,
    /// CFGR.OVRMOD.
    pub(super) overwrites: bool,
    /// Conversions that make one result, and by how many bits their sum is shifted.
    pub(super) ratio: u32,
    pub(super) shift: u32,
    /// Codes that there are.
    full: f64,
}

/// One rank of the sequence.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rank {
    pub(super) channel: usize,
    /// Time of sampling, and of the whole conversion.
    pub(super) sampling: Time,
    pub(super) whole: Time,
}

impl Plan {
    /// Reads the registers of a converter whose clock has so many hertz.
    pub(super) fn read(bank: &Bank, clock: u64) -> Self {
        let set = |field| bank.is_set("CFGR", field);
        let code = bank.get("CFGR", "EXTSEL");
        let trigger = TRIGGERS.iter().find(|&&(known, _)| known == code);
        let bits = 12 - 2 * bank.get("CFGR", "RES");
        let oversamples = bank.is_set("CFGR2", "ROVSE");
        let mut plan = Self {
            last: bank.get("SQR1", "L") as usize,
            trigger: trigger.map(|&(_, timer)| timer).filter(|_| set("EXTEN")),
            is_triggered: set("EXTEN"),
            latency: [4, 1].map(|half_clocks| Time::period(2 * clock) * half_clocks),
            is_continuous: set("CONT"),
            uses_dma: set("DMAEN"),
            is_circular: set("DMACFG"),
            overwrites: set("OVRMOD"),
            ratio: if oversamples { 2 << bank.get("CFGR2", "OVSR") } else { 1 },
            shift: if oversamples { bank.get("CFGR2", "OVSS") } else { 0 },
            full: f64::from(1_u32 << bits),
            ..Self::default()
        };
        for (place, rank) in plan.ranks.iter_mut().enumerate().take(plan.last + 1) {
            *rank = Rank::read(bank, place, clock, bits);
        }
        plan
    }

    pub(super) fn rank(&self, place: usize) -> Rank {
        self.ranks[place]
    }

    /// Code of a voltage.
    pub(super) fn code(&self, volts: f64) -> u32 {
        (volts / VREF_VOLTS * self.full).floor().clamp(0.0, self.full - 1.0) as u32
    }
}

impl Rank {
    fn read(bank: &Bank, place: usize, clock: u64, bits: u32) -> Self {
        let (register, field) = if place < 4 { (1, place) } else { (2 + (place - 4) / 5, (place - 4) % 5) };
        let channel = bank.get(&format!("SQR{register}"), &format!("SQ[{field}]")) as usize;
        let half_clock = Time::period(2 * clock);
        let sampling = sampling(bank, channel);
        // Sampling takes its half clocks, and then each bit takes one clock, and half a clock more.
        let whole = half_clock * (sampling + 2 * u64::from(bits) + 1);
        Self { channel, sampling: half_clock * sampling, whole }
    }
}

/// Half clocks for which a channel is sampled; SMPPLUS makes 2.5 clocks 3.5.
fn sampling(bank: &Bank, channel: usize) -> u64 {
    let name = if channel < 10 { "SMPR" } else { "SMPR2" };
    let field = format!("SMP[{}]", channel % 10);
    // There is no channel above 18.
    let is_known = bank.map.register(name).has_field(&field);
    let setting = if is_known { bank.get(name, &field) as usize } else { 0 };
    let plus = u64::from(setting == 0 && bank.is_set("SMPR", "SMPPLUS"));
    SAMPLING[setting] + 2 * plus
}
