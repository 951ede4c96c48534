//! A patch with another calibration.

use dermatome_patch::tables::SurfaceTables;
use dermatome_shared::{
    calibration::Calibration,
    hysteresis::PlayOperator,
    patch::{PatchContents, PatchError, PatchHeader, PatchView},
};

/// The patch `bytes` with this curve and these plays; all else stays.
pub fn with_calibration(
    bytes: &[u8],
    calibration: &Calibration,
    plays: &[PlayOperator],
) -> Result<Vec<u8>, PatchError> {
    let patch = PatchView::validate(bytes)?;
    let header = PatchHeader {
        calibration: calibration.clone(),
        play_operators: plays.len() as u8,
        ..patch.header.clone()
    };
    let (steps, combination): (Vec<_>, Vec<_>) = patch.steps().zip(patch.combination()).unzip();
    let tables = SurfaceTables::read(&patch);
    let exponents: Vec<i8> = patch.exponents().iter().map(|&byte| i8::from_le_bytes([byte])).collect();
    let matrix: Vec<i16> =
        patch.matrix().chunks_exact(2).map(|pair| i16::from_le_bytes([pair[0], pair[1]])).collect();
    let contents = PatchContents {
        play_operators: plays,
        header: &header,
        steps: &steps,
        combination: &combination,
        pixels: &tables.pixels,
        neighbours: &tables.neighbours,
        exponents: &exponents,
        matrix: &matrix,
    };
    // A curve and plays of the greatest length add less than this.
    let mut out = vec![0; bytes.len() + 1024];
    let length = contents.write(&mut out).expect("the buffer is longer than the patch can become");
    out.truncate(length);
    PatchView::validate(&out)?;
    Ok(out)
}
