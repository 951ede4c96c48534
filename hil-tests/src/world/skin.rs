//! The skin as a network between its electrodes: the true skin, solved on a mesh of its own and reduced to
//! the admittance that the electrodes' leads see.

use super::multiplexers::Closed;
use dermatome::{
    model::ModelError,
    sheet::ElectrodeModel,
    simulate::{Press, ScriptedSheet, TrueSkin},
    skin::Skin,
};
use nalgebra::DMatrix;
use num_complex::Complex64;
use std::{
    f64::consts::TAU,
    sync::{Arc, Mutex, PoisonError},
};

/// Channels of a multiplexer, and so electrodes that the front end can reach.
pub const LEADS: usize = 16;
/// Between solutions whose conductivities are this far apart (natural logarithm) impedances are
/// interpolated; they depend on it so smoothly that the error is below 1e-6.
const GRID: f64 = 0.005;

/// Current into each lead's electrode by the voltage of each: `[lead][lead]`, S. Leads without an electrode
/// have zeros.
pub type Admittance = [[Complex64; LEADS]; LEADS];

/// What touches a skin, and what its sheet remembers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Touch {
    /// Fingers on the skin.
    pub presses: Vec<Press>,
    /// Relative conductivity of the true skin's elements, `[element]`, where it follows from pressure over time; none: the
    /// presses alone make it.
    pub conductivity: Option<Arc<Vec<f64>>>,
}

/// A skin that presses and drift change.
#[derive(Debug)]
pub struct SkinNetwork {
    truth: TrueSkin,
    sheet_conductivity: f64,
    ground: usize,
    solved: Mutex<Solved>,
}

/// Impedances under the present touch, at places of the grid.
#[derive(Debug, Default)]
struct Solved {
    touch: Touch,
    impedances: Vec<(i32, DMatrix<Complex64>)>,
}

impl SkinNetwork {
    /// The skin at a frequency, Hz, stretched along x by a share; its contacts have a capacitance, F per metre of
    /// electrode, beside the resistance that the skin file gives.
    pub fn new(
        skin: &Skin,
        contact_capacitance: f64,
        frequency: f64,
        stretch: f64,
    ) -> Result<Self, ModelError> {
        let impedance = |z: &f64| 1.0 / Complex64::new(1.0 / z, TAU * frequency * contact_capacitance);
        let contacts = match &skin.electrodes.model {
            ElectrodeModel::Point => vec![Complex64::default(); usize::from(skin.electrodes.count)],
            ElectrodeModel::Complete { contact_impedance, .. } => {
                contact_impedance.iter().map(impedance).collect()
            }
        };
        Ok(Self {
            truth: TrueSkin::with_contacts(skin, &contacts, frequency, stretch)?,
            sheet_conductivity: skin.material.sheet_conductivity,
            ground: skin.electrodes.ground,
            solved: Mutex::default(),
        })
    }

    /// What the leads see under this touch, the sheet's conductivity being `scale` times the skin file's.
    #[must_use]
    pub fn admittance(&self, touch: &Touch, scale: f64) -> Admittance {
        let grounded = self.impedance(touch, scale).try_inverse();
        let grounded = grounded.expect("electrodes on one skin have an impedance matrix of full rank");
        expanded(&(grounded * Complex64::from(self.sheet_conductivity)), self.ground)
    }

    /// Voltage between the last two of four electrodes per ampere from the first to the second, ohm: the
    /// forward model itself, nothing inverted or interpolated; electrodes that the skin lacks give zero.
    #[must_use]
    pub fn transfer(&self, touch: &Touch, scale: f64, closed: Closed) -> Complex64 {
        let transfer = self.truth.transfer(&self.conductivity(touch, scale));
        let channels = closed.map(|channel| channel.map_or(LEADS, usize::from));
        let [drive, sink, plus, minus] = channels;
        if channels.iter().any(|&channel| channel >= transfer.len()) {
            return Complex64::default();
        }
        let driven = |at: usize| transfer[at][drive] - transfer[at][sink];
        (driven(plus) - driven(minus)) / self.sheet_conductivity
    }

    /// Presses held until a time of the script, s, on a sheet that remembers.
    #[must_use]
    pub fn touch(&self, sheet: &mut ScriptedSheet, presses: Vec<Press>, time: f64) -> Touch {
        let conductivity = sheet.conductivity(&self.truth, &presses, time);
        Touch { presses, conductivity: Some(conductivity.into()) }
    }

