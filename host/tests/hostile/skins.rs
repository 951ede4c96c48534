//! Every field of a skin file with values that it does not take.

use super::{
    case::{Case, tiny},
    program::TINY,
};

/// Wrong for each field that is a number or a quantity.
const QUANTITY: &[&str] =
    &["\"\"", "\"x\"", "\"5 furlong\"", "nan", "inf", "true", "[]", "{}", "1979-05-27", "\"1e999 m\""];
/// Above zero.
const POSITIVE: &[&str] =
    &["0", "-1", "\"\"", "\"x\"", "\"5 furlong\"", "nan", "inf", "true", "[]", "{}", "1e300"];
const WHOLE: &[&str] = &["0", "-1", "2.5", "\"8\"", "nan", "true", "[]", "9223372036854775807"];
const WORD: &[&str] = &["\"\"", "\"x\"", "\"Adjacent\"", "1", "true", "[]"];
const FLAG: &[&str] = &["\"true\"", "1", "nan", "[]"];

/// Field, the line of the tiny skin in whose place it is put (after it, where that is a table's heading), wrong values.
type Field = (&'static str, &'static str, &'static [&'static str]);

const FIELDS: &[Field] = &[
    (
        "name",
        "name = \"tiny\"",
        &["\"\"", "\"a b\"", "\"../x\"", "\"ä\"", "\"abcdefghijklmnopqrstuvwxyzabcdefg\"", "1", "[]"],
    ),
    ("description", "name = \"tiny\"", &["1", "[]", "true"]),
    ("kind", "kind = \"disc\"", WORD),
    ("diameter", "diameter = \"100 mm\"", POSITIVE),
    ("radius", "[shape]", POSITIVE),
    ("weld", "[shape]", &["1", "\"x\"", "[]"]),
    ("unit", "[shape]", &["1", "\"mm\""]),
    ("points", "[shape]", &["1", "[]", "\"x\"", "[[1]]", "[[1, 2, 3]]", "[[1, 2], [3, 4]]"]),
    ("edge_length", "edge_length = \"8 mm\"", POSITIVE),
    ("edge_length", "edge_length = \"8 mm\"", &["\"1 um\"", "\"1 m\"", "\"26 mm\""]),
    ("electrode_edge_length", "[mesh]", POSITIVE),
    ("electrode_edge_length", "[mesh]", &["\"9 mm\"", "\"1 um\""]),
    ("sheet_conductivity", "sheet_conductivity = \"5.88 mS\"", POSITIVE),
    ("sheet_conductivity_across", "[material]", POSITIVE),
    ("sheet_conductivity_across", "[material]", &["1e3", "1e-9"]),
    ("grain", "[material]", QUANTITY),
    (
        "conductivity_map",
        "[material]",
        &[
            "1",
            "[]",
            "\"none.csv\"",
            "[[1]]",
            "[[0, 0, 0]]",
            "[[0, 0, 1000]]",
            "[[0, 0, nan]]",
            "[[0, 0, 1, 2, 3]]",
        ],
    ),
    ("sheet_capacitance", "[material]", &["-1", "\"x\"", "nan", "\"5 pS\"", "[]", "inf"]),
    ("count", "count = 8", WHOLE),
    ("count", "count = 8", &["3", "251"]),
    ("placement", "placement = \"rim\"", WORD),
    ("pitch", "[electrodes]", POSITIVE),
    ("positions", "[electrodes]", &["1", "[[0, 0]]", "\"x\"", "[[0]]"]),
    ("first", "[electrodes]", QUANTITY),
    ("direction", "[electrodes]", WORD),
    ("model", "model = \"complete\"", WORD),
    ("width", "width = \"8 mm\"", POSITIVE),
    ("width", "width = \"8 mm\"", &["\"40 mm\"", "[1, 2]", "[\"8 mm\", \"x\"]"]),
    ("contact_impedance", "contact_impedance = \"0.18 ohm m\"", POSITIVE),
    ("contact_impedance", "contact_impedance = \"0.18 ohm m\"", &["[1]", "\"5 mm\""]),
    ("ground", "[electrodes]", &["0", "9", "-1", "1.5", "\"1\"", "[]"]),
    ("pattern", "pattern = \"adjacent\"", WORD),
    (
        "pattern",
        "pattern = \"adjacent\"",
        &["\"skip-3\"", "\"skip--1\"", "\"skip-x\"", "\"skip-99999999999\""],
    ),
    ("driven", "[drive]", WORD),
    ("table", "[drive]", &["[]", "[[1, 2, 3, 4]]"]),
    ("reciprocal", "reciprocal = \"combined\"", WORD),
    ("frequency", "frequency = \"50 kHz\"", POSITIVE),
    ("amplitude", "amplitude = \"1 mA\"", POSITIVE),
    ("frame_rate", "frame_rate = \"50 Hz\"", POSITIVE),
    ("phase", "[drive]", &["-1", "7", "\"x\"", "nan", "[]", "\"361 deg\""]),
    ("settling", "[drive]", &["-1", "101", "\"x\"", "nan", "[]"]),
    ("integration", "[drive]", &["0", "65", "1.5", "\"x\"", "[]"]),
    ("gain", "[drive]", &["0", "3", "128", "\"x\"", "nan", "[]"]),
    ("component", "[drive]", WORD),
    ("method", "[inverse]", WORD),
    ("prior", "prior = \"laplace\"", WORD),
    ("noser_exponent", "[inverse]", &["-1", "3", "\"x\"", "nan", "[]"]),
    ("gaussian_diameter", "[inverse]", &["0", "2", "\"x\"", "nan"]),
    ("greit_radius", "[inverse]", &["0", "2", "\"x\"", "nan"]),
    ("hyperparameter", "hyperparameter = 0.03", &["0", "-1", "\"\"", "\"x\"", "nan", "inf", "true", "[]"]),
    ("noise_figure", "[inverse]", &["0", "-1", "\"x\"", "nan", "inf"]),
    ("noise_db", "[inverse]", &["-1", "201", "\"x\"", "nan"]),
    ("normalised", "normalised = true", FLAG),
    ("weights", "[inverse]", &["1", "[]", "[1, 2]", "\"x\"", "\"none.csv\"", "[nan]", "\"notes.txt\""]),
    ("electrode_movement", "[inverse]", &["0", "-1", "\"x\"", "nan", "inf"]),
    ("columns", "columns = 16", &["0", "3", "65", "-1", "2.5", "\"x\"", "[]"]),
    ("pixels", "[image]", &["3", "100001", "-1", "2.5", "\"x\"", "[]"]),
    ("threshold", "threshold = 0.05", &["0", "-1", "1001", "\"x\"", "nan", "inf", "[]"]),
    ("found_in", "[contact]", WORD),
    ("false_alarms", "[contact]", &["0", "-1", "3601", "\"x\"", "nan"]),
    ("averaging", "[contact]", &["-1", "11", "\"x\"", "nan", "\"5 mm\""]),
    ("drift_time", "[contact]", &["-1", "0.5", "86401", "\"x\"", "nan", "\"5 mm\""]),
];

