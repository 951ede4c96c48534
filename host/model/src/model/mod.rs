//! Model: a skin taken through mesh, forward model, Jacobian and reconstruction matrix.

pub mod design;
mod driven;
mod import;
mod memory;
mod stages;

pub use crate::inverse::difference::divisors;
use crate::{
    forward::{Admittivity, Fields, ForwardError, ForwardModel, SheetTensors},
    inverse::{
        InverseError,
        figures::{self, Blur},
        movement::Movement,
        reconstruction::{Measurements, Reconstruction, reconstruct},
        selection::Selection,
        targets::{Responses, Untouched},
    },
    jacobian::{combine_rows, combine_voltages, jacobian, step_counts},
    metrics::detectability::{Detectability, Frame, Sought, detectability},
    pixels::{self, Pixels},
    prior::{Factored, Prior},
    skin::{ImageLayout, Method, NotFlat, Shape, Skin},
    stimulation::Stimulation,
};
use dermatome_geometry::{
    mesh::{Lattice, Mesh, MeshError, generate},
    sheet::ElectrodeModel,
};
use dermatome_patch::tables::SurfaceTables;
use dermatome_shared::{
    MAX_PIXELS,
    patch::{CombinedInto, Difference},
    scan::test_step,
    stimulation::Step,
};
pub use driven::driven_error;
use faer::{Col, Mat};
pub use memory::needed_gigabytes;
use num_complex::Complex64;
pub use stages::Stage;
use stages::{StageClock, timed};

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
    /// Voltages of the untouched skin, in phase with the current: `[step]`.
    pub voltages: Vec<f64>,
    /// The same of the test of each electrode ([`test_step`]): `[electrode]`.
    pub test_voltages: Vec<f64>,
    /// What images consist of.
    pub pixels: Pixels,
    /// d voltage / d relative conductivity: `[measurement][pixel]`.
    pub jacobian: Mat<f64>,
    /// The prior, unless the method has none.
    pub prior: Option<Prior>,
    /// W for model volts: `[measurement]`.
    pub weights: Vec<f64>,
    /// Relative conductivity from difference data of the skin's kind, as the board computes them
    /// (see [`dermatome_shared::reference`]): `[pixel][measurement]`.
    pub conductivity_from_difference: Mat<f64>,
    /// Kind of difference data the matrix takes.
    pub difference: Difference,
    /// The hyperparameter used.
    pub hyperparameter: f64,
    /// The criterion it was chosen by, unless the skin file gives it.
    pub selection: Option<Selection>,
    /// d voltage / d relative conductivity of the standard target, see
    /// [`crate::inverse::targets`]: `[measurement]`.
    pub target: Vec<f64>,
    /// How measurements respond to the movement of electrodes, where it is asked for or all are on the rim.
    pub movement: Option<Movement>,
    /// How long each stage took.
    pub stages: Vec<Stage>,
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
    /// No reconstruction matrix.
    #[error(transparent)]
    Inverse(#[from] InverseError),
    /// A curved skin with a pixel grid.
    #[error(transparent)]
    NotFlat(#[from] NotFlat),
    /// More memory than there is.
    #[error(
        "`electrodes.count` and `drive` give {measurements} measurements, whose model takes {needed:.1} GB of memory; allowed \
         here: {available:.1} GB, as much as is free"
    )]
    Memory {
        /// Measurements after reciprocal steps are averaged.
        measurements: usize,
        /// What the model takes, GB.
        needed: f64,
        /// What there is, GB.
        available: f64,
    },
    /// A pixel that no part of the mesh falls into.
    #[error(
        "no element of the mesh lies in pixel {pixel}: `mesh.edge_length` is too coarse for `image.columns`"
    )]
    EmptyPixel {
        /// Index of the pixel.
        pixel: usize,
    },
}

/// More pixels, or neighbours of pixels, than boards and pictures take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{field}` makes {count} pixels; boards and pictures take at most {MAX_PIXELS}")]
pub struct TooManyPixels {
    field: &'static str,
    count: usize,
}

