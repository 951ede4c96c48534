//! The front end in time: what the chip does goes in, volts at its converter come out.
//!
//! Between changes the whole chain only decays (see [`super::modes`]). A change of switches, gain or skin
//! takes it to another chain with the same node voltages; a switch also pushes its charge into the nodes
//! at its sides. Where the source can reach its limit, time passes in small steps, each of which checks
//! whether it has.

use super::{
    fault::{Fault, stuck},
    handle::{Conditions, WorldHandle},
    modes::{CURRENT, Chain, DRIVE, LIMIT, MODES, Modes, PARTS, Parts},
    multiplexers::{Closed, Multiplexers},
    network::{MINUS, NODES, Network, PLUS, SOURCE},
    noise::Noise,
    parameters::Analogue,
    range::RangeSwitch,
};
use crate::chip::{
    system_memory::{VREFINT_VOLTS, sensor_volts},
    time::Time,
    world::{OpampSetting, World},
};
use nalgebra::SVector;
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// Step of time where the source may reach its limit: 10 cycles of the chip's clock, and more the longer nothing changes.
const SMALL_STEP: Time = Time::from_nanos(59);
/// What was left alone for so many steps changes little in one.
const CALM: u64 = 17;
/// Drift and scripts go on this often.
const PASS_PERIOD: Time = Time::from_millis(1);

/// The analogue world of an emulated board.
#[derive(Clone, Debug)]
pub struct AnalogueWorld {
    handle: WorldHandle,
    analogue: Analogue,
    seen: u64,
    conditions: Conditions,
    network: Arc<Network>,
    chains: Chains,
    current: usize,
    parts: Parts,
    now: Time,
    /// When something happened last that voltages follow.
    changed: Time,
    next_pass: Time,
    /// Voltage of the DAC's pin.
    dac: f64,
    multiplexers: Multiplexers,
    range: RangeSwitch,
    closed: Closed,
    /// Whether the source is at its limit.
    limited: bool,
    opamp: OpampSetting,
    gain: f64,
    noise: Noise,
}

/// Chains that have been needed with the present network.
#[derive(Clone, Debug, Default)]
struct Chains {
    places: FxHashMap<(Closed, bool, u64), usize>,
    chains: Vec<Chain>,
}

impl AnalogueWorld {
    /// The world that this handle changes, at rest.
    #[must_use]
    pub fn new(handle: WorldHandle) -> Self {
        let setup = handle.setup().clone();
        let (network, conditions) = (handle.network(), handle.conditions());
        let analogue = handle.analogue();
        let mut world = Self {
            seen: handle.version(),
            range: RangeSwitch::new(&analogue.ranges, conditions.in_small_range),
            conditions,
            handle,
            network,
            chains: Chains::default(),
            current: 0,
            parts: [0.0; PARTS],
            now: Time::ZERO,
            changed: Time::ZERO,
            next_pass: Time::ZERO,
            dac: 0.0,
            multiplexers: Multiplexers::new(&analogue.multiplexer),
            closed: [None; 4],
            limited: false,
            opamp: OpampSetting::Off,
            gain: 1.0,
            noise: Noise::new(&analogue, setup.seed),
            analogue,
        };
        world.current = world.chain();
        world.noise.follow(&world.chains.chains[world.current]);
        world
    }

    /// Voltage at the output of the current source.
    #[must_use]
    pub fn source_voltage(&self) -> f64 {
        self.chains.chains[self.current].source_voltage(&self.parts)
    }

    /// Lets time pass up to `at`, with what happens on the way.
    fn advance(&mut self, at: Time) {
        if at >= self.next_pass {
            self.handle.pass(at);
            self.next_pass = at + PASS_PERIOD;
        }
        if self.handle.version() != self.seen {
            self.renew();
        }
        loop {
            let [switches, range] = [self.multiplexers.next_change(), self.range.next_change()];
            let next = switches.min(range);
            if next > at {
                break;
            }
            self.pass(next);
            if switches <= range {
                self.multiplexers.close();
                self.switch();
            } else {
                self.change_range();
            }
        }
        self.pass(at);
    }

