//! Model: a skin taken through mesh, forward model, Jacobian and reconstruction matrix.

use crate::{
    forward::{Fields, ForwardError, ForwardModel, electrode_unknown},
    inverse::reconstruction_matrix,
    jacobian::{combine_rows, combine_voltages, jacobian, step_counts},
    mesh::{Lattice, Mesh, MeshError, generate},
    pixels,
    prior::{Prior, PriorError},
    skin::{Skin, electrodes::ElectrodeModel},
};
use dermatome_shared::{
    MAX_PIXELS,
    image::{Geometry, pixel_cells},
    patch::{CombinedInto, Difference},
    stimulation::Step,
};
use faer::{Col, Mat};
use std::time::{Duration, Instant};

/// Everything computed for one skin. Voltages are relative: at unit current and unit
/// conductivity, see [`crate::forward`].
#[derive(Clone, Debug)]
pub struct Model {
    /// Stimulation table: `[step]`.
    pub steps: Vec<Step>,
    /// Where each step goes: `[step]`.
    pub combination: Vec<CombinedInto>,
    /// The mesh.
    pub mesh: Mesh,
    /// Fields of the untouched skin.
    pub fields: Fields,
    /// Voltages of the untouched skin: `[step]`.
    pub voltages: Vec<f64>,
    /// Pixel grid.
    pub geometry: Geometry,
    /// d voltage / d relative conductivity: `[measurement][pixel]`.
    pub jacobian: Mat<f64>,
    /// Relative conductivity from difference data of the skin's kind, as the board computes them
    /// (see [`dermatome_shared::reference`]): `[pixel][measurement]`.
    pub conductivity_from_difference: Mat<f64>,
    /// Kind of difference data the matrix takes.
    pub difference: Difference,
    /// How long each stage took.
    pub stages: Vec<Stage>,
}

/// How long one stage took.
#[derive(Clone, Debug)]
pub struct Stage {
    /// Name of the stage.
    pub name: &'static str,
    /// Wall time.
    pub time: Duration,
}

/// Why a skin has no model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// No mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// No forward solution.
    #[error(transparent)]
    Forward(#[from] ForwardError),
    /// No prior.
    #[error(transparent)]
    Prior(#[from] PriorError),
    /// Too many pixels for a board, or none.
    #[error("`image.columns` gives {pixels} pixels; allowed: 1 to {MAX_PIXELS}")]
    Pixels {
        /// Pixels inside the outline.
        pixels: usize,
    },
    /// A pixel that no part of the mesh falls into.
    #[error(
        "no element of the mesh lies in pixel {pixel}: `mesh.edge_length` is too coarse for `image.columns`"
    )]
    EmptyPixel {
        /// Index of the pixel.
        pixel: usize,
    },
    /// A normalised measurement would be divided by next to nothing.
    #[error(
        "measurement {measurement} of the untouched skin is too small to normalise by ({share:.0e} of the mean); \
         allowed here: `inverse.normalised` = false"
    )]
    SmallVoltage {
        /// Index of the measurement.
        measurement: usize,
        /// Its size over the mean.
        share: f64,
    },
}

/// Mesh of a skin and its forward model.
pub fn forward_model(
    skin: &Skin,
    edge_length: f64,
    lattice: Lattice,
) -> Result<(Mesh, ForwardModel), ModelError> {
    let mesh = generate(&skin.outline, &skin.electrodes, edge_length, lattice)?;
    let impedance = match &skin.electrodes.model {
        ElectrodeModel::Point => vec![0.0; skin.electrodes.centres.len()],
        ElectrodeModel::Complete { contact_impedance, .. } => {
            contact_impedance.iter().map(|z| z * skin.sheet_conductivity).collect()
        }
    };
    let ground = electrode_unknown(&mesh, skin.electrodes.ground);
    let forward = ForwardModel::new(&mesh, &impedance, ground)?;
    Ok((mesh, forward))
}