/// Mesh of a skin whose edges are `fineness` times as long as the skin file says.
pub fn mesh(skin: &Skin, fineness: f64, lattice: Lattice) -> Result<Mesh, ModelError> {
    match &skin.shape {
        Shape::Sheet(sheet) => {
            Ok(generate(sheet, &skin.electrodes.model, skin.edges.scaled(fineness), lattice)?)
        }
        Shape::Mesh { mesh, .. } => Ok((**mesh).clone()),
    }
}

/// Forward model of a skin on one of its meshes.
pub fn forward_model<T: Admittivity>(skin: &Skin, mesh: &Mesh) -> Result<ForwardModel<T>, ModelError> {
    let impedance = match &skin.electrodes.model {
        ElectrodeModel::Point => vec![T::default(); mesh.electrodes.len()],
        ElectrodeModel::Complete { contact_impedance, .. } => {
            contact_impedance.iter().map(|z| T::from(z * skin.material.sheet_conductivity)).collect()
        }
    };
    Ok(ForwardModel::on_sheet(mesh, &impedance, SheetTensors::new(&skin.material, mesh))?)
}

/// Pixels of a skin's image on a mesh.
pub fn pixels_on(skin: &Skin, mesh: &Mesh) -> Result<Pixels, ModelError> {
    let pixels = match skin.image {
        ImageLayout::Grid { columns } => pixels::raster(mesh, &pixels::grid(skin.shape.flat()?, columns)),
        ImageLayout::Elements => pixels::per_element(mesh),
        ImageLayout::ElementPatches { count } => pixels::element_patches(mesh, count),
    };
    match pixels.elements.iter().position(Vec::is_empty) {
        Some(pixel) => Err(ModelError::EmptyPixel { pixel }),
        None => Ok(pixels),
    }
}

/// How the untouched skin responds, in phase: voltages `[step]`, Jacobian `[measurement][pixel]`, and
/// simulated targets.
struct Response {
    voltages: Vec<f64>,
    test_voltages: Vec<f64>,
    jacobian: Mat<f64>,
    targets: Responses,
}

/// The untouched skin solved, before reciprocal steps are averaged and quadrature is dropped.
pub struct Solved<T: Admittivity> {
    /// Admittivity of every element.
    pub admittivity: T,
    /// The forward model.
    pub forward: ForwardModel<T>,
    /// `[step]`.
    pub voltages: Vec<T>,
    /// `[step][pixel]`.
    pub jacobian: Mat<T>,
}

/// Real or, for a sheet with capacitance, complex.
pub enum Solution {
    /// Of a sheet that only conducts.
    Real(Box<Solved<f64>>),
    /// Of a sheet with capacitance.
    Complex(Box<Solved<Complex64>>),
}

