//! Electrodes: how many, how wide, how well they touch. Where they lie says the skin's shape.

use dermatome_geometry::sheet::ElectrodeModel;

/// Electrodes of a skin, electrode 1 first.
#[derive(Clone, Debug, PartialEq)]
pub struct Electrodes {
    /// How many there are.
    pub count: u8,
    /// Point or complete model.
    pub model: ElectrodeModel,
    /// Zero-based electrode whose potential is 0 V. Voltages between electrodes do not depend on it.
    pub ground: usize,
}
