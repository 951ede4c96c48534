//! Keeping: a board that a keeper holds, as `serve` does, and what it tells.

use super::{Desk, TINY};
use dermatome::{
    body::{
        file::BodyFile,
        keeper::{Keeper, Phase, Told},
        surface,
    },
    shared::protocol::Selection,
    skin::Skin,
};
use std::{
    path::Path,
    sync::mpsc::{Receiver, channel},
    time::{Duration, Instant},
};

const BODY: &str = "name = \"arm\"\n[[patches]]\nname = \"palm\"\nskin = \"skin.toml\"\nport = \"PORT\"\n\
                    link = \"hand\"\nposition = [0, 0, 0]\norientation = [0, 0, 0, 1]\n";

/// Keeps the board of `skin.toml` behind a port.
pub(crate) fn keep(desk: &Desk, port: &str, selection: Selection) -> (Keeper, Receiver<Told>) {
    desk.write("robot.toml", BODY.replace("PORT", port));
    let file = BodyFile::load(&desk.path("robot.toml")).unwrap();
    let skin = Skin::parse(Path::new("skin.toml"), TINY).unwrap().made().unwrap();
    let surface = surface::of_skin(&skin).unwrap().unwrap();
    let (sender, receiver) = channel();
    let keeper = Keeper::start(&file.patches[0], surface, selection, move |told| {
        let _ = sender.send(told);
    });
    (keeper.unwrap(), receiver)
}

/// Whether a board says that it stands so.
pub(crate) fn is(told: &Told, phase: Phase) -> bool {
    matches!(told, Told::State(state) if state.phase == phase)
}

/// Waits until what is told is it.
pub(crate) fn wait<T>(told: &Receiver<Told>, mut is_it: impl FnMut(Told) -> Option<T>) -> T {
    let until = Instant::now() + Duration::from_secs(60);
    loop {
        let told = told.recv_timeout(until.saturating_duration_since(Instant::now())).expect("told in time");
        if let Some(it) = is_it(told) {
            return it;
        }
    }
}
