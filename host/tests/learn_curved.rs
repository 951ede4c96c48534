//! `learn` on curved skins that their model does not know, beside the built patch and regressions on the same presses.
#![cfg(unix)]

mod distances;
mod peers;
mod program;

use dermatome::{
    inverse::targets::half_side,
    learn::{
        Request, Strength, learn,
        presses::{Positions, Presses, Recording},
    },
    model::Model,
    presses::{RecordedPresses, of_odd_skin},
    quantize,
    recorded::{
        order::Arrangement,
        read::Frames,
        replay::{Replay, Times, Untouched},
    },
    recording::play::Player,
    simulate::Noise,
    skin::Skin,
};
use dermatome_shared::{contact::Contacts, patch::PatchView};
use nalgebra::{Point3, Vector3};
use num_complex::Complex64;
use peers::{Features, regression, some_of};
use program::{Desk, TINY, row, transcript};
use std::{collections::BTreeSet, f64::consts::TAU, path::Path};

/// Presses that nothing is learnt from.
const JUDGED: usize = 80;

fn shipped(name: &str) -> Skin {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../models/{name}/skin.toml"));
    Skin::load(&file).unwrap().made().unwrap()
}

/// A bent tube that narrows, mm, as STL.
fn tube() -> Vec<u8> {
    let (rings, around, bend) = (40, 72, 0.6_f64);
    let at = |i: usize, j: usize| {
        let (share, turn) = (i as f64 / rings as f64, TAU * (j % around) as f64 / around as f64);
        let (angle, radius) = (bend * share, 55.0 - 17.0 * share);
        let centre = Vector3::new(1.0 - angle.cos(), 0.0, angle.sin()) * (260.0 / bend);
        let across = Vector3::new(angle.cos(), 0.0, -angle.sin());
        centre + (across * turn.cos() + Vector3::y() * turn.sin()) * radius
    };
    let mut bytes = vec![0; 80];
    bytes.extend(((2 * rings * around) as u32).to_le_bytes());
    for (i, j) in (0..rings).flat_map(|i| (0..around).map(move |j| (i, j))) {
        for corners in [[(i, j), (i, j + 1), (i + 1, j + 1)], [(i, j), (i + 1, j + 1), (i + 1, j)]] {
            bytes.extend([0; 12]);
            let corners = corners.map(|(i, j)| at(i, j));
            corners.iter().flat_map(|it| it.iter()).for_each(|it| bytes.extend((*it as f32).to_le_bytes()));
            bytes.extend([0; 2]);
        }
    }
    bytes
}

/// Reaches round half of such a tube.
const SIDE: [&str; 2] = ["--radius", "75"];
/// Reaches round all of it but for a gap, across which places are near in space and far along the skin.
const SLEEVE: [&str; 4] = ["--between-planes", "0,0,1,60,170", "--between-planes", "1,0,0,-100,55"];

/// A skin cut out of such a tube.
fn cut(region: &[&str]) -> Skin {
    let desk = Desk::empty();
    desk.write("forearm.stl", tube());
    let command = [
        "cut",
        "forearm.stl",
        "--unit",
        "mm",
        "--around",
        "-45,0,110",
        "--out",
        "skin",
        "--edge-length",
        "3.5",
    ];
    desk.run(&[&command[..], region].concat()).success();
    Skin::load(&desk.path("skin/skin.toml")).unwrap().made().unwrap()
}

/// Presses of a finger at 60 dB.
fn recorded(skin: &Skin, count: usize, seed: u64) -> RecordedPresses {
    of_odd_skin(skin, count, Noise { snr_db: 60.0, seed }).unwrap()
}

/// Median and 90 % error, mm.
type Figures = [f64; 2];

fn figures(mut errors: Vec<f64>) -> Figures {
    errors.sort_by(f64::total_cmp);
    [0.5, 0.9].map(|share: f64| errors[(share * (errors.len() - 1) as f64).round() as usize])
}

/// A skin unlike its model, and presses on it.
struct Odd<'a> {
    skin: &'a Skin,
    model: Model,
    recording: Recording,
    untouched: Frames,
    presses: Presses,
}

impl<'a> Odd<'a> {
    fn new(skin: &'a Skin, count: usize, seed: u64) -> Self {
        let model = Model::build(skin, |_| ()).unwrap();
        let RecordedPresses { recording, untouched } = recorded(skin, count, seed);
        let presses = recording.on(&model, &Arrangement::default()).unwrap();
        Self { skin, model, recording, untouched, presses }
    }

