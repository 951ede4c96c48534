//! Map of the chip: every peripheral, register and field with its place, from stm32-metapac.
//!
//! The models take addresses, interrupt numbers, DMA requests and bit positions from here and from
//! nowhere else, so that they follow the chip and not our firmware.

use rustc_hash::FxHashMap;
use std::{collections::BTreeMap, sync::OnceLock};
use stm32_metapac::metadata::{
    METADATA, Peripheral,
    ir::{Access, Array, BitOffset, BlockItemInner, IR},
};

/// The chip's peripherals.
#[derive(Debug)]
pub struct Map {
    peripherals: Vec<PeripheralMap>,
}

/// One peripheral: its place and its registers.
#[derive(Debug)]
pub struct PeripheralMap {
    /// Its name in the reference manual.
    pub name: &'static str,
    /// Place among the chip's peripherals.
    pub place: usize,
    /// Its first address.
    pub base: u32,
    /// Register and field of the RCC that switch its clock, if any.
    pub clock: Switch,
    /// Register and field of the RCC that reset it, if any.
    pub reset: Switch,
    /// In order of their offsets.
    registers: Vec<Register>,
    /// Places in `registers` of each name, by index.
    places: FxHashMap<String, Vec<Option<usize>>>,
    source: &'static Peripheral,
}

/// One register.
#[derive(Clone, Debug)]
pub struct Register {
    /// Its name, with its block's name before a dot: `CH.CR`.
    pub name: String,
    /// Which of an array of equal registers or blocks.
    pub index: usize,
    /// Place among the peripheral's registers.
    pub place: usize,
    /// Bytes from the peripheral's first address.
    pub offset: u32,
    /// Whether it can be written.
    pub writable: bool,
    /// Whether it can be read.
    pub readable: bool,
    /// Bits that mean something.
    pub known_bits: u32,
    fields: Vec<NamedField>,
}

/// Where a field is, for models that look at it often.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Place of its register among the peripheral's.
    pub place: usize,
    /// Its lowest bit.
    pub shift: u32,
    /// Its bits.
    pub mask: u32,
}

#[derive(Clone, Debug)]
struct NamedField {
    name: String,
    offset: u32,
    bits: u32,
}

impl Map {
    /// The map of the STM32G474RE.
    #[must_use]
    pub fn of_chip() -> &'static Self {
        static MAP: OnceLock<Map> = OnceLock::new();
        MAP.get_or_init(|| {
            let mut peripherals: Vec<_> =
                METADATA.peripherals.iter().filter_map(PeripheralMap::new).collect();
            peripherals.sort_by_key(|peripheral| peripheral.base);
            (0..).zip(&mut peripherals).for_each(|(place, peripheral)| peripheral.place = place);
            Self { peripherals }
        })
    }

    /// The peripheral of that name. Panics if the chip has none: names in models are fixed.
    #[must_use]
    pub fn peripheral(&self, name: &str) -> &PeripheralMap {
        let found = self.peripherals.iter().find(|peripheral| peripheral.name == name);
        found.unwrap_or_else(|| panic!("the chip has no peripheral {name}"))
    }

    /// Every peripheral that has registers.
    pub fn peripherals(&self) -> impl Iterator<Item = &PeripheralMap> {
        self.peripherals.iter()
    }

    /// The peripheral that an address belongs to: the last that starts at or before it.
    #[must_use]
    pub fn at(&self, address: u32) -> Option<&PeripheralMap> {
        let before = self.peripherals.partition_point(|peripheral| peripheral.base <= address);
        let mut nearest_first = self.peripherals[..before].iter().rev();
        nearest_first.find(|peripheral| address - peripheral.base < peripheral.length())
    }
}

/// Number of the interrupt of that name. Panics if the chip has none.
#[must_use]
pub fn interrupt_number(name: &str) -> u32 {
    let found = METADATA.interrupts.iter().find(|interrupt| interrupt.name == name);
    found.unwrap_or_else(|| panic!("the chip has no interrupt {name}")).number
}

/// Bits of priority that the chip's NVIC has.
#[must_use]
pub fn priority_bits() -> u8 {
    METADATA.nvic_priority_bits.unwrap_or(8)
}

impl PeripheralMap {
    fn new(source: &'static Peripheral) -> Option<Self> {
        let registers = source.registers.as_ref()?;
        let mut all = BTreeMap::new();
        collect(registers.ir, registers.block, "", 0, 0, &mut all);
        let rcc = |register: &stm32_metapac::metadata::PeripheralRccRegister| {
            (register.register.to_owned(), register.field.to_owned())
        };
        let (clock, reset) = source
            .rcc
            .as_ref()
            .map_or((None, None), |clocks| (clocks.enable.as_ref().map(rcc), clocks.reset.as_ref().map(rcc)));
        let (clock, reset) = match source.name {
            name if name.starts_with("OPAMP") => with_syscfg(),
            name if name.starts_with("FDCANRAM") => (with_fdcan(), None),
            "USBRAM" => with_usb(),
            _ => (clock, reset),
        };
        let base = u32::try_from(source.address).ok()?;
        let mut places: FxHashMap<String, Vec<Option<usize>>> = FxHashMap::default();
        let mut registers: Vec<Register> = all.into_values().collect();
        for (place, register) in registers.iter_mut().enumerate() {
            register.place = place;
            let of_name = places.entry(register.name.clone()).or_default();
            of_name.resize(of_name.len().max(register.index + 1), None);
            of_name[register.index].get_or_insert(place);
        }
        Some(Self { name: source.name, place: 0, base, clock, reset, registers, places, source })
    }

