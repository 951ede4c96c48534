//! Skin files that are wrong: each is refused with file, field, value and what is allowed.

use dermatome::{
    model::Model,
    patch::write::{Stored, with_calibration},
    skin::{FoundIn, Skin},
};
use dermatome_shared::{
    calibration::{Calibration, CalibrationPoint, MAX_POINTS},
    drive::{Component, Gain},
    hysteresis::{MAX_PLAY_OPERATORS, PlayOperator},
    patch::PatchView,
};
use std::path::Path;

const GOOD: &str = include_str!("../../models/disc-210mm/skin.toml");
const SQUARE: &str = include_str!("../../models/square-50mm/skin.toml");

/// The error of a skin file in which `from` is replaced by `to`.
fn error_of(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "the test replaces {from:?}, which is not there");
    let changed = text.replacen(from, to, 1);
    Skin::parse(Path::new("hand/skin.toml"), &changed).expect_err(to).to_string()
}

#[test]
fn wrong_values_name_file_field_value_and_what_is_allowed() {
    let cases: &[(&str, &str, &str, &[&str])] = &[
        (
            GOOD,
            "diameter = \"210 mm\"",
            "diameter = \"-210 mm\"",
            &["`shape.diameter`", "-210 mm", "above zero"],
        ),
        (
            GOOD,
            "diameter = \"210 mm\"",
            "diameter = \"210 inch\"",
            &["`shape.diameter`", "inch", "cm, mm or um"],
        ),
        (GOOD, "diameter = \"210 mm\"", "diameter = nan", &["`shape.diameter`", "NaN"]),
        (GOOD, "diameter = \"210 mm\"", "", &["`shape.diameter`", "missing"]),
        (GOOD, "kind = \"disc\"", "kind = \"star\"", &["`shape.kind`", "star", "\"disc\", \"rectangle\""]),
        (GOOD, "kind = \"disc\"", "kind = \"disc\"\nwidth = 1", &["`shape.width`", "a disc has"]),
        (
            GOOD,
            "edge_length = \"4.5 mm\"",
            "edge_length = \"0.0001 mm\"",
            &["`mesh.edge_length`", "0.0001 mm", "mm to"],
        ),
        (GOOD, "edge_length = \"4.5 mm\"", "edge_length = \"4 m\"", &["`mesh.edge_length`", "4 m"]),
        (GOOD, "count = 16", "count = 3", &["`electrodes.count`", "is 3", "4 to 250"]),
        (GOOD, "count = 16", "count = 251", &["`electrodes.count`", "is 251", "4 to 250"]),
        (GOOD, "count = 16", "count = -16", &["`electrodes.count`", "is -16"]),
        (
            GOOD,
            "width = \"11 mm\"",
            "width = \"42 mm\"",
            &["`electrodes.width`", "42 mm", "overlap", "less than"],
        ),
        (GOOD, "placement = \"rim\"", "placement = \"sides\"", &["`electrodes.placement`", "for a disc"]),
        (
            GOOD,
            "placement = \"rim\"",
            "placement = \"inside\"",
            &["`electrodes.placement`", "inside", "\"rim\", \"sides\""],
        ),
        (GOOD, "direction = \"clockwise\"", "direction = \"left\"", &["`electrodes.direction`", "left"]),
        (GOOD, "model = \"complete\"", "model = \"shunt\"", &["`electrodes.model`", "shunt"]),
        (
            GOOD,
            "model = \"complete\"",
            "model = \"point\"",
            &["`electrodes.width`", "point electrodes have none"],
        ),
        (
            GOOD,
            "contact_impedance = \"0.18 ohm m\"",
            "contact_impedance = [1, 2]",
            &["`electrodes.contact_impedance`", "list of 2", "list of 16"],
        ),
        (
            GOOD,
            "contact_impedance = \"0.18 ohm m\"",
            "contact_impedance = 0",
            &["`electrodes.contact_impedance`", "is 0"],
        ),
        (GOOD, "ground = 1", "ground = 17", &["`electrodes.ground`", "is 17", "1 to 16"]),
        (
            GOOD,
            "pattern = \"adjacent\"",
            "pattern = \"skip-9\"",
            &["`drive.pattern`", "skip-9", "\"skip-6\""],
        ),
        (GOOD, "reciprocal = \"combined\"", "reciprocal = \"yes\"", &["`drive.reciprocal`", "yes"]),
        (GOOD, "frame_rate = \"50 Hz\"", "frame_rate = 0", &["`drive.frame_rate`", "is 0"]),
        (
            GOOD,
            "prior = \"laplace\"",
            "prior = \"total-variation\"",
            &["`inverse.prior`", "total-variation", "noser"],
        ),
        (GOOD, "hyperparameter = 0.03", "hyperparameter = -1.0", &["`inverse.hyperparameter`", "is -1"]),
        (
            GOOD,
            "hyperparameter = 0.03",
            "hyperparameter = \"l-kurve\"",
            &[
                "`inverse.hyperparameter`",
                "l-kurve",
                "\"l-curve\", \"gcv\", \"noise-figure\" or \"best-resolution\"",
            ],
        ),
        (
            GOOD,
            "hyperparameter = 0.03",
            "hyperparameter = \"gcv\"\nnoise_figure = 0.5",
            &["`inverse.noise_figure`", "is 0.5", "only the hyperparameter \"noise-figure\""],
        ),
        (
            GOOD,
            "hyperparameter = 0.03",
            "hyperparameter = \"noise-figure\"\nnoise_figure = 0",
            &["`inverse.noise_figure`", "is 0", "above zero"],
        ),
        (
            GOOD,
            "hyperparameter = 0.03",
            "hyperparameter = 0.03\nnoise_db = -3",
            &["`inverse.noise_db`", "is -3", "0 to 200"],
        ),
        (GOOD, "prior = \"laplace\"", "", &["`inverse.prior`", "missing", "laplace-squared"]),
        (
            GOOD,
            "prior = \"laplace\"",
            "prior = \"laplace\"\nmethod = \"greit\"",
            &["`inverse.prior`", "laplace", "\"greit\" has no prior"],
        ),
        (GOOD, "prior = \"laplace\"", "method = \"grit\"", &["`inverse.method`", "grit", "\"greit\""]),
        (
            GOOD,
            "prior = \"laplace\"",
            "prior = \"laplace\"\nnoser_exponent = 0.5",
            &["`inverse.noser_exponent`", "is 0.5", "only the prior \"noser\""],
        ),
        (
            GOOD,
            "prior = \"laplace\"",
            "prior = \"noser\"\nnoser_exponent = 3",
            &["`inverse.noser_exponent`", "is 3", "0 to 2"],
        ),
        (
            GOOD,
            "prior = \"laplace\"",
            "prior = \"gaussian\"\ngaussian_diameter = 0",
            &["`inverse.gaussian_diameter`", "is 0", "0.01 to 1"],
        ),
        (
            GOOD,
            "prior = \"laplace\"",
            "method = \"greit\"\ngreit_radius = 2",
            &["`inverse.greit_radius`", "is 2", "0.01 to 1"],
        ),
        (
            GOOD,
            "electrode_movement = 10",
            "electrode_movement = 0",
            &["`inverse.electrode_movement`", "is 0", "above zero"],
        ),
        (
            GOOD,
            "normalised = true",
            "normalised = false\nweights = \"reference-squared\"",
            &["`inverse.weights`", "reference-squared", "for normalised data"],
        ),
        (
            GOOD,
            "normalised = true",
            "normalised = true\nweights = \"missing.csv\"",
            &["`inverse.weights`", "missing.csv", "CSV file with the columns weight"],
        ),
        (GOOD, "columns = 32", "columns = 0", &["`image.columns`", "is 0", "4 to 64"]),
        (GOOD, "columns = 32", "pixels = 3", &["`image.pixels`", "is 3", "elements", "4 to 100000"]),
        (GOOD, "columns = 32", "pixels = \"nodes\"", &["`image.pixels`", "nodes", "elements"]),
        (GOOD, "columns = 32", "columns = 32\npixels = 9", &["`image.pixels`", "given", "nothing"]),
        (GOOD, "columns = 32", "", &["`image.columns`", "missing", "`pixels`"]),
        (GOOD, "\"adjacent\"", "\"table\"", &["`drive.table`", "missing", "CSV"]),
        (GOOD, "\"adjacent\"", "\"adjacent\"\ntable = [[1, 2, 3, 4]]", &["`drive.table`", "only pattern"]),
        (
            GOOD,
            "\"adjacent\"",
            "\"table\"\ntable = [[2, 1, 3, 4], [2, 1, 3, 17]]",
            &["`drive.table`", "[2, 1, 3, 17] in row 2", "electrodes 1 to 16"],
        ),
        (
            GOOD,
            "\"adjacent\"",
            "\"table\"\ntable = [[2, 2, 3, 4]]",
            &["`drive.table`", "row 1", "two different electrodes"],
        ),
        (GOOD, "\"adjacent\"", "\"table\"\ntable = []", &["`drive.table`", "0 steps", "1 to 65535"]),
        (GOOD, "\"adjacent\"", "\"table\"\ntable = \"no.csv\"", &["`drive.table`", "no.csv", "drive_plus"]),
        (GOOD, "\"adjacent\"", "\"adjacent\"\ndriven = \"no\"", &["`drive.driven`", "skipped"]),
        (
            GOOD,
            "sheet_conductivity = \"5.88 mS\"",
            "sheet_conductivity = 1.0\nsheet_capacitance = \"1 nS\"",
            &["`material.sheet_capacitance`", "1 nS", "pF"],
        ),
        (GOOD, "threshold = 0.05", "threshold = 0.0", &["`contact.threshold`", "is 0"]),
        (GOOD, "name = \"disc-210mm\"", "name = \"../evil\"", &["`name`", "../evil", "letters, digits"]),
        (GOOD, "name = \"disc-210mm\"", "name = \"\"", &["`name`", "1 to 32 letters"]),
        (
            SQUARE,
            "pitch = \"10 mm\"",
            "pitch = \"15.1 mm\"",
            &["`electrodes.pitch`", "at most 15.000 mm", "outside"],
        ),
        (SQUARE, "pitch = \"10 mm\"", "pitch = \"4 mm\"", &["`electrodes.width`", "overlap"]),
        (SQUARE, "pitch = \"10 mm\"", "", &["`electrodes.pitch`", "missing"]),
        (SQUARE, "count = 16", "count = 14", &["`electrodes.count`", "multiple of 4"]),
        (SQUARE, "height = \"50 mm\"", "height = \"0 mm\"", &["`shape.height`", "0 mm"]),
    ];
    for (text, from, to, expected) in cases {
        let error = error_of(text, from, to);
        for part in expected.iter().chain(&["`hand/skin.toml`"]) {
            assert!(error.contains(part), "{to}: {part:?} is not in {error:?}");
        }
    }
}

