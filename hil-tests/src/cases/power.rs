//! Cases of power cuts: whatever the flash is doing, the board comes back with a whole patch.
//!
//! A power cut forgets all but the flash. So each cut is made on a copy of the flash, at the moment
//! the operation is under way, and a board of its own is booted from that copy; the upload goes on
//! meanwhile, to the next operation.

use super::{Case, Failure, ensure, patches};
use crate::{
    board::VirtualBoard,
    chip::{FlashObserver, flash::Flash},
    machine::Options,
    rig::{Capability, Rig, START_TIME, VirtualRig},
};
use dermatome::link::{self, Link};
use dermatome_shared::patch::PatchView;
use rand::{SeedableRng, seq::index};
use rand_pcg::Pcg64;
use std::sync::{
    Arc, Mutex, PoisonError,
    mpsc::{Receiver, Sender, channel},
};

/// Cuts in a full-size upload.
const SEEDED_CUTS: usize = 500;
/// Ways in which the commit record is left undone.
const COMMIT_CUTS: u64 = 40;
/// Boards that boot at the same time.
const WORKERS: usize = 2;

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
    let patches = [patches::patch(36, true, 21), patches::patch(36, true, 22)];
    ensure(patches[1].len() >= 8192, || format!("the patch has only {} bytes", patches[1].len()))?;
    let found = cut_upload(rig, &patches, |_| true)?;
    let operations = last_operation(&patches[1]);
    ensure(found.cuts == operations + COMMIT_CUTS, || format!("{} cuts of {operations}", found.cuts))?;
    ensure(found.new > 0, || "no cut came after the commit".to_owned())?;
    Ok(format!("{found} of {} bytes", patches[1].len()))
}

fn seeded_operations(rig: &Rig) -> Result<String, Failure> {
    let patches = [patches::patch(812, true, 23), patches::patch(812, true, 24)];
    let operations = last_operation(&patches[1]) as usize;
    let mut chosen: Vec<bool> = vec![false; operations];
    let mut random = Pcg64::seed_from_u64(25);
    for place in index::sample(&mut random, operations, SEEDED_CUTS - COMMIT_CUTS as usize) {
        chosen[place] = true;
    }
    let found = cut_upload(rig, &patches, move |operation| chosen.get(operation as usize) == Some(&true))?;
    Ok(format!("{found} of {} bytes", patches[1].len()))
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
struct Found {
    cuts: u64,
    old: u64,
    new: u64,
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
    let (send, receive) = channel::<Cut>();
    let first = board.with(|machine| machine.chip(|chip| chip.flash.operations()));
    watch(board, first, last_operation(&patches[1]), chosen, send);
    let crcs = [0, 1].map(|place| PatchView::validate(&patches[place]).map_or(0, |view| view.crc()));
    let receive = Arc::new(Mutex::new(receive));
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..WORKERS)
            .map(|_| {
                let receive = receive.clone();
                scope.spawn(move || boot_all(&receive, options, crcs))
            })
            .collect();
        let uploaded = rig
            .link()
            .map_err(Failure::from)
            .and_then(|mut link| link::upload(&mut link, &patches[1], |_| ()).map_err(Failure::from));
        // Ends the workers once they have emptied the channel.
        board.with(|machine| machine.chip(|chip| chip.flash_observer = None));
        let mut found = Found::default();
        for worker in workers {
            let part = worker.join().unwrap_or_else(|_| Err(Failure::wrong("a board crashed")))?;
            found.cuts += part.cuts;
            found.old += part.old;
            found.new += part.new;
        }
        uploaded.map(|_| found)
    })
}

fn watch(
    board: &VirtualBoard,
    first: u64,
    last: u64,
    chosen: impl Fn(u64) -> bool + Send + 'static,
    send: Sender<Cut>,
) {
    let flash_observer = FlashObserver(Box::new(move |flash: &Flash| {
        let operation = flash.operations() - first - 1;
        // The commit record decides: its operation, the last, is cut in many ways.
        let ways = if operation == last { COMMIT_CUTS } else { u64::from(chosen(operation)) };
        for way in 0..ways {
            let seed = operation << 8 | way;
            let _ = send.send(Cut { operation, seed, flash: flash.clone() });
        }
    }));
    board.with(move |machine| machine.chip(|chip| chip.flash_observer = Some(flash_observer)));
}

fn boot_all(
    receive: &Mutex<Receiver<Cut>>,
    options: &Options,
    [old, new]: [u32; 2],
) -> Result<Found, Failure> {
    let mut found = Found::default();
    loop {
        let next = receive.lock().unwrap_or_else(PoisonError::into_inner).recv();
        let Ok(Cut { operation, seed, mut flash }) = next else { return Ok(found) };
        let doing = flash.operation();
        flash.cut(options.seed << 32 ^ seed);
        let board = VirtualBoard::start(flash, options.clone())?;
        board.run(START_TIME)?;
        let offered = Link::connect("virtual", board.line())?.info()?.patch.map(|patch| patch.crc);
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
