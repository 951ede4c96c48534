use super::probe::chip;
use crate::chip::{
    Ram,
    time::Time,
    world::{OpampSetting, World},
};
use std::sync::{Arc, Mutex};

/// Something that the world was told, and when.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Told {
    Dac(usize, usize, Option<u16>),
    Pins(char, u16),
    Opamp(usize, OpampSetting),
}

/// A world that writes down what it is told.
#[derive(Clone, Debug, Default)]
pub(super) struct Diary(Arc<Mutex<Vec<(Time, Told)>>>);

impl Diary {
    pub(super) fn take(&self) -> Vec<(Time, Told)> {
        std::mem::take(&mut self.0.lock().unwrap())
    }

    fn note(&self, at: Time, told: Told) {
        self.0.lock().unwrap().push((at, told));
    }
}

impl World for Diary {
    fn dac(&mut self, dac: usize, channel: usize, code: Option<u16>, at: Time) {
        self.note(at, Told::Dac(dac, channel, code));
    }
    fn pins(&mut self, port: char, levels: u16, at: Time) {
        self.note(at, Told::Pins(port, levels));
    }
    fn opamp(&mut self, number: usize, setting: OpampSetting, at: Time) {
        self.note(at, Told::Opamp(number, setting));
    }
    fn voltage(&mut self, _: usize, _: usize, _: Time) -> f64 {
        1.65
    }
}

#[test]
fn the_world_is_told_each_change_once_with_its_time() {
    let (mut chip, mut ram) = (chip(), Ram::default());
    let diary = Diary::default();
    chip.modify("RCC", "AHB2ENR", &[("GPIOBEN", 1), ("DAC1EN", 1)]);
    chip.modify("RCC", "APB2ENR", &[("SYSCFGEN", 1)]);
    chip.modify("DAC1", "CR", &[("EN[0]", 1)]);
    chip.pass(Time::from_micros(1), &mut ram);
    chip.connect(Box::new(diary.clone()));
    let first = diary.take();
    assert_eq!(first.len(), 4 * 2 + 7 + 6, "everything, once");
    assert!(first.contains(&(Time::from_micros(1), Told::Dac(1, 0, Some(0)))));
    assert!(first.contains(&(Time::from_micros(1), Told::Opamp(2, OpampSetting::Off))));
    chip.modify("GPIOB", "MODER", &[("MODER[0]", 1), ("MODER[9]", 1)]);
    chip.put("GPIOB", "ODR", 0, 0x0FFF);
    chip.pass(Time::from_micros(1), &mut ram);
    chip.put("DAC1", "DHR12R", 0, 1234);
    chip.put("DAC1", "DHR12R", 0, 1234);
    chip.pass(Time::from_micros(1), &mut ram);
    chip.modify("OPAMP2", "CSR", &[("OPAMPEN", 1), ("VM_SEL", 3)]);
    chip.pass(Time::from_micros(1), &mut ram);
    let follower = OpampSetting::Amplifier { input: 0, gain: 1.0 };
    let expected = [Told::Pins('B', 0x0201), Told::Dac(1, 0, Some(1234)), Told::Opamp(2, follower)];
    let expected: Vec<_> = (1..).map(Time::from_micros).zip(expected).collect();
    assert_eq!(diary.take(), expected, "pins that are outputs; codes that change; the amplifier");
}

#[test]
fn an_amplifier_has_the_clock_of_the_system_configuration() {
    let message = chip().refused("OPAMP2", "CSR", &[("OPAMPEN", 1)]);
    assert!(message.contains("RCC.APB2ENR.SYSCFGEN is 0"), "{message}");
}
