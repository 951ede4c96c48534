use super::spot;
use crate::{
    frame::{Frame, FrameFlags},
    patch::{
        PatchView,
        places::Places,
        tests::{flat_frame, patch_with_places},
    },
    pipeline::{Outcome, PipelineState, process},
    units::AdcCode,
};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::{vec, vec::Vec};

const CODE: f64 = 1e6;
const LEVEL: f32 = 5.5;

/// A patch with places, the board's state, and noise of this share of the voltages.
struct Trial {
    bytes: Vec<u8>,
    state: PipelineState,
    random: Pcg64Mcg,
    noise: f64,
    now_us: u64,
}

impl Trial {
    fn new(noise: f64, tare: u16) -> Self {
        Self::averaging(0.0, noise, tare)
    }

    /// The same with still frames averaged over so many seconds.
    fn averaging(averaging: f32, noise: f64, tare: u16) -> Self {
        Self::with_level(LEVEL, averaging, noise, tare)
    }

    /// The same with contacts from this level on.
    fn with_level(level: f32, averaging: f32, noise: f64, tare: u16) -> Self {
        let mut trial = Self {
            bytes: patch_with_places(level, averaging),
            state: PipelineState::default(),
            random: Pcg64Mcg::seed_from_u64(7),
            noise,
            now_us: 0,
        };
        trial.state.start_tare(tare);
        for _ in 0..tare {
            trial.frame(&[], |_| 0.0);
        }
        trial
    }

    fn patch(&self) -> PatchView<'_> {
        PatchView::validate(&self.bytes).unwrap()
    }

    /// A frame under presses of these strengths on these places, changed by some more: `[measurement]`.
    fn frame(&mut self, presses: &[(usize, f64)], more: impl Fn(usize) -> f64) -> Outcome {
        let patch = PatchView::validate(&self.bytes).unwrap();
        let places = patch.places();
        let code = |m: usize| {
            let response = |&(place, strength): &(usize, f64)| {
                let mantissa = Places::four(places.row(place), m / 4)[m % 4];
                strength * f64::from(mantissa) * f64::from(-places.row_exponent(place)).exp2()
            };
            let change = presses.iter().map(response).sum::<f64>() + more(m);
            let noise: f64 = (0..12).map(|_| self.random.random_range(-0.5..0.5)).sum();
            AdcCode((CODE * (1.0 + change + self.noise * noise)) as i32)
        };
        let codes = (0..40).map(code).collect();
        self.now_us += 20_000;
        process(&patch, &mut self.state, &Frame { codes, timestamp_us: self.now_us, ..flat_frame(0) })
    }

    /// Contacts after some frames of the same: place nearest to each, strength, significance.
    fn found(&mut self, presses: &[(usize, f64)], frames: usize) -> Vec<(usize, f32, f32)> {
        (0..frames).for_each(|_| assert_eq!(self.frame(presses, |_| 0.0), Outcome::Image));
        self.contacts()
    }

    fn contacts(&self) -> Vec<(usize, f32, f32)> {
        let patch = self.patch();
        let surface = patch.surface();
        let found = self.state.contacts().iter().map(|contact| {
            let away =
                |centre: [f32; 3]| (centre[0] - contact.position[0]).hypot(centre[1] - contact.position[1]);
            let centres = surface.pixels().map(|pixel| away(surface.centre(&pixel)));
            let (place, _) = centres.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
            (place, contact.strength, contact.evidence.unwrap().significance)
        });
        found.collect()
    }
}

#[test]
fn presses_are_found_one_in_each_frame_with_their_strengths_and_go_when_they_are_lifted() {
    let mut trial = Trial::new(1e-4, 20);
    let presses = [(27, 1.0), (117, 0.6)];
    let first = trial.found(&presses, 1);
    assert_eq!(first.iter().map(|found| found.0).collect::<Vec<_>>(), [27]);
    for frames in [1, 5] {
        let found = trial.found(&presses, frames);
        let [one, other] = found[..] else { panic!("{found:?}") };
        assert!(one.0 == 27 && (one.1 - 1.0).abs() < 0.02, "{one:?}");
        assert!(other.0 == 117 && (other.1 - 0.6).abs() < 0.02, "{other:?}");
        assert!(one.2 > 100.0 && other.2 > 100.0);
    }
    assert!(trial.found(&[], 1).is_empty());
}

