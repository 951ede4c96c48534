use super::probe::{address, chip, run_at_170_mhz};
use crate::chip::{
    Chip, Memory, RAM_START, Ram,
    adc::VREF_VOLTS,
    map::Map,
    misuse::Misuse,
    nvic::{NMI, Nvic},
    rcc::ResetCause,
    time::Time,
    trace::Event,
    usart::Symbol,
    world::{OpampSetting, World},
};

#[test]
fn the_pll_brings_the_core_to_170_mhz_where_boost_and_wait_states_allow() {
    let mut fast = chip();
    run_at_170_mhz(&mut fast, true, 4).unwrap();
    assert_eq!(fast.clocks().core, 170_000_000);
    let slow_flash = run_at_170_mhz(&mut chip(), true, 3).unwrap_err().to_string();
    assert!(slow_flash.contains("3 wait states, 4 are needed"), "{slow_flash}");
    let weak = run_at_170_mhz(&mut chip(), false, 4).unwrap_err().to_string();
    assert!(weak.contains("too fast for its voltage"), "{weak}");
}

#[test]
fn a_pll_that_is_off_is_not_switched_to() {
    let message = chip().refused("RCC", "CFGR", &[("SW", 3)]);
    assert!(message.contains("not ready"), "{message}");
}

#[test]
fn a_peripheral_without_clock_is_not_touched() {
    let mut chip = chip();
    let message = chip.refused("LPUART1", "BRR", &[("BRR", 0x1000)]);
    assert_eq!(message, "LPUART1.BRR is used while RCC.APB1ENR2.LPUART1EN is 0: it has no clock");
    let message = chip.read(address("GPIOA", "IDR", 0), 4).unwrap_err().to_string();
    assert!(message.contains("AHB2ENR.GPIOAEN"), "{message}");
}

#[test]
fn reserved_bits_read_only_registers_and_registers_unknown_are_refused_by_name() {
    let mut chip = chip();
    chip.modify("RCC", "AHB2ENR", &[("GPIOAEN", 1)]);
    let idr = chip.write(address("GPIOA", "IDR", 0), 4, 1).unwrap_err();
    assert_eq!(idr.to_string(), "GPIOA.IDR cannot be written");
    let reserved = chip.write(address("GPIOA", "ODR", 0), 4, 0x0003_0001).unwrap_err();
    assert_eq!(reserved.to_string(), "GPIOA.ODR = 0x00030001 sets reserved bits 0x00030000");
    let unmodelled = chip.write(address("GPIOA", "LCKR", 0), 4, 1).unwrap_err();
    assert_eq!(unmodelled.to_string(), "GPIOA.LCKR (offset 0x1c) is not modelled");
    let hole = chip.read(0x4800_0000 + 0x2C, 4).unwrap_err();
    assert!(matches!(hole, Misuse::NoRegister { .. }), "{hole}");
}

#[test]
fn bytes_and_halfwords_change_only_themselves() {
    let mut chip = chip();
    chip.modify("RCC", "AHB2ENR", &[("GPIOCEN", 1)]);
    let odr = address("GPIOC", "ODR", 0);
    chip.write(odr, 4, 0x1234).unwrap();
    chip.write(odr + 1, 1, 0xAB).unwrap();
    assert_eq!((chip.read(odr, 4).unwrap(), chip.read(odr + 1, 1).unwrap()), (0xAB34, 0xAB));
}

#[test]
fn a_reset_tells_its_cause_and_forgets_everything_else() {
    let mut chip = chip();
    run_at_170_mhz(&mut chip, true, 4).unwrap();
    chip.write(0xE000_ED0C, 4, 0x05FA_0004).unwrap();
    let cause = chip.take_reset().unwrap();
    chip.reset(cause);
    assert_eq!((cause, chip.clocks().core, chip.take_reset()), (ResetCause::Software, 16_000_000, None));
    let csr = chip.read(address("RCC", "CSR", 0), 4).unwrap();
    let map = Map::of_chip().peripheral("RCC").register("CSR");
    assert_eq!((map.get(csr, "SFTRSTF"), map.get(csr, "IWDGRSTF")), (1, 0));
}

#[test]
fn the_watchdog_resets_a_chip_that_does_not_reload_it() {
    let (mut chip, mut ram) = (chip(), Ram::default());
    chip.put("IWDG", "KR", 0, 0xCCCC);
    chip.pass(Time::from_millis(511), &mut ram);
    assert_eq!(chip.take_reset(), None);
    chip.pass(Time::from_millis(1), &mut ram);
    assert_eq!(chip.take_reset(), Some(ResetCause::Watchdog));
}

