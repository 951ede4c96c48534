//! Inverse: how images are computed.

use dermatome_shared::patch::Difference;

/// How images are computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Inverse {
    /// Where the reconstruction matrix comes from.
    pub method: Method,
    /// Weight of the prior or of the noise, or how it is chosen.
    pub hyperparameter: Hyperparameter,
    /// Plain or normalised difference data.
    pub difference: Difference,
    /// How much each measurement counts.
    pub weights: Weights,
    /// Weight of the prior on electrode movement over the prior on the image (EIDORS'
    /// `prior_movement`), if electrodes are taken to move.
    pub electrode_movement: Option<f64>,
    /// Signal-to-noise ratio, dB, of the simulated frames on which a hyperparameter is chosen.
    pub noise_db: f64,
}

/// Where the reconstruction matrix comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// One Gauss-Newton step with a prior.
    OneStep(Prior),
    /// Trained on small targets (GREIT).
    Greit {
        /// Radius of the desired image of a target, as a share of half the skin's larger side.
        radius: f64,
    },
}

/// Regularisation prior R.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Prior {
    /// Neighbouring pixels are alike (EIDORS `prior_laplace`, used as R'R).
    Laplace,
    /// The same with the graph Laplacian as R, so that its square is R'R (thesis equations 2.11 and
    /// 3.1).
    SquaredLaplace,
    /// Pixels are small (identity).
    Tikhonov,
    /// Pixels are small where the data say much: diag(J'WJ)^exponent (EIDORS `prior_noser`).
    Noser {
        /// 0.5 in EIDORS.
        exponent: f64,
    },
    /// What a Gaussian filter would smooth away is small (EIDORS `prior_gaussian_HPF`).
    Gaussian {
        /// Diameter of the filter as a share of the skin's larger side; 0.1 in EIDORS.
        diameter: f64,
    },
}

/// lambda in x = (J'WJ + lambda^2 R)^-1 J'W y, or GREIT's weight of the noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hyperparameter {
    /// A number.
    Fixed(f64),
    /// Chosen for the skin.
    Chosen(Criterion),
}

/// How a hyperparameter is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Criterion {
    /// Corner of the L-curve.
    LCurve,
    /// Generalised cross-validation.
    CrossValidation,
    /// This noise figure.
    NoiseFigure(f64),
    /// The sharpest image of a small target.
    BestResolution,
}

impl Criterion {
    /// What the skin file calls it.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::LCurve => "l-curve",
            Self::CrossValidation => "gcv",
            Self::NoiseFigure(_) => "noise-figure",
            Self::BestResolution => "best-resolution",
        }
    }
}

/// Weights W of measurements.
#[derive(Clone, Debug, PartialEq)]
pub enum Weights {
    /// How many steps a measurement averages.
    Steps,
    /// The same times the reference squared, as EIDORS weighs normalised data.
    ReferenceSquared,
    /// One for each measurement.
    Each(Vec<f64>),
}
