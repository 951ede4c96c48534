//! Parameters: the analogue front end as a file such as `rigs/analogue.toml` describes it, checked and in
//! SI units.
//!
//! Where each value is from stands beside it in the file.

mod file;

use dermatome::skin::quantity::{CAPACITANCE, FREQUENCY, Kind, Quantity};
use file::{AdcTable, AmplifierTable, DacTable, File, MultiplexerTable, PgaTable, RangeTable, StrayTable};
use std::{
    ops::RangeInclusive,
    path::{Path, PathBuf},
};

const VOLTAGE: Kind = Kind::new(&[("V", 1.0), ("mV", 1e-3), ("uV", 1e-6)]);
const RESISTANCE: Kind = Kind::new(&[("ohm", 1.0), ("kohm", 1e3), ("Mohm", 1e6), ("Gohm", 1e9)]);
const TRANSCONDUCTANCE: Kind = Kind::new(&[("S", 1.0), ("mS", 1e-3), ("uS", 1e-6)]);
const CHARGE: Kind = Kind::new(&[("C", 1.0), ("nC", 1e-9), ("pC", 1e-12)]);
const DURATION: Kind = Kind::new(&[("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)]);
const DECIBELS: Kind = Kind::new(&[("dB", 1.0)]);
const NOISE_DENSITY: Kind = Kind::new(&[("V/sqrt(Hz)", 1.0), ("uV/sqrt(Hz)", 1e-6), ("nV/sqrt(Hz)", 1e-9)]);
const CURRENT_NOISE_DENSITY: Kind =
    Kind::new(&[("A/sqrt(Hz)", 1.0), ("pA/sqrt(Hz)", 1e-12), ("fA/sqrt(Hz)", 1e-15)]);
const LSB: Kind = Kind::new(&[("LSB", 1.0)]);

/// Why a file describes no analogue front end.
#[derive(Debug, thiserror::Error)]
pub enum ParameterError {
    /// The file cannot be read.
    #[error("cannot read the analogue file `{}`: {reason}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: std::io::Error,
    },
    /// The file is no TOML, or lacks a field, or has one too many.
    #[error("analogue file `{}`: {reason}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// What the reader says.
        reason: String,
    },
    /// A field has a value that is not allowed.
    #[error("analogue file `{}`: `{field}` is {value}; allowed: {allowed}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// Table and field.
        field: String,
        /// Its value.
        value: String,
        /// Values that are allowed.
        allowed: String,
    },
}

/// The front end between the chip's DAC and its ADC.
#[derive(Clone, Debug, PartialEq)]
pub struct Analogue {
    /// The chip's DAC.
    pub dac: Dac,
    /// The current source, in the range in use: in a file's front end, and in a drawn one, the large one.
    pub source: Source,
    /// Its ranges.
    pub ranges: Ranges,
    /// The four multiplexers, all alike.
    pub multiplexer: Multiplexer,
    /// The instrumentation amplifier.
    pub amplifier: Amplifier,
    /// The chip's amplifier with programmable gain.
    pub pga: Pga,
    /// The chip's converter.
    pub adc: Adc,
    /// Capacitance of the leads to the electrodes.
    pub stray: Stray,
}

/// The chip's DAC with its output buffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dac {
    /// LSB, V.
    pub lsb: f64,
    /// Lowest and highest voltage of its buffer, V.
    pub range: [f64; 2],
    /// Frequency of the pole with which its buffer settles, Hz.
    pub bandwidth: f64,
    /// Error of its gain.
    pub gain_error: f64,
}

/// Ranges of the current source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ranges {
    /// For currents up to 1 mA.
    pub large: Source,
    /// For currents up to 29 uA.
    pub small: Source,
    /// Time from a change of the pin to the other range, s.
    pub switching: f64,
}

/// The current source, a Norton equivalent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source {
    /// A/V.
    pub transconductance: f64,
    /// Amplitude at the DAC that is 100 %, V.
    pub full_drive: f64,
    /// Frequency of its pole, Hz.
    pub bandwidth: f64,
    /// Output resistance, ohm.
    pub output_resistance: f64,
    /// Output capacitance, F.
    pub output_capacitance: f64,
    /// Voltage up to which it is linear, V.
    pub compliance: f64,
    /// Peak voltage with nothing connected, V.
    pub open_voltage: f64,
}

impl Source {
    /// Amplitude of the current at 100 %, A.
    #[must_use]
    pub fn full_current(&self) -> f64 {
        self.transconductance * self.full_drive
    }
}

