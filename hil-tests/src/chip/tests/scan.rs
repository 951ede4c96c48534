//! The scan's chain: TIM4 clocks TIM3, whose events move multiplexer words and gains, and whose output
//! drives a pin.

use super::{
    bus::nanos,
    outside::{Diary, Told},
    probe::{address, chip, run_at_170_mhz},
};
use crate::chip::{Chip, Memory, RAM_START, Ram, nvic::Nvic, time::Time, world::OpampSetting::Amplifier};

const WORDS: u32 = RAM_START + 0x100;
const GAINS: u32 = RAM_START + 0x200;

/// TIM4 fires each microsecond; TIM3 makes slots of four of them; DMA1 channels 2 and 3 (from 0 on).
fn slots() -> (Chip, Ram, Diary) {
    let (mut chip, mut ram, diary) = (chip(), Ram::default(), Diary::default());
    run_at_170_mhz(&mut chip, true, 4).unwrap();
    chip.modify("RCC", "AHB1ENR", &[("DMA1EN", 1), ("DMAMUX1EN", 1)]);
    chip.modify("RCC", "AHB2ENR", &[("GPIOBEN", 1), ("GPIOCEN", 1)]);
    chip.modify("RCC", "APB1ENR1", &[("TIM3EN", 1), ("TIM4EN", 1)]);
    chip.modify("RCC", "APB2ENR", &[("SYSCFGEN", 1)]);
    chip.modify("PWR", "CR3", &[("UCPD1_DBDIS", 1)]);
    chip.put("GPIOB", "MODER", 0, 0x5555_5555);
    chip.put("GPIOC", "AFR", 0, 2 << 24);
    chip.modify("GPIOC", "MODER", &[("MODER[6]", 2)]);
    for (place, word) in [0x2101_u16, 0x4323].into_iter().enumerate() {
        ram.write(WORDS + 2 * place as u32, &word.to_le_bytes());
    }
    // On around VINM0: gain 4, then 16.
    for (place, code) in [9_u32, 11].into_iter().enumerate() {
        ram.write(GAINS + 4 * place as u32, &(1 | 2 << 5 | code << 14).to_le_bytes());
    }
    chip.modify("TIM3", "DIER", &[("UDE", 1), ("CCDE[1]", 1)]);
    chip.put("TIM3", "ARR", 0, 3);
    chip.put("TIM3", "CCR", 0, 1);
    chip.put("TIM3", "CCR", 1, 2);
    chip.modify("TIM3", "CCMR_INPUT", &[("OCM[0]", 7)]);
    chip.modify("TIM3", "CCER", &[("CCE[0]", 1)]);
    chip.modify("TIM3", "SMCR", &[("TS", 3), ("SMS", 7)]);
    // Circular, from memory, interrupts at half and end: 16 bits wide, and 32.
    for (channel, request, register, from, control) in [
        (2, 65, address("GPIOB", "ODR", 0), WORDS, 0x05B7),
        (3, 62, address("OPAMP2", "CSR", 0), GAINS, 0x0AB7),
    ] {
        chip.put("DMAMUX1", "CCR", channel, request);
        chip.put("DMA1", "CH.PAR", channel, register);
        chip.put("DMA1", "CH.MAR", channel, from);
        chip.put("DMA1", "CH.NDTR", channel, 2);
        chip.put("DMA1", "CH.CR", channel, control);
    }
    chip.modify("TIM3", "CR1", &[("CEN", 1)]);
    chip.put("TIM4", "ARR", 0, 169);
    chip.modify("TIM4", "CR2", &[("MMS", 2)]);
    chip.connect(Box::new(diary.clone()));
    diary.take();
    chip.modify("TIM4", "CR1", &[("CEN", 1)]);
    (chip, ram, diary)
}

#[test]
fn words_gains_and_the_enable_pulse_come_in_step_with_the_slots() {
    let (mut chip, mut ram, diary) = slots();
    chip.pass(Time::from_micros(11), &mut ram);
    let (low, high) = (Told::Pins('C', 0), Told::Pins('C', 1 << 6));
    let word = |word| Told::Pins('B', word);
    let gain = |gain| Told::Opamp(2, Amplifier { input: 0, gain });
    let expected = [
        (1, high.clone()),
        (2, gain(4.0)),
        (4, word(0x2101)),
        (4, low.clone()),
        (5, high.clone()),
        (6, gain(16.0)),
        (8, word(0x4323)),
        (8, low),
        (9, high),
        (10, gain(4.0)),
    ];
    let told = diary.take();
    let micros = |time: &Time| (time.seconds() * 1e6).round() as u64;
    let rounded: Vec<(u64, Told)> = told.iter().map(|(time, told)| (micros(time), told.clone())).collect();
    assert_eq!(rounded, expected, "PWM mode 2: low until the counter reaches 1");
    for channel in [13, 14] {
        assert!(chip.core.nvic.is_pending(Nvic::exception_of(channel)), "DMA1 channels 3 and 4");
    }
    let pins = chip.read(address("GPIOC", "IDR", 0), 4).unwrap();
    assert_eq!(pins & 1 << 6, 1 << 6, "the pin reads what the timer gives");
}

