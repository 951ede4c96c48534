//! Thermometer: the chip's temperature sensor. It is for moments at which the other converter is at rest.

use embassy_stm32::adc::{Adc, SampleTime, Temperature};

use super::{TEMPERATURE_POINTS, ThermometerConverter};

/// Supply of the converter when the factory measured.
const FACTORY_VOLTS: f32 = 3.0;
/// Supply of the converter on the board.
const VOLTS: f32 = 3.3;

/// The chip's temperature sensor.
pub struct Thermometer {
    converter: Adc<'static, ThermometerConverter>,
    sensor: Temperature,
}

impl Thermometer {
    /// Starts the sensor, which this converter can measure.
    pub(super) fn new(converter: Adc<'static, ThermometerConverter>) -> Self {
        let sensor = converter.enable_temperature();
        Self { converter, sensor }
    }

    /// Degrees Celsius, by the two points that the factory has measured.
    ///
    /// A conversion that begins more than a millisecond after the one before may be wrong (erratum of the
    /// STM32G474, ES0430): the second of two counts.
    pub fn celsius(&mut self) -> f32 {
        let [_, code] =
            [(); 2].map(|()| self.converter.blocking_read(&mut self.sensor, SampleTime::CYCLES640_5));
        let code = f32::from(code) * VOLTS / FACTORY_VOLTS;
        let [(low, cold), (high, hot)] = TEMPERATURE_POINTS.map(|(at, celsius)| (factory_code(at), celsius));
        cold + (code - low) * (hot - cold) / (high - low)
    }
}

fn factory_code(address: usize) -> f32 {
    #[expect(unsafe_code, reason = "the factory left it at an address")]
    // SAFETY: the board's table says where; the chip's system memory is always readable.
    let code = unsafe { core::ptr::read_volatile(address as *const u16) };
    f32::from(code)
}