/// LPUART1 at 2 Mbaud from the system clock: PA2 sends, PA3 receives (alternate function 12).
fn link(chip: &mut Chip) {
    run_at_170_mhz(chip, true, 4).unwrap();
    chip.modify("RCC", "AHB2ENR", &[("GPIOAEN", 1)]);
    chip.modify("RCC", "APB1ENR2", &[("LPUART1EN", 1)]);
    chip.modify("RCC", "AHB1ENR", &[("DMA1EN", 1), ("DMAMUX1EN", 1)]);
    chip.put("GPIOA", "AFR", 0, 0xCC00);
    chip.put("GPIOA", "MODER", 0, 0xABFF_FFAF);
    chip.put("LPUART1", "BRR", 0, 21_760);
    chip.modify("LPUART1", "CR3", &[("DMAR", 1), ("DMAT", 1)]);
    chip.modify("LPUART1", "CR1", &[("UE", 1), ("RE", 1), ("TE", 1)]);
}

fn start_channel(
    chip: &mut Chip,
    index: usize,
    request: u32,
    register: &str,
    beats: u32,
    fields: &[(&str, u32)],
) {
    chip.put("DMAMUX1", "CCR", index, request);
    chip.put("DMA1", "CH.PAR", index, address("LPUART1", register, 0));
    chip.put("DMA1", "CH.MAR", index, RAM_START + 0x100 * index as u32);
    chip.put("DMA1", "CH.NDTR", index, beats);
    let map = Map::of_chip().peripheral("DMA1").element("CH.CR", index);
    let all = fields.iter().chain(&[("MINC", 1), ("TCIE", 1), ("HTIE", 1), ("EN", 1)]);
    let value = all.fold(0, |value, &(field, content)| map.with(value, field, content));
    chip.put("DMA1", "CH.CR", index, value);
}

fn dma_flags(chip: &mut Chip, channel: usize) -> u32 {
    chip.read(address("DMA1", "ISR", 0), 4).unwrap() >> (4 * channel) & 0xF
}

#[test]
fn a_circular_channel_fills_a_ring_from_the_link() {
    let (mut chip, mut ram) = (chip(), Ram::default());
    link(&mut chip);
    start_channel(&mut chip, 0, 34, "RDR", 4, &[("CIRC", 1)]);
    let symbols = (1..=6).map(|byte| Symbol { byte, damaged: false });
    chip.uart.receive(symbols, chip.now);
    chip.pass(Time::from_micros(5), &mut ram);
    assert_eq!((ram.0[..4].to_vec(), dma_flags(&mut chip, 0)), (vec![1, 0, 0, 0], 0));
    chip.pass(Time::from_micros(5), &mut ram);
    assert_eq!(dma_flags(&mut chip, 0), 0b0101, "half");
    assert!(chip.core.nvic.is_pending(Nvic::exception_of(11)));
    chip.put("DMA1", "IFCR", 0, 0xF);
    chip.pass(Time::from_micros(10), &mut ram);
    assert_eq!(dma_flags(&mut chip, 0), 0b0011, "end");
    chip.pass(Time::from_micros(10), &mut ram);
    assert_eq!(ram.0[..4], [5, 6, 3, 4]);
    assert_eq!(chip.read(address("DMA1", "CH.NDTR", 0), 4).unwrap(), 2);
}

#[test]
fn a_channel_sends_a_buffer_at_the_speed_of_the_link() {
    let (mut chip, mut ram) = (chip(), Ram::default());
    link(&mut chip);
    ram.write(RAM_START + 0x100, b"dermatome");
    start_channel(&mut chip, 1, 35, "TDR", 9, &[("DIR", 1)]);
    chip.pass(Time::from_micros(45), &mut ram);
    let sent = chip.uart.take_sent();
    let bytes: Vec<u8> = sent.iter().map(|&(_, byte)| byte).collect();
    assert_eq!((bytes.as_slice(), sent.last().unwrap().0), (&b"dermatome"[..], Time::from_micros(45)));
    assert_eq!(dma_flags(&mut chip, 1), 0b0111);
}