    /// What a board says of a press that it sees in three frames after the untouched ones.
    fn replayed(&self, patch: &PatchView<'_>, press: usize) -> Contacts {
        let row = self.recording.pressed.iter().nth(press).unwrap();
        let held = Frames { values: row.repeat(3), frames: 3, ..self.recording.pressed.clone() };
        let untouched = Untouched::Apart(&self.untouched);
        let replay =
            Replay::new(patch, &held, untouched, &Arrangement::default(), &Times::Rate(50.0)).unwrap();
        let steps: Vec<_> = patch.steps().collect();
        let mut player = Player::new(patch, &steps).unwrap();
        replay.filter_map(|item| player.take(&item.unwrap()).unwrap()).last().unwrap().contacts
    }

    /// Errors of the strongest contacts of the judged presses, and the share of these that are not one contact.
    fn on_board(&self, patch: &[u8]) -> (Figures, f64) {
        let patch = PatchView::validate(patch).unwrap();
        let (mut not_one, mut lifted, mut errors) = (0.0, Vec::new(), Vec::new());
        for (press, place) in self.presses.places.iter().take(JUDGED).enumerate() {
            let contacts = self.replayed(&patch, press);
            not_one += f64::from(u8::from(contacts.len() != 1)) / JUDGED as f64;
            let strongest = contacts.first().map(|contact| Point3::from(contact.position.map(f64::from)));
            lifted.extend(strongest.map(|at| (self.model.mesh.nearest(at) - at).norm() * 1e3));
            errors.push(strongest.map_or(2.0 * half_side(&self.model.mesh), |at| (at - place).norm()) * 1e3);
        }
        // Contacts lie on the plane of the pixel nearest to the mean of theirs, which leaves a curved skin farther out.
        let [_, nine_in_ten] = figures(lifted.clone());
        let farthest = lifted.into_iter().fold(0.0, f64::max);
        assert!(nine_in_ten < 2.5 && farthest < 6.0, "contacts {nine_in_ten} and {farthest} mm off the skin");
        (figures(errors), not_one)
    }

    fn compared(&self, count: usize) -> Compared {
        let (judged, taught) =
            (some_of(&self.presses, 0..JUDGED), some_of(&self.presses, JUDGED..JUDGED + count));
        let request = Request { test_share: 0.0, seed: 1, strength: Strength::Response };
        let learnt = learn(self.skin, &self.model, &taught, &request).unwrap();
        let lay = |told: Point3<f64>| self.model.mesh.nearest(told);
        let ridges = [Features::Linear, Features::Direction, Features::Logarithm]
            .map(|kind| figures(regression(&taught, &judged, kind, false, lay)));
        let (learnt, not_one) = self.on_board(&learnt.patch);
        let (built, built_not_one) = self.on_board(&quantize::patch(self.skin, &self.model).unwrap());
        Compared {
            learnt,
            built,
            ridge: ridges.into_iter().min_by(|a, b| a[0].total_cmp(&b[0])).unwrap(),
            kernel: figures(regression(&taught, &judged, Features::Direction, true, lay)),
            not_one: [not_one, built_not_one],
        }
    }
}

/// Of held-out presses.
struct Compared {
    /// Of the learnt patch, on a board.
    learnt: Figures,
    /// Of the patch of `build`, on a board.
    built: Figures,
    /// Of the best of three ridge regressions.
    ridge: Figures,
    kernel: Figures,
    /// Shares of presses that the learnt and the built patch show as another number of contacts than one.
    not_one: [f64; 2],
}

/// Numbers that the environment gives in place of these, as `LEARN_SEEDS=501,502`.
fn numbers(name: &str, default: &[u64]) -> Vec<u64> {
    let given = std::env::var(name).ok();
    let numbers = given.map(|given| given.split(',').map(|number| number.trim().parse().unwrap()).collect());
    numbers.unwrap_or_else(|| default.to_vec())
}