#[test]
fn the_louder_the_noise_the_less_significant_is_a_press_until_it_is_none() {
    let mut last = f32::INFINITY;
    for (noise, is_found) in [(1e-4, true), (1e-3, true), (1e-2, true), (1e-1, false)] {
        let mut trial = Trial::new(noise, 20);
        let found = trial.found(&[(66, 1.0)], 1);
        assert_eq!(!found.is_empty(), is_found, "{noise}: {found:?}");
        if let [(place, _, significance)] = found[..] {
            assert!(place == 66 || noise > 1e-3, "{noise}: {place}");
            assert!(significance < last / 5.0, "{noise}: {significance} after {last}");
            last = significance;
        }
        assert!(trial.found(&[], 300).is_empty());
    }
}

#[test]
fn what_one_frame_shows_of_an_untouched_skin_is_found_in_it_although_still_frames_are_averaged() {
    let [each, averaged] = [0.0, 0.4].map(|averaging| {
        let mut trial = Trial::with_level(4.2, averaging, 1e-2, 50);
        let seen = (0..100).filter(|&place| {
            trial.found(&[], 60);
            !trial.found(&[(place, 0.3)], 1).is_empty()
        });
        seen.count()
    });
    // Where only the sum of squares opens the average, 50 are seen in their first frame, of 68.
    assert!(each < 90 && 10 * averaged >= 9 * each, "{averaged}, each frame by itself {each}");
}

#[test]
fn a_press_that_a_frame_does_not_show_is_found_when_it_stays() {
    for (averaging, is_found) in [(0.0, false), (0.4, true)] {
        let mut trial = Trial::averaging(averaging, 1e-2, 20);
        trial.found(&[], 100);
        let found = trial.found(&[(66, 0.15)], 30);
        assert_eq!(!found.is_empty(), is_found, "over {averaging} s: {found:?}");
        assert!(trial.found(&[], 60).is_empty(), "over {averaging} s");
    }
}

#[test]
fn a_press_beside_a_stronger_one_is_part_of_it() {
    // Radius 10 mm, place to place 10 mm: 30 mm are within reach, 50 mm are not.
    for (other, contacts) in [(69, 1), (71, 2)] {
        let mut trial = Trial::new(1e-4, 20);
        let found = trial.found(&[(66, 1.0), (other, 1.0)], 12);
        assert_eq!(found.len(), contacts, "{found:?}");
        let sum: f32 = found.iter().map(|found| found.1).sum();
        assert!((sum - 2.0).abs() < 0.1, "{found:?}");
    }
}

#[test]
fn a_change_of_all_voltages_is_no_press_and_hides_none() {
    for common in [0.05, -0.05] {
        let mut trial = Trial::new(1e-4, 20);
        for _ in 0..3 {
            trial.frame(&[], |_| common);
            assert!(trial.contacts().is_empty());
        }
        for _ in 0..3 {
            trial.frame(&[(66, 1.0)], |_| common);
        }
        let found = trial.contacts();
        assert!(matches!(found[..], [(66, strength, _)] if (strength - 1.0).abs() < 0.05), "{found:?}");
    }
}

#[test]
fn what_presses_do_not_account_for_is_no_contact() {
    let mut trial = Trial::new(1e-4, 20);
    for _ in 0..10 {
        trial.frame(&[], |m| if m % 2 == 0 { 0.03 } else { -0.03 });
        assert!(trial.contacts().is_empty(), "{:?}", trial.contacts());
    }
}

#[test]
fn what_comes_in_pieces_is_undecided_for_some_frames_and_noise_never_is() {
    let mut trial = Trial::new(1e-3, 20);
    for _ in 0..100 {
        trial.frame(&[], |_| 0.0);
        assert!(!trial.state.detector.is_undecided());
    }
    let mut most = 0;
    for percent in 0..20 {
        let mut trial = Trial::new(1e-4, 20);
        let of_no_press =
            |m: usize| f64::from(percent) / 100.0 * if m.is_multiple_of(2) { 0.3 } else { -0.3 };
        let mut undecided = 0;
        for _ in 0..60 {
            trial.frame(&[(66, 1.0)], of_no_press);
            undecided += usize::from(trial.state.detector.is_undecided());
        }
        assert!(undecided < super::UNDECIDED.into(), "{percent} %: {undecided}");
        most = most.max(undecided);
    }
    assert_eq!(most, usize::from(super::UNDECIDED) - 1);
}

