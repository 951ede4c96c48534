use super::*;
use crate::evaluate::report::{Report, Ring, Spread};
use dermatome_model::skin::{Drive, ImageLayout, Pattern, Shape};
use dermatome_shared::stimulation::Driven;
use dermatome_simulate::{
    Noise, Rig,
    rig::{Observer, SETTLED},
};
use std::{
    path::Path,
    sync::atomic::{AtomicUsize, Ordering},
};

/// A skin of 8 electrodes and a few hundred elements.
pub(crate) fn coarse_disc() -> Skin {
    Skin::parse(Path::new("tiny.toml"), include_str!("../../../tests/data/tiny.toml"))
        .unwrap()
        .made()
        .unwrap()
}

/// Stops after so many steps.
struct Until(usize, AtomicUsize);

impl Watch for Until {
    fn begin(&self, _: &'static str, _: usize) {}

    fn step(&self) {
        self.1.fetch_add(1, Ordering::Relaxed);
    }

    fn go_on(&self) -> bool {
        self.1.load(Ordering::Relaxed) < self.0
    }
}

fn endless() -> Until {
    Until(usize::MAX, AtomicUsize::new(0))
}

/// No noise, no errors, contacts from the image; about a hundred targets.
const PLAIN: Options = Options {
    spacing: Some(Length::Share(0.09)),
    diameter: Length::Share(0.15),
    contrast: 1.0,
    snr_db: None,
    seed: 1,
    electrode_error: Length::Metres(0.0),
    impedance_error: 0.0,
    found_in: Some(FoundIn::Image),
    threshold: None,
};

/// As the board has it that the skin file asks for: contacts from the voltages, at its noise.
const BOARD: Options = Options { snr_db: Some(60.0), found_in: None, ..PLAIN };

fn of(skin: &Skin, options: Options) -> Evaluation {
    let model = Model::build(skin, |_| ()).unwrap();
    evaluate(skin, &model, &options, &endless()).unwrap()
}

fn shipped(name: &str) -> Skin {
    let file = format!("{}/../../models/{name}/skin.toml", env!("CARGO_MANIFEST_DIR"));
    Skin::load(Path::new(&file)).unwrap().made().unwrap()
}

fn report(skin: &Skin, options: Options) -> Report {
    Report::new(&of(skin, options))
}

fn mean(spread: Option<Spread>) -> f64 {
    spread.unwrap().mean
}

#[test]
fn without_noise_targets_are_found_where_they_are_and_the_rings_make_up_the_skin() {
    let report = report(&coarse_disc(), PLAIN);
    assert!((90..130).contains(&report.total.targets), "{}", report.total.targets);
    assert_eq!((report.total.missed, report.contacts_found_by), (0, "board"));
    for ring in report.rings.iter().filter(|ring| ring.to_percent <= 80.0) {
        let error = ring.position_error_percent.unwrap();
        assert!(error.mean < 3.0 && error.max < 5.0, "{ring:?}");
        let (thesis, greit) = (&ring.thesis, &ring.greit);
        assert!(thesis.position_error_percent.unwrap().max.abs() <= error.max + 0.2, "{ring:?}");
        assert!(greit.position_error_percent.unwrap().max.abs() < 5.0, "{ring:?}");
        // A disc of twice the conductivity bends the current like one of a change of 2 / (2 + 1).
        assert!((mean(greit.amplitude_response) - 2.0 / 3.0).abs() < 0.3, "{ring:?}");
        assert!(mean(greit.shape_deformation) < 0.2, "{ring:?}");
    }
    assert_eq!(report.rings.iter().map(|ring| ring.targets).sum::<usize>(), report.total.targets);
    assert_eq!(report.targets.len(), report.total.targets);
    let centre = report.rings[0].thesis.resolution;
    let rim = report.rings.last().unwrap().thesis.resolution;
    assert!(mean(centre) > 1.2 * mean(rim), "electrodes are near the rim");
    assert!((mean(report.rings[0].greit.amplitude_over_centre) - 1.0).abs() < 0.1);
}

#[test]
fn one_seed_gives_the_same_figures_on_one_thread_or_many() {
    let skin = coarse_disc();
    for found_in in [FoundIn::Image, FoundIn::Voltages] {
        let noisy = Options { snr_db: Some(40.0), found_in: Some(found_in), ..PLAIN };
        let first = report(&skin, noisy);
        for threads in [1, 4] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert_eq!(pool.install(|| report(&skin, noisy)), first, "{threads} threads");
        }
        assert_ne!(report(&skin, Options { seed: 2, ..noisy }), first);
    }
}