    fn length(&self) -> u32 {
        self.registers.last().map_or(0, |register| register.offset + 4)
    }

    /// The register at an offset, which may lie inside it.
    #[must_use]
    pub fn register_at(&self, offset: u32) -> Option<&Register> {
        let place = self.registers.binary_search_by_key(&(offset & !3), |register| register.offset);
        place.ok().map(|place| &self.registers[place])
    }

    /// The first register of that name. Panics if there is none: names in models are fixed.
    #[must_use]
    pub fn register(&self, name: &str) -> &Register {
        self.element(name, 0)
    }

    /// One of an array of registers of that name. Panics if there is none.
    #[must_use]
    pub fn element(&self, name: &str, index: usize) -> &Register {
        let place = self.places.get(name).and_then(|of_name| of_name.get(index).copied().flatten());
        let found = place.map(|place| &self.registers[place]);
        found.unwrap_or_else(|| panic!("{} has no register {name}[{index}]", self.name))
    }

    /// Every register.
    pub fn registers(&self) -> impl Iterator<Item = &Register> {
        self.registers.iter()
    }

    /// Numbers of its interrupts, each with the signals that raise it.
    pub fn interrupts(&self) -> impl Iterator<Item = (&'static str, u32)> {
        self.source.interrupts.iter().map(|entry| (entry.signal, interrupt_number(entry.interrupt)))
    }

    /// Its DMA signals, with the number each has at the DMA request multiplexer.
    pub fn dma_requests(&self) -> impl Iterator<Item = (&'static str, u32)> {
        self.source.dma_channels.iter().filter_map(|entry| Some((entry.signal, entry.request?)))
    }

    /// Pins that can carry a signal of this peripheral: name and alternate function.
    pub fn pins(&self, signal: &str) -> impl Iterator<Item = (&'static str, u8)> {
        let wanted = signal.to_owned();
        let pins = self.source.pins.iter().filter(move |pin| pin.signal == wanted);
        pins.filter_map(|pin| Some((pin.pin, pin.af?)))
    }
}

impl Register {
    /// Value of a field. Panics if there is none of that name: names in models are fixed.
    #[must_use]
    pub fn get(&self, value: u32, field: &str) -> u32 {
        (value & self.mask(field)) >> self.field(field).offset
    }

    /// The value with a field replaced.
    #[must_use]
    pub fn with(&self, value: u32, field: &str, content: u32) -> u32 {
        let mask = self.mask(field);
        (value & !mask) | ((content << self.field(field).offset) & mask)
    }

    /// Whether there is a field of that name.
    #[must_use]
    pub fn has_field(&self, field: &str) -> bool {
        self.fields.iter().any(|candidate| candidate.name == field)
    }

    /// Bits of a field.
    #[must_use]
    pub fn mask(&self, field: &str) -> u32 {
        let NamedField { offset, bits, .. } = *self.field(field);
        bit_mask(offset, bits)
    }

    /// Where a field is. Panics if there is none of that name: names in models are fixed.
    #[must_use]
    pub fn find(&self, field: &str) -> Field {
        Field { place: self.place, shift: self.field(field).offset, mask: self.mask(field) }
    }

    fn field(&self, name: &str) -> &NamedField {
        let found = self.fields.iter().find(|field| field.name == name);
        found.unwrap_or_else(|| panic!("register {} has no field {name}", self.name))
    }
}

/// Clock and reset of what belongs to the system configuration, which stm32-metapac does not say: RM0440,
/// RCC_APB2ENR, "SYSCFG + COMP + VREFBUF + OPAMP clock enable".
fn with_syscfg() -> (Switch, Switch) {
    let of_syscfg = |register: &str, field: &str| Some((register.to_owned(), field.to_owned()));
    (of_syscfg("APB2ENR", "SYSCFGEN"), of_syscfg("APB2RSTR", "SYSCFGRST"))
}

/// Clock of the FDCANs' memory, which stm32-metapac does not say either: theirs. No reset clears it.
fn with_fdcan() -> Switch {
    Some(("APB1ENR1".to_owned(), "FDCANEN".to_owned()))
}

/// Those of the packet memory: the USB's.
fn with_usb() -> (Switch, Switch) {
    let of_usb = |register: &str, field: &str| Some((register.to_owned(), field.to_owned()));
    (of_usb("APB1ENR1", "USBEN"), of_usb("APB1RSTR1", "USBRST"))
}