#[test]
fn a_pin_that_is_no_longer_the_timers_lets_go() {
    let (mut chip, mut ram, diary) = slots();
    chip.pass(nanos(1_100), &mut ram);
    assert_eq!(diary.take().last().unwrap().1, Told::Pins('C', 1 << 6));
    chip.modify("GPIOC", "MODER", &[("MODER[6]", 0)]);
    chip.settle(&mut ram).unwrap();
    assert_eq!(diary.take().last().unwrap().1, Told::Pins('C', 0));
}

/// ADC1 or ADC2 at a channel, started once, with the longest sampling.
fn convert(adc: &str, channel: u32, prepare: impl Fn(&mut Chip)) -> Result<(), String> {
    let longest = |chip: &mut Chip| chip.modify(adc, "SMPR2", &[("SMP[6]", 7), ("SMP[8]", 7)]);
    convert_after(&[adc], channel, &[&longest, &prepare])
}

/// Converters at a channel, started one after the other.
fn convert_after(adcs: &[&str], channel: u32, prepare: &[&dyn Fn(&mut Chip)]) -> Result<(), String> {
    let (mut chip, mut ram) = (chip(), Ram::default());
    run_at_170_mhz(&mut chip, true, 4).unwrap();
    chip.connect(Box::new(Diary::default()));
    chip.modify("RCC", "AHB2ENR", &[("ADC12EN", 1)]);
    chip.modify("RCC", "APB2ENR", &[("SYSCFGEN", 1)]);
    chip.modify("ADC12_COMMON", "CCR", &[("CKMODE", 3)]);
    prepare.iter().for_each(|prepare| prepare(&mut chip));
    for adc in adcs {
        chip.modify(adc, "CR", &[("DEEPPWD", 0)]);
        chip.modify(adc, "CR", &[("ADVREGEN", 1)]);
        chip.pass(Time::from_micros(20), &mut ram);
        chip.modify(adc, "SQR1", &[("SQ[0]", channel)]);
        chip.modify(adc, "CR", &[("ADEN", 1)]);
    }
    for adc in adcs {
        chip.modify(adc, "CR", &[("ADSTART", 1)]);
    }
    chip.settle(&mut ram).unwrap();
    chip.advance(chip.now + Time::from_micros(20), &mut ram).map_err(|misuse| misuse.to_string())
}

#[test]
fn what_is_inside_the_chip_needs_its_time_and_converters_side_by_side_a_slower_clock() {
    let on = |chip: &mut Chip| {
        let amplifier = [("VM_SEL", 3), ("OPAMPEN", 1), ("OPAINTOEN", 1), ("OPAHSM", 1)];
        chip.modify("OPAMP2", "CSR", &amplifier);
        chip.modify("ADC12_COMMON", "CCR", &[("VSENSEEN", 1)]);
    };
    let sampled = |adc, code| {
        let sampling = move |chip: &mut Chip| chip.modify(adc, "SMPR2", &[("SMP[6]", code)]);
        convert_after(&[adc], 16, &[&on, &sampling])
    };
    let refusal = sampled("ADC2", 1).unwrap_err();
    assert!(refusal.contains("ADC2 samples Opamp(2) for 152 ns, it takes 200"), "{refusal}");
    assert_eq!(sampled("ADC2", 2), Ok(()));
    let refusal = sampled("ADC1", 4).unwrap_err();
    assert!(refusal.contains("ADC1 samples Temperature for 1117 ns, it takes 5000"), "{refusal}");
    assert_eq!(sampled("ADC1", 7), Ok(()));
    let beside = |kernel: bool| {
        let clock = move |chip: &mut Chip| {
            if kernel {
                // HSE 24 MHz / 6 * 85 / 6: 56.7 MHz.
                chip.modify("RCC", "PLLCFGR", &[("PLLP", 6), ("PLLPEN", 1)]);
                chip.modify("RCC", "CCIPR", &[("ADC12SEL", 1)]);
                chip.modify("ADC12_COMMON", "CCR", &[("CKMODE", 0)]);
            }
            for adc in ["ADC1", "ADC2"] {
                chip.modify(adc, "SMPR2", &[("SMP[6]", 7)]);
            }
        };
        convert_after(&["ADC1", "ADC2"], 16, &[&on, &clock])
    };
    assert_eq!(beside(false), Ok(()));
    let refusal = beside(true).unwrap_err();
    assert!(refusal.contains("at 56666666 Hz beside another one: up to 52000000 Hz"), "{refusal}");
}

