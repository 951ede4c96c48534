use super::*;
use crate::chip::tests::bus::Bus;

const PLACE: u32 = START + 200 * PAGE;

fn unlocked() -> Bus<Flash> {
    let mut bus = Bus::new(Flash::default());
    bus.write("KEYR", 0x4567_0123);
    bus.write("KEYR", 0xCDEF_89AB);
    bus
}

fn store(bus: &mut Bus<Flash>, address: u32, size: u32, value: u32) {
    let at = bus.moment();
    bus.model.write_word(address, size, value, at).unwrap();
}

fn program(bus: &mut Bus<Flash>, address: u32, value: u64) {
    bus.fields("CR", &[("PG", 1)]);
    store(bus, address, 4, value as u32);
    store(bus, address + 4, 4, (value >> 32) as u32);
}

fn erase(bus: &mut Bus<Flash>, bank: u32, page: u32) {
    bus.fields("CR", &[("PER", 1), ("BKER", bank), ("PNB", page), ("STRT", 1)]);
}

fn errors(bus: &mut Bus<Flash>) -> Vec<&'static str> {
    let all = ["PROGERR", "WRPERR", "PGAERR", "SIZERR", "PGSERR"];
    all.into_iter().filter(|flag| bus.get("SR", flag) == 1).collect()
}

#[test]
fn two_keys_in_order_unlock_it_and_a_wrong_one_does_not() {
    let mut bus = Bus::new(Flash::default());
    assert!(bus.refused("CR", 1).contains("locked"));
    bus.write("KEYR", 0x4567_0123);
    assert!(bus.refused("KEYR", 0x4567_0123).contains("wrong key"));
    let mut bus = unlocked();
    assert_eq!(bus.get("CR", "LOCK"), 0);
    bus.fields("CR", &[("LOCK", 1)]);
    assert!(bus.refused("CR", 1).contains("locked"));
}

#[test]
fn a_double_word_takes_82_us_and_a_page_22_ms_and_busy_says_so() {
    let mut bus = unlocked();
    program(&mut bus, PLACE, 0x0123_4567_89AB_CDEF);
    assert_eq!(bus.model.operation(), Some(Operation::Program(PLACE, 0x0123_4567_89AB_CDEF)));
    bus.pass(PROGRAM_TIME - Time::period(1_000_000_000));
    assert_eq!(bus.get("SR", "BSY"), 1);
    assert!(bus.refused("CR", 0).contains("BSY"));
    let at = bus.moment();
    assert!(bus.model.write_word(PLACE + 8, 4, 0, at).is_err());
    bus.pass(Time::period(1_000_000_000));
    assert_eq!(bus.get("SR", "BSY"), 0);
    let start = (PLACE - START) as usize;
    assert_eq!(bus.model.content()[start..start + 8], 0x0123_4567_89AB_CDEF_u64.to_le_bytes());
    bus.fields("CR", &[("PG", 0)]);
    erase(&mut bus, 0, 0);
    bus.pass(Time::from_micros(22_019));
    assert_eq!(bus.get("SR", "BSY"), 1);
    bus.pass(Time::from_micros(1));
    assert_eq!(bus.get("SR", "BSY"), 0);
    assert_eq!(bus.model.operations(), 2);
}

#[test]
fn a_store_without_pg_is_a_sequence_error() {
    let mut bus = unlocked();
    store(&mut bus, PLACE, 4, 0);
    assert_eq!(errors(&mut bus), ["PGSERR"]);
    assert_eq!(bus.model.operation(), None);
    let status = bus.read("SR");
    bus.write("SR", status);
    assert_eq!(errors(&mut bus), [""; 0]);
}

#[test]
fn only_erased_double_words_are_programmed_but_zeros_go_over_anything() {
    let mut bus = unlocked();
    program(&mut bus, PLACE, 0x1111);
    bus.pass(PROGRAM_TIME);
    program(&mut bus, PLACE, 0x0111);
    assert_eq!(errors(&mut bus), ["PROGERR"]);
    program(&mut bus, PLACE + 8, 0x0111);
    assert_eq!(errors(&mut bus), ["PROGERR", "PGSERR"], "errors have to be cleared first (SR.PGSERR)");
    bus.write("SR", 0xC3FA);
    program(&mut bus, PLACE, 0);
    bus.pass(PROGRAM_TIME);
    assert_eq!(bus.model.double_word(PLACE), 0);
}

#[test]
fn words_that_make_no_double_word_and_stores_of_other_sizes_are_errors() {
    for (first, second, size, error) in
        [(PLACE, PLACE + 8, 4, "PGAERR"), (PLACE + 4, PLACE, 4, "PGAERR"), (PLACE, PLACE + 4, 2, "SIZERR")]
    {
        let mut bus = unlocked();
        bus.fields("CR", &[("PG", 1)]);
        store(&mut bus, first, size, 0);
        store(&mut bus, second, size, 0);
        assert!(errors(&mut bus).contains(&error), "{first:#x} {second:#x} {size}");
        assert_eq!(bus.model.operations(), 0);
    }
}