#[test]
fn wrong_drives_drift_times_and_calibrations_are_refused() {
    let rate = "frame_rate = \"50 Hz\"";
    let cases: &[(&str, &str, &[&str])] = &[
        (rate, "phase = \"361 deg\"", &["`drive.phase`", "361 deg", "0 deg to 360 deg"]),
        (rate, "phase = \"30 mm\"", &["`drive.phase`", "30 mm"]),
        (rate, "settling = -0.1", &["`drive.settling`", "-0.1", "0 to 100 carrier periods"]),
        (rate, "settling = nan", &["`drive.settling`", "NaN"]),
        (rate, "integration = 0", &["`drive.integration`", "is 0", "1 to 64"]),
        (rate, "integration = 65", &["`drive.integration`", "is 65"]),
        (rate, "gain = 3", &["`drive.gain`", "is 3", "\"automatic\", 1, 2, 4, 8, 16, 32 or 64"]),
        (rate, "gain = \"loud\"", &["`drive.gain`", "loud"]),
        (rate, "component = \"both\"", &["`drive.component`", "both", "\"magnitude\""]),
        ("[contact]", "drift_time = \"0.5 s\"", &["`contact.drift_time`", "0.5 s", "1 s to 86400 s"]),
        ("[contact]", "drift_time = -1", &["`contact.drift_time`", "is -1"]),
        ("[contact]", "false_alarms = 0", &["`contact.false_alarms`", "is 0", "0.000001 to 3600"]),
        ("[contact]", "averaging = \"11 s\"", &["`contact.averaging`", "11 s", "0 s to 10 s"]),
        ("[contact]", "drift_time = \"2 days\"", &["`contact.drift_time`", "2 days"]),
    ];
    for (after, line, words) in cases {
        let message = error_of(GOOD, after, &format!("{after}\n{line}"));
        assert!(words.iter().all(|word| message.contains(word)), "{line}: {message}");
    }
    let calibrations: &[(&str, &str, &[&str])] = &[
        ("[0.1, 0.2]", "[\"1 kPa\"]", &["`calibration.pressure`", "1 points", "as many"]),
        ("[0.2, 0.1]", "[1, 2]", &["`calibration.strength`", "is 0.1", "rise", "more than 0.2"]),
        ("[0.1, 0.2]", "[2, 2]", &["`calibration.pressure`", "is 2", "rise"]),
        ("[0.0, 0.2]", "[1, 2]", &["`calibration.strength`", "is 0", "rise"]),
        ("[0.1, inf]", "[1, 2]", &["`calibration.strength`", "inf"]),
        ("[0.1]", "[\"5 bar\"]", &["`calibration.pressure`", "5 bar", "kPa"]),
    ];
    let refused = |strength: &str, pressure: &str| {
        let table = format!("[calibration]\nstrength = {strength}\npressure = {pressure}\n");
        Skin::parse(Path::new("skin.toml"), &format!("{GOOD}\n{table}")).unwrap_err().to_string()
    };
    for (strength, pressure, words) in calibrations {
        let message = refused(strength, pressure);
        assert!(words.iter().all(|word| message.contains(word)), "{strength} {pressure}: {message}");
    }
    let share = refused("[0.1]", "[1]\nload_share = 0");
    assert!(share.contains("`calibration.load_share` is 0; allowed: 0.000001 to 1000000"), "{share}");
    let many = format!("{:?}", (1..=17).collect::<Vec<_>>());
    assert!(refused(&many.replace(',', ".0,"), &many).contains("17 points; allowed: at most 16"));
}

