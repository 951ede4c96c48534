//! The thesis' own simulation (section 5.2, Figs 5.2 to 5.4): regions that conduct twice as well, imaged with its
//! surface mesh on which they were simulated, and less flattering: the same regions on a skin meshed anew, with noise.
//! Its planar meshes (Figs 3.10 and 5.6) likewise.
//!
//! Other than in the experiments beside this one, forward and inverse share a mesh where the thesis' did, and images
//! are computed in floating point.

mod draw;
mod mesh;
mod setup;

use super::{
    ExperimentError,
    report::{Report, Wanted, mean_and_deviation, number},
};
use crate::scenes::matched;
use dermatome_model::{
    metrics::{Target, thesis},
    model::Model,
};
use draw::{Row, draw};
use nalgebra::Point3;
use rayon::prelude::*;
use serde_json::{Value, json};
use setup::{Bench, COMMON_CURRENT, Measured, Place, SETUPS, Setup, Way, doubled};

/// Regions, as in Figs 5.3 (a) to (c) and 5.4. The figures do not say where theirs are.
const SCENES: [(&str, &[Place]); 5] = [
    ("one, in the middle", &[[0.0, 0.0]]),
    ("one, half way", &[[150.0, 0.5]]),
    ("one, near the rim", &[[300.0, 0.75]]),
    ("two", &[[20.0, 0.55], [200.0, 0.55]]),
    ("three", &[[90.0, 0.55], [210.0, 0.55], [330.0, 0.55]]),
];
/// Scenes with one region.
const SINGLE: usize = 3;
/// Radius of a region, and of a thin finger, share of the skin's larger side.
const RADIUS: f64 = 0.1;
const THIN: f64 = 0.04;
/// How far a peak may lie from a region's middle, share of the larger side.
const NEAR: f64 = 0.1;
/// Peaks closer than this, share of the larger side, are one.
const APART: f64 = 0.15;
/// Frames of each scene; without noise they are alike.
const FRAMES: u64 = 20;
/// The thesis' way, and less flattering ones.
const WAYS: [Way; 6] = [
    Way { radius: RADIUS, measured: Measured::SameMesh },
    Way { radius: RADIUS, measured: Measured::Skin(None) },
    Way { radius: RADIUS, measured: Measured::Skin(Some(60.0)) },
    Way { radius: RADIUS, measured: Measured::Skin(Some(50.0)) },
    Way { radius: THIN, measured: Measured::Skin(Some(60.0)) },
    Way { radius: THIN, measured: Measured::Skin(Some(50.0)) },
];

/// What one way makes of all scenes.
struct Outcome {
    way: Way,
    /// Images of the first frame: `[scene]`.
    images: Vec<Vec<f64>>,
    /// `[scene]`.
    scenes: Vec<Scene>,
}

/// What one way makes of one scene.
#[derive(Clone, Copy, Debug, Default)]
struct Scene {
    /// Share of the frames that match.
    matched: f64,
    /// Means over the frames that have a region of interest: distance of its centre from the region's as seen from
    /// above, share of the larger side; RES; RNG.
    figures: Option<[f64; 3]>,
}

