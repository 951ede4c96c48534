//! Tracking: contacts that move keep their numbers on the board ([`dermatome_shared::track`]).
//!
//! Not one of the thesis' experiments: it tracks a point by pressing five places.

use super::{
    ExperimentError, approach,
    plot::{Chart, Series, Style},
    report::{Report, Wanted, largest},
    sample::THREE_SINGLE,
    sample_rig::{Artefacts, SampleRig},
};
use dermatome_shared::contact::Contact;
use dermatome_simulate::{
    Press,
    script::{Moment, Script},
};
use rayon::prelude::*;
use serde_json::json;
use std::{collections::BTreeSet, f64::consts::PI};

/// Frames, and frames in a second.
const FRAMES: u32 = 300;
const RATE: f64 = 50.0;
/// A track belongs to a finger that is so close, share of the diameter.
const CLOSE: f64 = 0.15;

/// What becomes of one finger.
#[derive(Default)]
struct Finger {
    /// Numbers that it had, in order, once for each change.
    ids: Vec<u32>,
    touching: u32,
    tracked: u32,
    /// Distances of its track, share of the diameter.
    errors: Vec<f64>,
    found: Vec<[f64; 2]>,
    truth: Vec<[f64; 2]>,
}

pub(super) fn run() -> Result<Report, ExperimentError> {
    let mut report = Report::new("tracking", "Contacts that move keep their identities");
    report.words(format!(
        "Three fingers on the disc of 210 mm at {RATE} frames per second, {FRAMES} frames: two go \
         round at 80 mm from the middle; the third moves in the middle, is lifted for 0.1 s and keeps its number, then for 1 s and \
         gets a new one. Contacts closer than the experiment two-point says become one, and no tracker tells them apart. Each finger doubles the conductivity beneath it. The board follows them. Artefacts: {}.",
        Artefacts::MOVING.words()
    ));
    let mut skin = THREE_SINGLE.skin()?;
    skin.drive.frame_rate = RATE;
    let mut rig = SampleRig::new(skin, Artefacts::MOVING, 1, 1)?;
    rig.tare(&vec![1.0; rig.elements()]);
    let fingers = scene();
    let presses: Vec<Vec<Option<Press>>> = (0..FRAMES).map(|frame| fingers_at(&fingers, frame)).collect();
    let phasors: Vec<_> = presses
        .par_iter()
        .map(|presses| {
            let touching: Vec<_> = presses.iter().flatten().cloned().collect();
            rig.solve(&rig.truth().conductivity(&touching))
        })
        .collect();
    let mut all_ids = BTreeSet::new();
    let mut of_fingers: Vec<Finger> = fingers.iter().map(|_| Finger::default()).collect();
    for (presses, phasors) in presses.iter().zip(&phasors) {
        let contacts = rig.glance(phasors);
        all_ids.extend(contacts.iter().filter_map(number));
        for (finger, press) in of_fingers.iter_mut().zip(presses) {
            if let Some(press) = press {
                finger.see(press.position, &contacts, rig.side());
            }
        }
    }
    let ghosts = all_ids.iter().filter(|id| !of_fingers.iter().any(|finger| finger.ids.contains(id))).count();
    let mut report = conclude(report, &of_fingers, ghosts)?;
    let approach = approach::show(&mut report, &mut rig)?;
    report.figures["approach"] = approach;
    Ok(report)
}

