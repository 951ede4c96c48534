//! Events of scans, in order, lost and mixed up; and the frames they make.

use super::*;
use dermatome_shared::frame::FrameFlags;
use proptest::{collection::vec, prelude::*, sample::Index};

const ALL: Selection =
    Selection { images: 1, contacts: 1, measurements: 1, health: 1, scope: 1, scope_slot: 0 };
const STAMPED: Selection = Selection { scope: 0, ..ALL };

fn at(sequence: u32) -> FrameStamp {
    FrameStamp { sequence, timestamp_us: u64::from(sequence) * 1000, flags: FrameFlags::default() }
}

/// What a board sends of a scan, in its order; each part says of which scan it is.
fn scan(selection: &Selection, sequence: u32) -> Vec<Event> {
    let at = at(sequence);
    let due = Parts::due(selection, sequence);
    let code = AdcCode(sequence as i32);
    let health = Health::default();
    let events = [
        (Parts::CONTACTS, Event::Contacts { at, contacts: Contacts::new() }),
        (
            Parts::HEALTH,
            Event::Health { at, health, vitals: Vitals::default(), drift: 0.0, missed: sequence },
        ),
        (
            Parts::MEASUREMENTS,
            Event::Measurements {
                at,
                codes: [code].into_iter().collect(),
                quadrature: [].into_iter().collect(),
            },
        ),
        (Parts::IMAGE, Event::Image { at, image: image(sequence) }),
        (Parts::SCOPE, Event::Scope(SlotSamples { slot: sequence as u16, ..SlotSamples::default() })),
    ];
    events.into_iter().filter(|(part, _)| due.contains(*part)).map(|(_, event)| event).collect()
}

fn image(sequence: u32) -> PackedImage {
    PackedImage { exponent: 3, mantissas: [sequence as i16].into_iter().collect() }
}

/// Events of scans one after another, each with its number.
fn stream(selection: &Selection, sequences: impl Iterator<Item = u32>) -> Vec<(u32, Event)> {
    (100..).zip(sequences.flat_map(|sequence| scan(selection, sequence))).collect()
}

fn assembled(selection: Selection, first: u32, events: &[(u32, Event)]) -> (Vec<ScanFrame>, Totals) {
    let mut assembler = Assembler::new(selection, first);
    let mut frames = Vec::new();
    for (number, event) in events {
        assembler.take(*number, event.clone());
        frames.extend(std::iter::from_fn(|| assembler.pop()));
    }
    assembler.finish();
    frames.extend(std::iter::from_fn(|| assembler.pop()));
    (frames, assembler.totals())
}

/// Whether each part of a frame is of the frame's scan.
fn is_of_one_scan(frame: &ScanFrame) -> bool {
    let Some(FrameStamp { sequence, .. }) = frame.at else { return true };
    let codes = frame.measurements.as_ref().map(|measurements| measurements.codes[0].0 as u16);
    let images = frame.image.as_ref().map(|image| image.mantissas[0] as u16);
    let health = frame.health.as_ref().map(|report| report.missed as u16);
    let scope = frame.scope.as_ref().map(|samples| samples.slot);
    [codes, images, health, scope].into_iter().flatten().all(|of| of == sequence as u16)
}

fn sequences(frames: &[ScanFrame]) -> Vec<u32> {
    frames.iter().filter_map(|frame| frame.at).map(|at| at.sequence).collect()
}

#[test]
fn whole_scans_are_frames_as_soon_as_their_last_part_is_there() {
    let mut assembler = Assembler::new(ALL, 7);
    let events = stream(&ALL, 7..9);
    for (index, (number, event)) in events.into_iter().enumerate() {
        assembler.take(number, event);
        let frame = assembler.pop();
        assert_eq!(frame.is_some(), index % 5 == 4, "{index}");
        if let Some(frame) = frame {
            assert!(frame.missing.is_empty() && frame.parts().count() == 5 && is_of_one_scan(&frame));
            assert_eq!(frame.at, Some(at(7 + index as u32 / 5)));
        }
    }
    assert_eq!(assembler.totals(), Totals { frames: 2, ..Totals::default() });
}

