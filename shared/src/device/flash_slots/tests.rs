use super::{
    nor::{Cut, Nor},
    *,
};
use crate::patch::{Difference, tests::small_patch};
use proptest::prelude::*;
use std::vec::Vec;

const TEST_SLOT: usize = 3 * PAGE_BYTES;

/// The small patch, made longer than a page by its matrix, and told from others by `seed`.
fn patch(pixels_across: u8, seed: i16) -> Vec<u8> {
    patch::tests::patch_of_pixels(pixels_across, seed)
}

fn open(nor: Nor) -> FlashSlotStore<Nor> {
    FlashSlotStore::open(nor)
}

fn write(store: &mut FlashSlotStore<Nor>, bytes: &[u8], piece: usize) -> Result<(), StoreError> {
    store.begin(bytes.len())?;
    for piece in bytes.chunks(piece) {
        store.append(piece)?;
        store.settle();
    }
    store.commit()
}

fn store_with(bytes: &[u8]) -> FlashSlotStore<Nor> {
    let mut store = open(Nor::new(TEST_SLOT, 1));
    write(&mut store, bytes, 512).unwrap();
    store
}

#[test]
fn a_flash_that_holds_anything_holds_no_patch() {
    for seed in 0..if cfg!(miri) { 3 } else { 100 } {
        assert_eq!(open(Nor::new(TEST_SLOT, seed)).active(), None);
    }
}

#[test]
fn a_patch_outlives_a_reboot_and_the_next_one_replaces_it() {
    let (old, new) = (patch(6, 1), patch(7, 2));
    let store = store_with(&old);
    let mut store = open(store.flash.reboot());
    assert!(store.active() == Some(&old[..]));
    for bytes in [&new, &old, &old, &new] {
        write(&mut store, bytes, 512).unwrap();
        assert!(store.active() == Some(&bytes[..]));
        store = open(store.flash.reboot());
        assert!(store.active() == Some(&bytes[..]));
    }
}

#[test]
fn pieces_of_any_length_and_no_settling_give_the_same_patch() {
    let bytes = patch(7, 3);
    for piece in [1, 3, 7, 8, 13, 500, 512] {
        let mut store = open(Nor::new(TEST_SLOT, 1));
        store.begin(bytes.len()).unwrap();
        bytes.chunks(piece).for_each(|piece| store.append(piece).unwrap());
        store.commit().unwrap();
        assert!(store.active() == Some(&bytes[..]), "{piece}");
    }
}

#[test]
fn a_patch_may_fill_the_slot_up_to_its_record() {
    let mut store = store_with(&patch(6, 1));
    assert_eq!(store.begin(TEST_SLOT - RECORD_BYTES + 1), Err(StoreError::Failed));
    store.begin(TEST_SLOT - RECORD_BYTES).unwrap();
    let filling: Vec<u8> = (0..TEST_SLOT - RECORD_BYTES).map(|i| i as u8).collect();
    filling.chunks(512).for_each(|piece| store.append(piece).unwrap());
    store.settle();
    assert!(store.staged() == filling);
    assert_eq!(store.append(&[0]), Err(StoreError::Failed), "longer than announced");
    assert_eq!(store.commit(), Err(StoreError::Failed), "not a patch");
    assert!(store.active() == Some(&patch(6, 1)[..]));
}

#[test]
fn a_page_is_erased_once_and_only_when_it_is_needed() {
    let bytes = patch(6, 1);
    let store = store_with(&bytes);
    let pages = bytes.len().div_ceil(PAGE_BYTES);
    assert!(pages < TEST_SLOT / PAGE_BYTES, "this patch leaves the record a page of its own");
    assert_eq!(store.flash.operations, pages + 1 + bytes.len().div_ceil(WORD_BYTES) + 1);
}

#[test]
fn a_patch_that_rots_gives_way_to_the_one_before() {
    let (old, new) = (patch(6, 1), patch(7, 2));
    let mut store = store_with(&old);
    write(&mut store, &new, 512).unwrap();
    let mut nor = store.flash.reboot();
    nor.flip(1, 1000);
    let mut store = open(nor);
    assert!(store.active() == Some(&old[..]));
    write(&mut store, &new, 512).unwrap();
    assert!(open(store.flash.reboot()).active() == Some(&new[..]));
}

