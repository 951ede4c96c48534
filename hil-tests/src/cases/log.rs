//! Cases of the log, as `dermatome firmware --logs` decodes it.

use super::{Case, Failure, ensure};
use crate::{
    machine::Machine,
    probe::emulated::{LogReader, READ},
    rig::{Capability, Rig, VirtualRig},
};
use dermatome::link::program::log::Log;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

/// Damaged logs that are decoded.
const DAMAGED: u64 = 1000;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "the log says who starts and why, at every start",
        needs: &[Capability::Log, Capability::Reset],
        run: says_who_starts,
    },
    Case { name: "a damaged log costs lines, and no more", needs: &[Capability::Log], run: damage },
];

fn says_who_starts(rig: &Rig) -> Result<String, Failure> {
    let VirtualRig { firmware, board, .. } = rig.emulated_rig();
    let log = Log::new(firmware).map_err(Failure::wrong)?;
    let mut reader = LogReader::new(&log, false);
    let mut lines = || reader.lines(board).map_err(Failure::wrong);
    ensure(lines()?.is_empty(), || "there is a log before the first instruction".to_owned())?;
    let link = rig.link()?;
    let who = format!("{} firmware {}", link.identity().board, link.identity().firmware);
    let first = lines()?;
    contains(&first, &[&who, "started after power on"])?;
    rig.reset()?;
    contains(&lines()?, &["(the board has restarted)", &who, "started after its reset pin"])?;
    Ok(first.join(" | "))
}

/// Some bytes of the ring are overwritten, as by a board that logs faster than it is read.
fn damage(rig: &Rig) -> Result<String, Failure> {
    let VirtualRig { firmware, board, .. } = rig.emulated_rig();
    let log = Log::new(firmware).map_err(Failure::wrong)?;
    let at = log.control_block() as u32;
    rig.link()?;
    let whole = LogReader::new(&log, false).lines(board).map_err(Failure::wrong)?;
    ensure(!whole.is_empty(), || "there is no log to damage".to_owned())?;
    let mut damaged = 0;
    for seed in 0..DAMAGED {
        let before = board.with(move |machine| overwrite(machine, at, seed));
        let lines = LogReader::new(&log, false).lines(board).map_err(Failure::wrong)?;
        damaged += usize::from(lines != whole);
        board.with(move |machine| restore(machine, at, &before));
    }
    let again = LogReader::new(&log, false).lines(board).map_err(Failure::wrong)?;
    ensure(again == whole, || format!("{again:?}, not {whole:?}"))?;
    ensure(damaged > 0, || "no damage was seen".to_owned())?;
    Ok(format!("{damaged} of {DAMAGED} read differently"))
}

/// Overwrites up to eight bytes that wait in the ring; gives what was there.
fn overwrite(machine: &mut Machine, at: u32, seed: u64) -> Vec<u8> {
    let (ring, length) = waiting(machine, at);
    let before = machine.peek(ring, length);
    let mut random = Pcg64::seed_from_u64(seed);
    for _ in 0..random.random_range(1..=8) {
        let place = random.random_range(0..length as u32);
        machine.poke(ring + place, &[random.random()]);
    }
    machine.poke(at + READ, &[0; 4]);
    before
}

/// Puts the ring as it was, nothing of it read.
fn restore(machine: &mut Machine, at: u32, before: &[u8]) {
    let (ring, _) = waiting(machine, at);
    machine.poke(ring, before);
    machine.poke(at + READ, &[0; 4]);
}

/// Where the ring is, and how much the board has written since its start.
fn waiting(machine: &Machine, at: u32) -> (u32, usize) {
    let word = |place| machine.peek(at + place, 4).first_chunk().copied().map_or(0, u32::from_le_bytes);
    (word(28), word(36) as usize)
}

/// The lines contain these words in this order, one line each; others may come between.
fn contains(lines: &[String], words: &[&str]) -> Result<(), Failure> {
    let mut rest = lines.iter();
    match words.iter().find(|word| !rest.any(|line| line.contains(**word))) {
        None => Ok(()),
        Some(missing) => Err(Failure::wrong(format!("no `{missing}` in {lines:?}"))),
    }
}
