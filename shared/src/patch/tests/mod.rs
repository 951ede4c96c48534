mod with_places;
mod with_reflexes;

use super::{
    matrix::{GROUP, INTERPOLATION_EXPONENT, Interpolation, coefficient_index},
    *,
};
use crate::{
    drive::stimulation::{Driven, pattern},
    frame::Frame,
    image::Geometry,
    units::AdcCode,
};
use proptest::prelude::*;
pub(crate) use with_places::patch_with_places;
pub(crate) use with_reflexes::{patch_with_reflexes, row, rule};

/// A matrix whose parts a test can look at.
#[derive(Clone)]
pub(crate) struct TestMatrix {
    pub(crate) column_exponents: std::vec::Vec<i8>,
    row_exponents: std::vec::Vec<i8>,
    pub(crate) positions: std::vec::Vec<u16>,
    interpolations: std::vec::Vec<Interpolation>,
    inputs: std::vec::Vec<u16>,
    mantissas: std::vec::Vec<i16>,
    columns: usize,
}

impl TestMatrix {
    /// All pixels from the data, one exponent for all: `rows[pixel][measurement]`.
    pub(crate) fn dense(exponent: i8, rows: &[std::vec::Vec<i16>]) -> Self {
        let columns = rows[0].len().next_multiple_of(GROUP);
        let mut mantissas = std::vec![0; rows.len().next_multiple_of(GROUP) * columns];
        for (row, values) in rows.iter().enumerate() {
            for (column, value) in values.iter().enumerate() {
                mantissas[coefficient_index(columns, row, column)] = *value;
            }
        }
        Self {
            column_exponents: std::vec![0; rows[0].len()],
            row_exponents: std::vec![exponent; rows.len()],
            positions: (0..rows.len() as u16).collect(),
            interpolations: std::vec::Vec::new(),
            inputs: std::vec::Vec::new(),
            mantissas,
            columns,
        }
    }

    /// Nine pixels, six of them from 40 measurements; entries in proportion to the seeds, from -1 to 1.
    pub(crate) fn new(seeds: &[f64], scales: &[i32; 6]) -> Self {
        let mut seeds = seeds.iter();
        let mut next = |factor: f64| (seeds.next().unwrap() * factor) as i16;
        let rows: std::vec::Vec<_> = (0..6).map(|_| (0..40).map(|_| next(1638.0)).collect()).collect();
        let mut mantissas = Self::dense(0, &rows).mantissas;
        for (inputs, outputs, most) in [(4, 2, 4096.0), (8, 1, 2048.0)] {
            let start = mantissas.len();
            mantissas.resize(start + inputs * GROUP, 0);
            for (row, column) in (0..outputs).flat_map(|row| (0..inputs).map(move |column| (row, column))) {
                mantissas[start + coefficient_index(inputs, row, column)] = next(most);
            }
        }
        Self {
            column_exponents: (0..40).map(|column| column % 7 - 3).collect(),
            row_exponents: scales.iter().map(|scale| 12 + *scale as i8).collect(),
            positions: std::vec![8, 0, 3, 4, 1, 7, 2, 6, 5],
            interpolations: std::vec![
                Interpolation { inputs: 4, outputs: 2 },
                Interpolation { inputs: 8, outputs: 1 }
            ],
            inputs: std::vec![5, 1, 0, 3, 0, 1, 2, 3, 4, 5, 0, 1],
            mantissas,
            columns: 40,
        }
    }

    pub(crate) fn tables(&self) -> MatrixTables<'_> {
        MatrixTables {
            column_exponents: &self.column_exponents,
            row_exponents: &self.row_exponents,
            positions: &self.positions,
            interpolations: &self.interpolations,
            inputs: &self.inputs,
            mantissas: &self.mantissas,
        }
    }

    /// In f64: the pixels' values in the order in which they are known.
    pub(crate) fn apply(&self, data: &[f64], known: &mut std::vec::Vec<f64>) {
        let entry = |start: usize, columns, row, column| {
            f64::from(self.mantissas[start + coefficient_index(columns, row, column)])
        };
        for (row, exponent) in self.row_exponents.iter().enumerate() {
            let column = |m: usize| 2_f64.powi(-i32::from(self.column_exponents[m]));
            let products =
                data.iter().enumerate().map(|(m, value)| entry(0, self.columns, row, m) * column(m) * value);
            known.push(products.sum::<f64>() * 2_f64.powi(-i32::from(*exponent)));
        }
        let mut start = self.row_exponents.len().next_multiple_of(GROUP) * self.columns;
        let mut inputs = &self.inputs[..];
        for interpolation in &self.interpolations {
            let columns = usize::from(interpolation.inputs);
            let (own, later) = inputs.split_at(columns);
            let values: std::vec::Vec<_> = own.iter().map(|&position| known[usize::from(position)]).collect();
            for row in 0..usize::from(interpolation.outputs) {
                let sum: f64 =
                    values.iter().enumerate().map(|(i, value)| entry(start, columns, row, i) * value).sum();
                known.push(sum / f64::from(1 << INTERPOLATION_EXPONENT));
            }
            start += usize::from(interpolation.outputs).next_multiple_of(GROUP) * columns;
            inputs = later;
        }
    }
}

