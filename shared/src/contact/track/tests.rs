use super::*;
use std::vec::Vec;

const FRAME_US: u64 = 20_000;
/// Of the standard press on a disc of 210 mm.
const RADIUS: f32 = 0.0095;

fn at(x: f32, y: f32) -> Contact {
    Contact {
        position: [x, y, 0.0],
        normal: [0.0, 0.0, 1.0],
        area: 1e-4,
        strength: 0.5,
        peak: 1.0,
        pressure: None,
        load_area: None,
        evidence: None,
        identity: None,
    }
}

fn as_strong_as_two(x: f32, y: f32) -> Contact {
    Contact { strength: 1.0, ..at(x, y) }
}

fn identities(tracker: &mut Tracker, now_us: u64, contacts: &[Contact]) -> Vec<Identity> {
    let mut contacts = Contacts::from_slice(contacts).unwrap();
    tracker.follow(now_us, RADIUS, &mut contacts);
    contacts.iter().map(|contact| contact.identity.unwrap()).collect()
}

fn numbers(tracker: &mut Tracker, now_us: u64, contacts: &[Contact]) -> Vec<u32> {
    identities(tracker, now_us, contacts).iter().map(|identity| identity.number).collect()
}

#[test]
fn fingers_that_pass_each_other_keep_their_numbers() {
    let mut tracker = Tracker::default();
    for frame in 0..100_u16 {
        let x = -0.05 + 0.001 * f32::from(frame);
        // Listed the other way round in every second frame, as the strongest comes first.
        let mut contacts = [at(x, 0.004), at(-x, -0.004)];
        let mut expected = [1, 2];
        if frame % 2 == 1 {
            contacts.reverse();
            expected.reverse();
        }
        assert_eq!(numbers(&mut tracker, u64::from(frame) * FRAME_US, &contacts), expected, "frame {frame}");
    }
}

#[test]
fn a_short_loss_keeps_the_number_and_a_long_one_does_not() {
    let mut tracker = Tracker::default();
    let mut now = 0;
    let mut show = |contacts: &[Contact], frames: u64| {
        let mut seen = Vec::new();
        for _ in 0..frames {
            now += FRAME_US;
            seen = numbers(&mut tracker, now, contacts);
        }
        seen
    };
    let finger = [at(0.01, 0.02)];
    assert_eq!(show(&finger, 3), [1]);
    show(&[], 13);
    assert_eq!(show(&finger, 1), [1]);
    show(&[], 17);
    assert_eq!(show(&finger, 1), [2]);
}

#[test]
fn frames_far_apart_keep_the_number() {
    for frame_us in [350_000, 1_000_000, 60_000_000] {
        let mut tracker = Tracker::default();
        for frame in 0..10 {
            let now = 5_000_000 + frame * frame_us;
            assert_eq!(
                numbers(&mut tracker, now, &[at(0.01, 0.02), at(-0.05, 0.0)]),
                [1, 2],
                "{frame_us} us"
            );
        }
        numbers(&mut tracker, 5_000_000 + 10 * frame_us, &[at(-0.05, 0.0)]);
        let seen = numbers(&mut tracker, 5_000_000 + 11 * frame_us, &[at(0.01, 0.02), at(-0.05, 0.0)]);
        assert_eq!(seen, [3, 2], "{frame_us} us: lost for a whole frame");
    }
}

#[test]
fn a_finger_elsewhere_is_another_one() {
    let mut tracker = Tracker::default();
    assert_eq!(numbers(&mut tracker, 0, &[at(0.0, 0.0)]), [1]);
    let seen = identities(&mut tracker, FRAME_US, &[at(0.05, 0.0)]);
    assert_eq!((seen[0].number, seen[0].split_from), (2, None));
}

#[test]
fn a_fast_swipe_is_one_finger_at_any_rate() {
    for (frame_us, speed) in [(20_000, 1.5), (2_500, 3.0), (2_500, 0.3), (100_000, 0.2)] {
        let mut tracker = Tracker::default();
        let step = speed * frame_us as f32 * 1e-6;
        for frame in 0..8_u16 {
            let seen =
                numbers(&mut tracker, u64::from(frame) * frame_us, &[at(step * f32::from(frame), 0.0)]);
            assert_eq!(seen, [1], "{speed} m/s, {frame_us} us, frame {frame}");
        }
    }
}

/// Two fingers that pass or turn back, at 0.25 m/s each, and are one contact as long as they are closer than 32 mm:
/// identities of every frame.
fn meet(frame_us: u64, turns_back: bool, rest_us: u64) -> Vec<Vec<Identity>> {
    let mut tracker = Tracker::default();
    let frames = (400_000 + rest_us) / frame_us;
    let way = |now: u64| {
        // They rest in the middle, at 0.2 s.
        let moved = if now < 200_000 { now } else { now.saturating_sub(rest_us).max(200_000) };
        -0.05 + 0.25 * moved as f32 * 1e-6
    };
    (0..frames)
        .map(|frame| {
            let now = frame * frame_us;
            let x = if turns_back { -way(now).abs() } else { way(now) };
            // 1 mm of jitter.
            let jitter = if frame % 2 == 0 { 5e-4 } else { -5e-4 };
            let contacts = if x.abs() < 0.016 {
                std::vec![as_strong_as_two(jitter, jitter)]
            } else {
                std::vec![at(x + jitter, 0.008 - jitter), at(-x - jitter, -0.008)]
            };
            identities(&mut tracker, now, &contacts)
        })
        .collect()
}