#[test]
fn memory_is_copied_without_requests_and_an_address_of_nothing_is_an_error() {
    let (mut chip, mut ram) = (chip(), Ram::default());
    link(&mut chip);
    ram.write(RAM_START + 0x200, &[1, 2, 3, 4, 5, 6, 7, 8]);
    let copy = [("MEM2MEM", 1), ("DIR", 1), ("PINC", 1), ("MSIZE", 2), ("PSIZE", 2)];
    start_channel(&mut chip, 2, 0, "TDR", 2, &[]);
    chip.put("DMA1", "CH.CR", 2, 0);
    for (target, flags) in [(RAM_START + 0x800, 0b0111), (0x1000_0000, 0b1001)] {
        chip.put("DMA1", "IFCR", 0, 0xF00);
        chip.put("DMA1", "CH.PAR", 2, target);
        chip.put("DMA1", "CH.NDTR", 2, 2);
        let map = Map::of_chip().peripheral("DMA1").element("CH.CR", 2);
        let all = copy.iter().chain(&[("MINC", 1), ("EN", 1)]);
        let value = all.fold(0, |value, &(field, content)| map.with(value, field, content));
        chip.put("DMA1", "CH.CR", 2, value);
        chip.settle(&mut ram).unwrap();
        assert_eq!(dma_flags(&mut chip, 2), flags);
        chip.put("DMA1", "CH.CR", 2, 0);
    }
    assert_eq!(ram.0[0x800..0x808], [1, 2, 3, 4, 5, 6, 7, 8]);
}

#[test]
fn the_lines_of_one_exception_are_or_ed() {
    let (mut chip, mut ram) = (chip(), Ram::default());
    chip.modify("RCC", "APB1ENR1", &[("TIM2EN", 1)]);
    chip.modify("TIM2", "DIER", &[("UIE", 1), ("CCIE[0]", 1)]);
    chip.modify("TIM2", "EGR", &[("UG", 1), ("CCG[0]", 1)]);
    chip.settle(&mut ram).unwrap();
    let exception = Nvic::exception_of(28);
    assert!(chip.core.nvic.is_pending(exception));
    for (clear, stays) in [(!1, true), (!2, false)] {
        chip.put("TIM2", "SR", 0, clear);
        chip.settle(&mut ram).unwrap();
        chip.core.nvic.unpend(exception);
        assert_eq!(chip.core.nvic.is_pending(exception), stays);
    }
}

#[test]
fn a_read_of_a_broken_double_word_by_the_dma_raises_nmi() {
    let (mut chip, mut ram) = (chip(), Ram::default());
    let place = crate::chip::flash::START + 0x7_F000;
    for key in [0x4567_0123, 0xCDEF_89AB] {
        chip.put("FLASH", "KEYR", 0, key);
    }
    chip.modify("FLASH", "CR", &[("PG", 1)]);
    let at = crate::chip::peripheral::Moment { now: chip.now, clocks: chip.clocks() };
    chip.flash.write_word(place, 4, 1, at).unwrap();
    chip.flash.write_word(place + 4, 4, 2, at).unwrap();
    let broken = (0..100).map(|seed| {
        let mut flash = chip.flash.clone();
        flash.cut(seed);
        flash
    });
    chip.flash = broken.into_iter().find(|flash| !flash.damaged().is_empty()).unwrap();
    chip.reset(ResetCause::Power);
    assert!(chip.flash.check_read(place, 4));
    chip.settle(&mut ram).unwrap();
    assert!(chip.core.nvic.is_pending(NMI));
}

#[test]
fn a_halfword_store_to_a_dac_is_refused_from_cpu_and_dma() {
    let (mut chip, mut ram) = (chip(), Ram::default());
    link(&mut chip);
    chip.modify("RCC", "AHB2ENR", &[("DAC1EN", 1)]);
    let holding = address("DAC1", "DHR12R", 0);
    let message = chip.write(holding, 2, 7).unwrap_err().to_string();
    assert_eq!(message, "DAC1: DHR12R is written by 2 bytes: its registers want words");
    chip.put("DMA1", "CH.PAR", 3, holding);
    chip.put("DMA1", "CH.MAR", 3, RAM_START);
    chip.put("DMA1", "CH.NDTR", 3, 1);
    // Memory to memory, from memory, 16 bits wide.
    chip.put("DMA1", "CH.CR", 3, 0x4511);
    assert_eq!(chip.settle(&mut ram).unwrap_err().to_string(), message);
}