#[test]
fn sequences_wrap_and_skip_the_one_that_erased_flash_reads() {
    let first = patch(6, 1);
    let mut store = open(Nor::new(TEST_SLOT, 1));
    store.begin(first.len()).unwrap();
    first.chunks(512).for_each(|piece| store.append(piece).unwrap());
    store.settle();
    let late = record(u32::MAX - 2, PatchView::open(&first).unwrap().crc());
    store.flash.program(0, TEST_SLOT - RECORD_BYTES, late).unwrap();
    store = open(store.flash.reboot());
    for seed in 2..6 {
        write(&mut store, &patch(6, seed), 512).unwrap();
        store = open(store.flash.reboot());
        assert!(store.active() == Some(&patch(6, seed)[..]), "{seed}");
    }
    assert_eq!(store.active.unwrap().sequence, 2);
}

/// Tries a power cut in each operation of an upload; gives the number of cuts.
fn cut_everywhere(before: &FlashSlotStore<Nor>, old: Option<&[u8]>, new: &[u8]) -> usize {
    let mut complete = open(before.flash.clone().reboot());
    write(&mut complete, new, 512).unwrap();
    let operations = complete.flash.operations;
    for at in 0..operations {
        for reached in [Cut::Before, Cut::Amid, Cut::After] {
            let mut nor = before.flash.clone().reboot();
            nor.cut = Some((at, reached));
            let mut store = open(nor);
            assert!(write(&mut store, new, 512).is_err());
            assert!(store.active() == old, "a board that goes on with failing flash keeps its patch");
            let mut store = open(store.flash.reboot());
            let is_last = at + 1 == operations && reached == Cut::After;
            assert!(store.active() == if is_last { Some(new) } else { old }, "cut {reached:?} {at}");
            write(&mut store, new, 512).unwrap();
            assert!(open(store.flash.reboot()).active() == Some(new), "upload after cut {reached:?} {at}");
        }
    }
    3 * operations
}

#[test]
#[cfg_attr(miri, ignore = "5,000 power cuts take Miri hours")]
fn power_fails_in_each_operation_of_an_upload() {
    let (old, new) = (patch(6, 1), patch(7, 2));
    let empty = open(Nor::new(TEST_SLOT, 5));
    let one = store_with(&old);
    let mut two = store_with(&new);
    write(&mut two, &old, 512).unwrap();
    let mut cuts = cut_everywhere(&empty, None, &new);
    cuts += cut_everywhere(&one, Some(&old), &new);
    cuts += cut_everywhere(&two, Some(&old), &new);
    cuts += cut_everywhere(&one, Some(&old), &old);
    let tiny = small_patch(Difference::Plain);
    cuts += cut_everywhere(&one, Some(&old), &tiny);
    std::println!("{cuts} power cuts");
    assert!(cuts > 5000, "{cuts}");
}

fn trim_of(gain: usize) -> Trim {
    let mut trim = Trim::NONE;
    trim.multiply(3, gain, [1.1, -0.1]);
    trim
}

#[test]
fn a_trim_outlives_reboots_and_patches_and_the_next_one_replaces_it() {
    let mut store = open(Nor::new(TEST_SLOT, 1));
    assert_eq!(store.trim(), None);
    for gain in [0, 1, 2, 2, 6] {
        store.keep_trim(&trim_of(gain)).unwrap();
        assert_eq!(store.trim(), Some(trim_of(gain)));
        write(&mut store, &patch(6, gain as i16), 512).unwrap();
        store = open(store.flash.reboot());
        assert_eq!(store.trim(), Some(trim_of(gain)));
    }
}