    /// Of each element, relative to the skin file's: `[element]`.
    fn conductivity(&self, touch: &Touch, scale: f64) -> Vec<f64> {
        let of_touch = touch.conductivity.as_deref().cloned();
        let mut conductivity = of_touch.unwrap_or_else(|| self.truth.conductivity(&touch.presses));
        conductivity.iter_mut().for_each(|sigma| *sigma *= scale);
        conductivity
    }

    /// Relative impedances against the ground, without its row and column.
    fn impedance(&self, touch: &Touch, scale: f64) -> DMatrix<Complex64> {
        let place = scale.ln() / GRID;
        let (low, share) = (place.floor() as i32, place - place.floor());
        let mut solved = self.solved.lock().unwrap_or_else(PoisonError::into_inner);
        if solved.touch != *touch {
            *solved = Solved { touch: touch.clone(), impedances: Vec::new() };
        }
        let below = self.solve(&mut solved, low);
        if share < 1e-9 {
            return below;
        }
        let above = self.solve(&mut solved, low + 1);
        below * Complex64::from(1.0 - share) + above * Complex64::from(share)
    }

    fn solve(&self, solved: &mut Solved, place: i32) -> DMatrix<Complex64> {
        if let Some((_, known)) = solved.impedances.iter().find(|(known, _)| *known == place) {
            return known.clone();
        }
        let scale = (f64::from(place) * GRID).exp();
        let transfer = self.truth.transfer(&self.conductivity(&solved.touch, scale));
        let kept: Vec<usize> = (0..transfer.len()).filter(|&electrode| electrode != self.ground).collect();
        // Against the ground's potential, for currents that leave by it.
        let ground = self.ground;
        let matrix = DMatrix::from_fn(kept.len(), kept.len(), |row, col| {
            let against = |driven: usize| transfer[kept[row]][driven] - transfer[ground][driven];
            against(kept[col]) - against(ground)
        });
        solved.impedances.retain(|(known, _)| (known - place).abs() <= 1);
        solved.impedances.push((place, matrix.clone()));
        matrix
    }
}

/// Puts the ground back: the currents of all electrodes add up to zero.
fn expanded(grounded: &DMatrix<Complex64>, ground: usize) -> Admittance {
    let mut admittance = [[Complex64::default(); LEADS]; LEADS];
    let lead = |place: usize| if place < ground { place } else { place + 1 };
    for row in 0..grounded.nrows() {
        for col in 0..grounded.ncols() {
            let value = (grounded[(row, col)] + grounded[(col, row)]) / 2.0;
            let (row, col) = (lead(row), lead(col));
            admittance[row][col] += value;
            admittance[ground][col] -= value;
            admittance[row][ground] -= value;
            admittance[ground][ground] += value;
        }
    }
    admittance
}

/// Resistors in a ring, ohm: `[lead]` is between that one and the next.
#[must_use]
pub fn ring(ohms: &[f64; LEADS]) -> Admittance {
    let mut admittance = [[Complex64::default(); LEADS]; LEADS];
    for (lead, ohms) in ohms.iter().enumerate() {
        let (next, siemens) = ((lead + 1) % LEADS, Complex64::from(1.0 / ohms));
        admittance[lead][lead] += siemens;
        admittance[next][next] += siemens;
        admittance[lead][next] -= siemens;
        admittance[next][lead] -= siemens;
    }
    admittance
}

/// The admittance with a resistance, ohm, between a lead and its electrode; infinite takes it off.
#[must_use]
pub fn with_resistance(admittance: &Admittance, electrode: usize, ohms: f64) -> Admittance {
    let conductance = 1.0 / ohms;
    let own = admittance[electrode][electrode];
    if own == Complex64::default() {
        return *admittance;
    }
    let inner = own + conductance;
    let mut changed = *admittance;
    for (row, values) in changed.iter_mut().enumerate() {
        for (col, value) in values.iter_mut().enumerate() {
            let (out, back) = (admittance[row][electrode], admittance[electrode][col]);
            *value = match (row == electrode, col == electrode) {
                (true, true) => own * conductance / inner,
                (true, false) => back * conductance / inner,
                (false, true) => out * conductance / inner,
                (false, false) => admittance[row][col] - out * back / inner,
            };
        }
    }
    changed
}
