//! Lines: which signals of which blocks raise which exception. Signals of one exception are or-ed.

use super::{
    Chip,
    blocks::{ADCS, Block},
    map::Map,
    nvic::Nvic,
};

/// Peripherals whose interrupts are modelled, converters apart.
const WITH_SIGNALS: [&str; 20] = [
    "LPUART1", "USART1", "USB", "TIM2", "TIM3", "TIM4", "TIM5", "TIM6", "TIM7", "TIM15", "DMA1", "DMA2",
    "FLASH", "DMAMUX1", "EXTI", "DAC1", "DAC2", "DAC3", "DAC4", "FDCAN1",
];

/// Every line, by exception.
#[derive(Clone, Debug)]
pub(super) struct Lines {
    groups: Vec<Group>,
    /// Places in `groups` that each block takes part in, by the block's number.
    of_block: Vec<Vec<usize>>,
}

/// The signals of one exception.
#[derive(Clone, Debug)]
struct Group {
    exception: usize,
    signals: Vec<(Block, &'static str)>,
}

impl Lines {
    /// The lines that the chip has.
    pub(super) fn of_chip() -> Self {
        let mut groups: Vec<Group> = Vec::new();
        let mut of_block = vec![Vec::new(); Block::all().count()];
        for name in WITH_SIGNALS.iter().chain(&ADCS) {
            let Some(block) = Block::named(name) else { continue };
            // All signals of a timer are one (its model raises all of them).
            let signals = Map::of_chip().peripheral(name).interrupts();
            for (signal, number) in signals.filter(|(signal, _)| !name.starts_with("TIM") || *signal == "UP")
            {
                let exception = Nvic::exception_of(number);
                let known = groups.iter().position(|group| group.exception == exception);
                let place = known.unwrap_or(groups.len());
                if known.is_none() {
                    groups.push(Group { exception, signals: Vec::new() });
                }
                groups[place].signals.push((block, signal));
                of_block[block.number()].push(place);
            }
        }
        Self { groups, of_block }
    }
}

impl Chip {
    /// Hands the lines of the blocks that were touched to the NVIC.
    pub(super) fn raise_lines(&mut self) {
        for block in self.touched.iter() {
            for place in 0..self.lines.of_block[block.number()].len() {
                let group = &self.lines.groups[self.lines.of_block[block.number()][place]];
                let is_up = |&(block, signal): &(Block, &str)| {
                    let model = self.model(block);
                    model.bank().is_in_use && model.interrupts(signal)
                };
                let level = group.signals.iter().any(is_up);
                self.core.nvic.set_line(group.exception, level);
            }
        }
    }
}
