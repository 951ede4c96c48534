//! `dermatome learn`: matrices calibrated from presses, on simulated skins that differ from their model.
#![cfg(unix)]

mod program;

use dermatome::{
    learn::{
        LearnError, Learnt, Request, Strength,
        judge::Judged,
        learn,
        matrix::spots,
        presses::{Positions, Presses, Recording},
        responses::Responses,
    },
    model::Model,
    recorded::{order::Arrangement, read::Frames},
    simulate::{Press, TrueSkin},
    skin::Skin,
};
use faer::Mat;
use insta::{Settings, assert_snapshot};
use nalgebra::Point3;
use npyz::WriterBuilder;
use num_complex::Complex64;
use program::{Desk, TINY, row, shape, transcript};
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use std::{fmt::Write as _, fs::File, path::Path};

const REQUEST: Request = Request { test_share: 0.2, seed: 1, strength: Strength::Response };

/// The tiny skin as it really is: electrodes 3 to 12 mm further round, contacts between a fifth and five
/// times what the skin file says.
fn true_tiny() -> Skin {
    let shifts = [12.0, 4.0, 10.0, 3.0, 9.0, 12.0, 5.0, 8.0];
    let position = |electrode: usize| {
        let angle = std::f64::consts::FRAC_PI_2 - std::f64::consts::TAU * electrode as f64 / 8.0;
        let angle = angle + shifts[electrode] / 50.0;
        format!("[\"{:.4} mm\", \"{:.4} mm\"]", 50.0 * angle.cos(), 50.0 * angle.sin())
    };
    let positions: Vec<_> = (0..8).map(position).collect();
    let placement = format!("placement = \"points\"\npositions = [{}]", positions.join(", "));
    let contacts = "contact_impedance = [\"0.9 ohm m\", \"0.04 ohm m\", \"0.18 ohm m\", \"0.5 ohm m\", \
                    \"0.06 ohm m\", \"0.9 ohm m\", \"0.1 ohm m\", \"0.04 ohm m\"]";
    let text = TINY
        .replace("placement = \"rim\"", &placement)
        .replace("contact_impedance = \"0.18 ohm m\"", contacts);
    Skin::parse(Path::new("true.toml"), &text).unwrap().made().unwrap()
}

/// Random presses on a true skin at 60 dB; forces are what the presses' depths are.
fn recording(skin: &Skin, count: usize, seed: u64) -> Recording {
    let truth = TrueSkin::new(skin).unwrap();
    let steps = skin.steps();
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let untouched = truth.voltages(&truth.conductivity(&[]), &steps);
    let size = (untouched.iter().map(|v| v * v).sum::<f64>() / untouched.len() as f64).sqrt() * 1e-3;
    let noisy = |voltages: Vec<f64>, random: &mut Pcg64Mcg| -> Vec<Complex64> {
        let sample = |v: f64| {
            let unit: f64 = StandardNormal.sample(random);
            Complex64::from(v + size * unit)
        };
        voltages.into_iter().map(sample).collect()
    };
    let (mut values, mut positions, mut forces) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..count {
        let (radius, angle) =
            (0.042 * random.random::<f64>().sqrt(), random.random_range(0.0..std::f64::consts::TAU));
        let position = [radius * angle.cos(), radius * angle.sin()];
        let depth = random.random_range(0.3..1.5);
        let press = Press::finger(position, 0.008, depth);
        values.extend(noisy(truth.voltages(&truth.conductivity(&[press]), &steps), &mut random));
        positions.push(position);
        forces.push(depth);
    }
    let frames =
        |values: Vec<Complex64>, frames| Frames { values, frames, measurements: steps.len(), complex: false };
    let unpressed = frames(noisy(untouched, &mut random), 1);
    let positions = Positions::FromAbove(positions);
    Recording { pressed: frames(values, count), unpressed, positions, forces: Some(forces) }
}