/// A patch of 8 electrodes, 2 x 2 pixels, whose pixel p reads measurement p.
pub(crate) fn small_patch(difference: Difference) -> std::vec::Vec<u8> {
    written(difference, 2, 1 << 14)
}

/// As the small patch of normalised data, with a reference that follows drift.
pub(crate) fn drifting_patch(drift_time: f32) -> std::vec::Vec<u8> {
    let bytes = small_patch(Difference::Normalised);
    let header = PatchView::validate(&bytes).unwrap().header;
    rewritten(&PatchHeader { drift_time, ..header }, &[])
}

/// As the small patch, but each two steps measure the same thing, the second with the opposite sign; its image
/// stays zero.
pub(crate) fn reciprocal_patch() -> std::vec::Vec<u8> {
    let bytes = small_patch(Difference::Plain);
    let patch = PatchView::validate(&bytes).unwrap();
    let steps: std::vec::Vec<_> = patch.steps().collect();
    let measurements = steps.len() as u16 / 2;
    let target = |step| CombinedInto { measurement: step / 2, flipped: step % 2 == 1 };
    let matrix = TestMatrix::dense(14, &std::vec![std::vec![0; measurements.into()]; 4]);
    let header = PatchHeader { measurements, ..patch.header };
    let combination: std::vec::Vec<_> = (0..2 * measurements).map(target).collect();
    bytes_of(header, &steps, &combination, &[], 2, &matrix)
}

/// All tables as bytes.
fn bytes_of(
    header: PatchHeader,
    steps: &[Step],
    combination: &[CombinedInto],
    play_operators: &[PlayOperator],
    across: u8,
    matrix: &TestMatrix,
) -> std::vec::Vec<u8> {
    let (pixels, neighbours) = square(across).tables();
    let header = PatchHeader { matrix: matrix.tables().layout(), ..header };
    written_with(&PatchContents {
        play_operators,
        reflexes: ReflexTables::default(),
        header: &header,
        steps,
        combination,
        pixels: &pixels,
        neighbours: &neighbours,
        matrix: matrix.tables(),
        places: Default::default(),
    })
}

fn written_with(contents: &PatchContents<'_>) -> std::vec::Vec<u8> {
    let mut out = std::vec![0; 65_536];
    let length = contents.write(&mut out).unwrap();
    out.truncate(length);
    out
}

/// The small patch of normalised data with another header.
fn rewritten(header: &PatchHeader, play_operators: &[PlayOperator]) -> std::vec::Vec<u8> {
    let bytes = small_patch(Difference::Normalised);
    let patch = PatchView::validate(&bytes).unwrap();
    let (steps, combination): (std::vec::Vec<_>, std::vec::Vec<_>) =
        patch.steps().zip(patch.combination()).unzip();
    bytes_of(header.clone(), &steps, &combination, play_operators, 2, &diagonal(2, 1 << 14))
}

/// As the small patch, with operators against hysteresis and a straight calibration: 100 kPa for each 1.
pub(crate) fn patch_with_hysteresis(play_operators: &[PlayOperator]) -> std::vec::Vec<u8> {
    let point = crate::contact::calibration::CalibrationPoint { strength: 1.0, pressure: 100e3 };
    let calibration = Calibration { points: [point].into_iter().collect(), load_share: Some(0.25) };
    let count = play_operators.len() as u8;
    let bytes = small_patch(Difference::Normalised);
    let header = PatchView::validate(&bytes).unwrap().header;
    rewritten(&PatchHeader { calibration, play_operators: count, ..header }, play_operators)
}

/// As the small patch, with a square of pixels and `mantissa` on the matrix' diagonal.
pub(crate) fn patch_of_pixels(across: u8, mantissa: i16) -> std::vec::Vec<u8> {
    written(Difference::Plain, across, mantissa)
}

