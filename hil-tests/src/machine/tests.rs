use super::{Halt, Machine, Options};
use crate::chip::{
    RAM_START,
    flash::{self, Flash},
    time::Time,
};
use unicorn_engine::RegisterARM;

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

/// A machine whose vectors and code are these, from address 0x0800_0000 on, run for a while.
fn run(vectors: &[u32], code: &[u16], time: Time) -> (Machine, Result<(), Halt>) {
    let bytes: Vec<u8> = vectors.iter().flat_map(|word| word.to_le_bytes()).collect();
    let mut flash = Flash::default();
    flash.load(flash::START, &bytes);
    let code: Vec<u8> = code.iter().flat_map(|halfword| halfword.to_le_bytes()).collect();
    flash.load(flash::START + bytes.len() as u32, &code);
    let mut machine = Machine::new(flash, Options::default()).unwrap();
    let result = machine.run_until(time);
    (machine, result)
}

#[test]
fn a_stack_that_leaves_ram_faults_and_the_handler_runs_though_nothing_could_be_saved() {
    // 64 bytes of stack. push {r0-r7, lr}; b to it; the handler: mov r5, sp; b to itself.
    let vectors = [RAM_START + 64, 0x0800_0011, 0, 0x0800_0015];
    let (mut machine, result) = run(&vectors, &[0xB5FF, 0xE7FD, 0x466D, 0xE7FE], Time::from_micros(100));
    result.unwrap();
    // One push fits. The core's own frame of 32 bytes does not fit behind it.
    assert_eq!(machine.get(RegisterARM::R5), u64::from(RAM_START + 64 - 36 - 32) & !7);
    let status = machine.chip(|chip| chip.read(0xE000_ED28, 4)).unwrap();
    assert_eq!(status & 0x1200, 0x1200, "PRECISERR and STKERR of {status:#x}");
}

#[test]
fn a_fault_in_the_handler_of_a_fault_locks_the_core_up_until_the_watchdog_bites() {
    // b to itself; push {r0}, which is the handler as well.
    let (vectors, code) = ([RAM_START, 0x0800_0011, 0, 0x0800_0013], [0xE7FE, 0xB401]);
    let faults = |is_watched: bool| {
        let (mut machine, result) = run(&vectors, &code, Time::from_micros(10));
        result.unwrap();
        if is_watched {
            machine.chip(|chip| chip.put("IWDG", "KR", 0, 0xCCCC));
        }
        machine.set(RegisterARM::PC, 0x0800_0013);
        let result = machine.run_until(Time::from_millis(400));
        (machine, result)
    };
    assert!(matches!(faults(false).1, Err(Halt::LockUp { .. })));
    let (mut machine, result) = faults(true);
    assert_eq!((result, machine.is_locked_up), (Ok(()), true));
    // The watchdog counts 4096 times four cycles of 32 kHz.
    machine.run_until(Time::from_millis(600)).unwrap();
    assert_eq!((machine.get(RegisterARM::PC), machine.is_locked_up), (0x0800_0010, false));
}
