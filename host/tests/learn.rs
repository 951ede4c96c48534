//! `dermatome learn`: matrices calibrated from presses, on simulated skins that differ from their model.
#![cfg(unix)]

mod program;

use dermatome::{
    learn::{
        LearnError, Learnt, Request, Strength,
        judge::Judged,
        learn,
        matrix::spots,
        presses::{Layout, Positions, Presses, Recording},
        responses::Responses,
    },
    model::Model,
    recorded::{
        order::Arrangement,
        read::{Frames, Source, read},
    },
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

/// The archive `presses.npz`.
fn write_archive(desk: &Desk, recording: &Recording) {
    let Recording { pressed, unpressed, positions, forces } = recording;
    let mut archive = npyz::npz::NpzWriter::new(File::create(desk.path("presses.npz")).unwrap());
    let real = |frames: &Frames| frames.values.iter().map(|value| value.re).collect::<Vec<_>>();
    let shape = |frames: &Frames| vec![frames.frames as u64, frames.measurements as u64];
    let count = pressed.frames as u64;
    let arrays = [
        ("v_pressed", shape(pressed), real(pressed)),
        ("v_unpressed", shape(unpressed), real(unpressed)),
        ("positions_m", vec![count, 2], positions.from_above().concat()),
        ("force_n", vec![count], forces.clone().unwrap()),
    ];
    for (name, shape, values) in arrays {
        let array = archive.array(name, Default::default()).unwrap().default_dtype().shape(&shape);
        let mut array = array.begin_nd().unwrap();
        array.extend(values).unwrap();
        array.finish().unwrap();
    }
}

#[test]
fn an_archive_of_presses_is_read_as_it_was_written() {
    let written = recording(&true_tiny(), 12, 10);
    let desk = Desk::empty();
    write_archive(&desk, &written);
    let path = desk.path("presses.npz");
    assert_eq!(Recording::read(&path, None, &Layout::default(), &tiny().0).unwrap(), written);
    let shifted =
        Recording::read(&path, None, &Layout { offset: 0.5, ..Layout::default() }, &tiny().0).unwrap();
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

/// Presses whose baseline is another one each time: every measurement by another share of 5 %.
fn drifting(count: usize) -> Recording {
    let mut recording = recording(&true_tiny(), count, 9);
    let steps = recording.pressed.measurements;
    recording.unpressed = recording.unpressed.for_each_of(count);
    let mut random = Pcg64Mcg::seed_from_u64(10);
    for (pressed, unpressed) in recording.pressed.values.iter_mut().zip(&mut recording.unpressed.values) {
        let unit: f64 = StandardNormal.sample(&mut random);
        *pressed *= 1.0 + 0.05 * unit;
        *unpressed *= 1.0 + 0.05 * unit;
    }
    assert_eq!(recording.unpressed.values.len(), count * steps);
    recording
}

fn table(frames: &Frames) -> String {
    let text = |frame: &[Complex64]| row(&frame.iter().map(|value| value.re).collect::<Vec<_>>());
    frames.iter().map(text).collect()
}

#[test]
fn presses_of_a_table_are_learnt_from_each_against_its_own_reference() {
    let desk = Desk::empty();
    desk.write("skin.toml", TINY);
    let recording = drifting(80);
    write_tables(&desk, &recording);
    desk.write("before.csv", table(&recording.unpressed));
    let learn = |more: &[&str]| {
        let command = ["learn", "skin.toml", "--presses", "presses.csv", "--json", "learn.json"];
        desk.run(&[&command[..], more].concat()).success();
        let report = desk.report("learn.json");
        ["test", "validation"].map(|part| report[part]["median_mm"].as_f64().unwrap())
    };
    let own = learn(&["--reference", "before.csv", "--each"]);
    let patch = desk.read("tiny.dermatome");
    let one = learn(&["--reference", "before.csv", "--force"]);
    println!("median errors of test and cross-validation: own references {own:.2?}, one {one:.2?} mm");
    assert!(own[0] < 3.0 && own[1] < 3.0, "{own:?}");
    assert!(one[0] > 2.5 * own[0] && one[1] > 2.5 * own[1], "{one:?} {own:?}");
    // An archive that holds them teaches the same.
    let before = read(&Source { path: desk.path("before.csv"), key: None }).unwrap();
    let as_table =
        Recording::read(&desk.path("presses.csv"), Some(before), &Layout::default(), &tiny().0).unwrap();
    write_archive(&desk, &as_table);
    desk.run(&["learn", "skin.toml", "--presses", "presses.npz", "-o", "archive.dermatome"]).success();
    assert!(desk.read("archive.dermatome") == patch, "an archive's own references");
}

#[test]
fn presses_as_potentials_or_in_columns_teach_the_same() {
    let desk = Desk::empty();
    desk.write("skin.toml", TINY);
    let recording = drifting(40);
    write_tables(&desk, &recording);
    desk.write("before.csv", table(&recording.unpressed));
    let learn = |presses: &str, before: &str, more: &[&str]| {
        let command =
            ["learn", "skin.toml", "--presses", presses, "--reference", before, "--each", "--force"];
        desk.run(&[&command[..], more].concat()).success();
        desk.read("tiny.dermatome")
    };
    let rows = learn("presses.csv", "before.csv", &[]);
    for name in ["presses", "before"] {
        let text = String::from_utf8(desk.read(&format!("{name}.csv"))).unwrap();
        let cells: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        let column = |column: usize| cells.iter().map(|row| row[column]).collect::<Vec<_>>().join(",") + "\n";
        desk.write(&format!("{name}-columns.csv"), (0..cells[0].len()).map(column).collect::<String>());
    }
    assert!(learn("presses-columns.csv", "before-columns.csv", &["--transpose"]) == rows, "columns");
    let refused = desk.run(&[
        "learn",
        "skin.toml",
        "--presses",
        "presses.csv",
        "--reference",
        "before.csv",
        "--single-ended",
        "--force",
    ]);
    assert!(refused.refused().contains("potentials of electrodes"), "differences are no potentials");
}

#[test]
fn what_learn_records_is_its_presses_through_the_learnt_patch() {
    let desk = Desk::empty();
    desk.write("skin.toml", TINY);
    let recording = drifting(40);
    write_tables(&desk, &recording);
    desk.write("before.csv", table(&recording.unpressed));
    desk.write("pressed.csv", table(&recording.pressed));
    let learn = ["learn", "skin.toml", "--presses", "presses.csv", "--reference", "before.csv", "--each"];
    let done = desk.run(&[&learn[..], &["--record", "presses.mcap"]].concat()).success();
    assert!(done.err.contains("recorded 80 frames to presses.mcap"), "{}", done.err);
    let replayed = desk.run(&["replay", "presses.mcap", "--json", "replay.json"]).success();
    assert!(replayed.err.contains("bit for bit: 40 images, contacts of 40 frames"), "{}", replayed.err);
    let contacts = |out: &str| -> Vec<String> {
        // Frames are numbered anew, and come at another time.
        out.lines().map(|line| line.split('\t').skip(2).take(7).collect::<Vec<_>>().join(" ")).collect()
    };
    let of_others =
        ["replay", "pressed.csv", "--patch", "tiny.dermatome", "--reference", "before.csv", "--each"];
    let direct = contacts(&desk.run(&of_others).success().out);
    assert!(direct.len() >= 38, "{}", direct.len());
    assert_eq!(contacts(&replayed.out), direct);
    let session = dermatome::recording::read::Recording::open(&desk.path("presses.mcap")).unwrap();
    let session = session.session();
    assert_eq!(session.patch, desk.read("tiny.dermatome"));
    assert_eq!((session.skin_file.as_deref(), session.port.as_str()), (Some(TINY), "presses.csv"));
    // With one reference for all, each press comes after that.
    desk.write("one.csv", table(&recording.unpressed.averaged()));
    let one =
        ["learn", "skin.toml", "--presses", "presses.csv", "--reference", "one.csv", "-o", "one.dermatome"];
    let done = desk.run(&[&one[..], &["--record", "one.mcap"]].concat()).success();
    assert!(done.err.contains("recorded 80 frames to one.mcap"), "{}", done.err);
    assert!(desk.run(&["replay", "one.mcap"]).success().err.contains("bit for bit"));
    // The page takes it as a board's.
    let mut view =
        desk.start(&["view", "--port", "replay:presses.mcap", "--no-browser", "--listen", "127.0.0.1:0"]);
    assert!(view.line().contains("http://127.0.0.1:"));
    let streamed = desk.run(&["stream", "--port", "replay:presses.mcap", "--frames", "40"]).success();
    assert_eq!(contacts(&streamed.out), direct);
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
    commands.push(learn("presses.csv", &["--reference", "idle.csv", "--each"]));
    commands.push(learn("presses.csv", &["--each"]));
    commands.push(learn("presses.csv", &["--reference", "idle.csv", "--record", "skin.toml"]));
    commands.push(learn("presses.csv", &["--reference", "idle.csv", "--record", "none/presses.mcap"]));
    let commands: Vec<&[&str]> = commands.iter().map(Vec::as_slice).collect();
    assert_snapshot!("errors_learn", transcript(&desk, &commands));
    assert!(!desk.files().contains(&"tiny.dermatome".to_owned()));
}