/// A 16:1 multiplexer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Multiplexer {
    /// Resistance of a channel that is on, ohm.
    pub on_resistance: f64,
    /// Greatest difference of that between channels, ohm.
    pub on_resistance_match: f64,
    /// Capacitance of the common pin to ground, F.
    pub common_capacitance: f64,
    /// Capacitance of a channel's pin to ground, F.
    pub channel_capacitance: f64,
    /// Charge that a switch pushes into either side as it opens, C.
    pub charge_injection: f64,
    /// Time from a change of the address or the enable pin to the new channel, s.
    pub transition_time: f64,
    /// Whether the old channel opens before the new one closes.
    pub break_before_make: bool,
}

/// The instrumentation amplifier and the filter behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Amplifier {
    /// Gain.
    pub gain: f64,
    /// Frequency of its pole, Hz.
    pub bandwidth: f64,
    /// Frequency of the filter's pole, Hz.
    pub filter: f64,
    /// Capacitance of each input to ground, F.
    pub input_capacitance: f64,
    /// Resistance of each input to ground, ohm.
    pub input_resistance: f64,
    /// Share of the voltage common to both inputs that adds to the difference.
    pub common_mode: f64,
    /// Noise at the input, V/sqrt(Hz).
    pub noise: f64,
    /// Noise of the current of each input, A/sqrt(Hz).
    pub current_noise: f64,
}

/// The chip's amplifier with programmable gain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pga {
    /// Gain-bandwidth product, Hz.
    pub gain_bandwidth: f64,
    /// Offset at the input, V.
    pub offset: f64,
    /// Noise at the input, V/sqrt(Hz).
    pub noise: f64,
    /// How near the output comes to ground and supply, V.
    pub headroom: f64,
    /// Error of each gain: `[log2 of the gain]`. At gain 1 there is no network to be wrong.
    pub gain_errors: [f64; 7],
}

impl Pga {
    /// The gain that it has where it should have this one, a power of two.
    #[must_use]
    pub fn gain(&self, gain: f64) -> f64 {
        let place = gain.log2() as usize;
        gain * (1.0 + self.gain_errors.get(place).copied().unwrap_or_default())
    }
}

/// The chip's converter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adc {
    /// Voltage of the highest code, V.
    pub full_scale: f64,
    /// Standard deviation of its noise, V.
    pub noise: f64,
    /// Offset, V.
    pub offset: f64,
    /// Error of its gain.
    pub gain_error: f64,
}

/// Capacitance of the leads to the electrodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stray {
    /// Each lead to ground, F.
    pub to_ground: f64,
    /// Between neighbours, F.
    pub between: f64,
}

impl Analogue {
    /// Reads and checks a file.
    pub fn load(path: &Path) -> Result<Self, ParameterError> {
        let text = std::fs::read_to_string(path)
            .map_err(|reason| ParameterError::Read { path: path.to_owned(), reason })?;
        Self::parse(path, &text)
    }

    /// Checks the text of a file; `path` is for error messages.
    pub fn parse(path: &Path, text: &str) -> Result<Self, ParameterError> {
        let syntax = |error: toml::de::Error| ParameterError::Syntax {
            path: path.to_owned(),
            reason: error.to_string().trim_end().to_owned(),
        };
        let file: File = toml::from_str(text).map_err(syntax)?;
        Checker { path }.analogue(&file)
    }

    /// The same with the source in one of its ranges.
    #[must_use]
    pub fn in_range(&self, is_small: bool) -> Self {
        let source = if is_small { self.ranges.small } else { self.ranges.large };
        Self { source, ..self.clone() }
    }

    /// The same with nothing but a plug on the board's connector.
    #[must_use]
    pub fn without_leads(&self) -> Self {
        Self { stray: Stray { to_ground: 0.0, between: 0.0 }, ..self.clone() }
    }
}

/// Turns each table into SI units; knows the file for error messages.
struct Checker<'a> {
    path: &'a Path,
}