#[test]
fn drive_drift_time_and_calibration_reach_the_patch() {
    let rate = "frame_rate = \"50 Hz\"";
    let drive = "phase = \"30 deg\"\nsettling = 0.5\nintegration = 2\ngain = 8\ncomponent = \"magnitude\"";
    let text = GOOD.replace(rate, &format!("{rate}\n{drive}")).replace("\"combined\"", "\"once\"");
    let text = text.replace("[contact]", "[contact]\ndrift_time = \"5 min\"");
    let text = format!(
        "{text}\n[calibration]\nstrength = [0.1, 0.3]\npressure = [\"5 kPa\", 20e3]\nload_share = 0.2\n"
    );
    let skin = Skin::parse(Path::new("skin.toml"), &text).unwrap().made().unwrap();
    let model = Model::build(&skin, |_| ()).unwrap();
    let bytes = dermatome::quantize::patch(&skin, &model).unwrap();
    let header = PatchView::validate(&bytes).unwrap().header;
    assert_eq!((header.steps, header.measurements), (104, 104));
    assert_eq!((header.drive.phase, header.drive.settling, header.drive.integration), (30.0, 0.5, 2));
    assert_eq!((header.drive.gain, header.drive.component), (Gain::Fixed(8), Component::Magnitude));
    assert_eq!(header.drift_time, 300.0);
    assert_eq!(header.calibration.pressure(0.2), Some(12.5e3));
    assert_eq!(header.calibration.load_share, Some(0.2));
    assert_eq!(header.test_resistances.len(), 16);
    let plain = Skin::parse(Path::new("skin.toml"), GOOD).unwrap().made().unwrap();
    assert_eq!(
        (plain.drift_time(), plain.drive.gain, plain.calibration.points.len()),
        (120.0, Gain::Automatic, 0)
    );
    let in_images = Skin { contacts_found_in: FoundIn::Image, ..plain };
    assert_eq!(in_images.drift_time(), 30.0);
}

