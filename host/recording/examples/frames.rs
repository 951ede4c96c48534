//! Prints the strongest contact of each frame of a recording, as its own patch finds it again.

use dermatome_recording::{
    frames::{Frames, Item},
    play::Player,
    read::Recording,
};
use dermatome_shared::patch::PatchView;
use std::{error::Error, path::Path};

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("allowed: a recording, such as run.mcap")?;
    let recording = Recording::open(Path::new(&path))?;
    let session = recording.session().clone();
    println!("{} at {}, {} {}", session.skin, session.port, session.board, session.firmware);
    let patch = PatchView::validate(&session.patch)?;
    let steps: Vec<_> = patch.steps().collect();
    let mut player = Player::new(&patch, &steps)?;
    let mut frames = Frames::of(recording);
    while let Some(item) = frames.next_item()? {
        let (Item::Frame(frame), Some(played)) = (&item, player.take(&item)?) else { continue };
        let strongest = played.contacts.first().map(|contact| (contact.position, contact.strength));
        println!("{}: {strongest:?}", frame.at.sequence);
    }
    Ok(())
}
