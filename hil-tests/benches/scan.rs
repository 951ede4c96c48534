//! Ten milliseconds of virtual time of a scan: without a CPU, and with one that sleeps.
//!
//! `cargo bench -p dermatome-hil`. Timers 4, 2 and 3 as in docs/hardware.md: ADC2 at 2 MS/s and DAC1 at 1 MS/s,
//! both by DMA, and at each slot of 60 samples a multiplexer word, a gain and an enable pulse.

use dermatome_hil::{
    chip::{
        Chip, Memory, RAM_START, Ram,
        flash::{self, Flash},
        map::Map,
        rcc::ResetCause,
        time::Time,
        world::{OpampSetting, World},
    },
    machine::{Machine, Options},
};
use divan::{Bencher, counter::ItemsCount};

const SAMPLES: u32 = 20_000;
const WAVE: u32 = RAM_START;
const WORDS: u32 = RAM_START + 0x100;
const GAINS: u32 = RAM_START + 0x200;
const RING: u32 = RAM_START + 0x4000;
const RING_SAMPLES: u32 = 480;

fn main() {
    divan::main();
}

/// Shorts the DAC to the converter.
#[derive(Debug, Default)]
struct Short(f64);

impl World for Short {
    fn dac(&mut self, _: usize, _: usize, code: Option<u16>, _: Time) {
        self.0 = f64::from(code.unwrap_or(0)) * 3.3 / 4096.0;
    }
    fn pins(&mut self, _: char, _: u16, _: Time) {}
    fn opamp(&mut self, _: usize, _: OpampSetting, _: Time) {}
    fn voltage(&mut self, _: usize, _: usize, _: Time) -> f64 {
        self.0
    }
}

fn set(chip: &mut Chip, peripheral: &str, register: &str, index: usize, fields: &[(&str, u32)]) {
    let map = Map::of_chip().peripheral(peripheral);
    let place = map.element(register, index);
    let address = map.base + place.offset;
    let old = chip.read(address, 4).expect("the register can be read");
    let value = fields.iter().fold(old, |value, &(field, content)| place.with(value, field, content));
    chip.write(address, 4, value).expect("the chip takes this");
}

fn put(chip: &mut Chip, peripheral: &str, register: &str, index: usize, value: u32) {
    let map = Map::of_chip().peripheral(peripheral);
    let address = map.base + map.element(register, index).offset;
    chip.write(address, 4, value).expect("the chip takes this");
}

fn address(peripheral: &str, register: &str) -> u32 {
    let map = Map::of_chip().peripheral(peripheral);
    map.base + map.register(register).offset
}

/// 170 MHz from the HSI, and the clocks of everything that the scan uses.
fn start_clocks(chip: &mut Chip) {
    set(chip, "RCC", "APB1ENR1", 0, &[("PWREN", 1), ("TIM2EN", 1), ("TIM3EN", 1), ("TIM4EN", 1)]);
    set(chip, "PWR", "CR5", 0, &[("R1MODE", 0)]);
    set(chip, "FLASH", "ACR", 0, &[("LATENCY", 4)]);
    set(chip, "RCC", "PLLCFGR", 0, &[("PLLSRC", 2), ("PLLM", 3), ("PLLN", 85), ("PLLREN", 1)]);
    set(chip, "RCC", "CR", 0, &[("PLLON", 1)]);
    set(chip, "RCC", "CFGR", 0, &[("SW", 3)]);
    set(chip, "RCC", "AHB1ENR", 0, &[("DMA1EN", 1), ("DMAMUX1EN", 1)]);
    let used = [("GPIOBEN", 1), ("GPIOCEN", 1), ("DAC1EN", 1), ("ADC12EN", 1)];
    set(chip, "RCC", "AHB2ENR", 0, &used);
    set(chip, "RCC", "APB2ENR", 0, &[("SYSCFGEN", 1)]);
}

/// One channel of DMA1, circular: who asks, where there, where here, beats, and width as a power of two.
fn start_channel(
    chip: &mut Chip,
    index: usize,
    (peripheral, signal): (&str, &str),
    there: u32,
    (here, beats, size, to_peripheral): (u32, u32, u32, u32),
) {
    let mut requests = Map::of_chip().peripheral(peripheral).dma_requests();
    let (_, number) = requests.find(|(known, _)| *known == signal).expect("the chip has this request");
    put(chip, "DMAMUX1", "CCR", index, number);
    put(chip, "DMA1", "CH.PAR", index, there);
    put(chip, "DMA1", "CH.MAR", index, here);
    put(chip, "DMA1", "CH.NDTR", index, beats);
    let fields =
        [("MINC", 1), ("CIRC", 1), ("MSIZE", size), ("PSIZE", size), ("DIR", to_peripheral), ("EN", 1)];
    set(chip, "DMA1", "CH.CR", index, &fields);
}

/// Everything but what has to wait for the converter's regulator.
fn prepare(chip: &mut Chip) {
    chip.connect(Box::new(Short::default()));
    start_clocks(chip);
    put(chip, "GPIOB", "MODER", 0, 0x5555_5555);
    set(chip, "GPIOC", "AFR", 0, &[("AFR[6]", 2)]);
    set(chip, "GPIOC", "MODER", 0, &[("MODER[6]", 2)]);
    start_channel(chip, 0, ("DAC1", "CH1"), address("DAC1", "DHR12R"), (WAVE, 20, 2, 1));
    start_channel(chip, 1, ("ADC2", "ADC2"), address("ADC2", "DR"), (RING, RING_SAMPLES, 1, 0));
    start_channel(chip, 2, ("TIM3", "UP"), address("GPIOB", "ODR"), (WORDS, 20, 1, 1));
    start_channel(chip, 3, ("TIM3", "CH2"), address("OPAMP2", "CSR"), (GAINS, 20, 2, 1));
    set(chip, "OPAMP2", "CSR", 0, &[("VM_SEL", 3), ("OPAINTOEN", 1), ("OPAHSM", 1), ("OPAMPEN", 1)]);
    set(chip, "DAC1", "CR", 0, &[("TSEL[0]", 4), ("TEN[0]", 1), ("DMAEN[0]", 1), ("EN[0]", 1)]);
    set(chip, "ADC12_COMMON", "CCR", 0, &[("CKMODE", 3)]);
    set(chip, "ADC2", "CR", 0, &[("DEEPPWD", 0)]);
    set(chip, "ADC2", "CR", 0, &[("ADVREGEN", 1)]);
}