impl Model {
    /// Computes the model of a skin; `on_stage` hears the name of each stage as it begins.
    pub fn build(skin: &Skin, mut on_stage: impl FnMut(&'static str)) -> Result<Self, ModelError> {
        Self::build_beside(skin, &mut on_stage, &mut drop, &mut |_| ())
    }

    /// The same; `keep` gets the solution, which is large, as soon as the model is through with it, and `beside` is
    /// done on the mesh while the forward model is solved.
    // Without types of its own, so that it is compiled once and not in every crate that calls it.
    pub fn build_beside(
        skin: &Skin,
        on_stage: &mut dyn FnMut(&'static str),
        keep: &mut dyn FnMut(Solution),
        beside: &mut (dyn FnMut(&Mesh) + Send),
    ) -> Result<Self, ModelError> {
        memory::check(skin)?;
        let mut clock = StageClock::default();
        let stimulation = skin.stimulation();

        on_stage(clock.begin("mesh"));
        let mesh = mesh(skin, 1.0, Lattice::default())?;

        let admittivity = skin.admittivity();
        let untouched = Unsolved { skin, stimulation: &stimulation, mesh: &mesh };
        let (Response { voltages, test_voltages, jacobian, targets }, of_pixels) = if admittivity.im == 0.0 {
            let done = untouched.solve(admittivity.re, beside, &mut clock, on_stage)?;
            keep(Solution::Real(Box::new(done.solved)));
            (done.response, done.of_pixels)
        } else {
            let done = untouched.solve(admittivity, beside, &mut clock, on_stage)?;
            keep(Solution::Complex(Box::new(done.solved)));
            (done.response, done.of_pixels)
        };
        let OfPixels { pixels, factored } = of_pixels;

        on_stage(clock.begin("matrix"));
        let Stimulation { steps, combination } = stimulation;
        let measurements = Measurements {
            jacobian: &jacobian,
            voltages: &combine_voltages(&voltages, &combination),
            step_counts: &step_counts(&combination),
            step_size: root_mean_square(&voltages),
            responses: &targets,
        };
        let Reconstruction { matrix, prior, weights, hyperparameter, selection } =
            reconstruct(&skin.inverse, &pixels, factored.as_ref(), &measurements)?;

        let stages = clock.finish();
        let difference = skin.inverse.difference;
        Ok(Self {
            difference,
            steps,
            combination,
            mesh,
            voltages,
            test_voltages,
            pixels,
            jacobian,
            prior,
            weights,
            conductivity_from_difference: matrix,
            hyperparameter,
            selection,
            target: targets.target,
            movement: targets.movement,
            stages,
        })
    }

    /// The pixels as boards and pictures know them.
    pub fn surface(&self) -> Result<SurfaceTables, TooManyPixels> {
        self.pixels
            .surface_tables()
            .ok_or(TooManyPixels { field: self.pixels.field(), count: self.pixels.count() })
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

    /// Noise figure of the matrix, for the standard target and white noise on every step; see
    /// [`crate::inverse::figures`].
    #[must_use]
    pub fn noise_figure(&self) -> f64 {
        let ratios = |values: &[f64]| {
            self.divisors().iter().zip(values).map(|(v, value)| value / v).collect::<Vec<_>>()
        };
        let (signal, noise) = (ratios(&self.target), self.relative_noise());
        figures::noise_figure(&self.conductivity_from_difference, &signal, &noise, &self.pixels.areas)
    }

    /// Standard deviations of the difference data for white noise on every step, of which only the ratios count:
    /// `[measurement]`.
    #[must_use]
    pub fn relative_noise(&self) -> Vec<f64> {
        let counts = step_counts(&self.combination);
        self.divisors().iter().zip(counts).map(|(v, count)| 1.0 / count.sqrt() / v).collect()
    }

    /// How widely the matrix spreads a point.
    #[must_use]
    pub fn blur(&self) -> Blur {
        let divisors = self.divisors();
        figures::blur(&self.conductivity_from_difference, &self.jacobian, &divisors, &self.pixels.areas)
    }

    /// Noise in the image, standard deviation of the worst pixel, for white noise on every step at this
    /// signal-to-noise ratio (dB, against the root mean square of the untouched voltages).
    #[must_use]
    pub fn image_noise(&self, snr_db: f64) -> f64 {
        let step_noise = root_mean_square(&self.voltages) * 10_f64.powf(-snr_db / 20.0);
        let counts = step_counts(&self.combination);
        let noise: Vec<f64> =
            self.divisors().iter().zip(counts).map(|(v, n)| step_noise / n.sqrt() / v.abs()).collect();
        let of_pixel = |pixel: usize| {
            let row = self.conductivity_from_difference.row(pixel);
            row.iter().zip(&noise).map(|(c, n)| (c * n).powi(2)).sum::<f64>().sqrt()
        };
        (0..self.conductivity_from_difference.nrows()).map(of_pixel).fold(0.0, f64::max)
    }

    /// What one frame tells of a press, all over the skin.
    #[must_use]
    pub fn detectability(&self, sought: &Sought) -> Detectability {
        let frame = Frame {
            jacobian: &self.jacobian,
            voltages: &self.measurements(),
            step_counts: &step_counts(&self.combination),
            step_size: root_mean_square(&self.voltages),
        };
        detectability(&self.pixels, &frame, sought)
    }

    /// Image in f64 of a change of voltages against a reference, both `[step]` in any one unit: the
    /// oracle of the board's fixed-point image. Relative conductivity: `[pixel]`.
    ///
    /// Measurements whose reference is zero cannot be normalised and count as unchanged.
    #[must_use]
    pub fn image(&self, change: &[f64], reference: &[f64]) -> Vec<f64> {
        let difference = self.difference_data(change, reference);
        let difference = Col::from_fn(difference.len(), |m| difference[m]);
        (&self.conductivity_from_difference * difference).iter().copied().collect()
    }

    /// The difference data that [`Self::image`] takes for the same voltages: `[measurement]`.
    #[must_use]
    pub fn difference_data(&self, change: &[f64], reference: &[f64]) -> Vec<f64> {
        let change = combine_voltages(change, &self.combination);
        let divisors = divisors(self.difference, &combine_voltages(reference, &self.combination));
        let ratio = |(change, divisor): (&f64, &f64)| if *divisor == 0.0 { 0.0 } else { change / divisor };
        change.iter().zip(&divisors).map(ratio).collect()
    }
}

fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

/// The untouched skin, to be solved.
struct Unsolved<'a> {
    skin: &'a Skin,
    stimulation: &'a Stimulation,
    mesh: &'a Mesh,
}

/// The untouched skin solved for one admittivity, and its pixels.
struct Done<T: Admittivity> {
    response: Response,
    solved: Solved<T>,
    of_pixels: OfPixels,
}

impl Unsolved<'_> {
    /// Solves it for one admittivity, and does on other cores what need not wait for that.
    fn solve<T: Admittivity>(
        &self,
        admittivity: T,
        beside: &mut (dyn FnMut(&Mesh) + Send),
        clock: &mut StageClock,
        stage: &mut dyn FnMut(&'static str),
    ) -> Result<Done<T>, ModelError> {
        let Self { skin, mesh, stimulation: Stimulation { steps, combination } } = self;
        clock.end();
        stage("pixels");
        stage("forward");
        let (forward, (of_pixels, ())) = rayon::join(
            || timed("forward", || self.fields(admittivity)),
            || rayon::join(|| timed("pixels", || OfPixels::new(skin, mesh)), || beside(mesh)),
        );
        let of_pixels = clock.take(of_pixels)?;
        let (forward, fields) = clock.take(forward)?;
        stage(clock.begin("jacobian"));
        let untouched = Untouched { mesh, forward: &forward, admittivity, fields: &fields, steps };
        let (jacobian, targets) = rayon::join(
            || jacobian(mesh, &fields, steps, &of_pixels.pixels),
            || Responses::simulate(&untouched, &skin.inverse, combination),
        );
        let voltages = fields.voltages(steps);
        let electrodes = skin.electrodes.count;
        let tests = (0..electrodes).map(|electrode| test_step(electrode, electrodes));
        let response = Response {
            targets: targets?,
            voltages: voltages.iter().map(|voltage| voltage.in_phase()).collect(),
            test_voltages: tests.map(|test| fields.voltage(test).in_phase()).collect(),
            jacobian: combine_rows(&jacobian, combination),
        };
        let solved = Solved { admittivity, forward, voltages, jacobian };
        Ok(Done { response, solved, of_pixels })
    }

    fn fields<T: Admittivity>(&self, admittivity: T) -> Result<(ForwardModel<T>, Fields<T>), ModelError> {
        let forward = forward_model::<T>(self.skin, self.mesh)?;
        let fields = forward.solve(&vec![admittivity; self.mesh.elements.len()])?;
        Ok((forward, fields))
    }
}

/// The pixels of a skin, and what of the reconstruction needs no more than them.
struct OfPixels {
    pixels: Pixels,
    factored: Option<Factored>,
}

impl OfPixels {
    fn new(skin: &Skin, mesh: &Mesh) -> Result<Self, ModelError> {
        let pixels = pixels_on(skin, mesh)?;
        let factored = match skin.inverse.method {
            Method::OneStep(kind) => Factored::new(kind, &pixels),
            Method::Greit { .. } => None,
        };
        Ok(Self { pixels, factored })
    }
}
