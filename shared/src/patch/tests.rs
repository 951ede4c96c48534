use super::*;
use crate::{
    drive::stimulation::{Driven, pattern},
    frame::Frame,
    image::Geometry,
    units::AdcCode,
};
use proptest::prelude::*;

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
    let (pixels, neighbours) = square(2).tables();
    let contents = PatchContents {
        play_operators: &[],
        header: &PatchHeader { measurements, ..patch.header },
        steps: &steps,
        combination: &(0..2 * measurements).map(target).collect::<std::vec::Vec<_>>(),
        pixels: &pixels,
        neighbours: &neighbours,
        exponents: &[14; 4],
        matrix: &std::vec![0; 4 * usize::from(measurements)],
    };
    let mut out = std::vec![0; 8192];
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
    let halves = patch.matrix().chunks_exact(2).map(|b| i16::from_le_bytes([b[0], b[1]]));
    let (pixels, neighbours) = square(2).tables();
    let contents = PatchContents {
        play_operators,
        header,
        steps: &steps,
        combination: &combination,
        pixels: &pixels,
        neighbours: &neighbours,
        exponents: &patch.exponents().iter().map(|&byte| byte as i8).collect::<std::vec::Vec<_>>(),
        matrix: &halves.collect::<std::vec::Vec<_>>(),
    };
    let mut out = std::vec![0; 8192];
    let length = contents.write(&mut out).unwrap();
    out.truncate(length);
    out
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
    let steps: std::vec::Vec<_> = pattern(8, 1, 1, Driven::Skipped).collect();
    let combination: std::vec::Vec<_> =
        (0..steps.len() as u16).map(|measurement| CombinedInto { measurement, flipped: false }).collect();
    let pixels = usize::from(across) * usize::from(across);
    let geometry = square(across);
    let (places, neighbours) = geometry.tables();
    let header = PatchHeader {
        skin: String::try_from("small").unwrap(),
        electrodes: 8,
        steps: steps.len() as u16,
        measurements: steps.len() as u16,
        pixels: pixels as u16,
        difference,
        neighbours: neighbours.len() as u16,
        surface: geometry.scale(),
        grid: Some(geometry.grid),
        drive: Drive::new(50e3, 1e-3, 50.0),
        contact_threshold: RelativeConductivity::from_f64(0.01),
        drift_time: 0.0,
        calibration: Calibration::default(),
        test_resistances: Default::default(),
        play_operators: 0,
    };
    let mut matrix = std::vec![0; pixels * steps.len()];
    for pixel in 0..pixels {
        matrix[pixel * steps.len() + pixel % steps.len()] = mantissa;
    }
    let contents = PatchContents {
        play_operators: &[],
        header: &header,
        steps: &steps,
        combination: &combination,
        pixels: &places,
        neighbours: &neighbours,
        exponents: &std::vec![14; pixels],
        matrix: &matrix,
    };
    let mut out = std::vec![0; 8192];
    let length = contents.write(&mut out).unwrap();
    out.truncate(length);
    out
}

/// A frame of the small patch in which every code is `value`.
pub(crate) fn flat_frame(value: i32) -> Frame {
    let codes = (0..40).map(|_| AdcCode(value)).collect();
    Frame { codes, ..Frame::default() }
}

fn with_valid_crc(mut bytes: std::vec::Vec<u8>) -> std::vec::Vec<u8> {
    let end = bytes.len() - CRC_BYTES;
    let crc = CRC32.checksum(&bytes[..end]);
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
    assert_eq!(patch.rows().count(), 4);
    let (row, exponent) = patch.rows().nth(2).unwrap();
    assert_eq!((exponent, i16::from_le_bytes([row[4], row[5]])), (14, 1 << 14));
}

#[test]
fn the_matrix_starts_at_a_multiple_of_four() {
    for across in 1..9 {
        let bytes = patch_of_pixels(across, 1);
        let patch = PatchView::validate(&bytes).unwrap();
        let before = patch.matrix.as_ptr().addr() - bytes.as_ptr().addr();
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
    bytes[4] = 9;
    assert_eq!(PatchView::validate(&bytes).unwrap_err(), PatchError::Version { found: 9 });
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
    let needed = whole.matrix.as_ptr().addr() - bytes.as_ptr().addr();
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