impl Model {
    /// Computes the model of a skin; `on_stage` hears the name of each stage as it begins.
    pub fn build(skin: &Skin, mut on_stage: impl FnMut(&'static str)) -> Result<Self, ModelError> {
        let mut clock = StageClock::default();
        let steps = skin.steps();
        let combination = skin.combination(&steps);

        on_stage(clock.begin("mesh"));
        let (mesh, forward) = forward_model(skin, skin.edge_length, Lattice::default())?;

        on_stage(clock.begin("forward"));
        let fields = forward.solve(&vec![1.0; mesh.elements.len()])?;
        let voltages = fields.voltages(&steps);

        on_stage(clock.begin("jacobian"));
        let geometry = pixels::grid(&skin.outline, skin.image_columns);
        check_pixels(&geometry)?;
        let raster = pixels::raster(&mesh, &geometry);
        check_raster(&raster)?;
        let jacobian = combine_rows(&jacobian(&mesh, &fields, &steps, &raster), &combination);

        on_stage(clock.begin("matrix"));
        let scale =
            DifferenceScale::new(skin.inverse.difference, &combine_voltages(&voltages, &combination))?;
        let weights = step_counts(&combination);
        let scaled = scale.scale_rows(&jacobian);
        let prior = Prior::new(skin.inverse.prior, &raster, &scaled, &weights);
        let matrix = reconstruction_matrix(&scaled, &prior, &weights, skin.inverse.hyperparameter)?;
        let conductivity_from_difference = scale.unscale_columns(matrix);

        let stages = clock.finish();
        let difference = skin.inverse.difference;
        Ok(Self {
            difference,
            steps,
            combination,
            mesh,
            fields,
            voltages,
            geometry,
            jacobian,
            conductivity_from_difference,
            stages,
        })
    }

    /// Voltages of the untouched skin after reciprocal steps are averaged: `[measurement]`.
    #[must_use]
    pub fn measurements(&self) -> Vec<f64> {
        combine_voltages(&self.voltages, &self.combination)
    }

    /// What difference data of this model divide a change of model voltage by: `[measurement]`.
    #[must_use]
    pub fn divisors(&self) -> Vec<f64> {
        divisors(self.difference, &self.measurements())
    }

    /// Noise in the image, standard deviation of the worst pixel, for white noise on every step at this
    /// signal-to-noise ratio (dB, against the root mean square of the untouched voltages).
    #[must_use]
    pub fn image_noise(&self, snr_db: f64) -> f64 {
        let mean_square = self.voltages.iter().map(|v| v * v).sum::<f64>() / self.voltages.len() as f64;
        let step_noise = mean_square.sqrt() * 10_f64.powf(-snr_db / 20.0);
        let counts = step_counts(&self.combination);
        let noise: Vec<f64> =
            self.divisors().iter().zip(counts).map(|(v, n)| step_noise / n.sqrt() / v.abs()).collect();
        let of_pixel = |pixel: usize| {
            let row = self.conductivity_from_difference.row(pixel);
            row.iter().zip(&noise).map(|(c, n)| (c * n).powi(2)).sum::<f64>().sqrt()
        };
        (0..self.conductivity_from_difference.nrows()).map(of_pixel).fold(0.0, f64::max)
    }

    /// Image in f64 of a change of voltages against a reference, both `[step]` in any one unit: the
    /// oracle of the board's fixed-point image. Relative conductivity: `[pixel]`.
    ///
    /// Measurements whose reference is zero cannot be normalised and count as unchanged.
    #[must_use]
    pub fn image(&self, change: &[f64], reference: &[f64]) -> Vec<f64> {
        let change = combine_voltages(change, &self.combination);
        let reference = combine_voltages(reference, &self.combination);
        let divisors = divisors(self.difference, &reference);
        let difference =
            Col::from_fn(reference.len(), |m| if divisors[m] == 0.0 { 0.0 } else { change[m] / divisors[m] });
        (&self.conductivity_from_difference * difference).iter().copied().collect()
    }
}

/// What a kind of difference data divides by: `[measurement]`; see [`dermatome_shared::reference`].
fn divisors(kind: Difference, reference: &[f64]) -> Vec<f64> {
    match kind {
        Difference::Plain => vec![mean_magnitude(reference); reference.len()],
        Difference::Normalised => reference.to_vec(),
    }
}

fn mean_magnitude(values: &[f64]) -> f64 {
    values.iter().map(|value| value.abs()).sum::<f64>() / values.len() as f64
}

/// Smallest untouched voltage that may be normalised by, over the mean: below it, noise at 60 dB is as
/// large as the voltage.
const SMALLEST_SHARE: f64 = 1e-3;

fn check_raster(raster: &pixels::Pixels) -> Result<(), ModelError> {
    match raster.elements.iter().position(Vec::is_empty) {
        Some(pixel) => Err(ModelError::EmptyPixel { pixel }),
        None => Ok(()),
    }
}

fn check_pixels(geometry: &Geometry) -> Result<(), ModelError> {
    let pixels = pixel_cells(&geometry.mask).count();
    if (1..=MAX_PIXELS).contains(&pixels) { Ok(()) } else { Err(ModelError::Pixels { pixels }) }
}

/// Between model voltages and difference data of a kind.
///
/// The hyperparameter keeps EIDORS' meaning: plain differences are weighed in model volts (unit
/// current and conductivity), and only then brought to the board's ratio by the mean voltage.
enum DifferenceScale {
    Plain { mean: f64 },
    Normalised { voltages: Vec<f64> },
}

impl DifferenceScale {
    fn new(kind: Difference, voltages: &[f64]) -> Result<Self, ModelError> {
        let mean = mean_magnitude(voltages);
        match kind {
            Difference::Plain => Ok(Self::Plain { mean }),
            Difference::Normalised => {
                let smallest =
                    (0..voltages.len()).min_by(|&a, &b| voltages[a].abs().total_cmp(&voltages[b].abs()));
                match smallest
                    .map(|m| (m, voltages[m].abs() / mean))
                    .filter(|(_, share)| *share < SMALLEST_SHARE)
                {
                    Some((measurement, share)) => Err(ModelError::SmallVoltage { measurement, share }),
                    None => Ok(Self::Normalised { voltages: voltages.to_vec() }),
                }
            }
        }
    }

    fn scale_rows(&self, jacobian: &Mat<f64>) -> Mat<f64> {
        match self {
            Self::Plain { .. } => jacobian.clone(),
            Self::Normalised { voltages } => {
                Mat::from_fn(jacobian.nrows(), jacobian.ncols(), |i, j| jacobian[(i, j)] / voltages[i])
            }
        }
    }

    fn unscale_columns(&self, matrix: Mat<f64>) -> Mat<f64> {
        match self {
            Self::Plain { mean } => matrix * faer::Scale(*mean),
            Self::Normalised { .. } => matrix,
        }
    }
}

/// Times stages that follow each other.
#[derive(Default)]
struct StageClock {
    running: Option<(&'static str, Instant)>,
    done: Vec<Stage>,
}

impl StageClock {
    fn begin(&mut self, name: &'static str) -> &'static str {
        self.end();
        self.running = Some((name, Instant::now()));
        name
    }

    fn end(&mut self) {
        if let Some((name, since)) = self.running.take() {
            self.done.push(Stage { name, time: since.elapsed() });
        }
    }

    fn finish(mut self) -> Vec<Stage> {
        self.end();
        self.done
    }
}