/// Register and field of the RCC.
pub type Switch = Option<(String, String)>;

fn bit_mask(offset: u32, bits: u32) -> u32 {
    (u64::from(u32::MAX) >> (32 - bits.min(32)) << offset) as u32
}

fn collect(ir: &IR, block: &str, prefix: &str, base: u32, index: usize, out: &mut BTreeMap<u32, Register>) {
    let Some(block) = ir.blocks.iter().find(|candidate| same(candidate.name, block)) else { return };
    if let Some(parent) = block.extends {
        collect(ir, parent, prefix, base, index, out);
    }
    for item in block.items {
        let name = format!("{prefix}{}", item.name.to_uppercase());
        for (position, place) in places(item.array.as_ref()).into_iter().enumerate() {
            let offset = base + item.byte_offset + place;
            let index = index.max(position);
            match &item.inner {
                BlockItemInner::Block(inner) => {
                    collect(ir, inner.block, &format!("{name}."), offset, index, out);
                }
                BlockItemInner::Register(register) => {
                    let fields = register.fieldset.map(|set| fields(ir, set)).unwrap_or_default();
                    let whole = bit_mask(0, register.bit_size);
                    let known =
                        fields.iter().fold(0, |bits, field| bits | bit_mask(field.offset, field.bits));
                    let known_bits = if fields.is_empty() { whole } else { known };
                    let writable = register.access != Access::Read;
                    let readable = register.access != Access::Write;
                    let name = name.clone();
                    let new =
                        Register { name, index, place: 0, offset, writable, readable, known_bits, fields };
                    out.entry(offset).and_modify(|old| merge(old, &new)).or_insert(new);
                }
            }
        }
    }
}

/// Two names of one place (input and output capture modes, say): the first name, both meanings.
fn merge(old: &mut Register, new: &Register) {
    old.known_bits |= new.known_bits;
    old.writable |= new.writable;
    old.readable |= new.readable;
    let unknown = |field: &&NamedField| !old.fields.iter().any(|known| known.name == field.name);
    let added: Vec<NamedField> = new.fields.iter().filter(unknown).cloned().collect();
    old.fields.extend(added);
}

fn fields(ir: &IR, set: &str) -> Vec<NamedField> {
    let Some(set) = ir.fieldsets.iter().find(|candidate| same(candidate.name, set)) else {
        return Vec::new();
    };
    let mut all = set.extends.map(|parent| fields(ir, parent)).unwrap_or_default();
    for field in set.fields {
        let places = places(field.array.as_ref());
        let many = places.len() > 1;
        for (position, place) in places.into_iter().enumerate() {
            let name = field.name.to_uppercase();
            let name = if many { format!("{name}[{position}]") } else { name };
            let ranges: Vec<(u32, u32)> = match &field.bit_offset {
                BitOffset::Regular(regular) => vec![(regular.offset, field.bit_size)],
                BitOffset::Cursed(cursed) => cursed
                    .ranges
                    .iter()
                    .map(|range| (*range.start(), range.end() - range.start() + 1))
                    .collect(),
            };
            all.extend(ranges.iter().enumerate().map(|(part, &(offset, bits))| NamedField {
                name: if part == 0 { name.clone() } else { format!("{name}.{part}") },
                offset: offset + place,
                bits,
            }));
        }
    }
    all
}

/// The crate writes one name in two ways: `TIM_GP32` and `TimGp32`.
fn same(one: &str, other: &str) -> bool {
    let letters = |name: &str| name.replace('_', "").to_lowercase();
    letters(one) == letters(other)
}

fn places(array: Option<&Array>) -> Vec<u32> {
    match array {
        None => vec![0],
        Some(Array::Regular(regular)) => (0..regular.len).map(|i| i * regular.stride).collect(),
        Some(Array::Cursed(cursed)) => cursed.offsets.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against RM0440, table "Memory map" and the register maps of each chapter.
    #[test]
    fn registers_lie_where_the_reference_manual_has_them() {
        let map = Map::of_chip();
        let uart = map.peripheral("LPUART1");
        assert_eq!(uart.base, 0x4000_8000);
        assert_eq!(uart.register("TDR").offset, 0x28);
        assert_eq!(uart.register("CR1").mask("UE"), 1);
        let dma = map.peripheral("DMA1");
        assert_eq!(dma.element("CH.CR", 7).offset, 0x8 + 7 * 20);
        assert_eq!(map.at(0x4002_0008).unwrap().name, "DMA1");
        assert_eq!(map.at(0x4800_0400).unwrap().name, "GPIOB");
        assert!(map.at(0x4FFF_0000).is_none());
        assert_eq!(interrupt_number("LPUART1"), 91);
        assert!(uart.pins("TX").any(|pin| pin == ("PA2", 12)));
        assert!(uart.dma_requests().any(|request| request == ("RX", 34)));
    }
}
