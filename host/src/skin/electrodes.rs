//! Electrodes: where they sit on the rim, how wide they are, how well they touch.

/// Electrodes on the rim of a skin, electrode 1 first.
#[derive(Clone, Debug, PartialEq)]
pub struct Electrodes {
    /// Arc length of each centre on the rim, m: see [`crate::skin::outline::Outline::rim_point`].
    pub centres: Vec<f64>,
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
    /// Each covers a piece of the rim: the complete electrode model.
    Complete {
        /// Length of the piece, m.
        width: f64,
        /// Contact impedance of each electrode, ohm m: `[electrode]`.
        contact_impedance: Vec<f64>,
    },
}

impl Electrodes {
    /// How many there are; a skin file holds at most 16.
    #[must_use]
    pub fn count(&self) -> u8 {
        self.centres.len() as u8
    }

    /// Length of rim each electrode covers, m; 0 for the point model.
    #[must_use]
    pub fn width(&self) -> f64 {
        match self.model {
            ElectrodeModel::Point => 0.0,
            ElectrodeModel::Complete { width, .. } => width,
        }
    }

    /// The two electrodes closest to each other (zero-based) and the free rim between them, m;
    /// negative if they overlap.
    #[must_use]
    pub fn tightest_gap(&self, perimeter: f64) -> (usize, usize, f64) {
        let mut order: Vec<usize> = (0..self.centres.len()).collect();
        let place = |i: usize| self.centres[i].rem_euclid(perimeter);
        order.sort_by(|&a, &b| place(a).total_cmp(&place(b)));
        let next = |i: usize| order[(i + 1) % order.len()];
        (0..order.len())
            .map(|i| {
                (order[i], next(i), (place(next(i)) - place(order[i])).rem_euclid(perimeter) - self.width())
            })
            .min_by(|a, b| a.2.total_cmp(&b.2))
            .unwrap_or((0, 0, perimeter))
    }
}
