//! Contact impedances and conductivity of the untouched skin, from frames recorded on it.
//!
//! Minimises the squared difference between the mean frame f and s v(z): v are the model's voltages,
//! z the contact impedance of each electrode, and the scale s holds the sheet's conductivity and the
//! instrument's gain. Damped least squares over the logarithms of s and z, which keeps both above zero, and of the
//! conductivity tensor where the skin file says that the sheet has a grain; derivatives are finite differences of the
//! forward model.
//!
//! What the model's mesh gets wrong goes into the impedances: at edges of 4.5 mm on electrodes of 11 mm
//! they come out 0.03 ohm m too large, at 0.5 mm a tenth of that (disc of 210 mm, 5.88 mS).
//! `mesh.electrode_edge_length` helps.
//!
//! Measurements that skip driven electrodes feel a contact only by the current that takes the short
//! cut through its metal. They say little about it, and the standard deviations tell how little.

use super::{
    diagnose::dead_below,
    difference::signed_reference,
    grain::{self, Grain},
    order::{Arrangement, OrderError},
};
use dermatome_geometry::{
    mesh::{Lattice, Mesh},
    sheet::ElectrodeModel,
};
use dermatome_model::{
    forward::{Admittivity, ForwardError, ForwardModel, SheetTensors},
    inverse::least_squares::{Fitted, Problem, Schedule, minimise},
    model::{ModelError, mesh},
    skin::{Material, Skin},
};
use dermatome_shared::stimulation::Step;
use nalgebra::{DMatrix, DVector, Vector2};
use num_complex::Complex64;
use rayon::prelude::*;
use serde::Serialize;

/// Change of a logarithm for a finite difference.
const DIFFERENCE: f64 = 1e-4;
/// Most change of a logarithm in one step.
const MOST_CHANGE: f64 = 1.0;
/// Damping of the search, and when it ends.
const SCHEDULE: Schedule = Schedule {
    first: 1e-3,
    rise: 10.0,
    fall: 10.0,
    least: f64::EPSILON,
    most: 1e8,
    ridge: 0.0,
    steps: 30,
    attempts: usize::MAX,
    attempts_in_all: usize::MAX,
    enough: 0.0,
    enough_share: 1e-6,
};
/// A contact impedance stays within this factor of the skin file's.
const FARTHEST: f64 = 1e3;
/// Most of either number of a grain: at their ends it conducts 150 to 1,200 times better along than across.
const MOST_STRETCH: f64 = 2.5;
/// A standard deviation above this share says nothing.
const UNDETERMINED: f64 = 1.0;

/// What was fitted, and how well.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fit {
    /// Root of the sum of squares left over, % of the frame's, with the skin file's impedances and the
    /// scale that suits them best.
    pub residual_before_percent: f64,
    /// The same with what was fitted.
    pub residual_percent: f64,
    /// Steps taken.
    pub steps: usize,
    /// The file's unit for each volt at 1 A and 1 S.
    pub scale: f64,
    /// Sheet conductivity if the file is in volts, S per square; along the grain.
    pub sheet_conductivity_s: f64,
    /// The grain, if the skin file has one.
    pub grain: Option<Grain>,
    /// Each electrode: `[electrode]`.
    pub contacts: Vec<Contact>,
}

/// Contact impedance of one electrode, ohm m, at the skin file's sheet conductivity: only the product
/// of the two shows in voltages that have no scale.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Contact {
    /// Electrode, from 0.
    pub electrode: usize,
    /// As the skin file says.
    pub before: f64,
    /// As fitted.
    pub contact_impedance: f64,
    /// Standard deviation, %, from what is left over; none if the frames do not say.
    pub deviation_percent: Option<f64>,
}

/// Why nothing could be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// Nothing to fit.
    #[error(
        "`electrodes.model` is \"point\", and point electrodes have no contact impedance to fit; allowed: \
         \"complete\""
    )]
    PointModel,
    /// The frames do not fit the drive pattern.
    #[error(transparent)]
    Order(#[from] OrderError),
    /// The skin has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// More to fit than measured.
    #[error(
        "{measurements} measurements are not zero, and {parameters} numbers are to be fitted; allowed: more"
    )]
    TooFew {
        /// Measurements that are not zero.
        measurements: usize,
        /// One for each electrode, the scale, and two of a grain.
        parameters: usize,
    },
}

impl From<ForwardError> for FitError {
    fn from(error: ForwardError) -> Self {
        Self::Model(error.into())
    }
}