fn square(across: u8) -> Geometry {
    let grid = PixelGrid { columns: across, rows: across, pitch: 0.01, left: -0.01, top: 0.01 };
    Geometry::first_cells(grid, grid.cells())
}

fn written(difference: Difference, across: u8, mantissa: i16) -> std::vec::Vec<u8> {
    patch_with_matrix(difference, across, &diagonal(across, mantissa))
}

/// 40 measurements, of which each pixel reads one.
fn diagonal(across: u8, mantissa: i16) -> TestMatrix {
    let row = |pixel: usize| (0..40).map(|m| if m == pixel % 40 { mantissa } else { 0 }).collect();
    let rows: std::vec::Vec<_> = (0..usize::from(across) * usize::from(across)).map(row).collect();
    TestMatrix::dense(14, &rows)
}

/// As the small patch, with a square of pixels and another matrix.
pub(crate) fn patch_with_matrix(
    difference: Difference,
    across: u8,
    matrix: &TestMatrix,
) -> std::vec::Vec<u8> {
    let steps: std::vec::Vec<_> = pattern(8, 1, 1, Driven::Skipped).collect();
    let combination: std::vec::Vec<_> =
        (0..steps.len() as u16).map(|measurement| CombinedInto { measurement, flipped: false }).collect();
    let geometry = square(across);
    let header = PatchHeader {
        skin: String::try_from("small").unwrap(),
        electrodes: 8,
        steps: steps.len() as u16,
        measurements: steps.len() as u16,
        pixels: u16::from(across) * u16::from(across),
        difference,
        neighbours: geometry.tables().1.len() as u16,
        surface: geometry.scale(),
        grid: Some(geometry.grid),
        drive: Drive::new(50e3, 1e-3, 50.0),
        contact_threshold: RelativeConductivity::from_f64(0.01),
        drift_time: 0.0,
        calibration: Calibration::default(),
        test_resistances: Default::default(),
        play_operators: 0,
        reflexes: 0,
        reflex_rows: 0,
        matrix: MatrixLayout::default(),
        detection: Default::default(),
    };
    bytes_of(header, &steps, &combination, &[], across, matrix)
}

/// A frame of the small patch in which every code is `value`.
pub(crate) fn flat_frame(value: i32) -> Frame {
    let codes = (0..40).map(|_| AdcCode(value)).collect();
    Frame { codes, ..Frame::default() }
}

fn with_valid_crc(mut bytes: std::vec::Vec<u8>) -> std::vec::Vec<u8> {
    let end = bytes.len() - CRC_BYTES;
    let crc = crc32(&[&bytes[..end]]);
    bytes[end..].copy_from_slice(&crc.to_le_bytes());
    bytes
}

#[test]
fn a_written_patch_reads_back() {
    let bytes = small_patch(Difference::Plain);
    let patch = PatchView::validate(&bytes).unwrap();
    assert_eq!(patch.header.skin, "small");
    assert_eq!(
        patch.steps().collect::<std::vec::Vec<_>>(),
        pattern(8, 1, 1, Driven::Skipped).collect::<std::vec::Vec<_>>()
    );
    let rows = patch.matrix().rows().next().unwrap();
    let third = 2 * coefficient_index(rows.columns, 2, 2);
    assert_eq!((rows.count, rows.columns, patch.matrix().row_exponents().nth(2)), (4, 40, Some(14)));
    assert_eq!(rows.mantissas[third..third + 2], (1_i16 << 14).to_le_bytes());
}

#[test]
fn every_mantissa_has_a_place_of_its_own_and_words_of_four_rows_lie_together() {
    let mut places: std::vec::Vec<_> =
        (0..8).flat_map(|row| (0..12).map(move |column| coefficient_index(12, row, column))).collect();
    assert_eq!(places[..4], [0, 1, 8, 9]);
    assert_eq!(places[12..14], [2, 3]);
    places.sort_unstable();
    assert_eq!(places, (0..96).collect::<std::vec::Vec<_>>());
}

/// What validation says of the nine pixels' patch with a change.
fn refusal(change: impl FnOnce(&mut TestMatrix)) -> PatchError {
    let mut matrix = TestMatrix::new(&[0.5; 400], &[0; 6]);
    PatchView::validate(&patch_with_matrix(Difference::Plain, 3, &matrix)).unwrap();
    change(&mut matrix);
    PatchView::validate(&patch_with_matrix(Difference::Plain, 3, &matrix)).unwrap_err()
}

