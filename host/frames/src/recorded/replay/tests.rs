use super::*;
use crate::recorded::order::SenseOrder;
use dermatome_model::{model::Model, quantize, skin::Skin};
use dermatome_recording::play::Player;
use dermatome_shared::{
    contact::Contacts,
    frame::Frame,
    pipeline::{Outcome, PipelineState, process},
};
use dermatome_simulate::{Noise, Press, rig::Rig};
use std::path::Path;

/// What a rig scanned: untouched frames, then a press that comes and goes.
struct Scanned {
    patch: Vec<u8>,
    frames: Vec<Frame>,
}

const UNTOUCHED: usize = 20;

/// What stands in the skin file for contacts.
const IN_VOLTAGES: &str = "threshold = 0.05";
const IN_IMAGE: &str = "threshold = 0.1\nfound_in = \"image\"";

fn scanned(contact: &str) -> Scanned {
    let text = include_str!("../../../../../models/square-50mm/skin.toml");
    let text = text.replace(IN_VOLTAGES, contact);
    let mut skin = Skin::parse(Path::new("skin.toml"), &text).unwrap().made().unwrap();
    skin.edges = skin.edges.scaled(2.0);
    let patch = quantize::patch(&skin, &Model::build(&skin, |_| ()).unwrap()).unwrap();
    let view = PatchView::validate(&patch).unwrap();
    let mut rig = Rig::new(&skin, &view, Noise { snr_db: 60.0, seed: 5 }).unwrap();
    let presses = |number: usize| match number {
        ..UNTOUCHED | 40.. => vec![],
        _ => vec![Press::finger([0.008, -0.005], 0.004, 0.6)],
    };
    let frames = (0..50).map(|number| rig.press(&presses(number))).collect();
    Scanned { patch, frames }
}

/// The frames as an instrument of complex gain `gain` files them, row by row.
fn filed(scanned: &Scanned, gain: Complex64, arrangement: &Arrangement) -> Frames {
    let view = PatchView::validate(&scanned.patch).unwrap();
    let steps: Vec<_> = view.steps().collect();
    let map = arrangement.index_map(&steps, view.header.electrodes, steps.len()).unwrap();
    let mut values = vec![Complex64::ZERO; steps.len() * scanned.frames.len()];
    for (frame, row) in scanned.frames.iter().zip(values.chunks_exact_mut(steps.len())) {
        for (place, code) in map.iter().zip(&frame.codes) {
            row[place.index] = gain * if place.flipped { -1.0 } else { 1.0 } * f64::from(code.0);
        }
    }
    Frames { values, frames: scanned.frames.len(), measurements: steps.len(), complex: gain.im != 0.0 }
}

/// Numbers of the frames with a contact, and the mean place of all contacts, mm.
fn seen(contacts: impl Iterator<Item = (usize, Contacts)>) -> (Vec<usize>, [f32; 2]) {
    let (mut numbers, mut sum) = (Vec::new(), [0.0; 2]);
    for (number, contacts) in contacts.filter(|(_, contacts)| !contacts.is_empty()) {
        assert_eq!(contacts.len(), 1, "{contacts:?}");
        numbers.push(number);
        sum = [0, 1].map(|axis| sum[axis] + contacts[0].position[axis] * 1e3);
    }
    let count = numbers.len() as f32;
    (numbers, sum.map(|sum| sum / count))
}

/// What a board sees.
fn on_board(scanned: &Scanned) -> (Vec<usize>, [f32; 2]) {
    let view = PatchView::validate(&scanned.patch).unwrap();
    let mut state = PipelineState::default();
    state.start_tare(UNTOUCHED as u16);
    let see = |(number, frame): (usize, &Frame)| {
        (process(&view, &mut state, frame) == Outcome::Image).then(|| (number, state.contacts().clone()))
    };
    seen(scanned.frames.iter().enumerate().filter_map(see))
}

fn replayed(
    scanned: &Scanned,
    frames: &Frames,
    untouched: Untouched<'_>,
    arrangement: &Arrangement,
) -> (Vec<usize>, [f32; 2]) {
    let view = PatchView::validate(&scanned.patch).unwrap();
    let mut replay = Replay::new(&view, frames, untouched, arrangement, &Times::Rate(50.0)).unwrap();
    let items: Vec<Item> = replay.by_ref().map(Result::unwrap).collect();
    let mut player = Player::new(&view, &view.steps().collect::<Vec<_>>()).unwrap();
    let played = items.iter().filter_map(|item| player.take(item).unwrap());
    seen(played.map(|it| (replay.in_file(it.at).sequence as usize, it.contacts)))
}