pub(super) fn run() -> Result<Report, ExperimentError> {
    let title = "The thesis' own simulation, and less flattering (thesis 5.2, Figs 5.2 to 5.4)";
    let mut report = Report::new("surface", title);
    words().into_iter().for_each(|words| report.words(words));
    let mut figures = Vec::new();
    let mut meshes = Vec::new();
    for setup in &SETUPS {
        let bench = setup.bench()?;
        let outcomes =
            WAYS.iter().map(|way| outcome(&bench, way)).collect::<Result<Vec<_>, ExperimentError>>()?;
        compare(&mut report, setup, &outcomes);
        tabulate(&mut report, setup, &outcomes);
        let words =
            format!("{}: stimulated elements, and images of the first frame; crosses: middles", setup.name);
        report.picture(picture(&bench, &outcomes)?, &words);
        meshes.push(mesh_row(setup, &bench.model));
        figures.push(json!({
            "mesh": setup.name, "nodes": bench.model.mesh.nodes.len(), "elements": bench.model.mesh.elements.len(),
            "hyperparameter": setup.hyperparameter, "ways": outcomes.iter().map(Outcome::json).collect::<Vec<_>>(),
        }));
    }
    report.table("Meshes", &["", "nodes, thesis", "here", "elements, thesis", "here"], meshes);
    report.words(
        "Rings of nodes give the numbers of Figs 5.2 and 5.6 exactly. Those of Fig. 3.10 leave, by Euler's formula, 70 edges on \
         the boundary of a sheet without holes, too few for a mesh of edges of one length, which the thesis says it is: \
         here it is the mesh of models/square-50mm with electrodes of 5 mm.",
    );
    report.figures = json!(figures);
    Ok(report)
}

/// What is done.
fn words() -> [String; 3] {
    let [large, thin, near] = [RADIUS, THIN, NEAR].map(|share| 100.0 * share);
    [
        format!(
            "Elements within {large:.0} % of the skin's larger side of a place conduct twice as well as the others. The thesis' \
             way: no noise, adjacent pattern, normalised data with EIDORS' weights, Laplace prior, one value for each \
             element, point electrodes (on Fig. 3.10's mesh complete ones), and the image made with the mesh that the voltages were \
             computed on, which no image of a real skin is. Its figures do not say where its regions are: these are ours. Its \
             hyperparameters: 0.001 of its listing; 0.15 and 0.032 of tables 5.5 and 4.1, taken to belong to the {COMMON_CURRENT:.0} units \
             of current of EIDORS' common models, so a tenth of that here."
        ),
        format!(
            "Less flattering: the skin as it is made, with electrodes of their width on a finer mesh of its own; noise in each of \
             {FRAMES} single frames, against a reference of 20; regions of {thin:.0} %, the size of a thin finger. Here, unlike \
             everywhere else on this page, images are computed in floating point and not by the board."
        ),
        format!(
            "Matched: the image has a peak within {near:.0} % of the larger side of each region's middle, and no other; a peak \
             is above a quarter of the largest value. The thesis shows three images of one region and two of more, and \
             says that they match. Of its planar meshes it shows no simulation."
        ),
    ]
}

fn outcome(bench: &Bench, way: &Way) -> Result<Outcome, ExperimentError> {
    let shown = SCENES.par_iter().map(|(_, places)| {
        let centres: Vec<_> = places.iter().map(|&place| bench.lay(place)).collect();
        let mut images = bench.images(way, &centres, FRAMES)?;
        let scene = Scene::new(bench, &centres, &images);
        Ok((images.swap_remove(0), scene))
    });
    let shown: Vec<_> = shown.collect::<Result<_, ExperimentError>>()?;
    let (images, scenes) = shown.into_iter().unzip();
    Ok(Outcome { way: *way, images, scenes })
}

impl Scene {
    fn new(bench: &Bench, centres: &[Point3<f64>], images: &[Vec<f64>]) -> Self {
        let model = &bench.model;
        let is_matched = |image: &&Vec<f64>| is_matched(model, image, centres, bench.side);
        let matched = images.iter().filter(is_matched).count() as f64 / images.len() as f64;
        let figures = |image: &Vec<f64>| single_figures(model, image, centres[0], bench.side);
        let found: Vec<[f64; 3]> =
            if centres.len() == 1 { images.iter().filter_map(figures).collect() } else { Vec::new() };
        let mean = |which: usize| mean_and_deviation(&found.iter().map(|f| f[which]).collect::<Vec<_>>())[0];
        Self { matched, figures: (!found.is_empty()).then(|| [0, 1, 2].map(mean)) }
    }
}

