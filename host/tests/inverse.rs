//! The [inverse] table at work: weights, criteria and electrode movement of whole skins.

use dermatome::{
    model::Model,
    sheet::Place,
    skin::{Criterion, Hyperparameter, ImageLayout, Method, Prior, Shape, Skin, Weights},
};
use dermatome_shared::patch::Difference;
use std::{fs, path::Path};

const DISC: &str = include_str!("../../models/disc-210mm/skin.toml");

/// A coarse disc, quick to build many times.
fn coarse() -> Skin {
    let mut skin = Skin::parse(Path::new("skin.toml"), DISC).unwrap().made().unwrap();
    skin.edges = skin.edges.scaled(2.0);
    skin.image = ImageLayout::Grid { columns: 16 };
    skin
}

fn build(skin: &Skin) -> Model {
    Model::build(skin, |_| ()).unwrap()
}

fn error_of(skin: &Skin) -> String {
    Model::build(skin, |_| ()).unwrap_err().to_string()
}

fn largest_difference(a: &Model, b: &Model) -> f64 {
    let (a, b) = (&a.conductivity_from_difference, &b.conductivity_from_difference);
    (a - b).norm_max() / a.norm_max()
}

#[test]
fn a_gaussian_prior_takes_pixels_as_large_as_its_filter() {
    let mut skin = coarse();
    skin.inverse.method = Method::OneStep(Prior::Gaussian { diameter: 0.1 });
    for count in [50, 100, 200, 500] {
        skin.image = ImageLayout::ElementPatches { count };
        let model = build(&skin);
        assert!(model.conductivity_from_difference.norm_max().is_finite());
        // A press in the middle of a pixel comes out there.
        let change: Vec<f64> = (0..104).map(|m| model.jacobian[(m, count / 2)]).collect();
        let data: Vec<f64> = change.iter().zip(model.divisors()).map(|(v, divisor)| v / divisor).collect();
        let image = &model.conductivity_from_difference * faer::Col::from_fn(104, |m| data[m]);
        let peak = (0..count).max_by(|&a, &b| image[a].total_cmp(&image[b])).unwrap();
        let off = (model.pixels.centres[peak] - model.pixels.centres[count / 2]).norm();
        assert!(off < 0.02, "{count} pixels: {off} m off");
    }
    skin.image = ImageLayout::ElementPatches { count: 20 };
    let error = error_of(&skin);
    assert!(error.contains("larger `inverse.gaussian_diameter`, or more pixels"), "{error}");
}

#[test]
fn weights_of_one_for_each_step_are_the_default_and_a_file_of_them_too() {
    let skin = coarse();
    let default = build(&skin);
    let mut listed = skin.clone();
    listed.inverse.weights = Weights::Each(vec![2.0; 104]);
    assert!(largest_difference(&default, &build(&listed)) < 1e-12);

    let folder = tempfile::tempdir().unwrap();
    let rows: String = (0..104).map(|_| "2\n").collect();
    fs::write(folder.path().join("weights.csv"), format!("weight\n{rows}")).unwrap();
    let text = DISC.replace("normalised = true", "normalised = true\nweights = \"weights.csv\"");
    let skin = Skin::parse(&folder.path().join("skin.toml"), &text).unwrap().made().unwrap();
    assert_eq!(skin.inverse.weights, listed.inverse.weights);
}

#[test]
fn weights_of_the_wrong_number_or_sign_are_refused() {
    let mut skin = coarse();
    skin.inverse.weights = Weights::Each(vec![1.0; 5]);
    let error = error_of(&skin);
    assert!(error.contains("`inverse.weights` has 5 entries") && error.contains("104"), "{error}");
    let mut weights = vec![1.0; 104];
    weights[17] = -1.0;
    skin.inverse.weights = Weights::Each(weights);
    let error = error_of(&skin);
    assert!(error.contains("-1 for measurement 17"), "{error}");
}

/// EIDORS' weights for normalised data undo the normalisation: images of plain data, divided by the
/// voltages.
#[test]
fn weights_of_the_squared_reference_undo_the_normalisation() {
    let mut plain = coarse();
    plain.inverse.hyperparameter = Hyperparameter::Fixed(0.01);
    let mut squared = plain.clone();
    plain.inverse.difference = Difference::Plain;
    squared.inverse.weights = Weights::ReferenceSquared;
    let (plain, squared) = (build(&plain), build(&squared));
    let change: Vec<f64> =
        plain.voltages.iter().enumerate().map(|(i, v)| 0.01 * v * ((i % 7) as f64 - 3.0)).collect();
    let [a, b] = [plain, squared].map(|model| model.image(&change, &model.voltages));
    let largest = a.iter().fold(0.0, |max: f64, v| max.max(v.abs()));
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-9 * largest));
}

