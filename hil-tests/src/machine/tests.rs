use super::{Machine, Options};
use crate::chip::{
    flash::{self, Flash},
    time::Time,
};

/// DWT's counter of cycles.
const CYCCNT: u32 = 0xE000_1004;
/// What it needs to count (ARMv7-M, C1.6.5 and C1.8.3).
const DEMCR: u32 = 0xE000_EDFC;
const DWT_CTRL: u32 = 0xE000_1000;
/// The bus fault's address (ARMv7-M, B3.2.18).
const BFAR: u32 = 0xE000_ED38;

#[test]
fn a_load_from_where_nothing_responds_leaves_its_address_for_the_fault_handler() {
    // Stack and handlers: reset, NMI, hard fault.
    let vectors: [u32; 4] = [0x2002_0000, 0x0800_0011, 0, 0x0800_0015];
    // ldr r0, [pc, #4]; ldr r1, [r0]; then the handler, which runs in circles; and the address.
    let code: [u16; 6] = [0x4801, 0x6801, 0xE7FE, 0, 0x5678, 0x9000];
    let bytes: Vec<u8> = vectors.iter().flat_map(|word| word.to_le_bytes()).collect();
    let mut flash = Flash::default();
    flash.load(flash::START, &bytes);
    flash.load(
        flash::START + 16,
        &code.iter().flat_map(|halfword| halfword.to_le_bytes()).collect::<Vec<u8>>(),
    );
    let mut machine = Machine::new(flash, Options::default()).unwrap();
    machine.run_until(Time::from_micros(100)).unwrap();
    assert_eq!(machine.chip(|chip| chip.read(BFAR, 4)), Ok(0x9000_5678));
}

#[test]
fn the_counter_of_cycles_stands_still_in_sleep_unless_its_clock_is_kept_on() {
    for (keeps_on, counted) in [(false, 0..200), (true, 15_000..17_000)] {
        let vectors: [u32; 2] = [0x2002_0000, 0x0800_0009];
        // wfi; b .
        let code: [u16; 2] = [0xBF30, 0xE7FE];
        let bytes: Vec<u8> = vectors.iter().flat_map(|word| word.to_le_bytes()).collect();
        let mut flash = Flash::default();
        flash.load(flash::START, &bytes);
        flash.load(flash::START + 8, &code.map(u16::to_le_bytes).concat());
        let mut machine = Machine::new(flash, Options::default()).unwrap();
        machine.chip(|chip| {
            chip.modify("DBGMCU", "CR", &[("DBG_SLEEP", u32::from(keeps_on))]);
            chip.write(DEMCR, 4, 1 << 24).unwrap();
            chip.write(DWT_CTRL, 4, 1).unwrap();
        });
        machine.run_until(Time::from_millis(1)).unwrap();
        let cycles = machine.chip(|chip| chip.read(CYCCNT, 4)).unwrap();
        assert!(counted.contains(&cycles), "{cycles} at 16 MHz");
    }
}
