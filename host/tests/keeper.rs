//! A board that a program keeps, as `serve` does: what it is asked for while it makes a reference.

mod program;

use dermatome::{
    body::keeper::{Asked, Phase, Reference, Told},
    shared::{drive::Drive, protocol::Selection},
};
use program::{
    Desk, Running,
    keeping::{is, keep, wait},
};
use std::{
    sync::mpsc::Receiver,
    thread,
    time::{Duration, Instant},
};

/// With raw codes: then a tare is made in the stream.
const RECORDED: Selection =
    Selection { images: 0, contacts: 1, measurements: 1, health: 0, scope: 0, scope_slot: 0 };
const SERVED: Selection = Selection { measurements: 0, ..RECORDED };

#[test]
fn a_drive_that_is_asked_for_in_a_tare_is_that_of_the_reference() {
    for selection in [RECORDED, SERVED] {
        let (desk, _board, port) = board();
        let (keeper, told) = keep(&desk, &port, selection);
        let before = reference(&told);
        wait(&told, |told| is(&told, Phase::Live).then_some(()));
        keeper.ask(Asked::Tare);
        wait(&told, |told| is(&told, Phase::Taring).then_some(()));
        // Some of the frames that it averages have come.
        thread::sleep(Duration::from_millis(300));
        // So slow that this tare would not end in the time that it has.
        let half = Drive::new(50e3, 0.5e-3, 4.0);
        keeper.ask(Asked::Drive(half));
        let driven = |told: Told| matches!(told, Told::Driven(driven) if driven.drive == half).then_some(());
        wait(&told, driven);
        let after = reference(&told);
        assert_eq!(after.voltages.len(), before.voltages.len());
        for (before, after) in before.voltages.iter().zip(&after.voltages) {
            let ratio = after / before;
            assert!((0.45..0.55).contains(&ratio), "of both drives: {ratio}");
        }
    }
}

#[test]
fn who_asks_for_a_tare_while_one_is_made_gets_one() {
    for selection in [RECORDED, SERVED] {
        let (desk, _board, port) = board();
        let (keeper, told) = keep(&desk, &port, selection);
        wait(&told, |told| is(&told, Phase::Live).then_some(()));
        // The second is asked for in the first.
        for _ in 0..2 {
            keeper.ask(Asked::Tare);
            wait(&told, |told| is(&told, Phase::Taring).then_some(()));
        }
        wait(&told, |told| is(&told, Phase::Live).then_some(()));
    }
}

#[test]
fn a_tare_of_frames_that_hardly_come_does_not_keep_its_keeper_from_ending() {
    let (desk, _board, port) = board();
    let (keeper, told) = keep(&desk, &port, SERVED);
    wait(&told, |told| is(&told, Phase::Live).then_some(()));
    keeper.ask(Asked::Drive(Drive::new(50e3, 1e-3, 0.01)));
    wait(&told, |told| is(&told, Phase::Taring).then_some(()));
    let begun = Instant::now();
    drop(keeper);
    assert!(begun.elapsed() < Duration::from_secs(10), "{:?}", begun.elapsed());
}

#[test]
fn a_drive_or_a_tare_waits_until_nothing_presses_and_says_so() {
    let half = Drive::new(50e3, 0.5e-3, 50.0);
    for (selection, asked) in [
        (RECORDED, Asked::Drive(half)),
        (SERVED, Asked::Drive(half)),
        (RECORDED, Asked::Tare),
        (SERVED, Asked::Tare),
    ] {
        let (desk, _board, port) = pressed_board(4);
        let (keeper, told) = keep(&desk, &port, selection);
        wait(&told, |told| (contacts(&told)? > 0).then_some(()));
        keeper.ask(asked);
        let mut waits = false;
        wait(&told, |told| {
            let is_done = is_driven(&told, &half)
                || matches!(&told, Told::State(state) if state.phase == Phase::Taring);
            assert!(!is_done, "while it is pressed");
            waits |= matches!(&told, Told::State(state) if state.waits() || state.drive_waits());
            (contacts(&told)? == 0).then_some(())
        });
        assert!(waits, "it is not said");
        if asked != Asked::Tare {
            wait(&told, |told| is_driven(&told, &half).then_some(()));
        }
        wait(&told, |told| is(&told, Phase::Taring).then_some(()));
        wait(&told, |told| is(&told, Phase::Live).then_some(()));
    }
}

#[test]
fn of_drives_that_wait_the_last_one_counts_and_that_of_now_gives_it_up() {
    let (desk, _board, port) = pressed_board(12);
    let (keeper, told) = keep(&desk, &port, SERVED);
    let before = wait(&told, |told| if let Told::Driven(driven) = told { Some(driven.drive) } else { None });
    wait(&told, |told| (contacts(&told)? > 0).then_some(()));
    let [slow, slower] = [30.0, 20.0].map(|rate| Drive { frame_rate: rate, ..before });
    let waits = |told: Told| matches!(&told, Told::State(state) if state.drive_waits()).then_some(());
    let given_up = |told: Told| if let Told::GivenUp(drive) = told { Some(drive) } else { None };
    keeper.ask(Asked::Drive(slow));
    wait(&told, waits);
    keeper.ask(Asked::Drive(before));
    assert_eq!(wait(&told, given_up), slow);
    wait(&told, |told| is_driven(&told, &before).then_some(()));
    wait(&told, |told| matches!(&told, Told::State(state) if state.text.is_empty()).then_some(()));
    // Each who asks is told that it waits.
    for drive in [slow, slower] {
        keeper.ask(Asked::Drive(drive));
        wait(&told, waits);
    }
    wait(&told, |told| {
        assert!(!is_driven(&told, &slow), "it was given up");
        is_driven(&told, &slower).then_some(())
    });
}

fn is_driven(told: &Told, drive: &Drive) -> bool {
    matches!(told, Told::Driven(driven) if driven.drive == *drive)
}

/// How many contacts a frame has; none where it is not told.
fn contacts(told: &Told) -> Option<usize> {
    let Told::Frame { frame, .. } = told else { return None };
    Some(frame.contacts.as_ref()?.len())
}

/// A simulated board with the patch of a skin that nothing presses on.
fn board() -> (Desk, Running, String) {
    let desk = Desk::with_patch();
    let (board, port) = flashed(&desk, &["--live"]);
    (desk, board, port)
}

/// One on whose skin a finger rests for so many seconds.
fn pressed_board(seconds: u32) -> (Desk, Running, String) {
    let desk = Desk::with_patch();
    let finger =
        format!("0,1,0,0,0.01,0.8\n{seconds},1,0,0,0.01,0.8\n{seconds}.1,1,0,0,0.01,0\n900,1,0,0,0.01,0\n");
    desk.write("path.csv", format!("time_s,finger,x_m,y_m,radius_m,depth\n{finger}"));
    let (board, port) = flashed(&desk, &["--path", "path.csv"]);
    (desk, board, port)
}

/// A simulated board with the skin's patch.
fn flashed(desk: &Desk, more: &[&str]) -> (Running, String) {
    let (board, port) = desk.board("skin.toml", more);
    desk.run(&["flash", "skin.dermatome", "--port", &port]).success();
    (board, port)
}

fn reference(told: &Receiver<Told>) -> Reference {
    wait(told, |told| if let Told::Reference(reference) = told { Some(*reference) } else { None })
}