#[test]
fn unknown_and_missing_fields_are_named_with_their_line() {
    let error = error_of(GOOD, "diameter =", "diametre =");
    assert!(error.contains("diametre") && error.contains("line 7") && error.contains("diameter"), "{error}");
    let error = error_of(GOOD, "hyperparameter = 0.03", "");
    assert!(error.contains("hyperparameter"), "{error}");
    let error = error_of(GOOD, "[shape]", "[shape");
    assert!(error.contains("line"), "{error}");
}

#[test]
fn too_many_pixels_for_a_board_are_refused_with_the_field() {
    let text = GOOD.replace("columns = 32", "columns = 64");
    let skin = Skin::parse(Path::new("skin.toml"), &text).unwrap().made().unwrap();
    let model = Model::build(&skin, |_| ()).unwrap();
    let error = dermatome::quantize::patch(&skin, &model).unwrap_err().to_string();
    assert!(error.contains("`image.columns`") && error.contains("1024"), "{error}");
}

#[test]
fn a_matrix_too_long_for_a_board_is_refused_with_what_to_change() {
    let text = GOOD.replace("reciprocal = \"combined\"", "reciprocal = \"kept\"");
    let skin = Skin::parse(Path::new("skin.toml"), &text).unwrap().made().unwrap();
    let model = Model::build(&skin, |_| ()).unwrap();
    // Beside so long a matrix places take all room but that of a calibration.
    let patch = dermatome::quantize::patch(&skin, &model).unwrap();
    let point = |n: u8| CalibrationPoint { strength: f32::from(n), pressure: 1e3 * f32::from(n) };
    let curve = Calibration { points: (1..=MAX_POINTS as u8).map(point).collect(), load_share: Some(0.5) };
    let play_operators = vec![PlayOperator::from_f64(2.0, 1.0); MAX_PLAY_OPERATORS];
    with_calibration(&patch, &Stored { curve, play_operators }).unwrap();
    let error = dermatome::quantize::learnt_patch(&skin, &model).unwrap_err().to_string();
    assert!(error.contains("188408") && error.contains("image.columns"), "{error}");
}

