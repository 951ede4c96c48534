//! Waves: a trace as a VCD file, for GTKWave and its like.

use crate::chip::{time::Time, trace::Event};
use std::io;
use vcd::{IdCode, SimulationCommand, TimescaleUnit, Value, VarType, Writer};

/// Bits that each signal has.
const WIDTHS: [(&str, u32); 10] = [
    ("exception", 9),
    ("sleeps", 1),
    ("link_to_host", 8),
    ("link_to_board", 8),
    ("can_to_host", 11),
    ("can_to_board", 11),
    ("flash_erase", 32),
    ("flash_program", 32),
    ("dma_complete", 8),
    ("resets", 16),
];

/// Pins of each port, 16 bits.
const PORTS: [&str; 7] = ["gpio_a", "gpio_b", "gpio_c", "gpio_d", "gpio_e", "gpio_f", "gpio_g"];

/// The events as a VCD file with nanoseconds.
pub fn vcd(events: &[(Time, Event)]) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut writer = Writer::new(&mut bytes);
    let signals = declare(&mut writer)?;
    let (mut handlers, mut resets) = (Vec::new(), 0);
    for &(time, event) in events {
        writer.timestamp(time.nanoseconds())?;
        for (name, value) in changes(event, &mut handlers, &mut resets) {
            let signal = signals.iter().find(|(signal, ..)| *signal == name);
            if let Some(&(_, width, id)) = signal {
                put(&mut writer, id, width, value)?;
            }
        }
    }
    Ok(bytes)
}

/// Writes the file's head, in which every signal is 0; gives name, width and identifier of each.
fn declare(writer: &mut Writer<&mut Vec<u8>>) -> io::Result<Vec<(&'static str, u32, IdCode)>> {
    writer.timescale(1, TimescaleUnit::NS)?;
    writer.add_module("stm32g474")?;
    let mut signals = Vec::new();
    for (name, width) in WIDTHS.into_iter().chain(PORTS.map(|port| (port, 16))) {
        signals.push((name, width, writer.add_var(VarType::Wire, width, name, None)?));
    }
    writer.upscope()?;
    writer.enddefinitions()?;
    writer.begin(SimulationCommand::Dumpvars)?;
    for &(_, width, id) in &signals {
        put(writer, id, width, 0)?;
    }
    writer.end()?;
    Ok(signals)
}

/// Signals that an event changes. `handlers` are the exceptions under way, innermost last.
fn changes(event: Event, handlers: &mut Vec<u64>, resets: &mut u64) -> Vec<(&'static str, u64)> {
    match event {
        Event::Enter(exception) => {
            handlers.push(exception as u64);
            vec![("exception", exception as u64), ("sleeps", 0)]
        }
        Event::Leave(_) => {
            handlers.pop();
            vec![("exception", handlers.last().copied().unwrap_or(0))]
        }
        Event::Pins { port, levels } => {
            let place = (port as usize).wrapping_sub('A' as usize);
            PORTS.get(place).map(|name| (*name, levels.into())).into_iter().collect()
        }
        Event::Sent(byte) => vec![("link_to_host", byte.into())],
        Event::Received(byte) => vec![("link_to_board", byte.into())],
        Event::Framed { is_sent, identifier, .. } => {
            vec![(if is_sent { "can_to_host" } else { "can_to_board" }, identifier.into())]
        }
        Event::DmaComplete { controller, channel } => {
            vec![("dma_complete", u64::from(controller) << 4 | u64::from(channel))]
        }
        Event::Erase(address) => vec![("flash_erase", address.into())],
        Event::Program(address) => vec![("flash_program", address.into())],
        Event::Reset(_) => {
            handlers.clear();
            *resets += 1;
            vec![("resets", *resets), ("exception", 0), ("sleeps", 0)]
        }
        Event::Sleep => vec![("sleeps", 1)],
    }
}

fn put(writer: &mut Writer<&mut Vec<u8>>, id: IdCode, width: u32, value: u64) -> io::Result<()> {
    let bit = |place: u32| if value >> place & 1 == 1 { Value::V1 } else { Value::V0 };
    if width == 1 {
        writer.change_scalar(id, bit(0))
    } else {
        writer.change_vector(id, (0..width).rev().map(bit))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_come_back_from_the_file_with_their_times() {
        let events = [
            (Time::from_micros(1), Event::Sleep),
            (Time::from_micros(2), Event::Enter(66)),
            (Time::from_micros(3), Event::Pins { port: 'B', levels: 0xA5 }),
            (Time::from_micros(4), Event::Leave(66)),
        ];
        let bytes = vcd(&events).unwrap();
        let mut parser = vcd::Parser::new(&bytes[..]);
        let header = parser.parse_header().unwrap();
        let exception = header.find_var(&["stm32g474", "exception"]).unwrap().code;
        let mut now = 0;
        let mut seen = Vec::new();
        for command in parser {
            match command.unwrap() {
                vcd::Command::Timestamp(time) => now = time,
                vcd::Command::ChangeVector(id, value) if id == exception && now > 0 => {
                    seen.push((now, value.iter().fold(0, |sum, bit| 2 * sum + u32::from(bit == Value::V1))));
                }
                _ => {}
            }
        }
        assert_eq!(seen, [(2000, 66), (4000, 0)]);
    }
}