fn conclude(mut report: Report, fingers: &[Finger], ghosts: usize) -> Result<Report, ExperimentError> {
    let changes: Vec<usize> = fingers.iter().map(|finger| finger.ids.len().saturating_sub(1)).collect();
    // The third finger's second absence is longer than a track waits.
    let wrong: usize = changes.iter().zip([0, 0, 1]).map(|(&found, right)| found.abs_diff(right)).sum();
    let [touching, tracked] =
        [|f: &Finger| f.touching, |f: &Finger| f.tracked].map(|of| fingers.iter().map(of).sum::<u32>());
    let share = 100.0 * f64::from(tracked) / f64::from(touching);
    let errors: Vec<f64> = fingers.iter().flat_map(|finger| finger.errors.clone()).collect();
    let mean = 100.0 * errors.iter().sum::<f64>() / errors.len().max(1) as f64;
    report.compare("identities wrong", "", None, wrong as f64, Some(Wanted::AtMost(0.0)));
    report.compare("finger frames with a track", "%", None, share, Some(Wanted::AtLeast(98.0)));
    report.compare("tracks that are no finger's", "", None, ghosts as f64, None);
    report.compare("distance of a track from its finger, mean", "%", None, mean, None);
    let rows = (1..).zip(fingers).map(|(number, finger)| {
        let ids: Vec<_> = finger.ids.iter().map(ToString::to_string).collect();
        vec![
            format!("finger {number}"),
            finger.touching.to_string(),
            finger.tracked.to_string(),
            ids.join(", then "),
            format!("{:.1}", 100.0 * largest(finger.errors.iter().copied())),
        ]
    });
    let columns = ["", "frames that touch", "with a track", "its numbers", "largest distance, %"];
    report.table("Each finger", &columns, rows.collect());
    let in_mm = |points: &[[f64; 2]]| points.iter().map(|point| point.map(|by| by * 1e3)).collect();
    let series = (1..).zip(fingers).flat_map(|(number, finger)| {
        [
            Series::new(format!("finger {number}"), in_mm(&finger.truth), Style::Line),
            Series::new(format!("its track {number}"), in_mm(&finger.found), Style::Marks),
        ]
    });
    report.words(
        "Tracks that are no finger's: artefacts that rise above a quarter of the largest change for some frames. A robot should \
         wait for a track to last before it believes it.",
    );
    report.plots(&[Chart {
        title: "Fingers and their tracks",
        x: "x, mm",
        y: "y, mm",
        series: series.collect(),
        square: Some(145.0),
    }])?;
    report.figures = json!({
        "identities_wrong": wrong,
        "tracks_without_finger": ghosts,
        "tracked_percent": share,
        "distance_percent": { "mean": mean, "max": 100.0 * largest(errors) },
        "numbers": fingers.iter().map(|finger| &finger.ids).collect::<Vec<_>>(),
    });
    Ok(report)
}

impl Finger {
    fn see(&mut self, at: [f64; 2], contacts: &[Contact], side: f64) {
        self.touching += 1;
        self.truth.push(at);
        let distance = |contact: &Contact| {
            let [x, y] = contact.from_above();
            (x - at[0]).hypot(y - at[1]) / side
        };
        let nearest = contacts.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let Some(contact) = nearest.filter(|contact| distance(contact) < CLOSE) else { return };
        self.tracked += 1;
        self.errors.push(distance(contact));
        self.found.push(contact.from_above());
        if let Some(number) = number(contact)
            && self.ids.last() != Some(&number)
        {
            self.ids.push(number);
        }
    }
}

fn number(contact: &Contact) -> Option<u32> {
    Some(contact.identity?.number)
}

/// Scripts of the three fingers, touch by touch.
fn scene() -> Vec<Vec<Vec<Moment>>> {
    let moment = |time: f64, position: [f64; 2]| Moment { time, press: Press::finger(position, 0.015, 1.0) };
    // An arc of 160 degrees from this angle on.
    let round = |from: f64| {
        let at = |i: u32| {
            let turn = from + 160_f64.to_radians() * f64::from(i) / 40.0;
            moment(0.1 + 5.8 * f64::from(i) / 40.0, [0.08 * turn.cos(), 0.08 * turn.sin()])
        };
        vec![(0..=40).map(at).collect()]
    };
    let touches = [(0.5, 1.5, -0.012), (1.6, 3.0, -0.004), (4.0, 5.9, 0.008)];
    let touch = |(from, to, y): (f64, f64, f64)| vec![moment(from, [0.0, y]), moment(to, [0.0, y + 0.008])];
    vec![round(0.2), round(0.2 + PI), touches.map(touch).into()]
}

/// Each finger in a frame, where it touches.
fn fingers_at(fingers: &[Vec<Vec<Moment>>], frame: u32) -> Vec<Option<Press>> {
    let time = f64::from(frame) / RATE;
    let at = |touches: &Vec<Vec<Moment>>| touches.iter().find_map(|moments| Script::at(moments, time));
    fingers.iter().map(at).collect()
}