/// TIM6 triggers DAC1 every ten microseconds; DMA1 channel 4 brings the next sample of a ring.
#[test]
fn a_timer_a_dac_and_the_dma_make_a_wave() {
    let (mut chip, mut ram) = (chip(), Ram::default());
    link(&mut chip);
    chip.modify("RCC", "AHB2ENR", &[("DAC1EN", 1)]);
    chip.modify("RCC", "APB1ENR1", &[("TIM6EN", 1)]);
    for (place, sample) in [100_u32, 200, 300].into_iter().enumerate() {
        ram.write(RAM_START + 4 * place as u32, &sample.to_le_bytes());
    }
    chip.put("DMAMUX1", "CCR", 3, 6);
    chip.put("DMA1", "CH.PAR", 3, address("DAC1", "DHR12R", 0));
    chip.put("DMA1", "CH.MAR", 3, RAM_START);
    chip.put("DMA1", "CH.NDTR", 3, 3);
    // Circular, from memory, 32 bits wide.
    chip.put("DMA1", "CH.CR", 3, 0x0AB1);
    let on = [("TEN[0]", 1), ("TSEL[0]", 7), ("DMAEN[0]", 1), ("EN[0]", 1)];
    let refusal = chip.refused("DAC1", "CR", &on);
    assert!(refusal.contains("MCR.HFSEL = 0, 2 is needed"), "{refusal}");
    chip.modify("DAC1", "MCR", &[("HFSEL", 2)]);
    chip.modify("DAC1", "CR", &on);
    assert!(chip.refused("DAC1", "MCR", &[("HFSEL", 1)]).contains("2 is needed"));
    chip.put("TIM6", "ARR", 0, 1699);
    chip.modify("TIM6", "CR2", &[("MMS", 2)]);
    chip.modify("TIM6", "CR1", &[("CEN", 1)]);
    let mut wave = Vec::new();
    for _ in 0..6 {
        chip.pass(Time::from_micros(10) + Time::from_micros(1) * u64::from(wave.is_empty()), &mut ram);
        wave.push(chip.dacs[0].output(0).unwrap());
    }
    assert_eq!(wave, [0, 100, 200, 300, 100, 200]);
}

#[test]
fn an_edge_of_the_chosen_port_raises_the_shared_interrupt() {
    let (mut chip, mut ram) = (chip(), Ram::default());
    chip.modify("RCC", "AHB2ENR", &[("GPIOCEN", 1), ("GPIOBEN", 1)]);
    chip.modify("RCC", "APB2ENR", &[("SYSCFGEN", 1)]);
    for port in ["GPIOB", "GPIOC"] {
        chip.modify(port, "MODER", &[("MODER[13]", 0), ("MODER[5]", 0)]);
    }
    chip.put("SYSCFG", "EXTICR", 3, 2 << 4);
    chip.modify("EXTI", "RTSR", &[("LINE[13]", 1)]);
    chip.modify("EXTI", "IMR", &[("LINE[13]", 1)]);
    let exception = Nvic::exception_of(40);
    for (port, pin, raised) in [('B', 13, false), ('C', 5, false), ('C', 13, true)] {
        chip.drive(port, pin, Some(true));
        chip.settle(&mut ram).unwrap();
        assert_eq!(chip.core.nvic.is_pending(exception), raised, "{port}{pin}");
    }
    chip.put("EXTI", "PR", 0, 1 << 13);
    chip.settle(&mut ram).unwrap();
    chip.core.nvic.unpend(exception);
    assert!(!chip.core.nvic.is_pending(exception));
}

/// Volts that say which converter, channel and sample they are.
#[derive(Debug, Default)]
struct Counter(u32);

impl World for Counter {
    fn dac(&mut self, _: usize, _: usize, _: Option<u16>, _: Time) {}
    fn pins(&mut self, _: char, _: u16, _: Time) {}
    fn opamp(&mut self, _: usize, _: OpampSetting, _: Time) {}
    fn voltage(&mut self, adc: usize, channel: usize, _: Time) -> f64 {
        self.0 += 1;
        VREF_VOLTS * f64::from(100 * adc as u32 + 10 * channel as u32 + self.0) / 4096.0 + 1e-6
    }
}