#[test]
fn a_recording_shows_what_the_board_saw_whatever_instrument_took_it() {
    let turned = Arrangement { sense: SenseOrder::Relative, rotation: 5, mirrored: true };
    let phase = Complex64::from_polar(3e-4, 2.5);
    for contact in [IN_VOLTAGES, IN_IMAGE] {
        let scanned = scanned(contact);
        let (frames, [x, y]) = on_board(&scanned);
        assert!(frames.len() >= 19 && frames[0] < 22, "{frames:?}");
        for (gain, arrangement) in
            [(1e-3.into(), Arrangement::default()), (phase, Arrangement::default()), (phase, turned)]
        {
            let file = filed(&scanned, gain, &arrangement);
            let (numbers, [found_x, found_y]) =
                replayed(&scanned, &file, Untouched::First(UNTOUCHED), &arrangement);
            assert_eq!(numbers, frames, "{arrangement:?}");
            assert!((found_x - x).hypot(found_y - y) < 0.02, "{found_x} {x} {found_y} {y}");
        }
    }
}

#[test]
fn magnitudes_and_a_reference_of_its_own_show_the_same() {
    let scanned = scanned(IN_VOLTAGES);
    let (_, [x, y]) = on_board(&scanned);
    let mut all = filed(&scanned, 1.0.into(), &Arrangement::default());
    all.values.iter_mut().for_each(|value| *value = value.norm().into());
    let part = |which: Range<usize>| Frames {
        values: all.values[which.start * all.measurements..which.end * all.measurements].to_vec(),
        frames: which.len(),
        ..all
    };
    let (untouched, pressed) = (part(0..UNTOUCHED), part(UNTOUCHED..40));
    let (numbers, [found_x, found_y]) =
        replayed(&scanned, &pressed, Untouched::Apart(&untouched), &Arrangement::default());
    assert!(numbers.len() >= 19, "{numbers:?}");
    assert!((found_x - x).hypot(found_y - y) < 0.02, "{found_x} {x} {found_y} {y}");
}

#[test]
fn each_frame_can_have_a_reference_of_its_own() {
    let scanned = scanned(IN_IMAGE);
    let (_, [x, y]) = on_board(&scanned);
    let all = filed(&scanned, 1.0.into(), &Arrangement::default());
    // The instrument's gain is another one for each press, and so are those of the measurements.
    let gain = |row: usize, m: usize| 1.0 + 0.3 * ((row * 7 + m * 3) as f64).sin();
    let rows = |first: usize| Frames {
        values: (0..10)
            .flat_map(|row| (0..all.measurements).map(move |m| (row, m)))
            .map(|(row, m)| all.values[(first + row) * all.measurements + m] * gain(row, m))
            .collect(),
        frames: 10,
        ..all
    };
    let (untouched, pressed) = (rows(5), rows(25));
    let (numbers, [found_x, found_y]) =
        replayed(&scanned, &pressed, Untouched::Each(&untouched), &Arrangement::default());
    assert_eq!(numbers, (0..10).collect::<Vec<_>>());
    assert!((found_x - x).hypot(found_y - y) < 0.5, "{found_x} {x} {found_y} {y}");
}

#[test]
fn what_cannot_be_replayed_is_refused() {
    let scanned = scanned(IN_VOLTAGES);
    let view = PatchView::validate(&scanned.patch).unwrap();
    let file = filed(&scanned, 1.0.into(), &Arrangement::default());
    let refused = |frames: &Frames, untouched, times| {
        Replay::new(&view, frames, untouched, &Arrangement::default(), &times).unwrap_err()
    };
    let (first, rate) = (Untouched::First(20), Times::Rate(50.0));
    let short = Frames { measurements: file.measurements / 2, frames: file.frames * 2, ..file.clone() };
    assert!(matches!(refused(&short, first, rate.clone()), ReplayError::Order(OrderError::Length { .. })));
    let lengths = refused(&file, Untouched::Apart(&short), rate.clone());
    assert!(matches!(lengths, ReplayError::Lengths { .. }), "{lengths}");
    for wanted in [0, 50, 2000] {
        let error = refused(&file, Untouched::First(wanted), rate.clone());
        assert_eq!(error, ReplayError::First { wanted, frames: 50 });
    }
    assert_eq!(refused(&file, Untouched::Each(&file), rate.clone()), ReplayError::Noise);
    let one = Frames { values: file.values[..file.measurements].to_vec(), frames: 1, ..file.clone() };
    let rows = refused(&file, Untouched::Each(&one), rate);
    assert_eq!(rows, ReplayError::Rows { what: "frames of the untouched skin", found: 1, frames: 50 });
    for wrong in [0.0, -1.0, f64::NAN, 1e7] {
        assert!(matches!(refused(&file, first, Times::Rate(wrong)), ReplayError::Rate(_)));
    }
    let times = |change: fn(&mut Vec<f64>)| {
        let mut times = (0..50).map(f64::from).collect();
        change(&mut times);
        refused(&file, first, Times::Each(times))
    };
    assert!(matches!(times(|times| times[7] = 3.0), ReplayError::Time { frame: 7, .. }));
    assert!(matches!(times(|times| times[0] = -1.0), ReplayError::Time { frame: 0, .. }));
    assert!(matches!(times(|times| times[9] = f64::NAN), ReplayError::Time { frame: 9, .. }));
    assert!(matches!(times(|times| times.truncate(3)), ReplayError::Rows { what: "times", found: 3, .. }));
    let silent = Frames { values: vec![Complex64::ZERO; file.values.len()], ..file.clone() };
    assert_eq!(refused(&file, Untouched::Apart(&silent), Times::Rate(1.0)), ReplayError::NoVoltage(0));
}

