//! Cases of power cuts: whatever the flash is doing, the board comes back with a whole patch.
//!
//! A power cut forgets all but the flash. So each cut is made on a copy of the flash, at the moment
//! the operation is under way, and a board is booted from that copy; the upload goes on meanwhile, to the next
//! operation. That board goes on from a snapshot of where its firmware first reads the slot of the upload, since
//! nothing before depends on it: each of the first ones is also switched on, and must do the same to the nanosecond.

use super::{Case, Failure, ensure, patches};
use crate::{
    board::{START_TIME, VirtualBoard},
    chip::{
        FlashObserver,
        flash::{self, Flash},
        time::Time,
    },
    machine::Options,
    rig::{Capability, Rig, VirtualRig},
};
use dermatome::link;
use dermatome_shared::{limits::FLASH_SLOT_BYTES, patch::PatchView};
use rand::{SeedableRng, seq::index};
use rand_pcg::Pcg64;
use std::{
    num::NonZeroU64,
    ops::Range,
    sync::{
        Arc, Mutex, PoisonError,
        mpsc::{Receiver, SyncSender, sync_channel},
    },
};

/// Cuts in a full-size upload.
const SEEDED_CUTS: usize = 500;
/// Ways in which the commit record is left undone.
const COMMIT_CUTS: u64 = 40;
/// Boards that boot at the same time.
const WORKERS: usize = 2;
/// Flashes that wait for them.
const WAITING: usize = 8;
/// Flashes that each of them boots in both ways: from switching on, and from the snapshot.
const BOTH_WAYS: u64 = 3;
/// Where an upload goes that follows another: the second slot, which ends the flash.
const UPLOAD_SLOT: Range<u32> =
    flash::START + flash::BYTES - FLASH_SLOT_BYTES as u32..flash::START + flash::BYTES;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "power is cut at every flash operation of an upload, one after the other",
        needs: &[Capability::PowerCut, Capability::FlashSteps],
        run: every_operation,
    },
    Case {
        name: "power is cut at 500 operations of a full-size upload",
        needs: &[Capability::PowerCut, Capability::FlashSteps],
        run: seeded_operations,
    },
];

fn every_operation(rig: &Rig) -> Result<String, Failure> {
    let patches = [patches::large(36, 21), patches::large(36, 22)];
    ensure(patches[1].len() >= 8192, || format!("the patch has only {} bytes", patches[1].len()))?;
    let found = cut_upload(rig, &patches, |_| true)?;
    let operations = last_operation(&patches[1]);
    ensure(found.cuts == operations + COMMIT_CUTS, || format!("{} cuts of {operations}", found.cuts))?;
    ensure(found.new > 0, || "no cut came after the commit".to_owned())?;
    Ok(format!("{found} of {} bytes", patches[1].len()))
}

fn seeded_operations(rig: &Rig) -> Result<String, Failure> {
    let patches = full_size();
    let operations = last_operation(&patches[1]) as usize;
    let mut chosen: Vec<bool> = vec![false; operations];
    let mut random = Pcg64::seed_from_u64(25);
    for place in index::sample(&mut random, operations, SEEDED_CUTS - COMMIT_CUTS as usize) {
        chosen[place] = true;
    }
    let found = cut_upload(rig, &patches, move |operation| chosen.get(operation as usize) == Some(&true))?;
    Ok(format!("{found} of {} bytes", patches[1].len()))
}

/// Cuts the power at each `every`th operation of a full-size upload, and in all ways at its commit record.
pub fn cut_full_size(rig: &Rig, every: NonZeroU64) -> Result<Found, Failure> {
    let patches = full_size();
    let found = cut_upload(rig, &patches, move |operation| operation.is_multiple_of(every.get()))?;
    let expected = last_operation(&patches[1]).div_ceil(every.get()) + COMMIT_CUTS;
    ensure(found.cuts == expected, || format!("{} cuts, not {expected}", found.cuts))?;
    ensure(found.new > 0, || "no cut came after the commit".to_owned())?;
    Ok(found)
}

/// Two patches of 808 pixels and 104 measurements, as large as a board takes.
fn full_size() -> [Vec<u8>; 2] {
    [23, 24].map(|seed| patches::large(808, seed))
}

/// A flash at the moment of a cut.
struct Cut {
    operation: u64,
    seed: u64,
    flash: Flash,
}

/// Operations before the commit record's: the page of the record, each page and each double word of
/// the patch.
fn last_operation(patch: &[u8]) -> u64 {
    1 + patch.len().div_ceil(2048) as u64 + patch.len().div_ceil(8) as u64
}

/// What the boards that lost their power offered.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// Boards that were booted.
    pub cuts: u64,
    /// Those of them that have the old patch, whole.
    pub old: u64,
    /// Those that have the new one, whole.
    pub new: u64,
}

impl Found {
    fn add(&mut self, other: &Self) {
        self.cuts += other.cuts;
        self.old += other.old;
        self.new += other.new;
    }
}

impl std::fmt::Display for Found {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            formatter,
            "{} cuts: {} boards have the old patch, {} the new one, whole; upload",
            self.cuts, self.old, self.new
        )
    }
}

