//! What the targets share: a small patch that fuzzers damage, and frames.

use dermatome_shared::{
    calibration::Calibration,
    drive::Drive,
    frame::Frame,
    image::{Geometry, PixelGrid},
    patch::{
        CombinedInto, Difference, PatchContents, PatchHeader,
        checksum::crc32,
        matrix::{Interpolation, MatrixTables, coefficient_index},
        places::{DetectionLayout, Place, PlacesTables},
        reflexes::{Limit, ReflexRow, ReflexRule, ReflexTables},
    },
    stimulation::{Driven, Step, pattern},
    units::{AdcCode, RelativeConductivity},
};

/// A valid patch of 4 electrodes, 4 steps and 2 x 2 pixels: small, so that damage soon hits
/// something that matters.
pub fn small_patch() -> Vec<u8> {
    let steps: Vec<Step> = pattern(4, 1, 1, Driven::Skipped).collect();
    let combination: Vec<_> = (0..steps.len() as u16)
        .map(|step| CombinedInto { measurement: step % 2, flipped: step > 2 })
        .collect();
    let grid = PixelGrid { columns: 2, rows: 2, pitch: 0.01, left: -0.01, top: 0.01 };
    let geometry = Geometry::first_cells(grid, 4);
    let (pixels, neighbours) = geometry.tables();
    let mut mantissas = [0; 4 * 4 + 4 * 4];
    let rows = [[1 << 14, 0], [0, 1 << 14], [i16::MAX, -i16::MAX]];
    for (row, column) in (0..3).flat_map(|row| [(row, 0), (row, 1)]) {
        mantissas[coefficient_index(4, row, column)] = rows[row][column];
    }
    for (column, mantissa) in [i16::MAX, 77, -5, i16::MIN].into_iter().enumerate() {
        mantissas[16 + coefficient_index(4, 0, column)] = mantissa;
    }
    let matrix = MatrixTables {
        column_exponents: &[2, -5],
        row_exponents: &[14, 3, -3],
        positions: &[2, 0, 3, 1],
        interpolations: &[Interpolation { inputs: 4, outputs: 1 }],
        inputs: &[0, 2, 1, 0],
        mantissas: &mantissas,
    };
    let header = PatchHeader {
        skin: "fuzz".try_into().unwrap(),
        electrodes: 4,
        steps: steps.len() as u16,
        measurements: 2,
        pixels: 4,
        difference: Difference::Normalised,
        neighbours: neighbours.len() as u16,
        surface: geometry.scale(),
        grid: Some(grid),
        drive: Drive::new(50e3, 1e-3, 50.0),
        contact_threshold: RelativeConductivity::from_f64(0.01),
        drift_time: 0.0,
        calibration: Calibration::default(),
        test_resistances: Default::default(),
        play_operators: 0,
        reflexes: 1,
        reflex_rows: 2,
        matrix: matrix.layout(),
        detection: DetectionLayout {
            places: 4,
            level: 5.8,
            radius: 0.01,
            smooth: 0,
            slips: 0,
            averaging: 0.1,
        },
    };
    let places: [Place; 4] = std::array::from_fn(|n| Place {
        pixel: n as u16,
        neighbours: [0, 1, 2, 3, 0, 1],
        shares: [[-40, 25, 3, -2, 1], [10; 5], [20, -20, 127, -127, 0], [5; 5], [0; 5], [0; 5], [5; 5]],
    });
    let mut responses = [0; 16];
    for row in 0..4 {
        responses[coefficient_index(4, row, 0)] = 9000 - 5000 * row as i16;
        responses[coefficient_index(4, row, 1)] = 4000 * row as i16;
    }
    let rule = ReflexRule {
        name: "fuzz".try_into().unwrap(),
        pin: 1,
        limit: Limit::Strength(0.3),
        release: 0.5,
        frames: 1,
        hold: 0.1,
        trips_blind: true,
        rows: 2,
    };
    let cells = [&[3.0, -1.0], &[-2.0, 5.0]].map(|weights| ReflexRow {
        area: 1e-4,
        places: [1; 32],
        weights: &weights[..],
    });
    let contents = PatchContents {
        play_operators: &[],
        reflexes: ReflexTables { rules: &[rule], rows: &cells },
        header: &header,
        steps: &steps,
        combination: &combination,
        pixels: &pixels,
        neighbours: &neighbours,
        matrix,
        places: PlacesTables {
            places: &places,
            column_exponents: &[0, -3],
            row_exponents: &[14, 13, 15, 14],
            mantissas: &responses,
        },
    };
    let mut out = vec![0; 1024];
    let length = contents.write(&mut out).unwrap();
    out.truncate(length);
    out
}

/// Overwrites bytes, each edit a place (u16, little-endian, taken modulo the length) and a value,
/// then makes length and checksum right again. The checksum would otherwise stop nearly every input.
pub fn damage(mut patch: Vec<u8>, edits: &[u8]) -> Vec<u8> {
    for edit in edits.chunks_exact(3) {
        let place = usize::from(u16::from_le_bytes([edit[0], edit[1]])) % patch.len();
        patch[place] = edit[2];
    }
    repair(patch)
}

/// Makes length and checksum of a patch right.
pub fn repair(mut patch: Vec<u8>) -> Vec<u8> {
    let length = patch.len();
    if length >= 16 {
        patch[8..12].copy_from_slice(&(length as u32).to_le_bytes());
        let crc = crc32(&[&patch[..length - 4]]);
        patch[length - 4..].copy_from_slice(&crc.to_le_bytes());
    }
    patch
}

/// A frame whose codes are `codes` over and over.
pub fn frame(steps: usize, codes: &[i32]) -> Frame {
    let repeated = codes.iter().cycle().take(steps.min(dermatome_shared::limits::MAX_STEPS));
    Frame { codes: repeated.map(|&code| AdcCode(code)).collect(), ..Frame::default() }
}