#[test]
fn a_matrix_that_does_not_make_each_pixel_once_from_known_ones_is_refused() {
    assert_eq!(refusal(|matrix| matrix.positions[3] = 8), PatchError::Position { pixel: 3 });
    assert_eq!(refusal(|matrix| matrix.positions[8] = 9), PatchError::Position { pixel: 8 });
    let wrong = |interpolation| PatchError::Interpolation { interpolation };
    assert_eq!(refusal(|matrix| matrix.inputs[3] = 6), wrong(0));
    assert_eq!(refusal(|matrix| matrix.inputs[11] = 8), wrong(1));
    assert_eq!(refusal(|matrix| matrix.interpolations[0].inputs = 3), wrong(0));
    assert_eq!(refusal(|matrix| matrix.interpolations[0].inputs = 0), wrong(0));
    assert_eq!(refusal(|matrix| matrix.interpolations[1].outputs = 0), wrong(1));
    assert_eq!(refusal(|matrix| matrix.interpolations[1].outputs = 2), wrong(2));
    assert_eq!(refusal(|matrix| matrix.interpolations.truncate(1)), wrong(1));
    assert_eq!(refusal(|matrix| matrix.inputs.push(0)), wrong(2));
    assert_eq!(refusal(|matrix| matrix.mantissas.push(0)), wrong(2));
    assert_eq!(refusal(|matrix| matrix.mantissas.truncate(300)), wrong(0));
}

#[test]
fn an_exponent_of_a_column_out_of_range_is_refused() {
    for exponent in [i8::MIN, -31, 31] {
        let refused = refusal(|matrix| matrix.column_exponents[7] = exponent);
        assert_eq!(refused, PatchError::ColumnExponent { measurement: 7 });
    }
}

#[test]
fn a_row_that_could_overflow_is_refused() {
    let interpolated = refusal(|matrix| {
        let start = matrix.mantissas.len() - 32;
        (0..3).for_each(|i| matrix.mantissas[start + coefficient_index(8, 0, i)] = 32_767);
    });
    assert_eq!(interpolated, PatchError::Row { row: 8 });
}

#[test]
fn the_mantissas_start_at_a_multiple_of_eight() {
    for across in 1..9 {
        let bytes = patch_of_pixels(across, 1);
        let patch = PatchView::validate(&bytes).unwrap();
        let before = patch.matrix().mantissas().as_ptr().addr() - bytes.as_ptr().addr();
        assert_eq!(before % MATRIX_ALIGNMENT, 0, "{across}");
        assert_eq!(at_start(&[&bytes[..], &[7; 9]].concat()), Some(&bytes[..]));
    }
    assert_eq!(at_start(b"DSKQ56789012"), None);
}

#[test]
fn wrong_magic_version_length_and_crc_are_told_apart() {
    let good = small_patch(Difference::Plain);
    let mut bytes = good.clone();
    bytes[0] = b'X';
    assert_eq!(PatchView::validate(&bytes).unwrap_err(), PatchError::Magic);
    let mut bytes = good.clone();
    bytes[4] = FORMAT_VERSION as u8 + 1;
    assert_eq!(PatchView::validate(&bytes).unwrap_err(), PatchError::Version { found: FORMAT_VERSION + 1 });
    let length = good.len();
    assert_eq!(
        PatchView::validate(&good[..length - 1]).unwrap_err(),
        PatchError::Length { expected: length, found: length - 1 }
    );
    let mut bytes = good.clone();
    bytes[length - 10] ^= 1;
    assert!(matches!(PatchView::validate(&bytes), Err(PatchError::Crc { .. })));
    assert!(matches!(PatchView::validate(&[]), Err(PatchError::Length { .. })));
}

#[test]
fn a_patch_for_more_electrodes_than_the_board_has_is_refused() {
    let mut bytes = small_patch(Difference::Plain);
    let electrodes = PREFIX_BYTES + 1 + "small".len();
    assert_eq!(bytes[electrodes], 8);
    bytes[electrodes] = 32;
    let error = PatchView::validate(&with_valid_crc(bytes)).unwrap_err();
    assert_eq!(error, PatchError::Range { field: "electrodes", value: 32, min: 4, max: 16 });
}