/// Whether each region has one peak near its middle, and there is no other.
fn is_matched(model: &Model, image: &[f64], centres: &[Point3<f64>], side: f64) -> bool {
    let peaks = peaks(&model.pixels.centres, image, APART * side);
    let is_in = |distance: &Option<f64>| distance.is_some_and(|distance| distance <= NEAR * side);
    peaks.len() == centres.len() && matched(centres, &peaks).iter().all(is_in)
}

/// Places of values above a quarter of the largest one that none within this distance exceeds.
fn peaks(places: &[Point3<f64>], image: &[f64], apart: f64) -> Vec<Point3<f64>> {
    let quarter = image.iter().copied().fold(0.0, f64::max) / 4.0;
    let high: Vec<usize> = (0..image.len()).filter(|&pixel| image[pixel] > quarter).collect();
    let exceeds = |other: usize, pixel: usize| {
        (image[other], pixel) > (image[pixel], other) && (places[other] - places[pixel]).norm() < apart
    };
    let is_peak = |pixel: &&usize| !high.iter().any(|&other| exceeds(other, **pixel));
    high.iter().filter(is_peak).map(|&pixel| places[pixel]).collect()
}

/// Position error as seen from above, share of the side; RES; RNG.
fn single_figures(model: &Model, image: &[f64], at: Point3<f64>, side: f64) -> Option<[f64; 3]> {
    let target = Target { position: at, amount: 1.0, skin_centre: Point3::origin() };
    let found = thesis::figures(image, &model.pixels, &target)?;
    let away = (found.centre - at).xy().norm() / side;
    Some([away, found.resolution, found.ringing])
}

impl Way {
    fn words(&self) -> String {
        let size = if self.radius < RADIUS { ", thin" } else { "" };
        match self.measured {
            Measured::SameMesh => format!("same mesh, no noise{size}"),
            Measured::Skin(None) => format!("skin meshed anew, no noise{size}"),
            Measured::Skin(Some(snr_db)) => format!("skin meshed anew, {snr_db:.0} dB{size}"),
        }
    }
}

impl Outcome {
    /// Scenes that match: mean number of them.
    fn matched(&self) -> f64 {
        self.scenes.iter().map(|scene| scene.matched).sum()
    }

    /// Mean figures of the scenes with one region; none where one has none.
    fn means(&self) -> Option<[f64; 3]> {
        let single: Vec<[f64; 3]> =
            self.scenes[..SINGLE].iter().map(|scene| scene.figures).collect::<Option<_>>()?;
        Some([0, 1, 2].map(|which| single.iter().map(|figures| figures[which]).sum::<f64>() / SINGLE as f64))
    }

    fn json(&self) -> Value {
        let scenes = self.scenes.iter().zip(SCENES).map(|(scene, (name, _))| {
            let [error, res, rng] = scene.figures.map_or([None; 3], |figures| figures.map(Some));
            json!({
                "scene": name, "matched": scene.matched, "position_error": error, "res": res, "ringing": rng,
            })
        });
        json!({ "way": self.way.words(), "scenes": scenes.collect::<Vec<_>>() })
    }
}

/// The thesis says that all match on its surface mesh, and nothing of the planar ones.
fn compare(report: &mut Report, setup: &Setup, outcomes: &[Outcome]) {
    let all = SCENES.len();
    let thesis = (setup.counts == SETUPS[0].counts).then_some(all as f64);
    for outcome in outcomes {
        let what = format!("{}: {}: images that match, of {all}", setup.name, outcome.way.words());
        report.compare(what, "", thesis, outcome.matched(), thesis.map(Wanted::AtLeast));
    }
}

fn tabulate(report: &mut Report, setup: &Setup, outcomes: &[Outcome]) {
    let rows = outcomes.iter().map(|outcome| {
        let means = outcome.means().map_or([const { String::new() }; 3], |[error, res, rng]| {
            [number(100.0 * error), number(100.0 * res), number(rng)]
        });
        let shares = outcome.scenes.iter().map(|scene| number(100.0 * scene.matched));
        std::iter::once(outcome.way.words()).chain(shares).chain(means).collect()
    });
    let mut columns = vec![""];
    columns.extend(SCENES.map(|(name, _)| name));
    columns.extend(["position error, one region, %", "RES, %", "RNG"]);
    report.table(&format!("{}: frames that match, %", setup.name), &columns, rows.collect());
}