fn tiny() -> (Skin, Model) {
    let skin = Skin::parse(Path::new("tiny.toml"), TINY).unwrap().made().unwrap();
    let model = Model::build(&skin, |_| ()).unwrap();
    (skin, model)
}

fn learnt(recording: &Recording, request: &Request) -> Result<Learnt, LearnError> {
    let (skin, model) = tiny();
    let presses = recording.on(&model, &Arrangement::default()).unwrap();
    learn(&skin, &model, &presses, request)
}

#[test]
fn presses_teach_where_electrodes_and_contacts_really_are() {
    let report = learnt(&recording(&true_tiny(), 150, 3), &REQUEST).unwrap().report;
    let (model, test) = (report.model_test.unwrap(), report.test.unwrap());
    println!("model {model:?}\nlearnt {test:?}\nvalidation {:?}", report.validation);
    assert!(test.mean_mm < 0.6 * model.mean_mm, "{test:?}, {model:?}");
    assert_eq!(test.missed, 0);
    assert!(!report.conductivity_falls && !report.turn.unwrap().mirrored);
    assert!((report.validation.mean_mm / test.mean_mm - 1.0).abs() < 0.5, "{:?}", report.validation);
    assert!(report.fixed_point_mm < 0.1 && report.force_correlation.unwrap() > 0.5, "{report:?}");
}

#[test]
fn what_the_test_presses_say_changes_nothing_that_is_learnt() {
    let mut recording = recording(&true_tiny(), 50, 4);
    let before = learnt(&recording, &REQUEST).unwrap();
    let held_out = dermatome::learn::split::split(&(0..50).collect::<Vec<_>>(), 0.2, 1).test;
    let mut places = recording.positions.from_above();
    places[held_out[0]] = [0.0, 0.0];
    recording.positions = Positions::FromAbove(places);
    let steps = recording.pressed.measurements;
    recording.pressed.values[held_out[1] * steps] *= 2.0;
    let after = learnt(&recording, &REQUEST).unwrap();
    assert_eq!(before.patch, after.patch);
    assert_ne!(before.report.test, after.report.test);
}

#[test]
fn with_forces_followed_strength_correlates_better_with_force() {
    let recording = recording(&true_tiny(), 150, 5);
    let correlation =
        |strength| learnt(&recording, &Request { strength, ..REQUEST }).unwrap().report.force_correlation;
    let (answer, force) = (correlation(Strength::Response).unwrap(), correlation(Strength::Force).unwrap());
    assert!(force > answer, "{force}, {answer}");
}

#[test]
fn responses_miss_as_much_of_other_presses_as_they_say() {
    let (_, model) = tiny();
    let presses = recording(&true_tiny(), 80, 9).on(&model, &Arrangement::default()).unwrap();
    let numbers: Vec<usize> = (0..80).collect();
    let (taught, others) = numbers.split_at(50);
    let learnt = Responses::learn(&model, &presses, taught, &numbers).unwrap();
    let places: Vec<_> = others.iter().map(|&press| presses.places[press]).collect();
    let told = learnt.at(&places);
    let missed = |(row, &press): (usize, &usize)| {
        let measured: Vec<f64> = presses.data[press].iter().zip(&learnt.usual).map(|(y, s)| y / s).collect();
        let product: f64 = told.row(row).iter().zip(&measured).map(|(a, b)| a * b).sum();
        1.0 - product.powi(2) / measured.iter().map(|y| y * y).sum::<f64>() / told.row(row).squared_norm_l2()
    };
    let missed = others.iter().enumerate().map(missed).sum::<f64>() / others.len() as f64;
    println!("of others {missed:.3}, of those left out {:.3}", learnt.missing_share());
    assert!((0.4..2.5).contains(&(missed / learnt.missing_share())) && missed < 0.3, "{missed}");
}