#[test]
fn electrode_one_is_at_the_top_and_numbers_run_clockwise() {
    let skin = Skin::parse(Path::new("skin.toml"), GOOD).unwrap().made().unwrap();
    let place = |i: usize| skin.shape.electrode_centres()[i];
    assert!(place(0).x.abs() < 1e-12 && (place(0).y - 0.105).abs() < 1e-12);
    assert!((place(4).x - 0.105).abs() < 1e-12);
    let skin = Skin::parse(Path::new("skin.toml"), SQUARE).unwrap().made().unwrap();
    let place = |i: usize| skin.shape.electrode_centres()[i];
    assert!((place(0).x - 0.005).abs() < 1e-12 && (place(0).y - 0.025).abs() < 1e-12);
    assert!((place(2).x - 0.025).abs() < 1e-12 && (place(2).y - 0.015).abs() < 1e-12);
}

#[test]
fn a_table_of_steps_counts_from_one_in_the_skin_file_and_from_zero_in_csv() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("steps.csv"),
        "drive_plus,drive_minus,sense_plus,sense_minus\n1,0,2,3\n",
    )
    .unwrap();
    let steps = |table: &str| {
        let text = GOOD.replace("\"adjacent\"", &format!("\"table\"\ntable = {table}"));
        Skin::parse(&folder.path().join("skin.toml"), &text).unwrap().steps()
    };
    assert_eq!(steps("[[2, 1, 3, 4]]"), steps("\"steps.csv\""));
    assert_eq!(steps("\"steps.csv\"")[0].to_bytes(), [1, 0, 2, 3]);
}

#[test]
fn driven_electrodes_are_measured_if_asked_for() {
    let text = GOOD.replace("\"adjacent\"", "\"adjacent\"\ndriven = \"measured\"");
    assert_eq!(Skin::parse(Path::new("skin.toml"), &text).unwrap().steps().len(), 256);
}

/// The disc's skin file with another shape.
fn shaped(shape: &str) -> String {
    GOOD.replace("kind = \"disc\"\ndiameter = \"210 mm\"", shape)
}