fn start(chip: &mut Chip) {
    start_converter(chip);
    start_timers(chip);
}

fn start_converter(chip: &mut Chip) {
    set(chip, "ADC2", "SMPR2", 0, &[("SMP[6]", 1)]);
    set(chip, "ADC2", "SQR1", 0, &[("SQ[0]", 16)]);
    let triggered = [("EXTEN", 1), ("EXTSEL", 12), ("DMAEN", 1), ("DMACFG", 1), ("OVRMOD", 1)];
    set(chip, "ADC2", "CFGR", 0, &triggered);
    set(chip, "ADC2", "CR", 0, &[("ADEN", 1)]);
    set(chip, "ADC2", "CR", 0, &[("ADSTART", 1)]);
}

fn start_timers(chip: &mut Chip) {
    put(chip, "TIM2", "ARR", 0, 1);
    set(chip, "TIM2", "CR2", 0, &[("MMS", 2)]);
    put(chip, "TIM3", "ARR", 0, 59);
    put(chip, "TIM3", "CCR", 0, 4);
    put(chip, "TIM3", "CCR", 1, 2);
    set(chip, "TIM3", "CCMR_INPUT", 0, &[("OCM[0]", 7)]);
    set(chip, "TIM3", "CCER", 0, &[("CCE[0]", 1)]);
    set(chip, "TIM3", "DIER", 0, &[("UDE", 1), ("CCDE[1]", 1)]);
    for slave in ["TIM2", "TIM3"] {
        set(chip, slave, "SMCR", 0, &[("TS", 3), ("SMS", 7)]);
        set(chip, slave, "CR1", 0, &[("CEN", 1)]);
    }
    put(chip, "TIM4", "ARR", 0, 84);
    set(chip, "TIM4", "CR2", 0, &[("MMS", 2)]);
    set(chip, "TIM4", "CR1", 0, &[("CEN", 1)]);
}

/// The wave, multiplexer words and gains: where, and the bytes.
fn tables() -> Vec<(u32, [u8; 4])> {
    let entry = |place: u32| {
        let code = 2048 + 100 * (place % 10);
        // On, internal output, gain 2 to 64 around VINM0.
        let gain = 1 | 2 << 5 | 1 << 8 | (8 + place % 6) << 14;
        let word = 0x2100 | place;
        [(WAVE + 4 * place, code), (WORDS + 2 * place, word), (GAINS + 4 * place, gain)]
    };
    (0..20).flat_map(entry).map(|(at, value)| (at, value.to_le_bytes())).collect()
}

/// A chip whose scan has just been started.
fn scan() -> (Chip, Ram) {
    let mut chip = Chip::new(2_000_000, false);
    let mut ram = Ram::default();
    tables().iter().for_each(|(at, bytes)| ram.write(*at, bytes));
    chip.reset(ResetCause::Power);
    prepare(&mut chip);
    chip.advance(chip.now + Time::from_micros(20), &mut ram).expect("time passes");
    start(&mut chip);
    chip.settle(&mut ram).expect("the chip settles");
    (chip, ram)
}

/// The same with a CPU that sleeps: `wfi`, and a branch back to it.
fn sleeper() -> Machine {
    let mut flash = Flash::default();
    flash.load(flash::START, &[0, 0x80, 0, 0x20, 0x01, 0x01, 0, 0x08]);
    flash.load(flash::START + 0x100, &[0x30, 0xBF, 0xFD, 0xE7]);
    let mut machine = Machine::new(flash, Options::default()).expect("the machine starts");
    tables().iter().for_each(|(at, bytes)| machine.poke(*at, bytes));
    machine.chip(prepare);
    machine.run_until(machine.now() + Time::from_micros(20)).expect("it runs");
    machine.chip(start);
    machine
}

fn check(ring: &[u8]) {
    let codes = ring.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]]));
    assert!(codes.clone().all(|code| code % 100 == 48) && codes.max() == Some(2948));
}

/// 20,000 conversions, 10,000 DAC updates, 333 slots.
#[divan::bench]
fn without_cpu(bencher: Bencher<'_, '_>) {
    bencher.counter(ItemsCount::new(SAMPLES)).with_inputs(scan).bench_local_values(|(mut chip, mut ram)| {
        chip.advance(chip.now + Time::from_millis(10), &mut ram).expect("time passes");
        let first = (RING - RAM_START) as usize;
        check(&ram.0[first..first + 2 * RING_SAMPLES as usize]);
    });
}

/// The same beside a CPU that sleeps, with unicorn's RAM.
#[divan::bench]
fn asleep(bencher: Bencher<'_, '_>) {
    bencher.counter(ItemsCount::new(SAMPLES)).with_inputs(sleeper).bench_local_values(|mut machine| {
        machine.run_until(machine.now() + Time::from_millis(10)).expect("it runs");
        check(&machine.peek(RING, 2 * RING_SAMPLES as usize));
    });
}
