//! `dermatome learn` on a real skin, whose recording is read in place.

use dermatome::{
    learn::{
        Learnt, Request, Strength,
        judge::{ToldApart, board_contacts, judge_board, pairs, told_apart},
        learn,
        presses::{Layout, Positions, Presses, Recording},
    },
    model::Model,
    recorded::{
        order::Arrangement,
        read::{Frames, Source, read},
        weights::by_magnitude,
    },
    skin::{Skin, Weights},
};
use dermatome_shared::patch::PatchView;
use faer::{Mat, linalg::solvers::Solve};
use rand::{SeedableRng, seq::SliceRandom};
use rand_pcg::Pcg64Mcg;
use std::{ffi::OsString, path::Path};

const REAL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/real/hydrogel_skin_wam.npz");
const HYDROGEL: &str = include_str!("data/hydrogel.toml");
const REQUEST: Request = Request { test_share: 0.2, seed: 1, strength: Strength::Response };

fn real(key: &str) -> Frames {
    read(&Source::new(&OsString::from(format!("{REAL}:{key}")))).unwrap()
}

/// The real skin, the model with weights by the measured reference, and presses; none where the recording is absent.
fn hydrogel() -> Option<(Skin, Model, Presses)> {
    if !Path::new(REAL).exists() {
        eprintln!("NOT RUN: hydrogel_skin_wam.npz is absent, so nothing was learnt from real presses");
        return None;
    }
    let mut skin = Skin::parse(Path::new("hydrogel.toml"), HYDROGEL).unwrap().made().unwrap();
    let steps = skin.steps();
    let recording = Recording::read(Path::new(REAL), None, &Layout::default(), &skin).unwrap();
    let map = Arrangement::default().index_map(&steps, 16, 192).unwrap();
    let weights = by_magnitude(&recording.unpressed.mean(), &map, &skin.stimulation().combination);
    skin.inverse.weights = Weights::Each(weights);
    let model = Model::build(&skin, |_| ()).unwrap();
    let presses = recording.on(&model, &Arrangement::default()).unwrap();
    Some((skin, model, presses))
}

#[test]
fn held_out_presses_on_the_real_hydrogel_skin_are_found_within_8_mm() {
    let Some((skin, model, presses)) = hydrogel() else { return };
    let learnt = learn(&skin, &model, &presses, &REQUEST).unwrap();
    let report = &learnt.report;
    println!("{report:#?}");
    let (model_test, test) = (report.model_test.unwrap(), report.test.unwrap());
    assert_eq!((test.presses, test.missed), (80, 0));
    assert!(test.median_mm <= 8.0 && report.validation.median_mm <= 8.0, "{test:?}");
    assert!(test.median_mm < model_test.median_mm);
    assert!(report.conductivity_falls && !report.turn.unwrap().mirrored);
    two_touches_stay_apart(&learnt);
}

/// Pairs of touches, which nothing was learnt from: those of the first kind are about 100 mm apart.
fn two_touches_stay_apart(learnt: &Learnt) {
    for (kind, is_far) in [("multitouchA", true), ("multitouchB", false)] {
        let recording = Recording {
            pressed: real(&format!("{kind}_pressed")),
            unpressed: real(&format!("{kind}_unpressed")),
            positions: Positions::FromAbove(vec![[0.0, 0.0]; 8]),
            forces: None,
        };
        let presses = recording.on(&learnt.model, &Arrangement::default()).unwrap();
        let view = PatchView::validate(&learnt.patch).unwrap();
        for data in &presses.data {
            let contacts = board_contacts(&view, data);
            let places: Vec<_> =
                contacts.iter().map(|contact| contact.position.map(|v| (v * 1e3).round())).collect();
            println!("{kind} {places:?}");
            assert!(contacts.len() == 2 || !is_far, "{places:?}");
        }
    }
}

/// Of presses that nothing was learnt from.
struct HeldOut {
    /// Median error of a board's contacts, mm.
    error_mm: f64,
    /// The same of plain ridge regression from measurements to places.
    ridge_mm: f64,
    /// Share with a second contact on the board.
    seconds: f64,
}

/// Learns from some presses and judges 80 others.
fn held_out(presses: &Presses, skin: &Skin, model: &Model, taught: usize, seed: u64) -> HeldOut {
    let (taught, judged) = shuffled(presses, taught, seed);
    let learnt = learnt_from(presses, &taught, skin, model);
    let view = PatchView::validate(&learnt.patch).unwrap();
    let errors = judge_board(&learnt.model, &view, presses, &judged).unwrap().errors();
    HeldOut {
        error_mm: errors.median_mm,
        ridge_mm: [1e-3, 1e-2, 1e-1, 1.0, 10.0]
            .map(|ridge| ridge_error(presses, &taught, &judged, ridge))
            .into_iter()
            .fold(f64::INFINITY, f64::min),
        seconds: errors.seconds as f64 / errors.presses as f64,
    }
}