#[test]
fn nothing_is_found_before_the_noise_is_known() {
    let mut trial = Trial::new(1e-3, 1);
    assert!(trial.found(&[], 7).is_empty());
    assert!(trial.found(&[(66, 1.0)], 1).is_empty());
    let mut trial = Trial::new(1e-3, 1);
    assert!(trial.found(&[], 40).is_empty());
    assert_eq!(trial.found(&[(66, 1.0)], 1).len(), 1);
}

/// A change that is no press, of this size; the first ones grow along an axis of the skin: `[measurement]`.
fn known_change(patch: &PatchView<'_>, change: usize, size: f64) -> Vec<f64> {
    let places = patch.places();
    let row = places.count() + change;
    let response = |m: usize| f64::from(Places::four(places.row(row), m / 4)[m % 4]);
    let scale = f64::from(-places.row_exponent(row)).exp2();
    (0..40).map(|m| size * scale * response(m)).collect()
}

#[test]
fn what_changes_slowly_and_smoothly_is_no_contact_and_the_reference_follows_it() {
    let mut trial = Trial::new(1e-4, 20);
    let slope = known_change(&trial.patch(), 0, 1.0);
    for frame in 0..500 {
        trial.frame(&[], |m| slope[m] * f64::from(frame) / 500.0);
        assert!(trial.contacts().is_empty(), "frame {frame}: {:?}", trial.contacts());
    }
    for _ in 0..150 {
        trial.frame(&[], |m| slope[m]);
    }
    assert_eq!(trial.state.detector.change(), super::Change::Still);
    for _ in 0..3 {
        trial.frame(&[(66, 1.0)], |m| slope[m]);
    }
    let found = trial.contacts();
    assert!(matches!(found[..], [(66, strength, _)] if (strength - 1.0).abs() < 0.1), "{found:?}");
}

#[test]
fn a_press_that_grows_as_slowly_as_drift_is_one() {
    let mut trial = Trial::new(1e-4, 20);
    let mut first = None;
    for frame in 0..3000 {
        trial.frame(&[(66, f64::from(frame) / 3000.0)], |_| 0.0);
        first = first.or((!trial.contacts().is_empty()).then_some(frame));
    }
    assert!(first.is_some_and(|frame| frame < 600), "{first:?}");
    let found = trial.contacts();
    assert!(matches!(found[..], [(66, strength, _)] if (strength - 1.0).abs() < 0.1), "{found:?}");
}

/// A press is held while others grow for six seconds; calls back after each frame.
fn held_while_grow(trial: &mut Trial, grown: &[(usize, f64)], seen: impl Fn(u32, &[(usize, f32, f32)])) {
    let held = (66, 1.0);
    for frame in 0..400 {
        let share = (f64::from(frame) - 75.0).clamp(0.0, 300.0) / 300.0;
        let mut presses = vec![held];
        presses.extend(grown.iter().map(|&(place, strength)| (place, share * strength)));
        trial.frame(&presses, |_| 0.0);
        seen(frame, &trial.contacts());
    }
}

#[test]
fn a_part_of_the_sheet_that_warms_beside_a_press_that_is_held_is_neither_a_press_nor_a_move() {
    let mut trial = Trial::new(1e-4, 20);
    // With a sharp edge, so that no smooth change is all of it.
    let patch = trial.patch();
    let (places, surface) = (patch.places(), patch.surface());
    let is_warm = |place: &usize| {
        let [x, y, _] = spot::at(&surface, &places, *place).0;
        x > 0.0 && y > 0.0
    };
    let warm: Vec<_> = (0..places.count()).filter(is_warm).map(|place| (place, 0.05)).collect();
    held_while_grow(&mut trial, &warm, |frame, found| {
        let is_held = matches!(found[..], [(66, strength, _)] if (strength - 1.0).abs() < 0.05);
        assert!(is_held, "frame {frame}: {found:?}");
    });
    for frame in 0..200 {
        trial.frame(&warm, |_| 0.0);
        assert!(trial.contacts().is_empty(), "frame {frame} after it: {:?}", trial.contacts());
    }
}