#[test]
fn a_lost_part_is_missing_once_the_next_scan_begins() {
    let mut events = stream(&STAMPED, 0..3);
    events.remove(3);
    let (frames, totals) = assembled(STAMPED, 0, &events);
    assert_eq!(sequences(&frames), [0, 1, 2]);
    assert_eq!((frames[0].missing, frames[0].image.is_some()), (Parts::IMAGE, false));
    assert_eq!(totals, Totals { frames: 3, incomplete: 1, parts_missing: 1, ..Totals::default() });
}

#[test]
fn scans_of_which_nothing_came_are_counted_from_the_first_one_on_and_across_the_wrap() {
    let contacts = Selection { contacts: 1, ..Selection::default() };
    let events = stream(&contacts, [u32::MAX - 1, u32::MAX, 2].into_iter());
    let (frames, totals) = assembled(contacts, u32::MAX - 3, &events);
    assert_eq!((frames.len(), totals.frames_missing), (3, 2 + 2));
}

#[test]
fn each_part_is_due_as_often_as_it_was_selected() {
    let selection = Selection { images: 4, contacts: 1, measurements: 2, ..Selection::default() };
    let (frames, totals) = assembled(selection, 0, &stream(&selection, 0..9));
    let counts: Vec<u32> = frames.iter().map(|frame| frame.parts().count()).collect();
    assert_eq!(counts, [3, 1, 2, 1, 3, 1, 2, 1, 3]);
    assert_eq!(totals, Totals { frames: 9, ..Totals::default() });
    let rare = Selection { images: 10, health: 15, ..Selection::default() };
    let events = stream(&rare, [0, 60].into_iter());
    let (frames, totals) = assembled(rare, 0, &events);
    // 10, 15, 20, 30, 40, 45 and 50 did not come.
    assert_eq!((frames.len(), totals.frames_missing), (2, 7));
}

#[test]
fn samples_alone_are_frames_that_do_not_say_of_which_scan_they_are() {
    let scope = Selection { scope: 2, ..Selection::default() };
    let (frames, totals) = assembled(scope, 1, &stream(&scope, 1..6));
    assert_eq!((frames.len(), frames[0].at, totals.frames), (2, None, 2));
    assert_eq!(frames[1].scope.as_ref().map(|samples| samples.slot), Some(4));
}

#[test]
fn samples_do_not_join_a_scan_that_they_may_not_belong_to() {
    let selection = Selection { contacts: 1, scope: 1, ..Selection::default() };
    let mut events = stream(&selection, 0..3);
    // The samples of scan 0 and the contacts of scan 1.
    events.drain(1..3);
    let (frames, totals) = assembled(selection, 0, &events);
    assert_eq!(frames.iter().map(|frame| frame.parts().count()).collect::<Vec<_>>(), [1, 1, 2]);
    assert_eq!((frames[0].missing, frames[1].at), (Parts::SCOPE, None));
    assert_eq!((totals.incomplete, totals.frames_missing), (1, 1));
}

#[test]
fn a_board_that_starts_anew_is_followed_and_nothing_counts_as_missing() {
    let mut events = stream(&STAMPED, 5000..5002);
    events.extend(stream(&STAMPED, 0..2));
    let (frames, totals) = assembled(STAMPED, 5000, &events);
    assert_eq!(sequences(&frames), [5000, 5001, 0, 1]);
    assert_eq!(totals, Totals { frames: 4, ..Totals::default() });
}

#[test]
fn what_comes_of_an_earlier_stream_is_not_used_and_a_tare_is_counted() {
    let mut events = stream(&STAMPED, 10..12);
    events.insert(0, (99, Event::Tared { frames: 20 }));
    let (frames, totals) = assembled(STAMPED, 11, &events);
    assert_eq!(sequences(&frames), [11]);
    assert_eq!(totals, Totals { frames: 1, parts_unused: 4, tares: 1, ..Totals::default() });
}

/// Periods of a selection: often none or each frame, sometimes every few.
fn selection() -> impl Strategy<Value = Selection> {
    let every = || prop_oneof![Just(0_u16), Just(1), 2_u16..5];
    (every(), every(), every(), every(), every()).prop_map(
        |(images, contacts, measurements, health, scope)| Selection {
            images,
            contacts,
            measurements,
            health,
            scope,
            scope_slot: 0,
        },
    )
}