#[test]
fn spots_are_found_where_the_press_is_also_near_the_edge() {
    let (_, model) = tiny();
    let wanted = spots(&model, &model.pixels.centres, 0.3);
    let surface = &model.surface().unwrap();
    // The disc has a radius of 50 mm, and the spot one of 15 mm.
    let inside = |centre: &Point3<f64>| centre.coords.norm() < 0.042;
    for (pixel, centre) in model.pixels.centres.iter().enumerate().filter(|(_, centre)| inside(centre)) {
        let image: Vec<f64> = wanted.col(pixel).iter().copied().collect();
        let matrix = Mat::from_fn(image.len(), 1, |row, _| image[row]);
        let presses = Presses {
            data: vec![vec![1.0]],
            places: vec![*centre],
            off: None,
            forces: None,
            mean_divisors: vec![1.0],
            mean_reference: Vec::new(),
        };
        let errors = Judged { matrix: &matrix, surface }.judge(&presses, &[0]).errors();
        assert!(errors.worst_mm < 1.5 && errors.seconds == 0, "pixel {pixel} at {centre}: {errors:?}");
    }
}

#[test]
fn an_archive_of_presses_is_read_as_it_was_written() {
    let written = recording(&true_tiny(), 12, 10);
    let desk = Desk::empty();
    let mut archive = npyz::npz::NpzWriter::new(File::create(desk.path("presses.npz")).unwrap());
    let real = |frames: &Frames| frames.values.iter().map(|value| value.re).collect::<Vec<_>>();
    let arrays = [
        ("v_pressed", vec![12, 40], real(&written.pressed)),
        ("v_unpressed", vec![40], real(&written.unpressed)),
        ("positions_m", vec![12, 2], written.positions.from_above().concat()),
        ("force_n", vec![12], written.forces.clone().unwrap()),
    ];
    for (name, shape, values) in arrays {
        let array = archive.array(name, Default::default()).unwrap().default_dtype().shape(&shape);
        let mut array = array.begin_nd().unwrap();
        array.extend(values).unwrap();
        array.finish().unwrap();
    }
    drop(archive);
    let path = desk.path("presses.npz");
    assert_eq!(Recording::read(&path, None, 0.0, &tiny().0).unwrap(), written);
    let shifted = Recording::read(&path, None, 0.5, &tiny().0).unwrap();
    assert_eq!(shifted.pressed.values[0], written.pressed.values[0] - 0.5);
    assert_eq!(shifted.positions, written.positions);
}

#[test]
fn impossible_requests_are_refused() {
    let mut recording = recording(&true_tiny(), 12, 6);
    let enough = Request { test_share: 0.0, ..REQUEST };
    assert!(learnt(&recording, &enough).is_ok());
    let few = learnt(&recording, &Request { test_share: 0.5, ..REQUEST }).unwrap_err();
    assert_eq!(few, LearnError::TooFew { found: 6, presses: 12, test: 6 });
    assert_eq!(
        learnt(&recording, &Request { test_share: 0.6, ..REQUEST }).unwrap_err(),
        LearnError::TestShare(0.6)
    );
    recording.forces = None;
    let forces = learnt(&recording, &Request { strength: Strength::Force, ..REQUEST });
    assert_eq!(forces.unwrap_err(), LearnError::NoForces);
    let steps = recording.pressed.measurements;
    let untouched = recording.unpressed.values.clone();
    recording.pressed.values[3 * steps..4 * steps].copy_from_slice(&untouched);
    assert_eq!(
        learnt(&recording, &Request { test_share: 0.0, ..REQUEST }).unwrap_err(),
        LearnError::NoChange(3)
    );
}

#[test]
fn presses_at_few_places_are_refused_and_those_at_one_place_are_not_on_both_sides() {
    let mut recording = recording(&true_tiny(), 60, 11);
    let all = recording.positions.from_above();
    let cycled = |places| Positions::FromAbove(all.iter().take(places).cycle().take(60).copied().collect());
    for places in [1, 9] {
        recording.positions = cycled(places);
        let LearnError::TooFewPlaces { found, places: of_all } = learnt(&recording, &REQUEST).unwrap_err()
        else {
            panic!("{places}")
        };
        assert!(found < places && of_all == places, "{found} of {of_all}");
    }
    // 15 places: 12 are learnt from, and the presses of three are the test.
    recording.positions = cycled(15);
    let report = learnt(&recording, &REQUEST).unwrap().report;
    assert_eq!((report.training_presses, report.test_presses), (48, 12));
}

