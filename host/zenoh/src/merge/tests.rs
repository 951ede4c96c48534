use super::*;
use crate::message::Version;
use dermatome_body::contact::{SkinContact, Wrench};
use dermatome_shared::{contact::Contact, frame::FrameFlags, protocol::FrameStamp};

const START: u64 = 1_700_000_000_000_000_000;

fn space(patch: &str) -> Space {
    Space { robot: "arm".to_owned(), link: "palm".to_owned(), patch: patch.to_owned() }
}

fn stamp(run: u64, number: u64) -> Stamp {
    Stamp { version: Version::OURS, run, number }
}

fn pressed(force: f64) -> SkinContact {
    let contact = Contact {
        position: [0.1, 0.0, 0.0],
        normal: [0.0, 0.0, 1.0],
        area: 1e-4,
        strength: 0.5,
        peak: 1.0,
        pressure: None,
        load_area: None,
        evidence: None,
        identity: None,
    };
    let wrench = Some(Wrench { force: [0.0, 0.0, -force], moment: [0.0; 3] });
    SkinContact { contact, geometric_centre: [0.1, 0.0, 0.0], wrench, pixels: Vec::new() }
}

/// Contacts whose scan ended 3 ms before they came, by their computer's clock that is `ahead` ns ahead.
fn contacts(patch: &str, run: u64, number: u64, ahead: u64) -> Heard {
    let received_ns = START + number * 10_000_000;
    let at =
        FrameStamp { sequence: number as u32, timestamp_us: number * 10_000, flags: FrameFlags::default() };
    let ended_ns = received_ns - 3_000_000 + ahead;
    let contacts = Box::new(Contacts { at, ended_ns, missing: 7, contacts: vec![pressed(2.0)] });
    Heard::Contacts { space: space(patch), stamp: stamp(run, number), contacts, received_ns }
}

fn state(patch: &str, run: u64, computer: &str, phase: Phase) -> Heard {
    let (computer, text) = (computer.to_owned(), String::new());
    let state = State { computer, phase, text, frames: 0, missing: 0, losses: 0 };
    Heard::State { space: space(patch), stamp: stamp(run, 1), state }
}

fn alive(patch: &str, run: u64) -> Heard {
    Heard::Alive { space: space(patch), run }
}

fn gone(patch: &str, run: u64) -> Heard {
    Heard::Gone { space: space(patch), run }
}

struct Scene {
    merge: Merge,
    now: Instant,
}

impl Scene {
    fn new() -> Self {
        Self { merge: Merge::default(), now: Instant::now() }
    }

    fn take(&mut self, heard: Heard) -> Vec<Change> {
        self.merge.take(heard, self.now)
    }

    fn wait(&mut self, seconds: f64) -> Vec<Change> {
        self.now += Duration::from_secs_f64(seconds);
        self.merge.look(self.now)
    }

    fn sense(&self, index: usize) -> &Sense {
        &self.merge.body().senses()[index]
    }

    fn findings(&mut self) -> Vec<String> {
        self.merge.take_findings().iter().map(|finding| finding.finding.clone()).collect()
    }
}

#[test]
fn skins_of_two_computers_on_one_link_are_summed_up() {
    let mut scene = Scene::new();
    for (patch, run) in [("front", 1), ("back", 2)] {
        scene.take(alive(patch, run));
        scene.take(state(patch, run, "left", Phase::Live));
        scene.take(contacts(patch, run, 1, 0));
    }
    assert_eq!(scene.merge.body().wrench("palm").unwrap().force, [0.0, 0.0, -4.0]);
    // Those of a computer that is gone are gone at once.
    assert_eq!(scene.take(gone("back", 2)), [Change::State(1)]);
    assert_eq!(scene.merge.body().wrench("palm").unwrap().force, [0.0, 0.0, -2.0]);
    assert!(scene.sense(1).report.is_none());
    assert_eq!(scene.sense(1).state.text, "its computer `left` is gone");
}

#[test]
fn what_does_not_come_is_counted_also_while_its_computer_is_cut_off() {
    let mut scene = Scene::new();
    scene.take(alive("front", 1));
    for number in [1, 2, 5] {
        scene.take(contacts("front", 1, number, 0));
    }
    scene.take(gone("front", 1));
    // Late, and of a run that is not there: stale.
    assert_eq!(scene.take(contacts("front", 1, 6, 0)), []);
    scene.take(alive("front", 1));
    assert_eq!(scene.take(contacts("front", 1, 105, 0)), [Change::State(0), Change::Frame(0)]);
    // The same again, and one that was overtaken.
    assert_eq!(scene.take(contacts("front", 1, 105, 0)), []);
    assert_eq!(scene.take(contacts("front", 1, 104, 0)), []);
    let [totals] = &scene.merge.totals()[..] else { panic!() };
    assert_eq!((totals.frames, totals.frames_lost, totals.frames_missing, totals.losses), (4, 2 + 99, 7, 1));
    // A program that has started anew counts from the start.
    scene.take(gone("front", 1));
    scene.take(alive("front", 2));
    scene.take(contacts("front", 2, 50, 0));
    assert_eq!(scene.merge.totals()[0].frames_lost, 2 + 99);
}

