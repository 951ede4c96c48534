//! Tables of a file such as `rigs/analogue.toml`, as they stand there.

use dermatome::skin::quantity::Quantity;
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub(super) dac: DacTable,
    pub(super) current_source: SourceTable,
    pub(super) large_range: RangeTable,
    pub(super) small_range: RangeTable,
    pub(super) multiplexer: MultiplexerTable,
    pub(super) amplifier: AmplifierTable,
    pub(super) pga: PgaTable,
    pub(super) adc: AdcTable,
    pub(super) stray: StrayTable,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DacTable {
    pub(super) bits: u32,
    pub(super) full_scale: Quantity,
    pub(super) lowest: Quantity,
    pub(super) highest: Quantity,
    pub(super) settling: Quantity,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SourceTable {
    pub(super) full_drive: Quantity,
    pub(super) range_switching: Quantity,
    /// So large that every carrier passes; without it a fault could send direct current into a person.
    pub(super) series_capacitance: Quantity,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RangeTable {
    pub(super) transconductance: Quantity,
    pub(super) bandwidth: Quantity,
    pub(super) output_resistance: Quantity,
    pub(super) output_capacitance: Quantity,
    pub(super) compliance: Quantity,
    pub(super) open_voltage: Quantity,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MultiplexerTable {
    pub(super) on_resistance: Quantity,
    pub(super) on_resistance_match: Quantity,
    pub(super) on_capacitance: Quantity,
    pub(super) common_off_capacitance: Quantity,
    pub(super) channel_off_capacitance: Quantity,
    pub(super) charge_injection: Quantity,
    pub(super) transition_time: Quantity,
    pub(super) break_before_make: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AmplifierTable {
    pub(super) gain: f64,
    pub(super) bandwidth: Quantity,
    pub(super) filter: Quantity,
    pub(super) input_capacitance: Quantity,
    pub(super) input_resistance: Quantity,
    pub(super) cmrr_50khz: Quantity,
    pub(super) noise: Quantity,
    pub(super) current_noise: Quantity,
    /// Read and checked; the model's inputs take any voltage, see the README.
    pub(super) input_range: Quantity,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PgaTable {
    pub(super) gain_bandwidth: Quantity,
    pub(super) offset: Quantity,
    pub(super) noise: Quantity,
    pub(super) headroom: Quantity,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AdcTable {
    pub(super) bits: u32,
    pub(super) full_scale: Quantity,
    pub(super) noise: Quantity,
    pub(super) offset: Quantity,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StrayTable {
    pub(super) lead_to_ground: Quantity,
    pub(super) lead_to_lead: Quantity,
}