/// A table of presses and one of the untouched skin.
fn write_tables(desk: &Desk, recording: &Recording) {
    let mut text = String::new();
    let forces = recording.forces.clone().unwrap();
    for ((frame, [x, y]), force) in recording.pressed.iter().zip(recording.positions.from_above()).zip(forces)
    {
        let values: Vec<f64> = frame.iter().map(|value| value.re).collect();
        write!(text, "{x:.6},{y:.6},{force:.4},{}", row(&values)).unwrap();
    }
    desk.write("presses.csv", text);
    desk.write("idle.csv", row(&recording.unpressed.mean().iter().map(|value| value.re).collect::<Vec<_>>()));
}

/// Snapshots without figures, which rounding may change.
fn without_figures(check: impl FnOnce()) {
    let mut settings = Settings::clone_current();
    settings.set_omit_expression(true);
    settings.add_filter(r"in the model \S+,", "in the model [NUMBER],");
    settings.add_filter(r"0x[0-9a-f]{8}", "0x[CRC]");
    settings.add_filter(r" +-?\d+\.\d+(e-?\d+)?", " [NUMBER]");
    settings.bind(check);
}

#[test]
fn what_learn_prints_and_reports() {
    let desk = Desk::empty();
    desk.write("skin.toml", TINY);
    write_tables(&desk, &recording(&true_tiny(), 60, 7));
    let command =
        ["learn", "skin.toml", "--presses", "presses.csv", "--reference", "idle.csv", "--json", "learn.json"];
    let done = desk.run(&command).success();
    without_figures(|| assert_snapshot!("learn", done.out));
    let report = desk.report("learn.json");
    assert_snapshot!("learn_json", shape(&report));
    assert_eq!(report["patch_bytes"], desk.read("tiny.dermatome").len());
    desk.run(&["inspect", "tiny.dermatome"]).success();
}

#[test]
fn wrong_presses_are_refused_with_press_value_and_what_is_allowed() {
    let desk = Desk::empty();
    desk.write("skin.toml", TINY);
    let good = recording(&true_tiny(), 12, 8);
    write_tables(&desk, &good);
    let table = String::from_utf8(desk.read("presses.csv")).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    let with = |column: usize, value: &str| {
        let mut first = cells(lines[0]);
        first[column] = value.to_owned();
        [&[first.join(",").as_str()], &lines[1..]].concat().join("\n")
    };
    desk.write("few.csv", lines[..9].join("\n"));
    desk.write("millimetres.csv", with(0, "35"));
    desk.write("beside.csv", with(1, "0.062"));
    desk.write("pulled.csv", with(2, "-2"));
    desk.write("nan.csv", with(7, "nan"));
    desk.write("short.csv", lines.iter().map(|line| cells(line)[..30].join(",") + "\n").collect::<String>());
    desk.write("presses.mat", "");
    let learn =
        |presses, more: &[&'static str]| [&["learn", "skin.toml", "--presses", presses], more].concat();
    let idle = ["--reference", "idle.csv"];
    let mut commands: Vec<_> = [
        "few.csv",
        "millimetres.csv",
        "beside.csv",
        "pulled.csv",
        "nan.csv",
        "short.csv",
        "presses.mat",
        "none.csv",
    ]
    .map(|file| learn(file, &idle))
    .to_vec();
    commands.push(learn("presses.csv", &[]));
    commands.push(learn("presses.csv", &["--reference", "idle.csv", "--test", "0.9"]));
    let commands: Vec<&[&str]> = commands.iter().map(Vec::as_slice).collect();
    assert_snapshot!("errors_learn", transcript(&desk, &commands));
    assert!(!desk.files().contains(&"tiny.dermatome".to_owned()));
}