#[test]
fn wrong_shapes_name_file_field_value_and_what_is_allowed() {
    let square = "points = [[0, 0], [0.2, 0], [0.2, 0.2], [0, 0.2]]";
    let polygon = |more: &str| format!("kind = \"polygon\"\n{square}\n{more}");
    let cases: Vec<(String, &[&str])> = vec![
        ("kind = \"ellipse\"\nheight = 0.1".into(), &["`shape.width`", "missing", "m, cm, mm or um"]),
        (
            "kind = \"ellipse\"\nwidth = \"-1 mm\"\nheight = 0.1".into(),
            &["`shape.width`", "-1 mm", "above zero"],
        ),
        (
            "kind = \"ellipse\"\nwidth = 0.1\nheight = 1.1".into(),
            &["`shape.height`", "1.1 m", "1/10 to 10 times"],
        ),
        (
            "kind = \"ellipse\"\nwidth = 0.1\nheight = 0.1\ndiameter = 1".into(),
            &["`shape.diameter`", "is 1", "an ellipse has `width`, `height`"],
        ),
        (
            "kind = \"rectangle\"\nwidth = 0.1\nheight = 11".into(),
            &["`shape.height`", "11 m", "1/100 to 100"],
        ),
        ("kind = \"polygon\"".into(), &["`shape.points`", "missing", "rows of x and y"]),
        (
            "kind = \"polygon\"\npoints = [[0, 0], [1, 0]]".into(),
            &["`shape.points`", "2 corners", "3 to 5000"],
        ),
        (
            "kind = \"polygon\"\npoints = [[0, 0], [1, nan], [1, 1]]".into(),
            &["`shape.points`", "NaN", "a number (m)"],
        ),
        (
            "kind = \"polygon\"\npoints = [[0, 0], [\"1 inch\", 0], [1, 1]]".into(),
            &["`shape.points`", "1 inch", "m, cm, mm or um"],
        ),
        (
            "kind = \"polygon\"\npoints = [[0, 0], [1, 1], [1, 0], [0, 1]]".into(),
            &["`shape.points`", "cross", "rows 1 and 3", "sides that do not meet"],
        ),
        (
            polygon("holes = [[[0.3, 0.3], [0.4, 0.3], [0.4, 0.4]]]"),
            &["`shape.holes`", "hole 1 does not lie", "apart"],
        ),
        (polygon("holes = [[[0.1, 0.1], [0.3, 0.1], [0.1, 0.15]]]"), &["`shape.holes`", "hole 1", "cross"]),
        (
            polygon("holes = [[[0.1, 0.1], [0.15, 0.1]]]"),
            &["`shape.holes`", "hole 1 has 2 corners", "3 to 5000"],
        ),
        (polygon("width = 1"), &["`shape.width`", "is 1", "a polygon has `points`, `holes`"]),
        ("kind = \"hemisphere\"".into(), &["`shape.diameter`", "missing", "above zero"]),
        ("kind = \"hemisphere\"\ndiameter = 0".into(), &["`shape.diameter`", "is 0", "above zero"]),
        (
            "kind = \"hemisphere\"\ndiameter = 1\nheight = 1".into(),
            &["`shape.height`", "is 1", "a hemisphere has `diameter`"],
        ),
        ("kind = \"cylinder\"\nheight = 1\nangle = 1".into(), &["`shape.diameter`", "missing"]),
        (
            "kind = \"cylinder\"\nradius = 1\ndiameter = 2\nheight = 1\nangle = 1".into(),
            &["`shape.radius`", "given", "`diameter` says the same"],
        ),
        (
            "kind = \"cylinder\"\nradius = inf\nheight = 1\nangle = 1".into(),
            &["`shape.radius`", "inf", "1e-18 to 1e18"],
        ),
        ("kind = \"cylinder\"\nradius = 1\nangle = 1".into(), &["`shape.height`", "missing"]),
        (
            "kind = \"cylinder\"\nradius = 1\nheight = 1".into(),
            &["`shape.angle`", "missing", "below 360 deg"],
        ),
        (
            "kind = \"cylinder\"\nradius = 1\nheight = 1\nangle = \"360 deg\"".into(),
            &["`shape.angle`", "360 deg", "below 360 deg", "open along one side"],
        ),
        (
            "kind = \"cylinder\"\nradius = 1\nheight = 1\nangle = \"90 grad\"".into(),
            &["`shape.angle`", "90 grad", "rad or deg"],
        ),
        ("kind = \"cone\"\nheight = 1\nangle = 1".into(), &["`shape.diameter_bottom`", "missing"]),
        (
            "kind = \"cone\"\ndiameter_bottom = 1\ndiameter_top = 1\nheight = 1\nangle = 1".into(),
            &["`shape.diameter_top`", "is 1", "0 to 0.999 times `diameter_bottom`"],
        ),
        (
            "kind = \"cone\"\ndiameter_bottom = 1\ndiameter_top = \"-1 mm\"\nheight = 1\nangle = 1".into(),
            &["`shape.diameter_top`", "-1 mm", "0 to 0.999"],
        ),
        (
            "kind = \"cone\"\ndiameter_bottom = 1\nheight = 1\nangle = 0".into(),
            &["`shape.angle`", "is 0", "above zero"],
        ),
        (
            "kind = \"cone\"\ndiameter_bottom = 1\nheight = 1\nangle = 1\nradius = 1".into(),
            &["`shape.radius`", "is 1", "a cone has `diameter_bottom`"],
        ),
        (
            "kind = \"disc\"\ndiameter = 1\nfile = \"a.stl\"".into(),
            &["`shape.file`", "given", "a disc has `diameter`"],
        ),
        ("kind = \"mesh\"\ndiameter = 1".into(), &["`shape.diameter`", "is 1", "a mesh has `file`, `unit`"]),
    ];
    for (shape, expected) in cases {
        let error = Skin::parse(Path::new("hand/skin.toml"), &shaped(&shape)).expect_err(&shape).to_string();
        for part in expected.iter().chain(&["`hand/skin.toml`"]) {
            assert!(error.contains(part), "{shape}: {part:?} is not in {error:?}");
        }
    }
}