#[test]
fn contacts_in_the_voltages_are_those_of_a_tared_board() {
    let skin = shipped("disc-210mm");
    let options = Options { spacing: Some(Length::Share(0.2)), seed: 5, ..BOARD };
    let evaluation = of(&skin, options);
    assert_eq!(evaluation.found_by, FoundBy::Voltages);
    let mut board = Observer::new(&skin).unwrap();
    let mut rig = Rig::new(&skin, &board.patch(), Noise { snr_db: 60.0, seed: 5 }).unwrap();
    let untouched = rig.truth().conductivity(&[]);
    board.tare(&rig.tare(&untouched));
    let surface = Surface::new(&skin.shape, rig.truth().mesh());
    let discs = Discs { radius: evaluation.target_diameter / 2.0, contrast: 1.0 };
    let places = surface.places(evaluation.spacing);
    assert_eq!(places.len(), evaluation.singles.len());
    for ((number, place), single) in (1..).zip(&places).zip(&evaluation.singles) {
        let phasors = rig.solve(&discs.at(&surface, &[*place]).conductivity);
        let frames = rig.numbered_scans(&phasors, SETTLED, number);
        let seen: Vec<_> = board.glance(&frames).contacts().iter().map(Found::from).collect();
        assert_eq!(single.contacts, seen, "{place}");
    }
    // And of any other noise.
    let error = |singles: &[Single]| {
        let errors = singles.iter().filter(|single| single.normalised_radius < 0.8);
        errors.map(|single| single.position_error().unwrap()).fold(0.0, f64::max)
    };
    let other = of(&skin, Options { seed: 6, ..options });
    assert!(error(&evaluation.singles) < 0.005 && error(&other.singles) < 0.005);
}

#[test]
fn a_board_says_how_sure_it_is_and_an_image_how_large_a_contact_is() {
    let skin = coarse_disc();
    let (voltages, image) = (report(&skin, BOARD), report(&skin, Options { snr_db: Some(60.0), ..PLAIN }));
    assert_eq!((voltages.contacts_found_in, image.contacts_found_in), ("voltages", "image"));
    assert_eq!((voltages.contact_threshold, image.contact_threshold), (None, Some(0.05)));
    let (of_board, of_image) = (&voltages.total, &image.total);
    assert!(of_board.within_two_stated_percent.unwrap() > 80.0, "{of_board:?}");
    assert!(of_board.stated_deviation_mm.is_some() && of_board.contact_area_percent.is_none());
    assert!(of_image.stated_deviation_mm.is_none() && of_image.within_two_stated_percent.is_none());
    assert!(of_image.contact_area_percent.is_some());
    // What images are worth does not depend on where contacts are found.
    assert_eq!((&of_board.greit, &of_board.thesis), (&of_image.greit, &of_image.thesis));
    for ring in voltages.rings.iter().filter(|ring| ring.to_percent <= 80.0) {
        assert_eq!((ring.exactly_one, ring.missed, ring.false_contacts), (ring.targets, 0, 0), "{ring:?}");
        assert!(ring.contact_strength_variation_percent.unwrap() < 20.0, "{ring:?}");
    }
}

#[test]
fn a_target_at_half_the_depth_that_the_image_misses_is_seen_in_the_voltages() {
    let skin = shipped("square-50mm");
    let faint = Options { diameter: Length::Share(0.08), contrast: 0.5, ..BOARD };
    let [voltages, image] = [FoundIn::Voltages, FoundIn::Image]
        .map(|found_in| report(&skin, Options { found_in: Some(found_in), ..faint }).total);
    assert!(10 * image.missed > image.targets, "{image:?}");
    assert!(50 * voltages.missed < voltages.targets, "{voltages:?}");
}