#[test]
fn every_method_and_criterion_makes_a_matrix() {
    let methods = [
        Method::OneStep(Prior::Laplace),
        Method::OneStep(Prior::SquaredLaplace),
        Method::OneStep(Prior::Tikhonov),
        Method::OneStep(Prior::Noser { exponent: 0.5 }),
        Method::OneStep(Prior::Gaussian { diameter: 0.1 }),
        Method::Greit { radius: 0.2 },
    ];
    let criteria = [
        Criterion::LCurve,
        Criterion::CrossValidation,
        Criterion::NoiseFigure(1.0),
        Criterion::BestResolution,
    ];
    println!("coarse disc-210mm        hyperparameter  noise figure  RES  radius (mm)");
    for method in methods {
        for criterion in criteria {
            let mut skin = coarse();
            skin.inverse.method = method;
            skin.inverse.hyperparameter = Hyperparameter::Chosen(criterion);
            let model = build(&skin);
            let (figure, blur) = (model.noise_figure(), model.blur());
            println!(
                "{method:?} {criterion:?}: {:.3e} {figure:.3} {:.3} {:.1}",
                model.hyperparameter,
                blur.resolution,
                1e3 * blur.median_radius
            );
            let selection = model.selection.expect("a criterion was asked for");
            assert_eq!(selection.criterion, criterion);
            assert_eq!(selection.chosen.hyperparameter, model.hyperparameter);
            assert!(blur.resolution > 0.1 && blur.resolution < 0.4, "{method:?} {criterion:?}: {blur:?}");
            if let Criterion::NoiseFigure(asked) = criterion {
                assert!((figure / asked - 1.0).abs() < 1e-3, "{figure}");
            }
        }
    }
}

#[test]
fn more_noise_asks_for_more_smoothing() {
    for criterion in [Criterion::CrossValidation, Criterion::BestResolution] {
        let chosen = |noise_db: f64| {
            let mut skin = coarse();
            skin.inverse.hyperparameter = Hyperparameter::Chosen(criterion);
            skin.inverse.noise_db = noise_db;
            build(&skin).hyperparameter
        };
        let [loud, quiet] = [40.0, 80.0].map(chosen);
        assert!(loud > 3.0 * quiet, "{criterion:?}: {loud} {quiet}");
    }
}

#[test]
fn a_noise_figure_out_of_reach_names_field_value_and_range() {
    let mut skin = coarse();
    skin.inverse.method = Method::OneStep(Prior::Tikhonov);
    skin.inverse.hyperparameter = Hyperparameter::Chosen(Criterion::NoiseFigure(0.01));
    let error = error_of(&skin);
    assert!(error.contains("`inverse.noise_figure` is 0.01; allowed here: 0."), "{error}");
}

#[test]
fn a_gaussian_prior_of_too_many_pixels_is_refused() {
    let mut skin = coarse();
    skin.edges = skin.edges.scaled(0.4);
    skin.image = ImageLayout::Elements;
    skin.inverse.method = Method::OneStep(Prior::Gaussian { diameter: 0.1 });
    let error = error_of(&skin);
    assert!(error.contains("\"gaussian\"") && error.contains("4096"), "{error}");
}

/// A skin whose fifth electrode was mounted 2 mm further on, and which is not pressed.
#[test]
fn a_moved_electrode_disturbs_the_image_less_where_movement_is_allowed_for() {
    let greit = Method::Greit { radius: 0.3 };
    for (method, hyperparameter) in [(coarse().inverse.method, 0.03), (greit, 3.0)] {
        moved_electrode(method, hyperparameter);
    }
}

fn moved_electrode(method: Method, hyperparameter: f64) {
    let mut skin = coarse();
    (skin.inverse.method, skin.inverse.hyperparameter) = (method, Hyperparameter::Fixed(hyperparameter));
    let mut moved = skin.clone();
    let Shape::Sheet(sheet) = &mut moved.shape else { panic!("a sheet") };
    let Place::Rim(place) = &mut sheet.places[4] else { panic!("on the rim") };
    *place += 2e-3;
    let (before, after) = (build(&skin), build(&moved));
    let change: Vec<f64> = after.voltages.iter().zip(&before.voltages).map(|(a, b)| a - b).collect();
    let disturbance = |weight: Option<f64>| {
        let mut skin = skin.clone();
        skin.inverse.electrode_movement = weight;
        let image = build(&skin).image(&change, &before.voltages);
        (image.iter().map(|v| v * v).sum::<f64>() / image.len() as f64).sqrt()
    };
    let (without, with) = (disturbance(None), disturbance(Some(10.0)));
    println!("root mean square of the disturbance: {without:.4} without, {with:.4} with the movement prior");
    assert!(with < 0.5 * without, "{with} {without}");
}