#[test]
fn numbers_of_the_header_may_be_zero_where_they_are_no_sizes_and_never_infinite() {
    let bytes = small_patch(Difference::Plain);
    let header = PatchView::validate(&bytes).unwrap().header;
    let grid = header.grid.unwrap();
    let with = |change: &dyn Fn(&mut PixelGrid, &mut PatchHeader)| {
        let (mut grid, mut header) = (grid, header.clone());
        change(&mut grid, &mut header);
        let bytes = rewritten(&PatchHeader { grid: Some(grid), ..header }, &[]);
        PatchView::validate(&bytes).map(drop)
    };
    let resistances = |ohms: f32| core::iter::repeat_n(ohms, 8).collect();
    let zero = with(&|grid, header| {
        (grid.left, grid.top, header.drift_time) = (0.0, 0.0, 0.0);
        header.test_resistances = resistances(0.0);
    });
    assert_eq!(zero, Ok(()));
    let refused = |field| Err(PatchError::NotPositive { field });
    assert_eq!(with(&|grid, _| grid.pitch = 0.0), refused("grid.pitch"));
    assert_eq!(with(&|grid, _| grid.left = f32::INFINITY), refused("grid.left"));
    assert_eq!(with(&|grid, _| grid.top = f32::NAN), refused("grid.top"));
    assert_eq!(with(&|_, header| header.drift_time = f32::NAN), refused("drift_time"));
    assert_eq!(with(&|_, header| header.drift_time = -1.0), refused("drift_time"));
    let test = with(&|_, header| header.test_resistances = resistances(f32::NAN));
    assert_eq!(test, refused("test_resistances"));
    let none = with(&|_, header| header.contact_threshold = RelativeConductivity(0));
    assert_eq!(none, refused("contact_threshold"));
}

#[test]
fn a_neighbour_that_does_not_exist_is_refused() {
    let bytes = small_patch(Difference::Plain);
    let tables = PatchView::validate(&bytes).unwrap();
    let first = tables.neighbours.as_ptr().addr() - bytes.as_ptr().addr();
    let end = tables.pixels.as_ptr().addr() - bytes.as_ptr().addr() + 3 * PIXEL_BYTES + 6;
    let area = end + 5;
    for (place, value, pixel) in [(first, 4, 0), (first + 7, 1, 1), (end, 7, 4), (end, 9, 3), (area, 0, 3)] {
        let mut bytes = bytes.clone();
        bytes[place] = value;
        let error = PatchView::validate(&with_valid_crc(bytes)).unwrap_err();
        assert_eq!(error, PatchError::Pixel { pixel }, "{value} at {place}");
    }
}

#[test]
fn the_start_of_a_patch_is_enough_to_know_where_its_pixels_lie() {
    let bytes = small_patch(Difference::Plain);
    let whole = PatchView::validate(&bytes).unwrap();
    let needed = whole.matrix().mantissas().as_ptr().addr() - bytes.as_ptr().addr();
    let (start, total) = PatchView::open_start(&bytes[..needed]).unwrap();
    assert_eq!(total, bytes.len());
    let pixels = start.surface().pixels().collect::<std::vec::Vec<_>>();
    assert_eq!(pixels, whole.surface().pixels().collect::<std::vec::Vec<_>>());
    for short in 0..needed {
        let error = PatchView::open_start(&bytes[..short]).unwrap_err();
        let PatchError::Length { expected, found } = error else { panic!("{error}") };
        assert!(found == short && expected > short && expected <= needed, "{expected} for {short}");
    }
}

#[test]
fn a_step_on_a_missing_electrode_is_refused() {
    let mut bytes = small_patch(Difference::Plain);
    let electrodes = PREFIX_BYTES + 1 + "small".len();
    bytes[electrodes] = 7;
    let error = PatchView::validate(&with_valid_crc(bytes)).unwrap_err();
    assert!(matches!(error, PatchError::Step { .. }));
}

proptest! {
    #[test]
    fn no_bytes_make_the_parser_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = PatchView::validate(&bytes);
    }

    #[test]
    fn no_damage_behind_a_valid_crc_makes_parser_or_pipeline_panic(
        place in 4_usize..130,
        value in any::<u8>(),
        cut in 0_usize..3,
    ) {
        let mut bytes = small_patch(Difference::Normalised);
        bytes.truncate(bytes.len() - cut);
        bytes[place] = value;
        let bytes = with_valid_crc(bytes);
        if let Ok(patch) = PatchView::validate(&bytes) {
            let mut state = crate::pipeline::PipelineState::default();
            state.start_tare(1);
            for value in [1000, 1200] {
                crate::pipeline::process(&patch, &mut state, &flat_frame(value));
            }
        }
    }
}