#[test]
fn a_board_without_noise_finds_every_target() {
    let silent = report(&coarse_disc(), Options { snr_db: None, ..BOARD });
    for ring in silent.rings.iter().filter(|ring| ring.to_percent <= 80.0) {
        assert_eq!((ring.missed, ring.false_contacts), (0, 0), "{ring:?}");
        assert!(ring.position_error_percent.unwrap().max < 5.0, "{ring:?}");
    }
}

#[test]
fn noise_makes_every_figure_worse() {
    let skin = coarse_disc();
    let (quiet, noisy) = (report(&skin, PLAIN), report(&skin, Options { snr_db: Some(30.0), ..PLAIN }));
    let figures = |report: &Report| {
        let (ring, greit) = (&report.total, &report.total.greit);
        [
            mean(ring.position_error_mm),
            mean(ring.thesis.ringing),
            mean(greit.ringing),
            mean(greit.shape_deformation),
        ]
    };
    for (quiet, noisy) in figures(&quiet).into_iter().zip(figures(&noisy)) {
        assert!(noisy > 1.3 * quiet, "{quiet} {noisy}");
    }
    assert!(noisy.total.false_contacts > quiet.total.false_contacts);
}

#[test]
fn errors_of_the_electrodes_misplace_targets() {
    let mut skin = coarse_disc();
    // Contact impedances matter most where driven electrodes are measured.
    let pattern = Pattern::Cyclic { drive_distance: 1, sense_distance: 1, driven: Driven::Measured };
    skin.drive = Drive { pattern, ..skin.drive };
    let model = Model::build(&skin, |_| ()).unwrap();
    let error = |options| {
        mean(Report::new(&evaluate(&skin, &model, &options, &endless()).unwrap()).total.position_error_mm)
    };
    let exact = error(PLAIN);
    let mean_of =
        |options: Options| (1..=4).map(|seed| error(Options { seed, ..options })).sum::<f64>() / 4.0;
    let moved = mean_of(Options { electrode_error: Length::Share(0.2), ..PLAIN });
    // 2.7 times over these seeds, 1.9 to 4.0 each.
    assert!((2.2..3.2).contains(&(moved / exact)), "{exact} {moved}");
    let worn = mean_of(Options { impedance_error: 1.0, ..PLAIN });
    // 1.03 over these seeds.
    assert!((1.02..1.1).contains(&(worn / exact)), "{exact} {worn}");
}

#[test]
fn an_electrode_error_in_per_cent_is_one_of_the_spacing() {
    let moved = of(&coarse_disc(), Options { electrode_error: Length::Share(0.1), ..PLAIN });
    let spacing = std::f64::consts::PI * 0.1 / 8.0;
    assert!((moved.electrode_error / (0.1 * spacing) - 1.0).abs() < 1e-9);
    let places = coarse_disc().shape.electrode_centres();
    let shifts = moved.electrodes.iter().zip(&places).map(|(to, from)| (to - from).norm_squared());
    let deviation = (shifts.sum::<f64>() / 8.0).sqrt();
    assert!((0.3..2.0).contains(&(deviation / moved.electrode_error)), "{deviation}");
}

