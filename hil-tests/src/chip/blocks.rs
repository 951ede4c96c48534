//! Blocks: the modelled peripherals by number, so that nothing looks for a name while time passes.

use super::{Chip, map::Map, peripheral::Peripheral};

/// One modelled peripheral; of many equal ones, which, from 0 on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Block {
    Rcc,
    Pwr,
    Flash,
    Link,
    Iwdg,
    Exti,
    Syscfg,
    Dbgmcu,
    Dmamux,
    Dma(u8),
    Port(u8),
    Timer(u8),
    Dac(u8),
    Adc(u8),
    AdcCommon(u8),
    Opamp(u8),
    Bus,
    Can,
    CanMemory,
    Crs,
    Usb,
    PacketMemory,
}

/// Timers: name, channels and bits.
pub(super) const TIMERS: [(&str, usize, u32); 7] = [
    ("TIM2", 4, 32),
    ("TIM3", 4, 16),
    ("TIM4", 4, 16),
    ("TIM5", 4, 32),
    ("TIM6", 0, 16),
    ("TIM7", 0, 16),
    ("TIM15", 2, 16),
];
/// Converters, and the common registers of the first two and of the others.
pub(super) const ADCS: [&str; 5] = ["ADC1", "ADC2", "ADC3", "ADC4", "ADC5"];
pub(super) const ADC_COMMONS: [&str; 2] = ["ADC12_COMMON", "ADC345_COMMON"];
pub(super) const DACS: [&str; 4] = ["DAC1", "DAC2", "DAC3", "DAC4"];
pub(super) const OPAMPS: [&str; 6] = ["OPAMP1", "OPAMP2", "OPAMP3", "OPAMP4", "OPAMP5", "OPAMP6"];

/// Every block, with its name in the reference manual; a block's place here is its number.
const NAMED: [(&str, Block); 48] = [
    ("RCC", Block::Rcc),
    ("PWR", Block::Pwr),
    ("FLASH", Block::Flash),
    ("LPUART1", Block::Link),
    ("IWDG", Block::Iwdg),
    ("EXTI", Block::Exti),
    ("SYSCFG", Block::Syscfg),
    ("DBGMCU", Block::Dbgmcu),
    ("DMAMUX1", Block::Dmamux),
    ("DMA1", Block::Dma(0)),
    ("DMA2", Block::Dma(1)),
    ("GPIOA", Block::Port(0)),
    ("GPIOB", Block::Port(1)),
    ("GPIOC", Block::Port(2)),
    ("GPIOD", Block::Port(3)),
    ("GPIOE", Block::Port(4)),
    ("GPIOF", Block::Port(5)),
    ("GPIOG", Block::Port(6)),
    ("TIM2", Block::Timer(0)),
    ("TIM3", Block::Timer(1)),
    ("TIM4", Block::Timer(2)),
    ("TIM5", Block::Timer(3)),
    ("TIM6", Block::Timer(4)),
    ("TIM7", Block::Timer(5)),
    ("TIM15", Block::Timer(6)),
    ("DAC1", Block::Dac(0)),
    ("DAC2", Block::Dac(1)),
    ("DAC3", Block::Dac(2)),
    ("DAC4", Block::Dac(3)),
    ("ADC1", Block::Adc(0)),
    ("ADC2", Block::Adc(1)),
    ("ADC3", Block::Adc(2)),
    ("ADC4", Block::Adc(3)),
    ("ADC5", Block::Adc(4)),
    ("ADC12_COMMON", Block::AdcCommon(0)),
    ("ADC345_COMMON", Block::AdcCommon(1)),
    ("OPAMP1", Block::Opamp(0)),
    ("OPAMP2", Block::Opamp(1)),
    ("OPAMP3", Block::Opamp(2)),
    ("OPAMP4", Block::Opamp(3)),
    ("OPAMP5", Block::Opamp(4)),
    ("OPAMP6", Block::Opamp(5)),
    ("USART1", Block::Bus),
    ("FDCAN1", Block::Can),
    ("FDCANRAM1", Block::CanMemory),
    ("CRS", Block::Crs),
    ("USB", Block::Usb),
    ("USBRAM", Block::PacketMemory),
];

impl Block {
    /// Every block.
    pub(super) fn all() -> impl Iterator<Item = Self> {
        NAMED.into_iter().map(|(_, block)| block)
    }

    /// The block of that name, if it is modelled.
    pub(super) fn named(name: &str) -> Option<Self> {
        NAMED.iter().find(|(known, _)| *known == name).map(|&(_, block)| block)
    }

