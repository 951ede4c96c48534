//! A patch with places.

use super::*;
use crate::patch::places::{PLACE_NEIGHBOURS, PLACE_ROWS, Place, SHARE_TERMS, SHARE_UNIT};

/// A square of 12 x 12 pixels of 10 mm with a place on each, to which 40 measurements here and there respond: by 0.1 where
/// they are, less by distance. Smooth changes and slips are told from presses.
pub(crate) fn patch_with_places(level: f32, averaging: f32) -> std::vec::Vec<u8> {
    const ACROSS: u8 = 12;
    const EXPONENT: i8 = 17;
    // A slope along x and one along y.
    const SMOOTH: usize = 2;
    // Each as if the sheet became a better conductor at one place, and a worse one at another.
    const SLIPS: [[usize; 2]; 4] = [[26, 50], [33, 57], [98, 110], [117, 93]];
    let bytes = written(Difference::Normalised, ACROSS, 1);
    let plain = PatchView::validate(&bytes).unwrap();
    let centres: std::vec::Vec<_> =
        plain.surface().pixels().map(|pixel| plain.surface().centre(&pixel)).collect();
    let away = |a: &[f32; 3], b: &[f32; 3]| f64::from((a[0] - b[0]).hypot(a[1] - b[1]));
    let mut mantissas = std::vec![0_i16; (centres.len() + SMOOTH + SLIPS.len()).next_multiple_of(GROUP) * 40];
    for (place, centre) in centres.iter().enumerate() {
        for measurement in 0..40 {
            let response = 0.1 * (-(away(centre, &centres[measurement * 47 % 144]) / 0.03).powi(2)).exp();
            mantissas[coefficient_index(40, place, measurement)] =
                (response * f64::from(EXPONENT).exp2()).round() as i16;
        }
    }
    for axis in 0..SMOOTH {
        for measurement in 0..40 {
            let response = f64::from(centres[measurement * 47 % 144][axis]);
            mantissas[coefficient_index(40, centres.len() + axis, measurement)] =
                (response * f64::from(EXPONENT).exp2()).round() as i16;
        }
    }
    for (slip, places) in SLIPS.into_iter().enumerate() {
        for measurement in 0..40 {
            let [better, worse] = places.map(|place| mantissas[coefficient_index(40, place, measurement)]);
            mantissas[coefficient_index(40, centres.len() + SMOOTH + slip, measurement)] = better - worse / 2;
        }
    }
    let places: std::vec::Vec<_> = (0..centres.len())
        .map(|place| {
            let mut others: std::vec::Vec<_> = (0..centres.len()).filter(|&other| other != place).collect();
            others.sort_by(|&a, &b| {
                away(&centres[place], &centres[a]).total_cmp(&away(&centres[place], &centres[b]))
            });
            let round: [_; PLACE_NEIGHBOURS] = core::array::from_fn(|n| centres[others[n]]);
            Place {
                pixel: place as u16,
                neighbours: core::array::from_fn(|n| others[n] as u8),
                shares: linear(centres[place], round),
            }
        })
        .collect();
    let (pixels, neighbours) = square(ACROSS).tables();
    let (steps, combination): (std::vec::Vec<_>, std::vec::Vec<_>) =
        plain.steps().zip(plain.combination()).unzip();
    let detection = DetectionLayout {
        places: places.len() as u16,
        level,
        radius: 0.01,
        smooth: SMOOTH as u8,
        slips: SLIPS.len() as u8,
        averaging,
    };
    written_with(&PatchContents {
        header: &PatchHeader { detection, drift_time: 120.0, ..plain.header.clone() },
        steps: &steps,
        combination: &combination,
        pixels: &pixels,
        neighbours: &neighbours,
        matrix: diagonal(ACROSS, 1).tables(),
        places: PlacesTables {
            places: &places,
            column_exponents: &[0; 40],
            row_exponents: &[EXPONENT; 144 + SMOOTH + SLIPS.len()],
            mantissas: &mantissas,
        },
        play_operators: &[],
        reflexes: ReflexTables::default(),
    })
}

/// Shares of responses that change linearly with the place, by least squares over the places round it.
fn linear(centre: [f32; 3], round: [[f32; 3]; PLACE_NEIGHBOURS]) -> [[i8; SHARE_TERMS]; PLACE_ROWS] {
    let ways = round.map(|at| [at[0] - centre[0], at[1] - centre[1]]);
    let lengths = ways.map(|[x, y]| x.hypot(y));
    let spacing = lengths.iter().sum::<f32>() / PLACE_NEIGHBOURS as f32;
    let [along_x, along_y] = ways[0].map(|part| part / lengths[0]);
    let ways =
        ways.map(|[x, y]| [along_x * x + along_y * y, along_x * y - along_y * x].map(|part| part / spacing));
    let sum = |a: usize, b: usize| ways.iter().map(|way| way[a] * way[b]).sum::<f32>();
    let (xx, xy, yy) = (sum(0, 0), sum(0, 1), sum(1, 1));
    let determinant = xx * yy - xy * xy;
    let mut shares = [[0; SHARE_TERMS]; PLACE_ROWS];
    for (row, [x, y]) in ways.into_iter().enumerate() {
        for (term, share) in [yy * x - xy * y, xx * y - xy * x].into_iter().enumerate() {
            let share = (share / determinant / SHARE_UNIT).round() as i8;
            shares[1 + row][term] = share;
            shares[0][term] -= share;
        }
    }
    shares
}