#[test]
fn pairs_are_told_apart_as_close_near_the_rim_as_inside_and_farther_apart_in_noise() {
    let skin = coarse_disc();
    let quiet = of(&skin, PLAIN);
    for pair in &quiet.pairs {
        assert!(pair.told_apart.is_none_or(|distance| distance <= pair.largest + 1e-12), "{pair:?}");
        assert!(pair.told_apart.is_none_or(|distance| distance >= quiet.target_diameter - 1e-12), "{pair:?}");
    }
    let side_by_side = |evaluation: &Evaluation, ways: std::ops::Range<f64>| -> Vec<f64> {
        let pairs = evaluation.pairs.iter().filter(|pair| pair.direction == pairs::Direction::Across);
        // What is never told apart counts with the distance that was not enough.
        pairs
            .filter(|pair| ways.contains(&pair.normalised_radius))
            .map(|pair| pair.told_apart.unwrap_or(pair.largest + evaluation.pair_step))
            .collect()
    };
    let mean = |distances: Vec<f64>| distances.iter().sum::<f64>() / distances.len() as f64;
    let (inner, outer) = (mean(side_by_side(&quiet, 0.0..0.3)), mean(side_by_side(&quiet, 0.5..0.8)));
    assert!(outer <= inner + quiet.pair_step, "{outer} {inner}");
    let noisy = of(&skin, Options { snr_db: Some(30.0), ..PLAIN });
    let (quiet, noisy) = (mean(side_by_side(&quiet, 0.0..1.0)), mean(side_by_side(&noisy, 0.0..1.0)));
    assert!(noisy > quiet, "{noisy} {quiet}");
}

#[test]
fn weak_targets_are_missed_unless_the_threshold_is_lowered() {
    let skin = coarse_disc();
    let weak = Options { contrast: 0.01, ..PLAIN };
    let board = report(&skin, weak);
    assert_eq!((board.total.missed, board.total.position_error_mm), (board.total.targets, None));
    let keen = report(&skin, Options { threshold: Some(0.0), ..weak });
    assert_eq!((keen.total.missed, keen.contact_threshold), (0, Some(0.0)));
    assert!(mean(keen.rings[0].position_error_percent) < 3.0);
    assert_eq!(keen.total.greit, board.total.greit, "figures do not depend on the threshold");
}

#[test]
fn a_falling_conductivity_is_evaluated_like_a_rising_one() {
    let skin = coarse_disc();
    let [rising, falling] = [1.0, -0.5].map(|contrast| report(&skin, Options { contrast, ..PLAIN }));
    assert_eq!(falling.total.missed, 0);
    assert!(mean(rising.total.relative_voltage_change_percent) < 0.0, "more conductivity, less voltage");
    assert!(mean(falling.total.relative_voltage_change_percent) > 0.0);
    // As 2 / (2 - 0.5) to 2 / (2 + 1).
    let response = |report: &Report| mean(report.total.greit.amplitude_response);
    assert!((response(&falling) / response(&rising) / 2.0 - 1.0).abs() < 0.2);
    let error = |report: &Report| mean(report.total.position_error_mm);
    assert!((error(&falling) / error(&rising) - 1.0).abs() < 0.2);
}

#[test]
fn a_sheet_with_capacitance_is_evaluated_too() {
    let mut skin = coarse_disc();
    let real = report(&skin, PLAIN);
    // Susceptance a fifth of the conductivity.
    skin.material.sheet_capacitance =
        0.2 * skin.material.sheet_conductivity / (std::f64::consts::TAU * skin.drive.frequency);
    let complex = report(&skin, PLAIN);
    assert_ne!(complex, real);
    let difference = mean(complex.total.greit.resolution) / mean(real.total.greit.resolution) - 1.0;
    assert!(difference.abs() < 0.05, "{difference}");
}

#[test]
fn what_means_nothing_in_the_voltages_is_refused_with_what_to_do() {
    let skin = coarse_disc();
    let model = Model::build(&skin, |_| ()).unwrap();
    let refused = |options: Options| evaluate(&skin, &model, &options, &endless()).unwrap_err().to_string();
    for (options, option) in [
        (Options { threshold: Some(0.1), ..BOARD }, "`threshold` cannot be used"),
        (Options { contrast: -0.5, ..BOARD }, "`contrast` cannot be used"),
    ] {
        let words = refused(options);
        assert!(words.starts_with(option) && words.ends_with("or `found_in` image"), "{words}");
    }
}