/// Fits a frame of the untouched skin, in the file's order.
pub fn fit(skin: &Skin, frame: &[Complex64], arrangement: &Arrangement) -> Result<Fit, FitError> {
    let ElectrodeModel::Complete { contact_impedance, .. } = &skin.electrodes.model else {
        return Err(FitError::PointModel);
    };
    let mean = skin.material.sheet_conductivity * skin.material.across.unwrap_or(1.0).sqrt();
    let relative: Vec<f64> = contact_impedance.iter().map(|z| z * mean).collect();
    let problem = Unknowns::new(skin, frame, arrangement, relative)?;
    let start = problem.start()?;
    let before = problem.share_left(&start);
    let Fitted { state, steps } = minimise(&problem, start, &SCHEDULE)?;
    let covariance = problem.covariance(&state)?;
    let grain = problem.grain(&state, covariance.as_ref());
    // From the mean to what the skin file gives: along the grain.
    let scale = state.numbers[0].exp() * grain.map_or(1.0, |grain| grain.across.sqrt());
    let deviation = |number: usize| covariance.as_ref().map(|covariance| covariance[(number, number)].sqrt());
    let contact = |electrode: usize| Contact {
        electrode,
        before: contact_impedance[electrode],
        contact_impedance: state.numbers[1 + electrode].exp() / mean,
        deviation_percent: deviation(1 + electrode).filter(|&it| it < UNDETERMINED).map(|it| it * 100.0),
    };
    Ok(Fit {
        residual_before_percent: before * 100.0,
        residual_percent: problem.share_left(&state) * 100.0,
        steps,
        scale,
        sheet_conductivity_s: skin.drive.amplitude / scale,
        grain,
        contacts: (0..contact_impedance.len()).map(contact).collect(),
    })
}

struct Unknowns<'a> {
    skin: &'a Skin,
    mesh: Mesh,
    /// Steps whose measurement is not zero.
    steps: Vec<Step>,
    /// What was recorded for them, with the model's sign.
    recorded: Vec<f64>,
    /// The skin file's contact impedances times its conductivity (along and across a grain, the mean), m.
    relative: Vec<f64>,
}

/// A point of the search and its voltages times the scale: `[step]`.
struct State {
    /// Logarithms of the scale and of each relative contact impedance, then, of a sheet with a grain, its stretch.
    numbers: Vec<f64>,
    scaled: Vec<f64>,
}

impl<'a> Unknowns<'a> {
    fn new(
        skin: &'a Skin,
        frame: &[Complex64],
        arrangement: &Arrangement,
        relative: Vec<f64>,
    ) -> Result<Self, FitError> {
        let all = skin.steps();
        let map = arrangement.index_map(&all, skin.electrodes.count, frame.len())?;
        let mesh = mesh(skin, 1.0, Lattice::default())?;
        let mut problem = Self { skin, mesh, steps: all, recorded: Vec::new(), relative };
        let model = problem.voltages(&problem.file_numbers(0.0)[1..])?;
        let signed = signed_reference(frame, &map, &model);
        let floor = dead_below(frame, &map);
        let alive = problem.steps.iter().zip(signed).filter(|(_, value)| value.abs() > floor);
        (problem.steps, problem.recorded) = alive.map(|(step, value)| (*step, value)).unzip();
        let (measurements, parameters) = (problem.steps.len(), problem.file_numbers(0.0).len());
        if measurements <= parameters {
            return Err(FitError::TooFew { measurements, parameters });
        }
        Ok(problem)
    }

    /// What the skin file says, after the logarithm of a scale.
    fn file_numbers(&self, scale: f64) -> Vec<f64> {
        let stretch = grain::stretch(&self.skin.material);
        let impedances = self.relative.iter().map(|z| z.ln());
        let stretch = stretch.iter().flat_map(|stretch| [stretch.x, stretch.y]);
        std::iter::once(scale).chain(impedances).chain(stretch).collect()
    }

    /// In-phase voltages at unit current and mean conductivity, of numbers without the scale: `[step]`.
    fn voltages(&self, numbers: &[f64]) -> Result<Vec<f64>, ForwardError> {
        let (logarithms, stretch) = numbers.split_at(self.relative.len());
        let impedance: Vec<f64> = logarithms.iter().map(|logarithm| logarithm.exp()).collect();
        let (material, along) = match *stretch {
            [c, d] => grain::stretched(&self.skin.material, Vector2::new(c, d)),
            _ => (self.skin.material.clone(), 1.0),
        };
        let admittivity = self.skin.admittivity() * along;
        if admittivity.im == 0.0 {
            self.solve(&impedance, &material, admittivity.re)
        } else {
            self.solve(&impedance, &material, admittivity)
        }
    }