#[test]
fn what_is_inside_the_chip_is_measured_only_while_it_is_on() {
    let amplifier =
        |fields: &'static [(&'static str, u32)]| move |chip: &mut Chip| chip.modify("OPAMP2", "CSR", fields);
    let sensor = |chip: &mut Chip| chip.modify("ADC12_COMMON", "CCR", &[("VSENSEEN", 1)]);
    let refusal = convert("ADC1", 16, |_| {}).unwrap_err();
    assert!(refusal.contains("ADC1 measures Temperature while CCR.VSENSEEN is 0"), "{refusal}");
    assert_eq!(convert("ADC1", 16, sensor), Ok(()));
    assert!(convert("ADC1", 18, sensor).unwrap_err().contains("VREFEN"));
    for fields in [&[("VM_SEL", 3), ("OPAMPEN", 1)], &[("VM_SEL", 3), ("OPAINTOEN", 1)]] {
        let refusal = convert("ADC2", 16, amplifier(fields)).unwrap_err();
        assert!(refusal.contains("ADC2 measures OPAMP2 while its OPAMPEN or OPAINTOEN is 0"), "{refusal}");
    }
    let refusal =
        convert("ADC2", 16, amplifier(&[("VM_SEL", 3), ("OPAMPEN", 1), ("OPAINTOEN", 1)])).unwrap_err();
    assert!(refusal.contains("ADC2 measures OPAMP2 while its OPAHSM is 0"), "{refusal}");
    let fast = amplifier(&[("VM_SEL", 3), ("OPAMPEN", 1), ("OPAINTOEN", 1), ("OPAHSM", 1)]);
    assert_eq!(convert("ADC2", 16, fast), Ok(()));
}

/// Peripheral, register, and its fields.
type Setting<'a> = (&'a str, &'a str, &'a [(&'a str, u32)]);

#[test]
fn pins_of_other_kinds_are_refused_where_they_spoil_a_signal() {
    let refusal = |settings: &[Setting<'_>]| {
        let mut chip = chip();
        chip.modify("RCC", "AHB2ENR", &[("GPIOAEN", 1), ("GPIOBEN", 1), ("DAC1EN", 1)]);
        chip.modify("RCC", "APB1ENR1", &[("PWREN", 1)]);
        settings.iter().for_each(|(peripheral, register, fields)| chip.modify(peripheral, register, fields));
        chip.settle(&mut Ram::default()).map_err(|misuse| misuse.to_string())
    };
    let output: Setting<'_> = ("GPIOB", "MODER", &[("MODER[6]", 1)]);
    assert!(refusal(&[output]).unwrap_err().contains("UCPD1 may pull PB6 down"));
    assert_eq!(refusal(&[("PWR", "CR3", &[("UCPD1_DBDIS", 1)]), output]), Ok(()));
    let dac: Setting<'_> = ("DAC1", "CR", &[("EN[0]", 1)]);
    assert_eq!(refusal(&[dac]), Ok(()));
    let wrong = refusal(&[("GPIOA", "MODER", &[("MODER[4]", 1)]), dac]).unwrap_err();
    assert!(wrong.contains("DAC: its pin PA4 is not analogue"), "{wrong}");
    for pin in ["MODER[5]", "MODER[7]"] {
        let amplifier = |chip: &mut Chip| {
            chip.modify("RCC", "AHB2ENR", &[("GPIOAEN", 1)]);
            chip.modify("GPIOA", "MODER", &[(pin, 1)]);
            let gain = [("VM_SEL", 2), ("PGA_GAIN", 9), ("OPAMPEN", 1), ("OPAINTOEN", 1), ("OPAHSM", 1)];
            chip.modify("OPAMP2", "CSR", &gain);
        };
        let wrong = convert("ADC2", 16, amplifier).unwrap_err();
        assert!(wrong.contains("OPAMP: its pin PA") && wrong.contains("is not analogue"), "{wrong}");
    }
}

/// Time that passes quietly ends where an exception becomes pending, and before the link does anything.
#[test]
fn quiet_time_ends_at_an_interrupt_and_at_the_link() {
    let (mut chip, mut ram, _) = slots();
    chip.core.nvic.forget_news();
    // NVIC_ISER0: DMA1 channel 3 is interrupt 13.
    chip.write(0xE000_E100, 4, 1 << 13).unwrap();
    chip.core.nvic.forget_news();
    assert_eq!(chip.advance_quietly(chip.now + Time::from_micros(20), &mut ram), Ok(false));
    assert_eq!((chip.now.seconds() * 1e6).round() as u64, 4, "half of two words");
    chip.core.nvic.forget_news();
    let symbol = crate::chip::usart::Symbol { byte: 1, damaged: false };
    chip.uart.receive([symbol], chip.now);
    chip.put("DMA1", "IFCR", 0, u32::MAX >> 4);
    let arrives = chip.now + Time::from_micros(5);
    chip.write(0xE000_E180, 4, 1 << 13).unwrap();
    chip.core.nvic.forget_news();
    assert_eq!(chip.advance_quietly(chip.now + Time::from_micros(20), &mut ram), Ok(false));
    assert_eq!(chip.now, arrives);
    chip.advance(arrives, &mut ram).unwrap();
    assert_eq!(chip.advance_quietly(arrives + Time::from_micros(1), &mut ram), Ok(true));
}