#[test]
fn a_model_that_no_board_takes_is_judged_by_its_image_unless_the_voltages_are_asked_for() {
    let skin = Skin { image: ImageLayout::Elements, edges: coarse_disc().edges.scaled(0.3), ..coarse_disc() };
    let model = Model::build(&skin, |_| ()).unwrap();
    let few = Options { spacing: Some(Length::Share(0.5)), ..BOARD };
    let report = Report::new(&evaluate(&skin, &model, &few, &endless()).unwrap());
    assert_eq!((report.contacts_found_in, report.contacts_found_by), ("image", "image"));
    assert!(report.no_board.unwrap().starts_with("`image.pixels` gives"));
    let asked = Options { found_in: Some(FoundIn::Voltages), ..few };
    let refused = evaluate(&skin, &model, &asked, &endless()).unwrap_err();
    assert!(matches!(refused, EvaluateError::NoBoard(PatchBuildError::TooMany { .. })), "{refused}");
}

/// Half a sphere, electrodes on its equator, imaged on patches.
fn hemisphere() -> Skin {
    let mut skin = coarse_disc();
    let mut mesh =
        dermatome_model::model::mesh(&skin, 1.0, dermatome_geometry::mesh::Lattice::default()).unwrap();
    for node in &mut mesh.nodes {
        let (share, turn) = (node.coords.norm() / 0.05, node.y.atan2(node.x));
        let tilt = share.min(1.0) * std::f64::consts::FRAC_PI_2;
        *node = Point3::new(tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), tilt.cos()) * 0.05;
    }
    skin.shape = Shape::Mesh { mesh: Box::new(mesh), outline: None };
    skin.image = ImageLayout::ElementPatches { count: 150 };
    skin
}

#[test]
fn a_curved_skin_is_evaluated_on_its_surface() {
    let skin = hemisphere();
    let evaluation = of(&skin, Options { spacing: Some(Length::Share(0.12)), ..PLAIN });
    let report = Report::new(&evaluation);
    assert_eq!(report.contacts_found_by, "board");
    // On the top, farthest from the electrodes, one of 108 stays below the threshold.
    let missed: Vec<_> = report.rings.iter().map(|ring| ring.missed).collect();
    assert!(missed[0] <= 1 && missed[1..].iter().all(|&missed| missed == 0), "{missed:?}");
    assert!((70..130).contains(&report.total.targets), "{}", report.total.targets);
    for single in &evaluation.singles {
        assert!((single.position.coords.norm() / 0.05 - 1.0).abs() < 0.06, "{single:?}");
    }
    let inner = report.rings.iter().filter(|ring| ring.to_percent <= 80.0);
    for ring in inner {
        assert!(ring.position_error_percent.unwrap().max < 10.0, "{ring:?}");
    }
    assert!(mean(report.total.position_error_percent) < 4.0, "{:?}", report.total);
    assert!(evaluation.pairs.iter().any(|pair| pair.told_apart.is_some()));
    let png = picture(&evaluation, "half a sphere".into()).unwrap();
    assert!(png.starts_with(b"\x89PNG"));
}

fn of_flattened(skin: &Skin, options: Options) -> Report {
    let flat = skin.flattened().unwrap();
    let model = Model::build(&flat, |_| ()).unwrap();
    Report::new(&evaluate_flattened(skin, &flat, &model, &options, &endless()).unwrap())
}

#[test]
fn the_model_of_a_flattened_hemisphere_misplaces_contacts_and_shows_other_sizes() {
    let options = Options { spacing: Some(Length::Share(0.12)), ..PLAIN };
    let (surface, flat) = (report(&hemisphere(), options), of_flattened(&hemisphere(), options));
    // The same targets on the same true skin.
    assert_eq!((surface.total.targets, surface.true_elements), (flat.total.targets, flat.true_elements));
    let places = |report: &Report| report.targets.iter().map(|row| row.position_mm).collect::<Vec<_>>();
    assert_eq!(places(&surface), places(&flat));
    let error = |report: &Report| mean(report.total.position_error_mm);
    assert!(error(&flat) > 2.0 * error(&surface), "{} {}", error(&flat), error(&surface));
    let area = |report: &Report| mean(report.total.contact_area_percent);
    assert!(
        area(&surface) > 100.0 && area(&flat) < 0.8 * area(&surface),
        "{} {}",
        area(&flat),
        area(&surface)
    );
    let strongest =
        |report: &Report| report.targets.iter().filter_map(|row| row.contact_area_percent).count();
    assert_eq!(strongest(&flat), flat.total.targets - flat.total.missed);
}