#[test]
fn another_press_that_grows_as_slowly_beside_one_that_is_held_is_one() {
    let mut trial = Trial::new(1e-4, 20);
    held_while_grow(&mut trial, &[(117, 0.6)], |frame, found| {
        assert!(!found.is_empty() && found[0].0 == 66, "frame {frame}: {found:?}");
    });
    let found = trial.contacts();
    let [one, other] = found[..] else { panic!("{found:?}") };
    assert!(one.0 == 66 && (one.1 - 1.0).abs() < 0.05, "{one:?}");
    assert!(other.0 == 117 && (other.1 - 0.6).abs() < 0.06, "{other:?}");
}

#[test]
fn what_pressed_in_the_tare_and_is_lifted_is_said_and_mended() {
    let mut trial = Trial::new(1e-4, 1);
    trial.state.start_tare(20);
    for _ in 0..20 {
        trial.frame(&[(66, 1.0)], |_| 0.0);
    }
    trial.frame(&[], |_| 0.0);
    assert!(trial.contacts().is_empty() && trial.state.flags().contains(FrameFlags::LIFTED));
    for _ in 0..100 {
        trial.frame(&[], |_| 0.0);
        assert!(trial.contacts().is_empty());
    }
    assert!(!trial.state.flags().contains(FrameFlags::LIFTED));
    for _ in 0..3 {
        trial.frame(&[(66, 1.0)], |_| 0.0);
    }
    let found = trial.contacts();
    assert!(matches!(found[..], [(66, strength, _)] if (strength - 1.0).abs() < 0.1), "{found:?}");
}

#[test]
fn rests_of_what_pressed_in_the_tare_are_no_contacts_and_presses_meanwhile_are() {
    for (frames, strength) in [(150, 0.3), (10, 0.9)] {
        let mut trial = Trial::new(1e-4, 1);
        trial.state.start_tare(20);
        // Once it is lifted, as if something pressed at 120, nearly as strongly.
        let rest = [(27, 1.0), (120, -0.7)];
        for _ in 0..20 {
            trial.frame(&rest, |_| 0.0);
        }
        for frame in 0..frames {
            trial.frame(&[], |_| 0.0);
            assert!(trial.contacts().is_empty(), "frame {frame}: {:?}", trial.contacts());
            assert!(frame != 0 || trial.state.flags().contains(FrameFlags::LIFTED));
        }
        for _ in 0..3 {
            trial.frame(&[(117, f64::from(strength))], |_| 0.0);
        }
        let found = trial.contacts();
        assert!(matches!(found[..], [(117, found, _)] if (found - strength).abs() < 0.1), "{found:?}");
    }
}

#[test]
fn what_was_learnt_wrongly_is_unlearnt_as_soon_as_the_skin_is_untouched() {
    // Whether something presses before, or the skin is untouched for long.
    for (frames, before) in [1, 4, 8, 12, 16, 20].into_iter().flat_map(|frames| [(frames, 1), (frames, 0)]) {
        let mut trial = Trial::new(1e-4, 20);
        let reference = trial.state.reference().unwrap().sums().to_vec();
        trial.found(&[(66, 1.0)], before);
        for _ in 0..frames {
            trial.frame(&[(66, -1.0)], |_| 0.0);
            assert!(trial.contacts().is_empty());
        }
        assert!(frames < 8 || trial.state.reference().unwrap().sums() != reference, "{frames}");
        for _ in 0..5 {
            trial.frame(&[], |_| 0.0);
            assert!(trial.contacts().is_empty(), "{frames}: {:?}", trial.contacts());
            assert_eq!(trial.state.flags(), FrameFlags::default());
        }
        for _ in 0..3 {
            trial.frame(&[(66, 1.0)], |_| 0.0);
        }
        let found = trial.contacts();
        assert!(matches!(found[..], [(66, strength, _)] if (strength - 1.0).abs() < 0.1), "{found:?}");
    }
}