#[test]
fn bker_chooses_the_bank_whose_page_is_erased() {
    for bank in [0, 1] {
        let mut bus = unlocked();
        bus.model.load(START, &vec![0xA5; BYTES as usize]);
        erase(&mut bus, bank, 5);
        let first = (bank * 128 + 5) * PAGE;
        assert_eq!(bus.model.operation(), Some(Operation::Erase(START + first)));
        let (from, to, until) = bus.model.stalled_code().unwrap();
        assert_eq!((from, to, until), (START + bank * BANK, START + (bank + 1) * BANK - 1, ERASE_TIME));
        bus.pass(ERASE_TIME);
        let erased = first as usize..(first + PAGE) as usize;
        for (place, &byte) in bus.model.content().iter().enumerate() {
            assert_eq!(byte == 0xFF, erased.contains(&place), "{place:#x}");
        }
    }
}

/// Old, new, or an ECC error, which is told from the former two by reading.
fn states_after_cut(bus: &mut Bus<Flash>, address: u32, old: u64, new: u64) -> usize {
    if bus.model.damaged().contains(&address) {
        return 2;
    }
    let found = bus.model.double_word(address);
    assert!(found == old || found == new, "{address:#x}: {found:#x}");
    usize::from(found == new)
}

#[test]
fn power_fails_while_a_double_word_is_programmed() {
    let mut seen = [0; 3];
    for seed in 0..300 {
        let mut bus = unlocked();
        program(&mut bus, PLACE, 0x5555_AAAA_0F0F_1234);
        bus.pass(Time::from_micros(40));
        bus.model.cut(seed);
        seen[states_after_cut(&mut bus, PLACE, u64::MAX, 0x5555_AAAA_0F0F_1234)] += 1;
        let others = bus.model.content().iter().enumerate();
        let mut changed = others.filter(|&(_, &byte)| byte != 0xFF).map(|(place, _)| place as u32 + START);
        assert!(changed.all(|address| (PLACE..PLACE + 8).contains(&address)), "seed {seed}");
        assert_eq!(bus.get("CR", "LOCK"), 1);
    }
    assert!(seen.iter().all(|&count| count > 30), "old, new, ECC error: {seen:?}");
}

#[test]
fn power_fails_while_a_page_is_erased() {
    let mut seen = [0; 3];
    for seed in 0..20 {
        let mut bus = unlocked();
        bus.model.load(START, &vec![0x3C; BYTES as usize]);
        erase(&mut bus, 1, 44);
        bus.pass(Time::from_millis(11));
        bus.model.cut(seed);
        let page = START + BANK + 44 * PAGE;
        for address in (START..START + BYTES).step_by(8) {
            let old = 0x3C3C_3C3C_3C3C_3C3C;
            let state = states_after_cut(&mut bus, address, old, u64::MAX);
            if (page..page + PAGE).contains(&address) {
                seen[state] += 1;
            } else {
                assert_eq!(state, 0, "{address:#x}, seed {seed}");
            }
        }
    }
    assert!(seen.iter().all(|&count| count > 500), "old, erased, ECC error: {seen:?}");
}

/// FLASH_ECCR: two wrong bits set ECCD, ADDR_ECC and BK_ECC and raise NMI.
#[test]
fn an_ecc_error_is_told_by_eccd_and_nmi_until_it_is_cleared() {
    let mut bus = unlocked();
    program(&mut bus, PLACE, 0x5555);
    let seed = (0..).find(|&seed| {
        let mut copy = bus.model.clone();
        copy.cut(seed);
        !copy.damaged().is_empty()
    });
    bus.model.cut(seed.unwrap());
    assert!(!bus.model.check_read(PLACE - 4, 4));
    assert!(!bus.model.raises_nmi());
    assert!(bus.model.check_read(PLACE + 6, 2));
    assert!(bus.model.raises_nmi());
    assert_eq!((bus.get("ECCR", "ECCD"), bus.get("ECCR", "BK_ECC")), (1, 1));
    assert_eq!(bus.get("ECCR", "ADDR_ECC"), (PLACE - START - BANK) / 8);
    bus.write("ECCR", 1 << 31);
    assert_eq!(bus.get("ECCR", "ECCD"), 0);
    assert!(!bus.model.raises_nmi());
}

#[test]
fn a_stuck_busy_flag_never_falls() {
    let mut bus = unlocked();
    bus.model.stick();
    program(&mut bus, PLACE, 1);
    bus.pass(Time::from_millis(1000));
    assert_eq!(bus.get("SR", "BSY"), 1);
}

#[test]
fn option_bytes_and_mass_erase_are_refused() {
    let mut bus = unlocked();
    assert!(bus.refused("OPTR", 0).contains("option bytes"));
    let start = bus.model.bank().map.register("CR").mask("STRT");
    assert!(bus.refused("CR", start).contains("mass erase"));
}
