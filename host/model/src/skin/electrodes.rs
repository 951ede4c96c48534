//! Electrodes: how many, how wide, how well they touch. Where they lie says the skin's shape.

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

/// How electrodes appear in the forward model.
#[derive(Clone, Debug, PartialEq)]
pub enum ElectrodeModel {
    /// Each is one node of the mesh, without contact impedance.
    Point,
    /// Each covers a piece of the rim, or inside the sheet a disc: the complete electrode model.
    Complete {
        /// Length of the piece, or diameter of the disc, m: `[electrode]`.
        width: Vec<f64>,
        /// Contact impedance of each electrode, ohm m: `[electrode]`. Divided by the width it gives ohms.
        contact_impedance: Vec<f64>,
    },
}

impl ElectrodeModel {
    /// Length of rim that an electrode covers, m; 0 for the point model.
    #[must_use]
    pub fn width(&self, electrode: usize) -> f64 {
        match self {
            Self::Point => 0.0,
            Self::Complete { width, .. } => width[electrode],
        }
    }
}