/// Tables that the tiny skin lacks: the field, what is at its end, wrong values in place of `@`.
const TABLES: &[(&str, &str, &[&str])] = &[
    (
        "strength",
        "[calibration]\nstrength = @\npressure = [1, 2]\n",
        &["[]", "[1]", "[2, 1]", "[0, 1]", "[-1, 1]", "[1, nan]", "[1, \"x\"]", "1"],
    ),
    (
        "pressure",
        "[calibration]\nstrength = [1, 2]\npressure = @\n",
        &["[]", "[1]", "[2, 1]", "[1, nan]", "[1, \"x\"]", "[1, \"2 mm\"]", "1"],
    ),
    (
        "load_share",
        "[calibration]\nstrength = [1, 2]\npressure = [1, 2]\nload_share = @\n",
        &["0", "-1", "1e9", "nan", "\"x\""],
    ),
    (
        "link",
        "[pose]\nlink = @\nposition = [0, 0, 0]\norientation = [0, 0, 0, 1]\n",
        &["\"\"", "\"a b\"", "1", "\"ä\""],
    ),
    (
        "position",
        "[pose]\nlink = \"a\"\nposition = @\norientation = [0, 0, 0, 1]\n",
        &["[]", "[0, 0]", "[0, 0, 0, 0]", "[0, 0, nan]", "[0, 0, 1001]", "[0, 0, \"x\"]", "1"],
    ),
    (
        "orientation",
        "[pose]\nlink = \"a\"\nposition = [0, 0, 0]\norientation = @\n",
        &["[]", "[0, 0, 1]", "[0, 0, 0, 0]", "[0, 0, 0, 2]", "[0, 0, 0, nan]", "[0, 0, 0, \"x\"]", "1"],
    ),
];

/// Other shapes in place of the disc: the field, the table, wrong values in place of `@`.
const SHAPES: &[(&str, &str, &[&str])] = &[
    ("width", "kind = \"rectangle\"\nwidth = @\nheight = \"100 mm\"\n", POSITIVE),
    ("height", "kind = \"rectangle\"\nwidth = \"100 mm\"\nheight = @\n", POSITIVE),
    (
        "height",
        "kind = \"ellipse\"\nwidth = \"100 mm\"\nheight = @\n",
        &["0", "-1", "nan", "\"1 mm\"", "\"10 m\""],
    ),
    (
        "points",
        "kind = \"polygon\"\npoints = @\n",
        &[
            "[]",
            "[[0, 0]]",
            "[[0, 0], [1, 0]]",
            "[[0, 0], [1, 0], [2, 0]]",
            "[[0, 0], [0, 0], [1, 1]]",
            "[[0, 0], [1, 1], [1, 0], [0, 1]]",
            "[[0, 0], [1, nan], [1, 0]]",
        ],
    ),
    (
        "holes",
        "kind = \"polygon\"\npoints = [[0, 0], [1, 0], [0, 1]]\nholes = @\n",
        &["[[]]", "[[[2, 2], [3, 2], [2, 3]]]", "1", "[[[0.1, 0.1], [0.2, 0.1]]]"],
    ),
    ("diameter", "kind = \"hemisphere\"\ndiameter = @\n", POSITIVE),
    ("diameter_bottom", "kind = \"cone\"\ndiameter_bottom = @\nheight = \"100 mm\"\nangle = 3\n", POSITIVE),
    (
        "diameter_top",
        "kind = \"cone\"\ndiameter_bottom = \"100 mm\"\ndiameter_top = @\nheight = \"100 mm\"\nangle = 3\n",
        &["-1", "1", "nan", "\"x\""],
    ),
    (
        "angle",
        "kind = \"cylinder\"\nradius = \"50 mm\"\nheight = \"100 mm\"\nangle = @\n",
        &["0", "-1", "7", "nan", "\"360 deg\"", "\"x\""],
    ),
];