/// Learning on so many presses of skins that nothing was developed on. With `LEARN_SEEDS=501,502,503,504,505
/// LEARN_PRESSES=50,100,200` it prints the table of docs/cli.md. The median error is below three quarters of that of the best
/// ridge regression, and below this share of that of the built patch.
fn is_learnt(name: &str, skin: &Skin, most_of_built: f64) {
    let counts = numbers("LEARN_PRESSES", &[50]);
    let most = *counts.iter().max().unwrap() as usize;
    let skins: Vec<Odd<'_>> =
        numbers("LEARN_SEEDS", &[501]).into_iter().map(|seed| Odd::new(skin, JUDGED + most, seed)).collect();
    println!(
        "median / 90 % error, mm      presses   learnt        built         best ridge    kernel ridge  not one contact"
    );
    let mut is_better = true;
    for count in counts {
        let all: Vec<Compared> = skins.iter().map(|odd| odd.compared(count as usize)).collect();
        let mean = |of: &dyn Fn(&Compared) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
        let both = |of: &dyn Fn(&Compared) -> Figures| [0, 1].map(|i| mean(&|one| of(one)[i]));
        let [learnt, built] = [both(&|one| one.learnt), both(&|one| one.built)];
        let [ridge, kernel] = [both(&|one| one.ridge), both(&|one| one.kernel)];
        let table = [learnt, built, ridge, kernel]
            .map(|[median, most]| format!("{median:>5.1} /{most:>6.1}"))
            .join(" ");
        println!("{name:<28} {count:>7} {table}  {:.3?}", both(&|one| one.not_one));
        is_better &= learnt[0] < (0.75 * ridge[0]).min(most_of_built * built[0]) && learnt[1] < ridge[1];
    }
    assert!(is_better, "{name}: the learnt patch is no better than the built one or ridge regression");
}

#[test]
fn a_hemisphere_with_electrodes_on_its_rim_is_learnt() {
    is_learnt("hemisphere-210mm", &shipped("hemisphere-210mm"), 1.0);
}

#[test]
fn a_hemisphere_with_electrodes_inside_is_learnt() {
    // The built patch, which finds contacts in the voltages, is no worse there.
    is_learnt("hemisphere-210mm-designed", &shipped("hemisphere-210mm-designed"), 1.5);
}

#[test]
fn a_skin_cut_out_of_one_side_of_a_tube_is_learnt() {
    is_learnt("side of a tube", &cut(&SIDE), 0.8);
}

#[test]
fn a_sleeve_round_a_tube_is_learnt() {
    is_learnt("sleeve with a gap", &cut(&SLEEVE), 0.9);
}

/// A small half sphere of 8 electrodes.
fn dome_text() -> String {
    let text = TINY.replace("name = \"tiny\"", "name = \"dome\"");
    let text = text.replace("kind = \"disc\"", "kind = \"hemisphere\"");
    text.replace("columns = 16", "pixels = 200")
}

fn dome() -> Skin {
    Skin::parse(Path::new("dome.toml"), &dome_text()).unwrap().made().unwrap()
}

#[test]
fn presses_are_laid_on_the_nearest_point_of_the_skin() {
    let skin = dome();
    let model = Model::build(&skin, |_| ()).unwrap();
    let mut recording = recorded(&skin, 3, 1).recording;
    // 2 mm above the top, 2 mm beneath a place half way down, and 2 mm below the rim.
    let down = 0.048 / 2f64.sqrt();
    recording.positions = Positions::InSpace(vec![[0.0, 0.0, 0.052], [down, 0.0, down], [0.05, 0.0, -0.002]]);
    let presses = recording.on(&model, &Arrangement::default()).unwrap();
    let half_way = 0.05 / 2f64.sqrt();
    let on_skin = [[0.0, 0.0, 0.05], [half_way, 0.0, half_way], [0.05, 0.0, 0.0]].map(Point3::from);
    for (place, wanted) in presses.places.iter().zip(on_skin) {
        // Triangles lie beneath the sphere.
        assert!((place - wanted).norm() < 8e-4, "{place} {wanted}");
    }
    let off = presses.off.unwrap();
    assert!((off.farthest_mm - 2.0).abs() < 0.6 && off.allowed_mm > 8.0 && off.median_mm > 1.2, "{off:?}");
}

/// A table of presses, x, y, z and the measurements, and one of the untouched skin.
fn write_tables(desk: &Desk, recording: &Recording) {
    let Positions::InSpace(places) = &recording.positions else { panic!("no places in space") };
    let line = |(frame, place): (&[Complex64], &[f64; 3])| {
        row(&place.iter().copied().chain(frame.iter().map(|value| value.re)).collect::<Vec<_>>())
    };
    desk.write("presses.csv", recording.pressed.iter().zip(places).map(line).collect::<String>());
    desk.write("idle.csv", row(&recording.unpressed.values.iter().map(|value| value.re).collect::<Vec<_>>()));
}