/// Uploads the second patch over the first, and boots a board from each chosen moment.
fn cut_upload(
    rig: &Rig,
    patches: &[Vec<u8>; 2],
    chosen: impl Fn(u64) -> bool + Send + 'static,
) -> Result<Found, Failure> {
    let VirtualRig { board, options, .. } = rig.emulated_rig();
    link::upload(&mut rig.link()?, &patches[0], |_| ())?;
    // A flash is half a megabyte: the upload waits where the workers do not keep up.
    let (send, receive) = sync_channel::<Cut>(WAITING);
    let first = board.with(|machine| machine.chip(|chip| chip.flash.operations()));
    watch(board, first, last_operation(&patches[1]), chosen, send);
    let crcs = [0, 1].map(|place| PatchView::validate(&patches[place]).map_or(0, |view| view.crc()));
    let receive = Arc::new(Mutex::new(receive));
    std::thread::scope(|scope| {
        let boot =
            |receive: Arc<Mutex<Receiver<Cut>>>| scope.spawn(move || boot_all(&receive, options, crcs));
        let workers: Vec<_> = (0..WORKERS).map(|_| boot(receive.clone())).collect();
        // Where all workers have failed, nobody waits for the flashes any more.
        drop(receive);
        let uploaded = rig
            .link()
            .map_err(Failure::from)
            .and_then(|mut link| link::upload(&mut link, &patches[1], |_| ()).map_err(Failure::from));
        // Ends the workers once they have emptied the channel.
        board.with(|machine| machine.chip(|chip| chip.flash_observer = FlashObserver::default()));
        let mut found = Found::default();
        for worker in workers {
            found.add(&worker.join().unwrap_or_else(|_| Err(Failure::wrong("a board crashed")))?);
        }
        uploaded.map(|_| found)
    })
}

fn watch(
    board: &VirtualBoard,
    first: u64,
    last: u64,
    chosen: impl Fn(u64) -> bool + Send + 'static,
    send: SyncSender<Cut>,
) {
    let flash_observer = FlashObserver::new(move |flash: &Flash| {
        let operation = flash.operations() - first - 1;
        // The commit record decides: its operation, the last, is cut in many ways.
        let ways = if operation == last { COMMIT_CUTS } else { u64::from(chosen(operation)) };
        for way in 0..ways {
            let seed = operation << 8 | way;
            let _ = send.send(Cut { operation, seed, flash: flash.clone() });
        }
    });
    board.with(move |machine| machine.chip(|chip| chip.flash_observer = flash_observer));
}

/// Boots a board from each flash that comes; the first ones in both ways.
fn boot_all(
    receive: &Mutex<Receiver<Cut>>,
    options: &Options,
    [old, new]: [u32; 2],
) -> Result<Found, Failure> {
    let (mut found, mut starts) = (Found::default(), None);
    loop {
        let next = receive.lock().unwrap_or_else(PoisonError::into_inner).recv();
        let Ok(Cut { operation, seed, mut flash }) = next else { return Ok(found) };
        let doing = flash.operation();
        flash.cut(options.seed << 32 ^ seed);
        let starts = match &mut starts {
            Some(starts) => starts,
            none => none.insert(Starts::new(&flash, options)?),
        };
        let offered =
            if found.cuts < BOTH_WAYS { starts.both_ways(flash)? } else { starts.offered(flash)?.0 };
        match offered {
            Some(crc) if crc == old => found.old += 1,
            Some(crc) if crc == new => found.new += 1,
            _ => {
                let what =
                    format!("after a cut at operation {operation} ({doing:x?}) it offers {offered:x?}");
                return Err(Failure::Wrong(what));
            }
        }
        found.cuts += 1;
    }
}

/// A board that starts again and again, each time from where it first reads the slot that the upload went to.
struct Starts {
    board: VirtualBoard,
    options: Options,
}

impl Starts {
    fn new(flash: &Flash, options: &Options) -> Result<Self, Failure> {
        let board = VirtualBoard::start(flash.clone(), options.clone())?;
        board.with(|machine| machine.run_before_read(UPLOAD_SLOT)).map_err(Failure::wrong)?;
        Ok(Self { board, options: options.clone() })
    }

    /// What a board offers that starts with this flash, and the hash of its trace.
    fn offered(&self, flash: Flash) -> Result<(Option<u32>, u64), Failure> {
        self.board.with(move |machine| machine.go_on_with(flash)).map_err(Failure::wrong)?;
        ask(&self.board)
    }

    /// The same of a board that is switched on: nothing may differ.
    fn both_ways(&self, flash: Flash) -> Result<Option<u32>, Failure> {
        let whole = ask(&VirtualBoard::start(flash.clone(), self.options.clone())?)?;
        let shortened = self.offered(flash)?;
        ensure(whole == shortened, || {
            format!("a whole start gives {whole:x?}, one from the snapshot {shortened:x?}")
        })?;
        Ok(whole.0)
    }
}

/// Lets a board start, and asks for its patch.
fn ask(board: &VirtualBoard) -> Result<(Option<u32>, u64), Failure> {
    let started = board.with(|machine| machine.run_until(Time::ZERO + START_TIME));
    started?;
    let offered = board.link()?.info()?.patch.map(|patch| patch.crc);
    Ok((offered, board.with(|machine| machine.chip(|chip| chip.trace.hash()))))
}