fn mesh_row(setup: &Setup, model: &Model) -> Vec<String> {
    let here = [model.mesh.nodes.len(), model.mesh.elements.len()];
    let pairs = setup.counts.into_iter().zip(here);
    let counts = pairs.flat_map(|(thesis, here)| [thesis.to_string(), here.to_string()]);
    std::iter::once(setup.name.to_owned()).chain(counts).collect()
}

fn picture(bench: &Bench, outcomes: &[Outcome]) -> Result<Vec<u8>, ExperimentError> {
    let mesh = &bench.model.mesh;
    let centres: Vec<Vec<_>> =
        SCENES.iter().map(|(_, places)| places.iter().map(|&place| bench.lay(place)).collect()).collect();
    let change = |centres: &Vec<_>| {
        doubled(mesh, centres, RADIUS * bench.side).iter().map(|sigma| sigma - 1.0).collect()
    };
    let stimulated =
        Row { name: "stimulated elements".to_owned(), mesh, images: centres.iter().map(change).collect() };
    let ways = outcomes.iter().map(|outcome| Row {
        name: outcome.way.words(),
        mesh,
        images: outcome.images.clone(),
    });
    draw(&std::iter::once(stimulated).chain(ways).collect::<Vec<_>>(), &centres, bench.side)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peak_is_what_nothing_near_exceeds_and_lower_than_a_quarter_is_none() {
        let places: Vec<_> = (0..9).map(|k| Point3::new(f64::from(k), 0.0, 0.0)).collect();
        let image = [0.0, 4.0, 3.9, 0.0, 0.0, 2.0, 2.0, 0.0, 0.9];
        let found: Vec<f64> = peaks(&places, &image, 1.5).iter().map(|at| at.x).collect();
        assert_eq!(found, [1.0, 5.0]);
        assert_eq!(peaks(&places, &[0.0; 9], 1.5), []);
    }

    #[test]
    fn the_thesis_way_matches_and_noise_and_thin_fingers_do_not() {
        let bench = SETUPS[0].bench().unwrap();
        let [thesis, anew, noisy] = [0, 1, 5].map(|way| outcome(&bench, &WAYS[way]).unwrap());
        assert_eq!([thesis.matched(), anew.matched()], [5.0, 5.0]);
        assert!(noisy.matched() < 2.0, "{}", noisy.matched());
        let error = |outcome: &Outcome| outcome.means().unwrap()[0];
        assert!(error(&thesis) < 0.02, "{}", error(&thesis));
        assert!(error(&thesis) < error(&anew) && 3.0 * error(&anew) < error(&noisy), "{}", error(&noisy));
    }

    #[test]
    fn one_mesh_for_both_gives_another_image_than_a_mesh_of_its_own() {
        let bench = SETUPS[1].bench().unwrap();
        let centre = [bench.lay([150.0, 0.5])];
        assert!((centre[0].coords.norm() - bench.side / 4.0).abs() < 1e-12);
        let [same, anew] = [0, 1].map(|way| bench.images(&WAYS[way], &centre, 1).unwrap().swap_remove(0));
        let peak = |image: &[f64]| image.iter().copied().fold(0.0, f64::max);
        let apart = same.iter().zip(&anew).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart > 0.01 * peak(&same) && apart < 0.5 * peak(&same), "{apart} of {}", peak(&same));
        assert!(is_matched(&bench.model, &same, &centre, bench.side));
        let elsewhere = [bench.lay([330.0, 0.5])];
        assert!(!is_matched(&bench.model, &same, &elsewhere, bench.side));
    }
}