    /// The switch of the source's range has moved.
    fn change_range(&mut self) {
        self.handle.record_range();
        self.handle.set_small_range(self.range.finish());
        self.renew();
    }

    fn pass(&mut self, until: Time) {
        while self.now < until {
            let left = until.since(self.now);
            let may_clamp = self.chains.chains[self.current].may_clamp;
            let calm = Time::from_nanos(self.now.since(self.changed).nanoseconds() / CALM);
            let step = if may_clamp { left.min(SMALL_STEP.max(calm)) } else { left };
            self.chains.chains[self.current].decay(&mut self.parts, step);
            self.now += step;
            if may_clamp {
                self.limit();
            }
        }
    }

    /// The source reaches its limit, or leaves it.
    fn limit(&mut self) {
        let volts = self.chains.chains[self.current].source_voltage(&self.parts);
        let compliance = self.analogue.source.compliance;
        if self.limited && volts * self.parts[LIMIT] < compliance {
            self.enter(|world, values| (world.limited, values[LIMIT]) = (false, 0.0));
        } else if !self.limited && volts.abs() > compliance {
            self.enter(|world, values| (world.limited, values[LIMIT]) = (true, volts.signum()));
        }
    }

    /// Changes what chain it is, or physical values; all others stay.
    fn enter(&mut self, change: impl FnOnce(&mut Self, &mut Parts)) {
        self.changed = self.now;
        let mut values = self.chains.chains[self.current].values(&self.parts);
        change(self, &mut values);
        self.current = self.chain();
        let chain = &self.chains.chains[self.current];
        self.parts = chain.parts(&values);
        self.noise.follow(chain);
    }

    /// The chain of how things are.
    fn chain(&mut self) -> usize {
        let key = (self.closed, self.limited, self.gain.to_bits());
        if let Some(&place) = self.chains.places.get(&key) {
            return place;
        }
        let source = &self.analogue.source;
        let limit = (source.full_current() / (source.open_voltage - source.compliance), source.compliance);
        let frequency = self.handle.frequency();
        let modes = Modes::new(&self.network, self.closed, self.limited.then_some(limit), frequency);
        let may_clamp = self.limited || self.network.may_clamp(self.closed, frequency);
        self.chains.chains.push(Chain::new(modes, &self.analogue, self.gain, may_clamp));
        let place = self.chains.chains.len() - 1;
        self.chains.places.insert(key, place);
        place
    }

    /// Something was changed through the handle.
    fn renew(&mut self) {
        self.enter(|world, values| {
            world.seen = world.handle.version();
            world.conditions = world.handle.conditions();
            world.network = world.handle.network();
            world.chains = Chains::default();
            let before = world.analogue.source.transconductance;
            world.analogue = world.handle.analogue();
            // The drive is in volts, and its parts in amperes.
            let ratio = world.analogue.source.transconductance / before;
            values[DRIVE..=CURRENT].iter_mut().for_each(|value| *value *= ratio);
        });
        self.follow();
        if self.is_broken(Fault::DacDead) {
            self.drive(self.analogue.adc.full_scale / 2.0);
        }
    }

    fn is_broken(&self, fault: Fault) -> bool {
        self.conditions.faults.contains(&fault)
    }

    /// Address, enable or a broken line have changed.
    fn follow(&mut self) {
        let faults = &self.conditions.faults;
        self.multiplexers.follow(|word| stuck(word, faults), self.now);
        self.switch();
    }

    /// Switches that are not as they were open and close, with their charge.
    fn switch(&mut self) {
        let (old, new) = (self.closed, self.multiplexers.closed());
        if old == new {
            return;
        }
        let charge = charges(old, new, self.analogue.multiplexer.charge_injection);
        let volts = self.network.charged(&charge);
        self.enter(|world, values| {
            world.closed = new;
            values[MODES..MODES + NODES].iter_mut().zip(&volts).for_each(|(value, volts)| *value += volts);
        });
    }