#[test]
fn fingers_that_were_one_contact_where_they_passed_keep_their_numbers() {
    for frame_us in [2_500, 5_000, 10_000, 20_000] {
        let seen = meet(frame_us, false, 0);
        let (first, last) = (&seen[3], &seen[seen.len() - 1]);
        let of = |seen: &[Identity]| seen.iter().map(|identity| identity.number).collect::<Vec<_>>();
        assert_eq!((of(first), of(last)), (std::vec![1, 2], std::vec![1, 2]), "{frame_us} us");
        let as_one = seen.iter().filter(|seen| seen.len() == 1);
        assert!(as_one.clone().count() > 0);
        for seen in as_one {
            // Which of both it is called says nothing: it is both.
            let both = [seen[0].number, seen[0].merged.unwrap()];
            assert!(both == [1, 2] || both == [2, 1], "{frame_us} us: {seen:?}");
        }
        assert!(last.iter().all(|identity| identity.merged.is_none() && identity.split_from.is_none()));
    }
}

#[test]
fn fingers_that_were_one_for_long_are_one_that_stays_and_one_that_split_from_it() {
    for turns_back in [false, true] {
        let seen = meet(20_000, turns_back, 1_000_000);
        let one = seen.iter().rfind(|seen| seen.len() == 1).unwrap()[0];
        assert_eq!(one.merged, Some(3 - one.number), "it says so as long as it holds");
        let last = &seen[seen.len() - 1];
        let stayed = last.iter().find(|identity| identity.number == one.number).unwrap();
        let new = last.iter().find(|identity| identity.number != one.number).unwrap();
        assert_eq!((new.number, new.split_from, stayed.merged), (3, Some(one.number), None), "{last:?}");
    }
}

#[test]
fn one_that_lifts_beside_another_did_not_merge_and_one_that_comes_beside_it_did_not_split() {
    let mut tracker = Tracker::default();
    for frame in 0..5 {
        numbers(&mut tracker, frame * FRAME_US, &[at(0.0, 0.0), at(0.034, 0.0)]);
    }
    let alone = identities(&mut tracker, 5 * FRAME_US, &[at(0.0, 0.0)]);
    assert_eq!((alone[0].number, alone[0].merged), (1, None));
    for frame in 6..30 {
        numbers(&mut tracker, frame * FRAME_US, &[at(0.0, 0.0)]);
    }
    let both = identities(&mut tracker, 30 * FRAME_US, &[at(0.0, 0.0), at(0.034, 0.0)]);
    assert_eq!((both[1].number, both[1].split_from), (3, None));
}

#[test]
fn velocity_is_that_of_the_finger() {
    let mut tracker = Tracker::default();
    let mut seen = Vec::new();
    for frame in 0..30_u16 {
        seen = identities(&mut tracker, u64::from(frame) * FRAME_US, &[at(0.002 * f32::from(frame), 0.0)]);
    }
    let [x, y, z] = seen[0].velocity;
    assert!((x - 0.1).abs() < 1e-3 && y.abs() < 1e-6 && z == 0.0, "{x} {y} {z}");
}

#[test]
fn contacts_are_told_apart_by_the_sum_of_their_ways_not_by_the_closest_pair_alone() {
    let mut tracker = Tracker::default();
    for frame in 0..5 {
        numbers(&mut tracker, frame * FRAME_US, &[at(0.0, 0.0), at(0.02, 0.0)]);
    }
    // Both step by 12 mm: the first comes to lie closer to where the second was than that comes to lie itself.
    assert_eq!(numbers(&mut tracker, 5 * FRAME_US, &[at(0.012, 0.0), at(0.032, 0.0)]), [1, 2]);
}

#[test]
fn more_contacts_than_fit_never_lose_a_track_that_touches() {
    let mut tracker = Tracker::default();
    for frame in 0..10_u16 {
        let contacts: Vec<_> =
            (0..MAX_CONTACTS as u16).map(|i| at(0.1 * f32::from(i), 0.06 * f32::from(frame % 2))).collect();
        let seen = numbers(&mut tracker, u64::from(frame) * FRAME_US, &contacts);
        let different: std::collections::BTreeSet<_> = seen.iter().collect();
        assert_eq!(different.len(), MAX_CONTACTS);
        assert!(tracker.tracks.len() <= MAX_TRACKS);
    }
}

#[test]
fn a_clock_that_stands_still_or_nonsense_places_do_no_harm() {
    let mut tracker = Tracker::default();
    for contact in [at(0.0, 0.0), at(0.001, 0.0), at(f32::NAN, 0.0), at(f32::INFINITY, 0.0)] {
        numbers(&mut tracker, 7, &[contact]);
    }
    numbers(&mut tracker, 0, &[at(0.0, 0.0)]);
    assert!(tracker.tracks.len() <= MAX_TRACKS);
}