#[test]
fn power_fails_in_each_operation_of_a_trim() {
    let mut before = store_with(&patch(6, 1));
    for kept in [None, Some(trim_of(1)), Some(trim_of(2))] {
        kept.iter().for_each(|trim| before.keep_trim(trim).unwrap());
        let operations = 1 + 5 * 7 + 1;
        for at in 0..operations {
            for reached in [Cut::Before, Cut::Amid, Cut::After] {
                let mut nor = before.flash.clone().reboot();
                nor.cut = Some((at, reached));
                let mut store = open(nor);
                assert!(store.keep_trim(&trim_of(3)).is_err());
                assert_eq!(store.trim(), kept);
                let mut store = open(store.flash.reboot());
                let is_last = at + 1 == operations && reached == Cut::After;
                assert_eq!(store.trim(), if is_last { Some(trim_of(3)) } else { kept }, "{reached:?} {at}");
                store.keep_trim(&trim_of(4)).unwrap();
                assert_eq!(open(store.flash.reboot()).trim(), Some(trim_of(4)), "{reached:?} {at}");
            }
        }
    }
}

#[test]
fn a_trim_that_rots_gives_way_to_the_one_before() {
    let mut store = open(Nor::new(TEST_SLOT, 1));
    store.keep_trim(&trim_of(1)).unwrap();
    store.keep_trim(&trim_of(2)).unwrap();
    for place in [0, 100, 279, PAGE_BYTES - 8, PAGE_BYTES - 1] {
        let mut nor = store.flash.clone().reboot();
        nor.flip(3, place);
        assert_eq!(open(nor).trim(), Some(trim_of(1)), "{place}");
    }
}

#[test]
fn a_trim_that_is_programmed_wrong_does_not_count_now_or_later() {
    let mut before = open(Nor::new(TEST_SLOT, 1));
    before.keep_trim(&trim_of(1)).unwrap();
    for operation in 1..1 + 5 * 7 + 1 {
        let mut nor = before.flash.clone().reboot();
        nor.wrong = Some(operation);
        let mut store = open(nor);
        assert!(store.keep_trim(&trim_of(2)).is_err(), "{operation}");
        assert_eq!(store.trim(), Some(trim_of(1)), "{operation}");
        assert_eq!(open(store.flash.reboot()).trim(), Some(trim_of(1)), "{operation}");
    }
}

#[derive(Clone, Debug)]
enum Deed {
    Begin { patch: usize },
    Append { length: usize },
    Settle,
    Commit,
    CutWithin { operations: usize },
    Reboot,
}

fn deeds() -> impl Strategy<Value = Vec<Deed>> {
    let deed = prop_oneof![
        2 => (0_usize..3).prop_map(|patch| Deed::Begin { patch }),
        12 => (1_usize..=512).prop_map(|length| Deed::Append { length }),
        4 => Just(Deed::Settle),
        2 => Just(Deed::Commit),
        1 => (0_usize..400).prop_map(|operations| Deed::CutWithin { operations }),
        1 => Just(Deed::Reboot),
    ];
    prop::collection::vec(deed, 1..80)
}

proptest! {
    #[test]
    fn whatever_comes_in_between_the_last_committed_patch_stays(deeds in deeds(), seed in any::<u64>()) {
        let patches = [patch(5, 1), patch(6, 2), small_patch(Difference::Plain)];
        let mut store = open(Nor::new(TEST_SLOT, seed));
        let (mut sending, mut sent) = (&patches[0], 0);
        // What the store must hold, and what it may hold as well since a commit was cut.
        let (mut held, mut perhaps): (Option<&Vec<u8>>, Option<&Vec<u8>>) = (None, None);
        for deed in deeds {
            match deed {
                Deed::Begin { patch } => {
                    (sending, sent) = (&patches[patch], 0);
                    let _ = store.begin(sending.len());
                }
                Deed::Append { length } => {
                    let end = (sent + length).min(sending.len());
                    if store.append(&sending[sent..end]).is_ok() {
                        sent = end;
                    }
                }
                Deed::Settle => store.settle(),
                Deed::Commit => match store.commit() {
                    Ok(()) => (held, perhaps) = (Some(sending), None),
                    Err(_) => perhaps = Some(sending),
                },
                Deed::CutWithin { operations } => {
                    store.flash.cut = Some((store.flash.operations + operations, Cut::Amid));
                }
                Deed::Reboot => {
                    store = open(store.flash.reboot());
                    if perhaps.is_some_and(|patch| store.active() == Some(patch)) {
                        held = perhaps;
                    }
                    perhaps = None;
                }
            }
            prop_assert!(store.active() == held.map(|patch| &patch[..]));
        }
    }
}