/// The parts of some frames.
fn parts(frames: &[ScanFrame]) -> u64 {
    frames.iter().map(|frame| u64::from(frame.parts().count())).sum()
}

proptest! {
    /// On a link, which keeps the order.
    #[test]
    fn whatever_is_lost_what_comes_is_in_one_frame_and_what_does_not_is_counted(
        selection in selection(),
        first in prop_oneof![Just(0_u32), any::<u32>()],
        scans in 1_u32..20,
        lost in vec(any::<Index>(), 0..40),
    ) {
        let whole = stream(&selection, (0..scans).map(|scan| first.wrapping_add(scan)));
        let is_lost = |index: usize| lost.iter().any(|lost| lost.index(whole.len()) == index);
        let came = whole.iter().enumerate().filter(|(index, _)| !is_lost(*index)).map(|(_, event)| event.clone());
        let came: Vec<_> = if whole.is_empty() { Vec::new() } else { came.collect() };
        let (frames, totals) = assembled(selection, first, &came);
        prop_assert!(frames.iter().all(is_of_one_scan));
        prop_assert_eq!((totals.parts_unused, parts(&frames)), (0, came.len() as u64));
        let stamped = sequences(&frames);
        prop_assert!(stamped.windows(2).all(|pair| pair[1].wrapping_sub(pair[0]) < scans));
        for frame in &frames {
            if let Some(at) = frame.at {
                let (due, there) = (Parts::due(&selection, at.sequence), frame.parts());
                prop_assert_eq!(there.count() + frame.missing.count(), due.count());
                prop_assert!(due.contains(there) && due.contains(frame.missing));
            }
        }
        let missing: u32 = frames.iter().map(|frame| frame.missing.count()).sum();
        let incomplete = frames.iter().filter(|frame| !frame.missing.is_empty()).count();
        prop_assert_eq!((totals.parts_missing, totals.incomplete), (missing.into(), incomplete as u64));
        // Scans before the last one that came, of which nothing with a stamp did.
        if let Some(last) = stamped.last() {
            let before = (0..last.wrapping_sub(first)).map(|ahead| first.wrapping_add(ahead));
            let gone = before.filter(|sequence| {
                let due = Parts::due(&selection, *sequence);
                due.is_stamped() && !stamped.contains(sequence)
            });
            prop_assert_eq!(totals.frames_missing, gone.count() as u64);
        }
        if came.len() == whole.len() {
            prop_assert_eq!((totals.parts_missing, totals.frames_missing), (0, 0));
        }
    }

    /// Beyond what a link does.
    #[test]
    fn however_parts_are_mixed_up_none_is_used_twice_or_forgotten(
        selection in selection(),
        scans in 1_u32..12,
        swaps in vec((any::<Index>(), any::<Index>()), 0..30),
        twice in vec(any::<Index>(), 0..5),
    ) {
        let mut events = stream(&selection, 0..scans);
        if !events.is_empty() {
            for index in twice {
                events.push(events[index.index(events.len())].clone());
            }
            for (a, b) in swaps {
                let count = events.len();
                events.swap(a.index(count), b.index(count));
            }
        }
        let (frames, totals) = assembled(selection, 0, &events);
        prop_assert!(frames.iter().filter(|frame| frame.scope.is_none()).all(is_of_one_scan));
        prop_assert_eq!(parts(&frames) + totals.parts_unused, events.len() as u64);
        let mut stamped = sequences(&frames);
        stamped.dedup();
        prop_assert_eq!(&stamped, &sequences(&frames));
        prop_assert!(stamped.is_sorted());
        prop_assert_eq!(totals.frames, frames.len() as u64);
    }

    /// Of each scan, its parts in any order: the frame is whole.
    #[test]
    fn the_order_of_a_scans_parts_does_not_matter(order in Just([0, 1, 2, 3]).prop_shuffle()) {
        let scans = (0..4).flat_map(|sequence| {
            let parts = scan(&STAMPED, sequence);
            order.map(|index| parts[index].clone())
        });
        let events: Vec<_> = (0..).zip(scans).collect();
        let (frames, totals) = assembled(STAMPED, 0, &events);
        prop_assert_eq!(sequences(&frames), [0, 1, 2, 3]);
        prop_assert_eq!(totals, Totals { frames: 4, ..Totals::default() });
    }
}