    fn solve<T: Admittivity>(
        &self,
        impedance: &[f64],
        material: &Material,
        admittivity: T,
    ) -> Result<Vec<f64>, ForwardError> {
        let impedance: Vec<T> = impedance.iter().map(|&z| T::from(z)).collect();
        let sheet = SheetTensors::new(material, &self.mesh);
        let forward = ForwardModel::on_sheet(&self.mesh, &impedance, sheet)?;
        let fields = forward.solve(&vec![admittivity; self.mesh.elements.len()])?;
        Ok(fields.voltages(&self.steps).into_iter().map(T::in_phase).collect())
    }

    /// The skin file's impedances, and the scale that suits them best.
    fn start(&self) -> Result<State, ForwardError> {
        let voltages = self.voltages(&self.file_numbers(0.0)[1..])?;
        let product: f64 = voltages.iter().zip(&self.recorded).map(|(v, f)| v * f).sum();
        let scale = product / voltages.iter().map(|v| v * v).sum::<f64>();
        let scaled = voltages.iter().map(|v| v * scale).collect();
        Ok(State { numbers: self.file_numbers(scale.ln()), scaled })
    }

    fn at(&self, numbers: Vec<f64>) -> Result<State, ForwardError> {
        let scale = numbers[0].exp();
        let scaled = self.voltages(&numbers[1..])?.into_iter().map(|v| v * scale).collect();
        Ok(State { numbers, scaled })
    }

    fn share_left(&self, state: &State) -> f64 {
        (self.square(state) / self.recorded.iter().map(|f| f * f).sum::<f64>()).sqrt()
    }

    /// Covariance of the numbers, from what is left over: `[number][number]`; none if it says nothing.
    fn covariance(&self, state: &State) -> Result<Option<DMatrix<f64>>, ForwardError> {
        let slopes = self.slopes(state)?;
        let variance = self.square(state) / (self.steps.len() - state.numbers.len()) as f64;
        Ok(slopes.tr_mul(&slopes).cholesky().map(|factor| factor.inverse() * variance))
    }

    fn grain(&self, state: &State, covariance: Option<&DMatrix<f64>>) -> Option<Grain> {
        let first = 1 + self.relative.len();
        let [c, d] = *state.numbers.get(first..)? else { return None };
        let covariance =
            covariance.map(|covariance| covariance.fixed_view::<2, 2>(first, first).into_owned());
        Some(Grain::new(&self.skin.material, Vector2::new(c, d), covariance))
    }
}

impl Problem for Unknowns<'_> {
    type State = State;
    type Error = ForwardError;

    fn left(&self, state: &State) -> DVector<f64> {
        let left = self.recorded.iter().zip(&state.scaled).map(|(f, v)| f - v);
        DVector::from_iterator(self.recorded.len(), left)
    }

    fn square(&self, state: &State) -> f64 {
        self.left(state).iter().map(|r| r * r).sum()
    }

    /// d scaled voltage / d number: `[step][number]`.
    fn slopes(&self, state: &State) -> Result<DMatrix<f64>, ForwardError> {
        let column = |number: usize| {
            let mut numbers = state.numbers.clone();
            numbers[number] += DIFFERENCE;
            let moved = self.at(numbers)?.scaled;
            Ok(moved.iter().zip(&state.scaled).map(|(a, b)| (a - b) / DIFFERENCE).collect())
        };
        let columns: Vec<Vec<f64>> =
            (1..state.numbers.len()).into_par_iter().map(column).collect::<Result<_, ForwardError>>()?;
        Ok(DMatrix::from_fn(self.steps.len(), state.numbers.len(), |step, number| match number {
            0 => state.scaled[step],
            _ => columns[number - 1][step],
        }))
    }

    fn moved(&self, state: &State, change: &DVector<f64>) -> Result<State, ForwardError> {
        let pairs = state.numbers.iter().zip(change.iter());
        let mut numbers: Vec<f64> =
            pairs.map(|(number, by)| number + by.clamp(-MOST_CHANGE, MOST_CHANGE)).collect();
        for (logarithm, z) in numbers[1..].iter_mut().zip(&self.relative) {
            *logarithm = logarithm.clamp((z / FARTHEST).ln(), (z * FARTHEST).ln());
        }
        for stretch in &mut numbers[1 + self.relative.len()..] {
            *stretch = stretch.clamp(-MOST_STRETCH, MOST_STRETCH);
        }
        self.at(numbers)
    }
}