#[test]
fn the_board_of_a_flattened_hemisphere_misplaces_contacts() {
    let options = Options { spacing: Some(Length::Share(0.12)), snr_db: Some(80.0), ..BOARD };
    let (surface, flat) = (report(&hemisphere(), options), of_flattened(&hemisphere(), options));
    assert_eq!((surface.contacts_found_in, flat.contacts_found_in), ("voltages", "voltages"));
    let error = |report: &Report| mean(report.total.position_error_mm);
    assert!(error(&flat) > 2.0 * error(&surface), "{} {}", error(&flat), error(&surface));
}

#[test]
fn a_flat_skin_flattened_is_the_same_skin() {
    let skin = coarse_disc();
    for options in [PLAIN, BOARD] {
        let (flat, surface) = (of_flattened(&skin, options).total, report(&skin, options).total);
        let figures = |ring: &Ring| [mean(ring.position_error_mm), mean(ring.contact_strength)];
        for (flat, surface) in figures(&flat).into_iter().zip(figures(&surface)) {
            assert!((flat / surface - 1.0).abs() < 1e-9, "{flat} {surface}");
        }
        let area = |ring: &Ring| ring.contact_area_percent.map(|area| (1e6 * area.mean).round());
        assert_eq!(area(&flat), area(&surface));
        assert_eq!((flat.missed, flat.false_contacts), (surface.missed, surface.false_contacts));
        assert_eq!(flat.greit, surface.greit);
    }
}

#[test]
fn an_imported_flat_mesh_is_evaluated_on_a_finer_one() {
    let mut skin = coarse_disc();
    let outline = skin.shape.flat().unwrap().clone();
    let mesh =
        dermatome_model::model::mesh(&skin, 1.0, dermatome_geometry::mesh::Lattice::default()).unwrap();
    let elements = mesh.elements.len();
    skin.shape = Shape::Mesh { mesh: Box::new(mesh), outline: Some(outline) };
    let report = report(&skin, PLAIN);
    assert_eq!(report.true_elements, 4 * elements);
    for ring in report.rings.iter().filter(|ring| ring.to_percent <= 80.0) {
        assert!(mean(ring.position_error_percent) < 3.0, "{ring:?}");
    }
}

#[test]
fn stopping_leaves_what_was_done() {
    let skin = coarse_disc();
    let model = Model::build(&skin, |_| ()).unwrap();
    let stopped = evaluate(&skin, &model, &PLAIN, &Until(5, AtomicUsize::new(0))).unwrap();
    assert!(!stopped.complete);
    assert!((5..30).contains(&stopped.singles.len()), "{}", stopped.singles.len());
    assert!(stopped.pairs.is_empty());
    assert_eq!(Report::new(&stopped).total.targets, stopped.singles.len());
}

#[test]
fn arguments_that_do_not_fit_the_skin_are_refused_with_what_is_allowed() {
    let skin = coarse_disc();
    let model = Model::build(&skin, |_| ()).unwrap();
    let refused = |options: Options| evaluate(&skin, &model, &options, &endless()).unwrap_err().to_string();
    let cases = [
        (
            Options { diameter: Length::Share(0.6), ..PLAIN },
            "`diameter` is 60.00 mm; allowed here: 0.50 mm to 50.00 mm",
        ),
        (Options { diameter: Length::Metres(0.0), ..PLAIN }, "`diameter` is 0.00 mm"),
        (Options { spacing: Some(Length::Share(0.0)), ..PLAIN }, "`spacing` is 0.00 mm; allowed here: 0.6"),
        (
            Options { electrode_error: Length::Share(3.0), ..PLAIN },
            "would touch; allowed: a smaller `electrode_error`",
        ),
    ];
    for (options, expected) in cases {
        let words = refused(options);
        assert!(words.contains(expected), "{words}");
    }
}
