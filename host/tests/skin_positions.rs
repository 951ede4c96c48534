//! Electrodes anywhere on a skin, by their coordinates: each place is refused with what is allowed, or meshed.

use dermatome::{mesh::Lattice, model::mesh, skin::Skin};
use proptest::prelude::*;
use std::path::Path;

const SKIN: &str = include_str!("../../models/disc-210mm/skin.toml");
const DISC: &str = "kind = \"disc\"\ndiameter = 0.21";
const RECTANGLE: &str = "kind = \"rectangle\"\nwidth = 0.21\nheight = 0.15";
const HOLED: &str = "kind = \"polygon\"\npoints = [[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]]\n\
                     holes = [[[-0.02, -0.02], [0.02, -0.02], [0.02, 0.02], [-0.02, 0.02]]]";

/// The disc's skin file with another shape and electrodes at these places.
fn with_points(shape: &str, width: f64, positions: &[[f64; 2]]) -> String {
    let (head, rest) = SKIN.split_once("kind = \"disc\"\ndiameter = \"210 mm\"").unwrap();
    let (middle, rest) = rest.split_once("[electrodes]").unwrap();
    let drive = rest.split_once("[drive]").unwrap().1;
    format!(
        "{head}{shape}{middle}[electrodes]\ncount = {}\nplacement = \"points\"\npositions = {positions:?}\n\
         model = \"complete\"\nwidth = {width}\ncontact_impedance = 0.18\n[drive]{drive}",
        positions.len()
    )
}

#[test]
fn wrong_positions_name_the_electrode_and_what_is_allowed() {
    let good = with_points(DISC, 0.01, &[[0.105, 0.0], [0.0, 0.105], [-0.105, 0.0], [0.0, 0.0]]);
    let last = "[0.0, 0.0]]";
    let cases: [(&str, &str, &[&str]); 7] = [
        (
            last,
            "[0.0, 0.0], [0.0, 0.05]]",
            &["`electrodes.positions`", "a list of 5", "each of 4 electrodes"],
        ),
        (
            last,
            "[0.0, 0.0, 0.0]]",
            &["`electrodes.positions`", "electrode 4 with 3 coordinates", "2 coordinates"],
        ),
        (last, "[0.0, inf]]", &["`electrodes.positions`", "inf", "a number (m)"]),
        (
            last,
            "[0.0, -0.2]]",
            &["`electrodes.positions`", "electrode 4 95.000 mm outside the skin", "5.000 mm"],
        ),
        (last, "[0.0, 0.105]]", &["`electrodes.width`", "electrodes 2 and 4 overlap"]),
        ("model =", "pitch = 1\nmodel =", &["`electrodes.pitch`", "is 1", "only placement \"sides\""]),
        ("model =", "first = 1\nmodel =", &["`electrodes.first`", "is 1", "`positions` say"]),
    ];
    for (from, to, expected) in cases {
        assert!(good.contains(from), "the test replaces {from:?}, which is not there");
        let text = good.replacen(from, to, 1);
        let error = Skin::parse(Path::new("hand/skin.toml"), &text).expect_err(to).to_string();
        for part in expected.iter().chain(&["`hand/skin.toml`"]) {
            assert!(error.contains(part), "{to}: {part:?} is not in {error:?}");
        }
    }
    let holed = with_points(HOLED, 0.01, &[[0.1, 0.0], [0.0, 0.1], [-0.1, 0.0], [0.0, 0.024]]);
    let error = Skin::parse(Path::new("skin.toml"), &holed).unwrap_err().to_string();
    assert!(error.contains("electrode 4 4.000 mm from the rim of a hole"), "{error}");
}

#[test]
fn an_electrode_so_close_to_a_rim_that_no_mesh_fits_between_is_refused_by_number() {
    let others = [[0.0, 0.05], [0.05, 0.0], [0.0, -0.05]];
    let at = |y: f64| {
        let positions = [&others[..], &[[0.0, -y]]].concat();
        Skin::parse(Path::new("hand/skin.toml"), &with_points(RECTANGLE, 0.01, &positions))
    };
    // Its rim is 0.1 mm from that of the skin, of 0.2 mm needed.
    let error = at(0.0699).unwrap_err().to_string();
    for part in
        ["`electrodes.positions`", "electrode 4 5.100 mm from a rim", "more than 5.200 mm, or at most 5.000"]
    {
        assert!(error.contains(part), "{part:?} is not in {error:?}");
    }
    assert!(at(0.0697).is_ok() && at(0.0701).is_ok(), "inside, and on the rim");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// Electrodes at all distances from a rim and from each other, most of them tiny.
    #[test]
    fn wherever_electrodes_are_put_they_are_refused_by_number_or_meshed(
        shape in 0..3_usize,
        width in 0.004..0.03,
        from_rim in -10..1_i32,
        apart in -10..1_i32,
        along in -0.4..0.4_f64,
        turn in 0.0..6.0_f64,
        lattice in (0.0..1.0, 0.0..1.0),
    ) {
        let depth = width / 2.0 * (1.0 + 2_f64.powi(from_rim));
        let first = match shape {
            0 => [(0.105 - depth) * turn.cos(), (0.105 - depth) * turn.sin()],
            1 => [along * 0.2, -0.075 + depth],
            _ => [along * 0.04, 0.02 + depth],
        };
        let away = width * (1.0 + 2_f64.powi(apart));
        let second = [first[0] + away * turn.sin(), first[1] + away * turn.cos()];
        let shape = [DISC, RECTANGLE, HOLED][shape];
        let text = with_points(shape, width, &[first, second, [-0.06, -0.03], [0.06, -0.03]]);
        match Skin::parse(Path::new("skin.toml"), &text) {
            Err(error) => {
                let words = error.to_string();
                prop_assert!(words.contains("electrode 1") || words.contains("electrode 2") || words.contains("electrodes "), "{words}");
            }
            Ok(skin) => {
                let skin = skin.made().unwrap();
                let turned = Lattice { angle: lattice.0, shift: lattice.1 };
                for (fineness, lattice) in [(1.0, Lattice::default()), (0.66, turned)] {
                    prop_assert!(mesh(&skin, fineness, lattice).is_ok(), "{text}");
                }
            }
        }
    }
}
