//! Any bytes as a patch, and frames of any codes through the pipeline of what passes the checks.
#![no_main]

use dermatome_shared::{
    limits::MAX_CONTACTS,
    patch::PatchView,
    pipeline::{Outcome, PipelineState, process},
    protocol::PackedImage,
};
use dermatome_shared_fuzz::{damage, frame, repair, small_patch};
use libfuzzer_sys::fuzz_target;

#[derive(arbitrary::Arbitrary, Debug)]
struct Input<'a> {
    /// Start from a valid patch instead of nothing.
    from_valid: bool,
    tare: [i32; 3],
    frames: [[i32; 3]; 2],
    bytes: &'a [u8],
}

fuzz_target!(|input: Input| {
    let _ = PatchView::validate(input.bytes);
    let bytes =
        if input.from_valid { damage(small_patch(), input.bytes) } else { repair(input.bytes.to_vec()) };
    let Ok(patch) = PatchView::validate(&bytes) else { return };
    let rows: usize = patch.matrix().rows().map(|rows| rows.count).sum();
    assert_eq!(rows, usize::from(patch.header.pixels));
    let steps = patch.header.steps.into();
    let mut state = PipelineState::default();
    state.start_tare(2);
    assert_eq!(process(&patch, &mut state, &frame(steps, &input.tare)), Outcome::Taring);
    assert_eq!(process(&patch, &mut state, &frame(steps, &input.tare)), Outcome::Tared);
    for codes in &input.frames {
        assert_eq!(process(&patch, &mut state, &frame(steps, codes)), Outcome::Image);
        assert_eq!(state.image().len(), usize::from(patch.header.pixels));
        assert!(state.contacts().len() <= MAX_CONTACTS);
        for contact in state.contacts() {
            assert!(contact.position.iter().all(|x| !x.is_nan()), "{contact:?}");
            assert!(!contact.strength.is_nan() && !contact.peak.is_nan(), "{contact:?}");
        }
        let packed = PackedImage::pack(state.image());
        for (packed, exact) in packed.values().zip(state.image()) {
            // Half a step: 2^-15 of the largest value, which is at most 2048.
            assert!((packed - exact.to_f64()).abs() <= 0.0625, "{packed} for {exact:?}");
        }
    }
    assert_eq!(process(&patch, &mut state, &frame(steps - 1, &[1])), Outcome::WrongLength);
});
