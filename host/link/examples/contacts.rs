//! Prints the contacts of a skin as they come: `cargo run -p dermatome-link --example contacts -- /dev/ttyACM0`.
//!
//! The board must hold a patch and have a reference. Positions and normals are in the skin's frame.

use dermatome_link::{Port, open, shared::protocol::Selection};
use std::{error::Error, time::Duration};

/// A board that is silent for so long has a fault.
const SILENCE: Duration = Duration::from_secs(5);

fn main() -> Result<(), Box<dyn Error>> {
    let port: Port = std::env::args()
        .nth(1)
        .ok_or("give a port: /dev/ttyACM0, COM5, tcp:HOST:PORT, rs485:LINE#ADDRESS or can:BUS#ADDRESS")?
        .parse()?;
    let mut link = open(&port)?;
    let mut stream = link.subscribe(Selection { contacts: 1, ..Selection::default() })?;
    while let Some(frame) = stream.next(SILENCE)? {
        for contact in frame.contacts.iter().flatten() {
            let [x, y, z] = contact.position.map(|metres| metres * 1e3);
            let force =
                contact.force().map_or("no force: not calibrated".to_owned(), |n| format!("{n:.3} N"));
            println!("({x:.1}, {y:.1}, {z:.1}) mm, normal {:.2?}, {force}", contact.normal);
        }
    }
    println!("the board is silent; {:?}", stream.stop()?);
    Ok(())
}