    /// Its number.
    pub(super) fn number(self) -> usize {
        let (first, place) = match self {
            Self::Rcc => (0, 0),
            Self::Pwr => (1, 0),
            Self::Flash => (2, 0),
            Self::Link => (3, 0),
            Self::Iwdg => (4, 0),
            Self::Exti => (5, 0),
            Self::Syscfg => (6, 0),
            Self::Dbgmcu => (7, 0),
            Self::Dmamux => (8, 0),
            Self::Dma(place) => (9, place),
            Self::Port(place) => (11, place),
            Self::Timer(place) => (18, place),
            Self::Dac(place) => (25, place),
            Self::Adc(place) => (29, place),
            Self::AdcCommon(place) => (34, place),
            Self::Opamp(place) => (36, place),
            Self::Bus => (42, 0),
            Self::Can => (43, 0),
            Self::CanMemory => (44, 0),
            Self::Crs => (45, 0),
            Self::Usb => (46, 0),
            Self::PacketMemory => (47, 0),
        };
        first + usize::from(place)
    }
}

/// A set of blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Blocks(u64);

impl Blocks {
    pub(super) const ALL: Self = Self((1 << NAMED.len()) - 1);
    /// Both DMA controllers.
    pub(super) const DMA: Self = Self(3 << 9);
    /// All timers.
    pub(super) const TIMERS: Self = Self(0x7F << 18);

    pub(super) fn is_empty(self) -> bool {
        self.0 == 0
    }

    pub(super) fn contains(self, block: Block) -> bool {
        self.0 >> block.number() & 1 == 1
    }

    pub(super) fn meets(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    pub(super) fn insert(&mut self, block: Block) {
        self.0 |= 1 << block.number();
    }

    pub(super) fn iter(self) -> impl Iterator<Item = Block> {
        let mut left = self.0;
        std::iter::from_fn(move || {
            let number = left.trailing_zeros() as usize;
            left &= left.wrapping_sub(1);
            NAMED.get(number).map(|&(_, block)| block)
        })
    }
}

/// Blocks of the peripherals, in the map's order.
pub(super) fn by_place() -> Vec<Option<Block>> {
    Map::of_chip().peripherals().map(|peripheral| Block::named(peripheral.name)).collect()
}

impl Chip {
    pub(super) fn model_mut(&mut self, block: Block) -> &mut dyn Peripheral {
        match block {
            Block::Rcc => &mut self.rcc,
            Block::Pwr => &mut self.pwr,
            Block::Flash => &mut self.flash,
            Block::Link => &mut self.uart,
            Block::Iwdg => &mut self.iwdg,
            Block::Exti => &mut self.exti,
            Block::Syscfg => &mut self.syscfg,
            Block::Dbgmcu => &mut self.dbgmcu,
            Block::Dmamux => &mut self.dmamux,
            Block::Dma(place) => &mut self.dma[usize::from(place)],
            Block::Port(place) => &mut self.ports[usize::from(place)],
            Block::Timer(place) => &mut self.timers[usize::from(place)],
            Block::Dac(place) => &mut self.dacs[usize::from(place)],
            Block::Adc(place) => &mut self.adcs[usize::from(place)],
            Block::AdcCommon(place) => &mut self.adc_commons[usize::from(place)],
            Block::Opamp(place) => &mut self.opamps[usize::from(place)],
            Block::Bus => &mut self.usart1,
            Block::Can => &mut self.fdcan,
            Block::CanMemory => &mut self.fdcan.ram,
            Block::Crs => &mut self.crs,
            Block::Usb => &mut self.usb,
            Block::PacketMemory => self.usb.memory_mut(),
        }
    }

    pub(super) fn model(&self, block: Block) -> &dyn Peripheral {
        match block {
            Block::Rcc => &self.rcc,
            Block::Pwr => &self.pwr,
            Block::Flash => &self.flash,
            Block::Link => &self.uart,
            Block::Iwdg => &self.iwdg,
            Block::Exti => &self.exti,
            Block::Syscfg => &self.syscfg,
            Block::Dbgmcu => &self.dbgmcu,
            Block::Dmamux => &self.dmamux,
            Block::Dma(place) => &self.dma[usize::from(place)],
            Block::Port(place) => &self.ports[usize::from(place)],
            Block::Timer(place) => &self.timers[usize::from(place)],
            Block::Dac(place) => &self.dacs[usize::from(place)],
            Block::Adc(place) => &self.adcs[usize::from(place)],
            Block::AdcCommon(place) => &self.adc_commons[usize::from(place)],
            Block::Opamp(place) => &self.opamps[usize::from(place)],
            Block::Bus => &self.usart1,
            Block::Can => &self.fdcan,
            Block::CanMemory => &self.fdcan.ram,
            Block::Crs => &self.crs,
            Block::Usb => &self.usb,
            Block::PacketMemory => self.usb.memory(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blocks_number_is_its_place_and_sets_give_back_what_they_were_given() {
        for (place, (name, block)) in NAMED.into_iter().enumerate() {
            assert_eq!((block.number(), Block::named(name)), (place, Some(block)));
        }
        assert!(Blocks::ALL.iter().eq(Block::all()));
        assert!(Blocks::TIMERS.iter().all(|block| matches!(block, Block::Timer(_))));
        assert_eq!(Blocks::TIMERS.iter().count(), TIMERS.len());
        assert!(Blocks::DMA.iter().eq([Block::Dma(0), Block::Dma(1)]));
    }
}
