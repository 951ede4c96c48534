//! Experiments: those of the thesis (docs/experiments.md cites it), on simulated samples, beside its figures.
//!
//! Everything here is simulation with stated models: the skin is solved for on a mesh of its own, the
//! material is a model ([`dermatome_simulate::material`]), the instrument has noise and artefacts, and what a board would show
//! is computed by the board's own code (`sample_rig`). Each experiment is a file; [`EXPERIMENTS`] lists them.

mod approach;
mod divider;
mod hemisphere;
mod html;
mod hysteresis;
mod loading;
mod plot;
mod points;
mod pressure_map;
mod report;
mod saline;
mod saline_map;
mod sample;
mod sample_rig;
mod shapes;
mod surface;
mod thin_fingers;
mod tracking;
mod two_point;

use crate::{deform::DeformError, evaluate::EvaluateError, scenes::ScenesError};
use dermatome_model::{
    model::ModelError,
    skin::{Skin, SkinError},
};
use dermatome_simulate::{material::MaterialError, rig::RigError};
pub use html::page;
use rayon::prelude::*;
pub use report::{Assessment, Comparison, Report, Wanted, json};

/// One experiment.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it shows, in a line.
    pub about: &'static str,
    run: fn() -> Result<Report, ExperimentError>,
}

/// All experiments, in the order of the thesis.
pub const EXPERIMENTS: [Experiment; 17] = [
    Experiment {
        name: "divider",
        about: "resistance of Samples 1 and 2 under load (3.2)",
        run: divider::run,
    },
    Experiment { name: "saline-depth", about: "a cube let down into salt water (4.1)", run: saline::depth },
    Experiment { name: "saline-volume", about: "three cubes in salt water (4.1)", run: saline::volume },
    Experiment { name: "saline-map", about: "a cube at 15 places in salt water (4.1)", run: saline_map::run },
    Experiment {
        name: "loading-1",
        about: "Sample 1 loaded and unloaded (4.2)",
        run: || loading::run(&sample::ONE),
    },
    Experiment {
        name: "loading-2",
        about: "Sample 2 loaded and unloaded (4.2)",
        run: || loading::run(&sample::TWO),
    },
    Experiment {
        name: "loading-3-single",
        about: "Sample 3, one layer, loaded and unloaded (5.4.1)",
        run: || loading::run(&sample::THREE_SINGLE),
    },
    Experiment {
        name: "loading-3-dual",
        about: "Sample 3, two layers, loaded and unloaded (5.4.1)",
        run: || loading::run(&sample::THREE_DUAL),
    },
    Experiment {
        name: "pressure-map",
        about: "1 kg at 15 places on Samples 1 and 2 (4.2)",
        run: pressure_map::run,
    },
    Experiment {
        name: "surface",
        about: "the thesis' own simulation on its surface mesh, and less flattering (5.2)",
        run: surface::run,
    },
    Experiment {
        name: "shapes",
        about: "an 'L', 'O's and thin fingers on Sample 3 (5.4.2)",
        run: shapes::run,
    },
    Experiment { name: "points", about: "one point at five places on Sample 3 (5.4.3)", run: points::run },
    Experiment {
        name: "hemisphere",
        about: "one, two and three contacts on a hemisphere (5.4.4)",
        run: hemisphere::count,
    },
    Experiment {
        name: "hemisphere-flat",
        about: "surface against planar image (5.4.4)",
        run: hemisphere::flat,
    },
    Experiment {
        name: "hysteresis",
        about: "hysteresis taken out by play operators and a Preisach network (6.2)",
        run: hysteresis::run,
    },
    Experiment {
        name: "tracking",
        about: "contacts that move, leave and come back, and approach each other",
        run: tracking::run,
    },
    Experiment { name: "two-point", about: "from what distance two contacts are two", run: two_point::run },
];

/// The experiments of a name, or `all` of them; `None` if there is none.
#[must_use]
pub fn named(name: &str) -> Option<Vec<Experiment>> {
    let found: Vec<_> =
        EXPERIMENTS.into_iter().filter(|experiment| name == "all" || experiment.name == name).collect();
    (!found.is_empty()).then_some(found)
}

/// Runs experiments, as many at once as there are processors; `on_done` hears of each that is done.
pub fn run(
    experiments: &[Experiment],
    on_done: impl Fn(&Report) + Sync,
) -> Result<Vec<Report>, ExperimentError> {
    let run = |experiment: &Experiment| {
        let report = (experiment.run)()?;
        on_done(&report);
        Ok(report)
    };
    experiments.par_iter().map(run).collect()
}

/// Shipped skins that stand for flat and curved ones: a disc, a square, a hemisphere.
pub fn shipped_skins() -> Result<[Skin; 3], ExperimentError> {
    Ok([sample::shipped(sample::DISC_210)?, sample::shipped(sample::SQUARE_210)?, hemisphere::shipped()?])
}

/// Why an experiment cannot be done.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// A skin file that comes with the program is not usable.
    #[error(transparent)]
    Skin(#[from] SkinError),
    /// A true skin has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A skin has no model or no patch.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// The artefacts do not suit the skin.
    #[error(transparent)]
    Artefacts(#[from] EvaluateError),
    /// Nor do they.
    #[error(transparent)]
    Deform(#[from] DeformError),
    /// A material cannot be used.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// Scenes cannot be played.
    #[error(transparent)]
    Scenes(#[from] ScenesError),
    /// Skin files that come with the program cannot be laid out.
    #[error("cannot lay out the hemisphere's files in a temporary folder: {0}")]
    Files(#[from] std::io::Error),
    /// A sample's readings give no curve.
    #[error("readings of {sample} do not rise with the load")]
    Readings {
        /// The sample.
        sample: &'static str,
    },
    /// A picture cannot be drawn.
    #[error("cannot draw: {0}")]
    Draw(String),
}