#[test]
fn complex_frames_have_no_signs_for_plain_differences() {
    let text = include_str!("../../../../../models/square-50mm/skin.toml");
    assert!(text.contains("normalised = true"));
    let text = text.replace("normalised = true", "normalised = false");
    let mut skin = Skin::parse(Path::new("skin.toml"), &text).unwrap().made().unwrap();
    skin.edges = skin.edges.scaled(2.0);
    let patch = quantize::patch(&skin, &Model::build(&skin, |_| ()).unwrap()).unwrap();
    let view = PatchView::validate(&patch).unwrap();
    let steps = view.steps().count();
    let frames =
        |complex| Frames { values: vec![Complex64::ONE; 4 * steps], frames: 4, measurements: steps, complex };
    let replay = |complex| {
        let (frames, arrangement) = (frames(complex), Arrangement::default());
        Replay::new(&view, &frames, Untouched::First(2), &arrangement, &Times::Rate(1.0)).err()
    };
    assert_eq!(replay(true), Some(ReplayError::Signs));
    assert_eq!(replay(false), None);
}

#[test]
fn numbers_and_times_of_a_board_count_the_untouched_frames_of_another_file() {
    let scanned = scanned(IN_IMAGE);
    let view = PatchView::validate(&scanned.patch).unwrap();
    let all = filed(&scanned, 1.0.into(), &Arrangement::default());
    let part =
        |frames: usize| Frames { values: all.values[..frames * all.measurements].to_vec(), frames, ..all };
    let (three, ten) = (part(3), part(10));
    let stamps = |untouched: Untouched<'_>| -> Vec<(u32, u64, u32)> {
        let times = Times::Each(vec![5.0, 5.1, 5.2]);
        let mut replay = Replay::new(&view, &three, untouched, &Arrangement::default(), &times).unwrap();
        let items: Vec<Item> = replay.by_ref().map(Result::unwrap).collect();
        assert!((replay.drive().frame_rate - 10.0).abs() < 1e-3, "{:?}", replay.drive());
        assert!(matches!(items[0], Item::Reference(_)));
        let stamp = |item: &Item| match item {
            Item::Frame(frame) => {
                assert_eq!(frame.log_time - replay.begun(), (frame.at.timestamp_us - 5_000_000) * 1000);
                Some((frame.at.sequence, frame.at.timestamp_us, replay.in_file(frame.at).sequence))
            }
            Item::Reference(_) => None,
        };
        items.iter().filter_map(stamp).collect()
    };
    assert_eq!(stamps(Untouched::First(1)), [(0, 5_000_000, 0), (1, 5_100_000, 1), (2, 5_200_000, 2)]);
    let apart = stamps(Untouched::Apart(&ten));
    assert_eq!(apart[..2], [(0, 5_000_000, 0), (1, 5_100_000, 0)]);
    assert_eq!(apart[10..], [(10, 6_000_000, 0), (11, 6_100_000, 1), (12, 6_200_000, 2)]);
    let each = [(0, 5_000_000, 0), (1, 5_100_000, 0), (2, 5_200_000, 1), (3, 5_300_000, 1)];
    assert_eq!(stamps(Untouched::Each(&three))[..4], each);
    assert_eq!(stamps(Untouched::Each(&three))[5], (5, 5_500_000, 2));
}