#[test]
fn who_is_silent_is_lost_and_comes_back_with_its_next_frame() {
    let mut scene = Scene::new();
    scene.take(alive("front", 1));
    scene.take(state("front", 1, "left", Phase::Live));
    scene.take(contacts("front", 1, 1, 0));
    assert_eq!(scene.wait(1.4), []);
    assert_eq!(scene.wait(0.2), [Change::State(0)]);
    assert_eq!(scene.sense(0).state.phase, Phase::Lost);
    assert_eq!(scene.sense(0).state.text, "nothing is heard from its computer `left`");
    assert!(scene.sense(0).report.is_none());
    assert_eq!(scene.wait(1.0), []);
    assert_eq!(scene.take(contacts("front", 1, 2, 0)), [Change::State(0), Change::Frame(0)]);
    assert_eq!(scene.sense(0).state.phase, Phase::Live);
}

#[test]
fn times_are_by_this_computers_clock_and_latency_is_measured_across_clocks() {
    let ahead = 5_000_000_000;
    let mut scene = Scene::new();
    scene.take(alive("front", 1));
    scene.take(contacts("front", 1, 1, ahead));
    // What the offset is was not known yet.
    assert_eq!(scene.merge.totals()[0].latency, None);
    let (asked_ns, answered_ns) = (START, START + 1_000_000);
    scene.take(Heard::Clock { run: 1, asked_ns, theirs_ns: START + 500_000 + ahead, answered_ns });
    scene.take(contacts("front", 1, 2, ahead));
    let report = scene.sense(0).report.as_ref().unwrap();
    assert_eq!(report.received_ns - report.time_ns, 3_000_000);
    let [totals] = &scene.merge.totals()[..] else { panic!() };
    assert_eq!(totals.latency, Some(Latency { median_ms: 3.0, most_ms: 3.0 }));
    assert_eq!((totals.clock_ahead_ms, totals.clock_doubt_ms), (Some(5000.0), Some(0.5)));
}

#[test]
fn two_computers_that_claim_one_skin_are_found_and_the_first_counts() {
    let mut scene = Scene::new();
    for (run, computer) in [(1, "left"), (2, "right")] {
        scene.take(alive("front", run));
        scene.take(state("front", run, computer, Phase::Live));
    }
    scene.take(contacts("front", 1, 1, 0));
    assert_eq!(scene.take(contacts("front", 2, 1, 0)), []);
    // The second may be the first, started anew.
    assert!(scene.findings().is_empty());
    for _ in 0..4 {
        scene.wait(1.0);
        scene.take(state("front", 1, "left", Phase::Live));
        scene.take(state("front", 2, "right", Phase::Live));
    }
    let findings = scene.findings();
    assert_eq!(findings.len(), 1);
    assert!(findings[0].starts_with("it is served twice, by `left` and by `right`"), "{findings:?}");
    assert_eq!(scene.merge.totals()[0].ignored, 1);
    assert_eq!(scene.merge.totals()[0].frames_lost, 0);
    // When the first is gone, the second counts.
    scene.take(gone("front", 1));
    assert_eq!(scene.take(contacts("front", 2, 2, 0)), [Change::State(0), Change::Frame(0)]);
}

#[test]
fn a_computer_with_other_messages_is_named_with_both_versions() {
    let mut scene = Scene::new();
    scene.take(alive("front", 1));
    let theirs = Version { messages: 9, ..Version::OURS };
    let error = DecodeError::Version { theirs };
    let unreadable = Heard::Unreadable { space: space("front"), error };
    assert_eq!(scene.take(unreadable.clone()), [Change::State(0)]);
    assert_eq!(scene.take(unreadable), []);
    let findings = scene.findings();
    let [finding] = &findings[..] else { panic!("{findings:?}") };
    assert!(
        finding.contains(&theirs.to_string()) && finding.contains(&Version::OURS.to_string()),
        "{finding}"
    );
    // And stays so, however long.
    assert_eq!(scene.wait(2.0), []);
    assert_eq!(scene.sense(0).state.text, *finding);
    assert_eq!(scene.merge.totals()[0].unreadable, 2);
}

#[test]
fn strangers_fill_no_memory() {
    let mut scene = Scene::new();
    for number in 0..2 * MOST_SKINS {
        scene.take(alive(&format!("p{number}"), number as u64));
        scene.take(alive("p0", 1 << 40 | number as u64));
    }
    assert_eq!(scene.merge.body().senses().len(), MOST_SKINS);
    assert!(scene.merge.offsets.len() <= MOST_SKINS + MOST_RUNS);
    // Of skins that nobody serves nothing is taken.
    let count = scene.merge.body().senses().len();
    scene.take(contacts("unknown", 1, 1, 0));
    scene.take(Heard::Unreadable { space: space("unknown"), error: DecodeError::Damaged(3) });
    assert_eq!((scene.merge.body().senses().len(), scene.findings().len()), (count, 0));
}