impl Checker<'_> {
    fn analogue(&self, file: &File) -> Result<Analogue, ParameterError> {
        let ranges = self.ranges(file)?;
        Ok(Analogue {
            dac: self.dac(&file.dac)?,
            source: ranges.large,
            ranges,
            multiplexer: self.multiplexer(&file.multiplexer)?,
            amplifier: self.amplifier(&file.amplifier)?,
            pga: self.pga(&file.pga)?,
            adc: self.adc(&file.adc)?,
            stray: self.stray(&file.stray)?,
        })
    }

    fn dac(&self, table: &DacTable) -> Result<Dac, ParameterError> {
        let full = self.read("dac.full_scale", &table.full_scale, VOLTAGE, 1.62..=3.6)?;
        let lowest = self.read("dac.lowest", &table.lowest, VOLTAGE, 0.0..=full)?;
        let highest = self.read("dac.highest", &table.highest, VOLTAGE, lowest..=full)?;
        let codes = self.codes("dac.bits", table.bits)?;
        let settling = self.read("dac.settling", &table.settling, DURATION, 1e-9..=1e-4)?;
        // To half a step of the full scale, as the datasheet counts.
        let bandwidth = (2.0 * codes).ln() / (std::f64::consts::TAU * settling);
        Ok(Dac { lsb: full / codes, range: [lowest, highest], bandwidth, gain_error: 0.0 })
    }

    fn ranges(&self, file: &File) -> Result<Ranges, ParameterError> {
        let (table, read) =
            (&file.current_source, |field, quantity, kind, range| self.read(field, quantity, kind, range));
        read("current_source.series_capacitance", &table.series_capacitance, CAPACITANCE, 1e-7..=1e-3)?;
        let full_drive = read("current_source.full_drive", &table.full_drive, VOLTAGE, 0.01..=1.65)?;
        let switching = &table.range_switching;
        Ok(Ranges {
            large: self.source("large_range", &file.large_range, full_drive)?,
            small: self.source("small_range", &file.small_range, full_drive)?,
            switching: read("current_source.range_switching", switching, DURATION, 0.0..=1.0)?,
        })
    }

    fn source(&self, name: &str, table: &RangeTable, full_drive: f64) -> Result<Source, ParameterError> {
        let read =
            |field: &str, quantity, kind, range| self.read(&format!("{name}.{field}"), quantity, kind, range);
        let compliance = read("compliance", &table.compliance, VOLTAGE, 0.1..=60.0)?;
        let beyond = compliance * 1.001..=200.0;
        let (resistance, capacitance) = (&table.output_resistance, &table.output_capacitance);
        Ok(Source {
            transconductance: read(
                "transconductance",
                &table.transconductance,
                TRANSCONDUCTANCE,
                1e-7..=0.1,
            )?,
            full_drive,
            bandwidth: read("bandwidth", &table.bandwidth, FREQUENCY, 1e4..=1e9)?,
            output_resistance: read("output_resistance", resistance, RESISTANCE, 1e3..=1e12)?,
            output_capacitance: read("output_capacitance", capacitance, CAPACITANCE, 0.0..=1e-8)?,
            compliance,
            open_voltage: read("open_voltage", &table.open_voltage, VOLTAGE, beyond)?,
        })
    }

    fn multiplexer(&self, table: &MultiplexerTable) -> Result<Multiplexer, ParameterError> {
        let small = 0.0..=1e-8;
        let farads = |field, quantity: &_| self.read(field, quantity, CAPACITANCE, small.clone());
        let channel_capacitance =
            farads("multiplexer.channel_off_capacitance", &table.channel_off_capacitance)?;
        farads("multiplexer.common_off_capacitance", &table.common_off_capacitance)?;
        let both = channel_capacitance..=1e-8;
        let on = self.read("multiplexer.on_capacitance", &table.on_capacitance, CAPACITANCE, both)?;
        let on_resistance =
            self.read("multiplexer.on_resistance", &table.on_resistance, RESISTANCE, 0.1..=1e4)?;
        let (spread, charge) = (&table.on_resistance_match, &table.charge_injection);
        Ok(Multiplexer {
            on_resistance,
            on_resistance_match: self.read(
                "multiplexer.on_resistance_match",
                spread,
                RESISTANCE,
                0.0..=on_resistance,
            )?,
            common_capacitance: on - channel_capacitance,
            channel_capacitance,
            charge_injection: self.read("multiplexer.charge_injection", charge, CHARGE, -1e-9..=1e-9)?,
            transition_time: self.read(
                "multiplexer.transition_time",
                &table.transition_time,
                DURATION,
                0.0..=1e-5,
            )?,
            break_before_make: table.break_before_make,
        })
    }

    fn amplifier(&self, table: &AmplifierTable) -> Result<Amplifier, ParameterError> {
        let read = |field, quantity, kind, range| self.read(field, quantity, kind, range);
        self.between("amplifier.gain", table.gain, 0.1..=1000.0, "")?;
        read("amplifier.input_range", &table.input_range, VOLTAGE, 0.01..=60.0)?;
        let rejection = read("amplifier.cmrr_50khz", &table.cmrr_50khz, DECIBELS, 20.0..=200.0)?;
        let (capacitance, resistance) = (&table.input_capacitance, &table.input_resistance);
        Ok(Amplifier {
            gain: table.gain,
            bandwidth: read("amplifier.bandwidth", &table.bandwidth, FREQUENCY, 1e4..=1e9)?,
            filter: read("amplifier.filter", &table.filter, FREQUENCY, 1e4..=1e9)?,
            input_capacitance: read("amplifier.input_capacitance", capacitance, CAPACITANCE, 0.0..=1e-8)?,
            input_resistance: read("amplifier.input_resistance", resistance, RESISTANCE, 1e3..=1e13)?,
            common_mode: 10_f64.powf(-rejection / 20.0),
            noise: read("amplifier.noise", &table.noise, NOISE_DENSITY, 0.0..=1e-5)?,
            current_noise: read(
                "amplifier.current_noise",
                &table.current_noise,
                CURRENT_NOISE_DENSITY,
                0.0..=1e-9,
            )?,
        })
    }

    fn pga(&self, table: &PgaTable) -> Result<Pga, ParameterError> {
        Ok(Pga {
            gain_bandwidth: self.read("pga.gain_bandwidth", &table.gain_bandwidth, FREQUENCY, 1e5..=1e9)?,
            offset: self.read("pga.offset", &table.offset, VOLTAGE, -0.1..=0.1)?,
            noise: self.read("pga.noise", &table.noise, NOISE_DENSITY, 0.0..=1e-5)?,
            headroom: self.read("pga.headroom", &table.headroom, VOLTAGE, 0.0..=1.0)?,
            gain_errors: [0.0; 7],
        })
    }

    fn adc(&self, table: &AdcTable) -> Result<Adc, ParameterError> {
        let full_scale = self.read("adc.full_scale", &table.full_scale, VOLTAGE, 1.62..=3.6)?;
        let lsb = full_scale / self.codes("adc.bits", table.bits)?;
        Ok(Adc {
            full_scale,
            noise: self.read("adc.noise", &table.noise, LSB, 0.0..=100.0)? * lsb,
            offset: self.read("adc.offset", &table.offset, LSB, -100.0..=100.0)? * lsb,
            gain_error: 0.0,
        })
    }

    fn stray(&self, table: &StrayTable) -> Result<Stray, ParameterError> {
        Ok(Stray {
            to_ground: self.read("stray.lead_to_ground", &table.lead_to_ground, CAPACITANCE, 0.0..=1e-8)?,
            between: self.read("stray.lead_to_lead", &table.lead_to_lead, CAPACITANCE, 0.0..=1e-8)?,
        })
    }

    /// Both converters of the chip have 12 bits, and the model of the chip says so too.
    fn codes(&self, field: &str, bits: u32) -> Result<f64, ParameterError> {
        self.between(field, f64::from(bits), 12.0..=12.0, "")?;
        Ok(f64::from(1_u32 << bits))
    }

    fn read(
        &self,
        field: &str,
        quantity: &Quantity,
        kind: Kind,
        range: RangeInclusive<f64>,
    ) -> Result<f64, ParameterError> {
        let Some(value) = kind.read(quantity) else {
            let allowed = format!("a number in {}, or text with its unit: {}", kind.si(), kind.units());
            return Err(self.refuse(field, quantity.to_string(), allowed));
        };
        self.between(field, value, range, kind.si())?;
        Ok(value)
    }

    fn between(
        &self,
        field: &str,
        value: f64,
        range: RangeInclusive<f64>,
        unit: &str,
    ) -> Result<(), ParameterError> {
        if range.contains(&value) {
            return Ok(());
        }
        let allowed = format!("{} to {} {unit}", range.start(), range.end()).trim_end().to_owned();
        Err(self.refuse(field, format!("{value} {unit}").trim_end().to_owned(), allowed))
    }

    fn refuse(&self, field: &str, value: String, allowed: String) -> ParameterError {
        ParameterError::Value { path: self.path.to_owned(), field: field.to_owned(), value, allowed }
    }
}
