//! Tolerances: front ends as they come out of a workshop, each part drawn from its limits.
//!
//! Every value is drawn evenly between its limits, which is harder than what parts do. Where limits are from: *found*
//! in DS12288 Rev 6, *by design* the tolerance of the parts in docs/hardware.md, or *assumed*.

use super::parameters::{Adc, Amplifier, Analogue, Dac, Multiplexer, Pga, Ranges, Source, Stray};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

/// Settling of the DAC's buffer against the typical 1.7 us: 3 us at most (table 74); assumed: 1 us at least.
const DAC_SETTLING: [f64; 2] = [1.0 / 1.7, 3.0 / 1.7];
/// Gain of the DAC (table 74).
const DAC_GAIN: f64 = 0.005;
/// Rin and Rf of 1 %, and a little of the bridge, by design.
const TRANSCONDUCTANCE: f64 = 0.022;
/// The small range's against the large one's: R5a and R5b of 0.1 %, by design.
const RANGE: f64 = 0.002;
/// Rf of 1 % and Cf of 5 %, by design.
const SOURCE_POLE: f64 = 0.06;
/// Gain-bandwidth product against the typical 13 MHz: 7 MHz at least (table 80); assumed: 19 MHz at most.
const GAIN_BANDWIDTH: [f64; 2] = [7.0 / 13.0, 19.0 / 13.0];
/// Gains 1 to 64 (table 80): 1 %, and 2 % from 32 on; a follower has no network.
const PGA_GAINS: [f64; 7] = [0.0, 0.01, 0.01, 0.01, 0.01, 0.02, 0.02];
/// Offset of the amplifier over all temperatures, V (table 80), and of the converter, LSB (tables 68 to 70).
const PGA_OFFSET: f64 = 3e-3;
const ADC_OFFSET: f64 = 6.9;
/// Gain of the converter, LSB of 4096 (tables 68 to 70).
const ADC_GAIN: f64 = 8.1;
/// Gain of the amplifier: RG of 1 %, by design, and 0.2 % of its own (assumed).
const AMPLIFIER_GAIN: f64 = 0.012;
/// Its bandwidth (assumed).
const AMPLIFIER_POLE: f64 = 0.3;
/// 1 kohm of 1 %, 150 pF of 5 %, and the clamp's diodes (assumed).
const FILTER: f64 = 0.09;
/// Common mode against the estimate, of either sign (assumed: 6 dB worse at most).
const COMMON_MODE: f64 = 2.0;
/// Resistances of switches (assumed).
const ON_RESISTANCE: f64 = 0.25;
/// Capacitances of chips, and of cables (assumed).
const CAPACITANCE: f64 = 0.3;
const CABLE: f64 = 0.5;

/// Draws within limits.
struct Draw(Pcg64);

impl Draw {
    fn between(&mut self, [low, high]: [f64; 2]) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// An error of either sign.
    fn error(&mut self, limit: f64) -> f64 {
        self.between([-limit, limit])
    }

    /// A value times 1, give or take.
    fn about(&mut self, value: f64, limit: f64) -> f64 {
        value * (1.0 + self.error(limit))
    }
}

impl Analogue {
    /// One front end of those that this design gives; `seed` says which.
    #[must_use]
    pub fn drawn(&self, seed: u64) -> Self {
        let mut draw = Draw(Pcg64::seed_from_u64(seed));
        let dac = draw.dac(self.dac);
        let source = draw.source(self.ranges.large);
        let drawn = Self {
            dac,
            source,
            ranges: self.ranges,
            multiplexer: draw.multiplexer(self.multiplexer),
            amplifier: draw.amplifier(self.amplifier),
            pga: draw.pga(self.pga),
            adc: draw.adc(self.adc),
            stray: Stray {
                to_ground: draw.about(self.stray.to_ground, CABLE),
                between: draw.about(self.stray.between, CABLE),
            },
        };
        Self { ranges: draw.ranges(self.ranges, source), ..drawn }
    }
}

impl Draw {
    fn dac(&mut self, dac: Dac) -> Dac {
        Dac { bandwidth: dac.bandwidth / self.between(DAC_SETTLING), gain_error: self.error(DAC_GAIN), ..dac }
    }

