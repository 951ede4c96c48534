use super::*;
use crate::array::{Array, mat};
use dermatome_model::skin::Skin;
use std::path::Path;

const PRESSES: usize = 12;
const STEPS: usize = 40;

fn skin() -> Skin {
    let text = include_str!("../../../../tests/data/tiny.toml");
    Skin::parse(Path::new("tiny.toml"), text).unwrap().made().unwrap()
}

fn voltage(press: usize, step: usize) -> f64 {
    (100 * press + step) as f64
}

fn place(press: usize, axis: usize) -> f64 {
    1e-3 * (press + 10 * axis) as f64
}

/// Reads a MATLAB file of these arrays.
fn read(arrays: &[(&str, Array<'_>)]) -> Result<Recording, PressError> {
    read_as(&Layout::default(), arrays)
}

/// The same of frames that lie there like this.
fn read_as(layout: &Layout, arrays: &[(&str, Array<'_>)]) -> Result<Recording, PressError> {
    let mut bytes = Vec::new();
    mat::write_header(&mut bytes).unwrap();
    arrays.iter().for_each(|(name, array)| mat::write_array(&mut bytes, name, array).unwrap());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("presses.mat");
    std::fs::write(&path, bytes).unwrap();
    Recording::read(&path, None, layout, &skin())
}

#[test]
fn a_matlab_file_holds_each_presss_own_reference_in_rows_or_columns() {
    let rows = read(&[
        ("v_pressed", Array::table(PRESSES, STEPS, voltage)),
        ("v_unpressed", Array::table(PRESSES, STEPS, |press, step| -voltage(press, step))),
        ("positions_m", Array::table(PRESSES, 2, place)),
        ("force_n", Array::list(PRESSES, |press| press as f64 + 1.0)),
    ]);
    let columns = read(&[
        ("v_pressed", Array::table(STEPS, PRESSES, |step, press| voltage(press, step))),
        ("v_unpressed", Array::table(STEPS, PRESSES, |step, press| -voltage(press, step))),
        ("positions_m", Array::table(2, PRESSES, |axis, press| place(press, axis))),
        ("force_n", Array::list(PRESSES, |press| press as f64 + 1.0)),
    ]);
    for recording in [rows.unwrap(), columns.unwrap()] {
        assert_eq!((recording.pressed.frames, recording.unpressed.frames), (PRESSES, PRESSES));
        assert_eq!(recording.pressed.values[3 * STEPS + 7].re, voltage(3, 7));
        assert_eq!(recording.unpressed.values[3 * STEPS + 7].re, -voltage(3, 7));
        assert_eq!(recording.positions.from_above()[3], [place(3, 0), place(3, 1)]);
        assert_eq!(recording.forces.unwrap()[3], 4.0);
    }
}

#[test]
fn a_matlab_file_of_one_table_holds_a_press_a_row() {
    let cell = |press: usize, column: usize| match column {
        0 | 1 => place(press, column),
        column => voltage(press, column - 2),
    };
    // A table needs a reference of its own, and is read before that is missed.
    let error = read(&[("presses", Array::table(PRESSES, STEPS + 2, cell))]).unwrap_err().to_string();
    assert!(error.contains("holds no frames of the untouched skin"), "{error}");
    let error = read(&[("presses", Array::table(PRESSES, STEPS + 5, cell))]).unwrap_err().to_string();
    assert!(error.contains("rows hold 12 numbers"), "{error}");
}

#[test]
fn references_are_one_or_one_for_each_press() {
    let with = |references: usize| {
        let read = read(&[
            ("v_pressed", Array::table(PRESSES, STEPS, voltage)),
            ("v_unpressed", Array::table(references, STEPS, voltage)),
            ("positions_m", Array::table(PRESSES, 2, place)),
        ]);
        read.unwrap().check().map_err(|error| error.to_string())
    };
    assert_eq!((with(1), with(PRESSES)), (Ok(()), Ok(())));
    let error = with(7).unwrap_err();
    assert!(error.contains("`v_unpressed` holds 7 rows, `v_pressed` 12"), "{error}");
    assert!(error.contains("allowed: 1, or one for each press"), "{error}");
}

#[test]
fn potentials_become_what_pairs_sense_and_columns_presses_where_the_user_says_so() {
    // As many presses as a square has potentials: a file of either direction looks the same. MATLAB's are read by columns.
    let potential = |press: usize, place: usize| ((press * 64 + place) as f64).sqrt();
    let turned = Layout { turned: true, ..Layout::default() };
    let read = |layout: &Layout, is_turned: bool| {
        let pressed = |row, column| if is_turned { potential(row, column) } else { potential(column, row) };
        let untouched = |row, column| pressed(row, column) + 1.0;
        let arrays = [
            ("v_pressed", Array::table(64, 64, pressed)),
            ("v_unpressed", Array::table(64, 64, untouched)),
            ("positions_m", Array::table(64, 2, place)),
        ];
        read_as(layout, &arrays)
    };
    let plain = read(&Layout::default(), false).unwrap();
    assert_eq!(read(&turned, true).unwrap(), plain);
    let one = [
        ("v_pressed", Array::table(PRESSES, STEPS, voltage)),
        ("v_unpressed", Array::table(STEPS, 1, |step, _| voltage(0, step))),
        ("positions_m", Array::table(PRESSES, 2, place)),
    ];
    assert_eq!(read_as(&turned, &one).unwrap().unpressed.frames, 1, "one reference for all");
    let apart = read(&Layout { potentials: true, ..turned }, true).unwrap();
    for (press, pairs) in apart.pressed.iter().enumerate() {
        for (place, pair) in pairs.iter().enumerate() {
            let minus = place / 8 * 8 + (place + 1) % 8;
            assert_eq!(pair.re, potential(press, place) - potential(press, minus), "{press}, {place}");
        }
    }
    assert_eq!(apart.positions, plain.positions);
    let rows = [
        ("v_pressed", Array::table(PRESSES, STEPS, voltage)),
        ("positions_m", Array::table(PRESSES, 2, place)),
        ("v_unpressed", Array::table(1, STEPS, voltage)),
    ];
    let error = read_as(&Layout { potentials: true, ..Layout::default() }, &rows).unwrap_err().to_string();
    assert!(error.contains("frames hold 40 values each; allowed are 64"), "{error}");
}
