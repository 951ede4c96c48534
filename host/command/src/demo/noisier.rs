//! The demo's fingers at more noise, by the board's own code without a link.

use super::{FRAMES, FrameRecord, Scorer};
use dermatome_shared::protocol::FrameStamp;
use dermatome_simulate::{
    Noise, Rig,
    rig::{Observer, RigError},
};

/// All frames of the demo at this noise; those until `go_on` says no.
pub(crate) fn noisier(
    scorer: &Scorer<'_>,
    noise: Noise,
    go_on: impl Fn() -> bool,
) -> Result<Vec<FrameRecord>, RigError> {
    let mut board = Observer::with_model(scorer.skin, scorer.model.clone())?;
    let mut rig = Rig::new(scorer.skin, &board.patch(), noise)?;
    let untouched = rig.truth().conductivity(&[]);
    board.tare(&rig.tare(&untouched));
    let record = |index| {
        let scan = rig.press(&scorer.presses(index));
        let seen = board.observe(&scan);
        let at = FrameStamp { sequence: index, timestamp_us: scan.timestamp_us, flags: scan.flags };
        let image = seen.image().iter().map(|value| value.to_f64()).collect();
        scorer.record(at, 0, image, seen.contacts().clone())
    };
    Ok((0..FRAMES).take_while(|_| go_on()).map(record).collect())
}