/// TIM6 triggers ADC1 every ten microseconds, and DMA1 channel 5 fills a ring of two.
#[test]
fn a_timer_an_adc_and_the_dma_record_the_world() {
    let (mut chip, mut ram) = (chip(), Ram::default());
    link(&mut chip);
    chip.connect(Box::new(Counter::default()));
    chip.modify("RCC", "AHB2ENR", &[("ADC12EN", 1)]);
    chip.modify("RCC", "APB1ENR1", &[("TIM6EN", 1)]);
    chip.modify("ADC12_COMMON", "CCR", &[("CKMODE", 3)]);
    chip.modify("ADC1", "CR", &[("DEEPPWD", 0)]);
    chip.modify("ADC1", "CR", &[("ADVREGEN", 1)]);
    chip.pass(Time::from_micros(20), &mut ram);
    chip.modify("ADC1", "SQR1", &[("SQ[0]", 7)]);
    chip.modify("ADC1", "CFGR", &[("EXTEN", 1), ("EXTSEL", 13), ("DMAEN", 1), ("DMACFG", 1)]);
    chip.modify("ADC1", "CR", &[("ADEN", 1)]);
    chip.modify("ADC1", "CR", &[("ADSTART", 1)]);
    chip.put("DMAMUX1", "CCR", 4, 5);
    chip.put("DMA1", "CH.PAR", 4, address("ADC1", "DR", 0));
    chip.put("DMA1", "CH.MAR", 4, RAM_START);
    chip.put("DMA1", "CH.NDTR", 4, 2);
    // Circular, to memory, 16 bits wide.
    chip.put("DMA1", "CH.CR", 4, 0x05A1);
    chip.put("TIM6", "ARR", 0, 1699);
    chip.modify("TIM6", "CR2", &[("MMS", 2)]);
    chip.modify("TIM6", "CR1", &[("CEN", 1)]);
    chip.pass(Time::from_micros(31), &mut ram);
    let recorded: Vec<u16> =
        ram.0[..4].chunks(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect();
    assert_eq!(recorded, [173, 172], "three samples, the third over the first");
}

#[test]
fn a_conversion_without_a_world_is_refused() {
    let (mut chip, mut ram) = (chip(), Ram::default());
    link(&mut chip);
    chip.modify("RCC", "AHB2ENR", &[("ADC12EN", 1)]);
    chip.modify("ADC12_COMMON", "CCR", &[("CKMODE", 3)]);
    chip.modify("ADC1", "CR", &[("DEEPPWD", 0)]);
    chip.modify("ADC1", "CR", &[("ADVREGEN", 1)]);
    chip.pass(Time::from_micros(20), &mut ram);
    chip.modify("ADC1", "CR", &[("ADEN", 1)]);
    chip.modify("ADC1", "CR", &[("ADSTART", 1)]);
    let result = chip.advance(chip.now + Time::from_micros(1), &mut ram);
    assert!(result.unwrap_err().to_string().contains("no world"));
}

#[test]
fn a_peripheral_held_in_reset_forgets_what_was_written_and_cannot_be_used() {
    let mut chip = chip();
    let rate = address("LPUART1", "BRR", 0);
    chip.modify("RCC", "APB1ENR2", &[("LPUART1EN", 1)]);
    chip.modify("LPUART1", "BRR", &[("BRR", 21_760)]);
    assert_eq!(chip.read(rate, 4), Ok(21_760));
    chip.modify("RCC", "APB1RSTR2", &[("LPUART1RST", 1)]);
    let refusal = chip.refused("LPUART1", "BRR", &[("BRR", 21_760)]);
    assert!(refusal.contains("LPUART1.BRR is used while RCC.APB1RSTR2.LPUART1RST is 1"), "{refusal}");
    chip.modify("RCC", "APB1RSTR2", &[("LPUART1RST", 0)]);
    assert_eq!(chip.read(rate, 4), Ok(0));
}

#[test]
fn a_port_that_is_reset_lets_its_pins_go() {
    let mut chip = chip();
    let mut ram = Ram::default();
    chip.modify("RCC", "AHB2ENR", &[("GPIOBEN", 1)]);
    chip.modify("GPIOB", "MODER", &[("MODER[3]", 1)]);
    chip.trace.take();
    chip.put("GPIOB", "ODR", 0, 1 << 3);
    chip.settle(&mut ram).unwrap();
    chip.modify("RCC", "AHB2RSTR", &[("GPIOBRST", 1)]);
    chip.settle(&mut ram).unwrap();
    let pins = chip.trace.take().into_iter().filter_map(|(_, event)| match event {
        Event::Pins { port: 'B', levels } => Some(levels),
        _ => None,
    });
    assert_eq!(pins.collect::<Vec<_>>(), [1 << 3, 0]);
}

/// DBGMCU lies among the core's own addresses and is the chip's.
#[test]
fn debug_support_is_found_among_the_cores_peripherals() {
    let mut chip = chip();
    for _ in 0..2 {
        assert_eq!(chip.read(0xE004_2000, 4), Ok(0x2003_6469), "IDCODE");
        assert_eq!(chip.read(0xE000_ED00, 4), Ok(0x410F_C241), "CPUID");
    }
}