    /// The design's output resistance is the least there is; its inverse lies evenly between that and nothing.
    fn source(&mut self, source: Source) -> Source {
        Source {
            transconductance: self.about(source.transconductance, TRANSCONDUCTANCE),
            bandwidth: self.about(source.bandwidth, SOURCE_POLE),
            output_resistance: source.output_resistance / self.between([0.02, 1.0]),
            output_capacitance: self.about(source.output_capacitance, CAPACITANCE),
            ..source
        }
    }

    /// The small range shares the parts that the large one was drawn with.
    fn ranges(&mut self, design: Ranges, large: Source) -> Ranges {
        let shared = |value: f64, of: fn(&Source) -> f64| value * of(&large) / of(&design.large);
        let small = Source {
            transconductance: self
                .about(shared(design.small.transconductance, |source| source.transconductance), RANGE),
            bandwidth: shared(design.small.bandwidth, |source| source.bandwidth),
            output_resistance: shared(design.small.output_resistance, |source| source.output_resistance),
            output_capacitance: shared(design.small.output_capacitance, |source| source.output_capacitance),
            ..design.small
        };
        Ranges { large, small, ..design }
    }

    fn multiplexer(&mut self, multiplexer: Multiplexer) -> Multiplexer {
        Multiplexer {
            on_resistance: self.about(multiplexer.on_resistance, ON_RESISTANCE),
            common_capacitance: self.about(multiplexer.common_capacitance, CAPACITANCE),
            channel_capacitance: self.about(multiplexer.channel_capacitance, CAPACITANCE),
            ..multiplexer
        }
    }

    fn amplifier(&mut self, amplifier: Amplifier) -> Amplifier {
        Amplifier {
            gain: self.about(amplifier.gain, AMPLIFIER_GAIN),
            bandwidth: self.about(amplifier.bandwidth, AMPLIFIER_POLE),
            filter: self.about(amplifier.filter, FILTER),
            input_capacitance: self.about(amplifier.input_capacitance, CAPACITANCE),
            common_mode: amplifier.common_mode * self.error(COMMON_MODE),
            ..amplifier
        }
    }

    fn pga(&mut self, pga: Pga) -> Pga {
        Pga {
            gain_bandwidth: pga.gain_bandwidth * self.between(GAIN_BANDWIDTH),
            gain_errors: PGA_GAINS.map(|limit| self.error(limit)),
            offset: self.error(PGA_OFFSET),
            ..pga
        }
    }

    fn adc(&mut self, adc: Adc) -> Adc {
        let lsb = adc.full_scale / 4096.0;
        Adc { offset: self.error(ADC_OFFSET) * lsb, gain_error: self.error(ADC_GAIN / 4096.0), ..adc }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn drawn_front_ends_differ_and_stay_within_the_limits() {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/rigs/analogue.toml"));
        let design = Analogue::load(path).unwrap();
        assert_eq!(design.drawn(3), design.drawn(3));
        let boards: Vec<Analogue> = (0..1000).map(|seed| design.drawn(seed)).collect();
        let range = |of: fn(&Analogue) -> f64| {
            let values = boards.iter().map(of);
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
        };
        for (what, (low, high), [least, most]) in [
            ("gain-bandwidth", range(|board| board.pga.gain_bandwidth), [7e6, 19e6]),
            ("gain 64", range(|board| board.pga.gain(64.0)), [62.72, 65.28]),
            ("gain 1", range(|board| board.pga.gain(1.0)), [1.0, 1.0]),
            ("adc", range(|board| board.adc.gain_error * 4096.0), [-8.1, 8.1]),
            ("source", range(|board| board.source.transconductance / 0.7143e-3), [0.978, 1.022]),
            ("cable", range(|board| board.stray.to_ground), [25e-12, 75e-12]),
        ] {
            let slack: f64 = 0.01 * (most - least) + 1e-12;
            assert!(low >= least - slack && high <= most + slack, "{what}: {low} to {high}");
            assert!(low <= least + slack && high >= most - slack, "{what}: {low} to {high}");
        }
    }
}