#[test]
fn electrodes_that_slip_are_no_contact_and_the_reference_heals() {
    let mut trial = Trial::new(1e-4, 20);
    let slips: Vec<_> = (2..6).map(|change| known_change(&trial.patch(), change, 1.0)).collect();
    let slip = |m: usize| slips.iter().map(|slip| slip[m]).sum();
    for frame in 0..1500 {
        trial.frame(&[], slip);
        assert!(trial.contacts().is_empty(), "frame {frame}: {:?}", trial.contacts());
        assert!(frame != 30 || trial.state.flags().contains(FrameFlags::UNLIKE_PRESS));
    }
    assert_eq!(trial.state.flags(), FrameFlags::default());
    for _ in 0..3 {
        trial.frame(&[(66, 1.0)], slip);
    }
    let found = trial.contacts();
    assert!(matches!(found[..], [(66, strength, _)] if (strength - 1.0).abs() < 0.1), "{found:?}");
}

#[test]
fn a_press_that_comes_with_slips_is_found_and_they_are_mended_at_once() {
    for size in [0.3, 1.0] {
        let mut trial = Trial::new(1e-4, 20);
        let slips: Vec<_> = (2..6).map(|change| known_change(&trial.patch(), change, size)).collect();
        let slip = |m: usize| slips.iter().map(|slip| slip[m]).sum();
        let mut flagged = 0;
        for _ in 0..10 {
            trial.frame(&[(66, 1.0)], slip);
            flagged += u32::from(trial.state.flags().contains(FrameFlags::UNLIKE_PRESS));
        }
        assert_eq!(flagged, 1, "{size}: the frame in which it is told");
        for _ in 0..500 {
            let found = trial.contacts();
            let is_it = matches!(found[..], [(66, strength, _)] if (strength - 1.0).abs() < 0.1);
            assert!(is_it, "{size}: {found:?}");
            assert!(trial.frame(&[(66, 1.0)], slip) == Outcome::Image);
        }
        // The finger lifts, and the electrodes stay.
        for frame in 0..200 {
            trial.frame(&[], slip);
            assert!(trial.contacts().is_empty(), "{size}, frame {frame}: {:?}", trial.contacts());
            assert!(!trial.state.flags().contains(FrameFlags::UNLIKE_PRESS), "{size}, frame {frame}");
        }
        // They go back, with the finger that comes.
        for _ in 0..10 {
            trial.frame(&[(31, 0.8)], |_| 0.0);
        }
        let found = trial.contacts();
        assert!(
            matches!(found[..], [(31, strength, _)] if (strength - 0.8).abs() < 0.1),
            "{size}: {found:?}"
        );
    }
}

#[test]
fn where_a_press_goes_together_with_slips_the_former_reference_is_right_again() {
    let mut trial = Trial::new(1e-4, 20);
    let slips: Vec<_> = (2..6).map(|change| known_change(&trial.patch(), change, 1.0)).collect();
    let slip = |m: usize| slips.iter().map(|slip| slip[m]).sum();
    let reference = trial.state.reference().unwrap().sums().to_vec();
    for _ in 0..12 {
        trial.frame(&[(66, 1.0)], slip);
    }
    assert_eq!(trial.contacts().len(), 1);
    assert_ne!(trial.state.reference().unwrap().sums(), reference);
    trial.frame(&[], |_| 0.0);
    assert!(trial.contacts().is_empty());
    assert_eq!(trial.state.reference().unwrap().sums(), reference);
}

#[test]
fn what_no_press_does_is_said_and_mended_in_half_a_minute() {
    let mut trial = Trial::new(1e-4, 20);
    let change = |m: usize| if m.is_multiple_of(2) { 0.03 } else { -0.03 };
    for frame in 0..1500 {
        trial.frame(&[], change);
        assert!(trial.contacts().is_empty(), "frame {frame}");
        assert!(frame != 30 || trial.state.flags().contains(FrameFlags::UNLIKE_PRESS));
    }
    assert_eq!(trial.state.flags(), FrameFlags::default());
    assert_eq!(trial.state.detector.change(), super::Change::Still);
}