#[test]
fn a_learnt_patch_of_a_curved_skin_is_replayed_with_contacts_on_the_skin() {
    let (desk, skin) = (Desk::empty(), dome());
    desk.write("skin.toml", dome_text());
    let RecordedPresses { recording, untouched } = recorded(&skin, 60, 2);
    write_tables(&desk, &recording);
    let rows = |frames: &Frames| {
        let text = |frame: &[Complex64]| row(&frame.iter().map(|value| value.re).collect::<Vec<_>>());
        frames.iter().map(text).collect::<String>()
    };
    desk.write("touch.csv", rows(&recording.pressed));
    desk.write("untouched.csv", rows(&untouched));
    let command =
        ["learn", "skin.toml", "--presses", "presses.csv", "--reference", "idle.csv", "--json", "learn.json"];
    let done = desk.run(&command).success();
    assert!(done.out.contains("laid          on the skin, "), "{}", done.out);
    let report = desk.report("learn.json");
    let farthest = report["off_skin"]["farthest_mm"].as_f64().unwrap();
    assert!((2.5..3.2).contains(&farthest), "{report}");
    let [learnt, built] = ["test", "model_test"].map(|test| report[test]["median_mm"].as_f64().unwrap());
    assert!(learnt < 0.7 * built, "{learnt} {built}");
    let replay =
        ["replay", "touch.csv", "--patch", "dome.dermatome", "--reference", "untouched.csv", "--rate", "50"];
    let done = desk.run(&replay).success();
    let Positions::InSpace(places) = &recording.positions else { panic!("no places in space") };
    let (mut seen, mut near) = (BTreeSet::new(), 0);
    for line in done.out.lines() {
        let cells: Vec<f64> = line.split('\t').map_while(|cell| cell.parse().ok()).collect();
        let (press, at) = (cells[0] as usize, Point3::new(cells[2], cells[3], cells[4]));
        assert!((at.coords.norm() - 50.0).abs() < 2.0, "{line}");
        // Of several contacts the first is the strongest.
        if seen.insert(press) {
            near += usize::from((at - Point3::from(places[press]) * 1e3).norm() < 15.0);
        }
    }
    let seen = seen.len();
    assert!(seen >= 57 && near >= 54, "{near} of {seen} near");
}

#[test]
fn wrong_presses_on_a_curved_skin_are_refused_with_press_value_and_what_is_allowed() {
    let desk = Desk::empty();
    desk.write("skin.toml", dome_text());
    write_tables(&desk, &recorded(&dome(), 12, 3).recording);
    let table = String::from_utf8(desk.read("presses.csv")).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    let first = |place: &str| {
        let rest: Vec<&str> = lines[0].split(',').skip(3).collect();
        [&[format!("{place},{}", rest.join(",")).as_str()], &lines[1..]].concat().join("\n")
    };
    let columns = |from: usize, to: usize| {
        lines
            .iter()
            .map(|line| line.split(',').skip(from).take(to).collect::<Vec<_>>().join(",") + "\n")
            .collect::<String>()
    };
    desk.write("without-z.csv", columns(1, 42));
    desk.write("columns.csv", columns(0, 30));
    desk.write("above.csv", first("0,0.01,0.065"));
    desk.write("millimetres.csv", first("0,10,48"));
    desk.write("few.csv", lines[..9].join("\n"));
    let files = ["without-z.csv", "columns.csv", "above.csv", "millimetres.csv", "few.csv", "none.csv"];
    let commands = files.map(|file| ["learn", "skin.toml", "--presses", file, "--reference", "idle.csv"]);
    let commands: Vec<&[&str]> = commands.iter().map(|command| &command[..]).collect();
    let mut settings = insta::Settings::clone_current();
    settings.set_omit_expression(true);
    // The nearest point is one of a mesh, and rounding may change that.
    settings.add_filter(r"nearest point is \([^)]*\) m", "nearest point is [POINT] m");
    settings.bind(|| insta::assert_snapshot!("errors_learn_curved", transcript(&desk, &commands)));
    assert!(!desk.files().contains(&"dome.dermatome".to_owned()));
}

#[test]
fn presses_without_z_in_an_archive_are_refused_on_a_curved_skin() {
    let skin = dome();
    let model = Model::build(&skin, |_| ()).unwrap();
    let mut recording = recorded(&skin, 3, 1).recording;
    recording.positions = Positions::FromAbove(vec![[0.01, 0.02]; 3]);
    let words = recording.on(&model, &Arrangement::default()).unwrap_err().to_string();
    assert!(words.contains("x and y only") && words.contains("allowed there: x, y and z"), "{words}");
}