    fn drive(&mut self, volts: f64) {
        self.changed = self.now;
        let change = (volts - self.dac) * self.analogue.source.transconductance;
        self.chains.chains[self.current].drive(&mut self.parts, change);
        self.dac = volts;
    }

    /// Voltage at the output of OPAMP2.
    fn amplified(&mut self, at: Time) -> f64 {
        let supply = self.analogue.adc.full_scale;
        if self.is_broken(Fault::AdcSaturated) {
            return supply;
        }
        let OpampSetting::Amplifier { input: 0, gain } = self.opamp else { return 0.0 };
        let gain = self.analogue.pga.gain(gain);
        let chain = &self.chains.chains[self.current];
        // The clamp before the chip's pin keeps the filter's output between ground and supply.
        let swing = gain * supply / 2.0;
        let pga = self.analogue.pga;
        let signal = chain.output(&self.parts).clamp(-swing, swing) + gain * pga.offset;
        let (amplifiers, converter) = self.noise.sample(at);
        let times = self.conditions.noise;
        let output = (supply / 2.0 + signal + times * amplifiers).clamp(pga.headroom, supply - pga.headroom);
        let adc = self.analogue.adc;
        output * (1.0 + adc.gain_error) + times * converter + adc.offset
    }
}

/// Charge into each node as switches go from `old` to `new`, C: a switch pushes it out as it opens and
/// takes it back as it closes.
fn charges(old: Closed, new: Closed, charge: f64) -> SVector<f64, NODES> {
    let mut charges = SVector::zeros();
    for (place, common) in [Some(SOURCE), None, Some(PLUS), Some(MINUS)].into_iter().enumerate() {
        let (opens, closes) = (old[place], new[place]);
        if opens == closes {
            continue;
        }
        for (channel, sign) in [(opens, 1.0), (closes, -1.0)] {
            let Some(channel) = channel else { continue };
            charges[usize::from(channel)] += sign * charge;
            if let Some(common) = common {
                charges[common] += sign * charge;
            }
        }
    }
    charges
}

impl World for AnalogueWorld {
    fn copy(&self) -> Option<Box<dyn World>> {
        Some(Box::new(self.clone()))
    }

    /// All capacitors are empty when it comes back.
    fn lose_power(&mut self, at: Time) {
        self.advance(at);
        self.enter(|world, values| {
            (world.limited, world.dac) = (false, 0.0);
            *values = [0.0; PARTS];
        });
    }

    /// A DAC that is off leaves its pin to the capacitor behind it.
    fn dac(&mut self, dac: usize, channel: usize, code: Option<u16>, at: Time) {
        let (1, 0, Some(code)) = (dac, channel, code) else { return };
        self.handle.record(code, at);
        self.advance(at);
        if !self.is_broken(Fault::DacDead) {
            let [lowest, highest] = self.analogue.dac.range;
            let volts = f64::from(code) * self.analogue.dac.lsb * (1.0 + self.analogue.dac.gain_error);
            self.drive(volts.clamp(lowest, highest));
        }
    }

    fn pins(&mut self, port: char, levels: u16, at: Time) {
        self.advance(at);
        if self.multiplexers.pins(port, levels) {
            let current = self.chains.chains[self.current].current(&self.parts);
            let share = current / self.analogue.source.full_current();
            self.handle.record_enable(self.multiplexers.is_enabled(), share, at);
            self.follow();
        }
        if self.range.pins(port, levels, at) {
            self.handle.record_range();
        }
    }

    fn opamp(&mut self, number: usize, setting: OpampSetting, at: Time) {
        if number != 2 {
            return;
        }
        self.advance(at);
        self.opamp = setting;
        if let OpampSetting::Amplifier { gain, .. } = setting
            && gain != self.gain
        {
            self.enter(|world, _| world.gain = gain);
        }
    }

    fn voltage(&mut self, adc: usize, channel: usize, at: Time) -> f64 {
        self.advance(at);
        match (adc, channel) {
            (2, 16) => self.amplified(at),
            (1, 16) => sensor_volts(self.conditions.temperature),
            (1, 18) => VREFINT_VOLTS,
            _ => 0.0,
        }
    }
}