/// So many presses to learn from, and 80 others to judge by.
fn shuffled(presses: &Presses, taught: usize, seed: u64) -> (Vec<usize>, Vec<usize>) {
    let mut order: Vec<usize> = (0..presses.count()).collect();
    order.shuffle(&mut Pcg64Mcg::seed_from_u64(seed));
    let judged = order.drain(..80).collect();
    order.truncate(taught);
    (order, judged)
}

fn learnt_from(presses: &Presses, taught: &[usize], skin: &Skin, model: &Model) -> Learnt {
    let some = Presses {
        data: taught.iter().map(|&press| presses.data[press].clone()).collect(),
        places: taught.iter().map(|&press| presses.places[press]).collect(),
        ..presses.clone()
    };
    learn(skin, model, &some, &Request { test_share: 0.0, ..REQUEST }).unwrap()
}

/// Median error of places by ridge regression on data that are divided by their usual sizes and those of the presses, mm.
fn ridge_error(presses: &Presses, taught: &[usize], judged: &[usize], ridge: f64) -> f64 {
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let usual = |m: usize| median(taught.iter().map(|&press| presses.data[press][m].abs()).collect());
    let usual: Vec<f64> = (0..presses.measurements()).map(usual).collect();
    let rows = |which: &[usize]| {
        let mut rows = Mat::from_fn(which.len(), usual.len(), |i, m| presses.data[which[i]][m] / usual[m]);
        for row in rows.row_iter_mut() {
            let size = row.norm_l2();
            row.iter_mut().for_each(|value| *value /= size);
        }
        rows
    };
    let (known, unknown) = (rows(taught), rows(judged));
    let mean =
        |axis: usize| taught.iter().map(|&p| presses.places[p][axis]).sum::<f64>() / taught.len() as f64;
    let mean = [mean(0), mean(1)];
    let mut system = &known * known.transpose();
    (0..taught.len()).for_each(|i| system[(i, i)] += ridge);
    let places = Mat::from_fn(taught.len(), 2, |i, axis| presses.places[taught[i]][axis] - mean[axis]);
    let told = unknown * known.transpose() * system.partial_piv_lu().solve(&places);
    let error = |(i, &press): (usize, &usize)| {
        let apart = |axis: usize| told[(i, axis)] + mean[axis] - presses.places[press][axis];
        apart(0).hypot(apart(1)) * 1e3
    };
    median(judged.iter().enumerate().map(error).collect())
}

#[test]
fn few_presses_teach_a_real_skin() {
    let Some((skin, model, presses)) = hydrogel() else { return };
    println!("presses  median error, mm  best ridge's  second contacts  (80 others, mean of five seeds)");
    for (taught, most) in [(20, 6.5), (50, 4.5), (100, 3.3), (320, 2.6)] {
        let of_seeds: Vec<_> =
            (201..206).map(|seed| held_out(&presses, &skin, &model, taught, seed)).collect();
        let mean = |of: fn(&HeldOut) -> f64| of_seeds.iter().map(of).sum::<f64>() / of_seeds.len() as f64;
        let (error, ridge) = (mean(|seed| seed.error_mm), mean(|seed| seed.ridge_mm));
        let seconds = mean(|seed| seed.seconds);
        let each: Vec<f64> = of_seeds.iter().map(|seed| seed.error_mm).collect();
        println!("{taught:>7} {error:>17.2} {ridge:>13.2} {seconds:>16.4}  {each:.2?}");
        assert!(
            error <= most && error < ridge && seconds <= 0.03,
            "{taught}: {error:.2} {ridge:.2} {seconds:.3}"
        );
    }
}

/// Judges pairs of held-out presses at about this distance, mm, with a board's arithmetic.
fn pairs_at(presses: &Presses, judged: &[usize], learnt: &Learnt, apart_mm: f64) -> ToldApart {
    let view = PatchView::validate(&learnt.patch).unwrap();
    let chosen = pairs(presses, judged, (apart_mm - 3.0) * 1e-3..=(apart_mm + 3.0) * 1e-3, 40);
    told_apart(presses, &chosen, |data| board_contacts(&view, data))
}

#[test]
fn two_touches_at_once_are_told_apart_by_what_single_presses_taught() {
    let Some((skin, model, presses)) = hydrogel() else { return };
    println!("presses  pairs of others told apart at 20 mm, 40 mm, 60 mm, 75 mm  (three seeds)");
    for (taught, least) in [(100, 0.55), (320, 0.5)] {
        let mut sums = [20.0, 40.0, 60.0, 75.0].map(|apart| (apart, ToldApart::default()));
        for seed in 201..204 {
            let (taught, judged) = shuffled(&presses, taught, seed);
            let learnt = learnt_from(&presses, &taught, &skin, &model);
            for (apart, sum) in &mut sums {
                *sum = sum.and(pairs_at(&presses, &judged, &learnt, *apart));
            }
        }
        let share = |(_, sum): (f64, ToldApart)| 1.0 - sum.missed();
        println!("{taught:>7}  {:.2?}", sums.map(share));
        assert!(share(sums[3]) >= least, "{taught}: {sums:?}");
    }
}