/// A mesh from a file: the field, wrong values in place of `@`.
const MESHES: &[(&str, &str, &[&str])] = &[
    (
        "file",
        "file = @\nunit = \"mm\"\n",
        &[
            "\"\"",
            "\"none.stl\"",
            "\"folder\"",
            "\"notes.txt\"",
            "\"../skin.stl\"",
            "\"/etc/passwd\"",
            "1",
            "\"skin.toml\"",
        ],
    ),
    ("unit", "file = \"skin.stl\"\nunit = @\n", &["\"\"", "\"x\"", "\"MM\"", "1"]),
    ("weld", "file = \"skin.stl\"\nunit = \"mm\"\nweld = @\n", &["-1", "1", "nan", "\"x\""]),
    ("allow_cracks", "file = \"skin.stl\"\nunit = \"mm\"\nallow_cracks = @\n", FLAG),
];

/// Commands that read a skin file; fields take turns.
const READERS: &[&[&str]] = &[
    &["build", "bad.toml"],
    &["forward", "bad.toml"],
    &["evaluate", "bad.toml"],
    &["design", "bad.toml"],
    &["export", "bad.toml", "--out", "new"],
    &["check-data", "bad.toml", "frames.csv"],
    &["reconstruct", "bad.toml", "--reference", "reference.csv", "--frames", "frames.csv"],
    &["learn", "bad.toml", "--presses", "presses.csv", "--reference", "reference.csv"],
    &["simulate", "bad.toml", "--listen", "tcp:127.0.0.1:0"],
    &["experiment", "trust", "bad.toml"],
    &["tare", "--port", "sim:bad.toml"],
    &["stream", "--port", "sim:bad.toml", "--frames", "1"],
];

pub(crate) fn cases() -> Vec<Case> {
    let mut wrong: Vec<(String, String)> = Vec::new();
    for (field, at, values) in FIELDS {
        for value in *values {
            let new = format!("{field} = {value}");
            let text = if at.starts_with(&format!("{field} =")) {
                tiny(at, &new)
            } else {
                tiny(at, &format!("{at}\n{new}"))
            };
            wrong.push(((*field).to_owned(), text));
        }
    }
    for (field, table, values) in TABLES {
        wrong.extend(
            values.iter().map(|value| ((*field).to_owned(), format!("{TINY}{}", table.replace('@', value)))),
        );
    }
    let disc = "kind = \"disc\"\ndiameter = \"100 mm\"\n";
    for (field, table, values) in SHAPES {
        wrong
            .extend(values.iter().map(|value| ((*field).to_owned(), tiny(disc, &table.replace('@', value)))));
    }
    let meshed = tiny("[mesh]\nedge_length = \"8 mm\"\n", "");
    for (field, table, values) in MESHES {
        let of = |value: &&str| {
            meshed.replacen(disc, &format!("kind = \"mesh\"\n{}", table.replace('@', value)), 1)
        };
        wrong.extend(values.iter().map(|value| ((*field).to_owned(), of(value))));
    }
    wrong.extend(lines());
    let command = |at: usize| READERS[at % READERS.len()];
    let case = |(at, (word, text)): (usize, &(String, String))| {
        Case::refused(command(at), &["bad.toml", word]).with("bad.toml", text.as_str())
    };
    wrong.iter().enumerate().map(case).collect()
}

/// Each line of the tiny skin left out, written twice, its key misspelled; each with the key, or the table's name.
fn lines() -> Vec<(String, String)> {
    let mut wrong = Vec::new();
    for line in TINY.lines().filter(|line| !line.starts_with('#')) {
        let whole = format!("{line}\n");
        let key = line.trim_matches(['[', ']']).split(" =").next().unwrap_or(line);
        let misspelled = line.replacen(key, &format!("{key}x"), 1);
        // Without its heading, a table's fields are in the table before.
        let left_out = if line.starts_with('[') { format!("{key}|unknown field") } else { key.to_owned() };
        wrong.push((left_out, tiny(&whole, "")));
        wrong.push((key.to_owned(), tiny(&whole, &whole.repeat(2))));
        wrong.push((format!("{key}x"), tiny(&whole, &format!("{misspelled}\n"))));
    }
    wrong
}
