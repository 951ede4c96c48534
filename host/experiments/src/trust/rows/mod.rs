//! Rows: what is tried. A file holds rows of one kind.

mod count;
mod drift;
mod faults;
mod force;
mod gestures;
mod limit;
mod single;
mod slow;
mod uneven;
mod untouched;
mod upset;

use super::{Bench, Figure, Options, TrustError};
use std::ops::Range;

/// One row.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Its name.
    pub name: &'static str,
    /// What it tries, in a line.
    pub about: &'static str,
    pub(super) run: fn(&Bench, &Options) -> Result<Vec<Figure>, TrustError>,
}

/// All rows. Each draws from a seed of its place here, so that a new one comes last.
pub const ROWS: [Row; 21] = [
    Row { name: "untouched", about: "frames of the untouched skin with a contact", run: untouched::run },
    Row { name: "one", about: "one finger of 4 % of the size, up to 95 % of the radius", run: single::one },
    Row { name: "rim", about: "one finger of 4 % in the outer 5 % of the radius", run: single::rim },
    Row {
        name: "strength",
        about: "strength of equal fingers over 90 % of the radius",
        run: single::strength,
    },
    Row {
        name: "several",
        about: "two and three fingers of 6 %, 25 % of the size apart",
        run: count::several,
    },
    Row { name: "pairs", about: "two fingers of 4 % told apart, by their distance", run: count::pairs },
    Row { name: "indenters", about: "one indenter of 3 to 12 % of the size", run: count::indenters },
    Row {
        name: "force",
        about: "load of indenters of 4 to 12 %, by the strength of one of 6 %",
        run: force::force,
    },
    Row { name: "sliding", about: "fingers of 4 to 10 % that slide at 0.2 m/s", run: gestures::sliding },
    Row { name: "latency", about: "frames until a contact at 400 frames a second", run: gestures::latency },
    Row {
        name: "uniform",
        about: "a minute and a half of even drift, the middle third pressed",
        run: drift::uniform,
    },
    Row { name: "regional", about: "a part of the skin warms by 12 % in a minute", run: drift::regional },
    Row { name: "upset", about: "what changes at once and is no press", run: upset::run },
    Row { name: "slow", about: "presses that grow over 1 to 600 s", run: slow::growing },
    Row { name: "tare", about: "a tare with a finger at the rim, which then lifts", run: slow::tare },
    Row { name: "identity", about: "identities of taps, swipes and crossings", run: gestures::identity },
    Row {
        name: "limit",
        about: "fingers of 4 % in single frames, beside what the voltages hold",
        run: limit::run,
    },
    Row {
        name: "uneven",
        about: "load on skins that read unevenly, with a field of gain from presses of known load",
        run: uneven::run,
    },
    Row { name: "held", about: "one indenter of 8 to 16 % at half depth, held", run: count::held },
    Row {
        name: "rest",
        about: "contacts left by one to three fingers, two seconds after",
        run: untouched::rest,
    },
    Row {
        name: "faults",
        about: "wires that break, or are broken, and a finger on such a skin",
        run: faults::run,
    },
];

/// Radius of a finger, share of the size.
const FINGER: f64 = 0.04;
/// Radii where things are tried that have nothing to do with the rim.
const WITHIN: Range<f64> = 0.0..0.9;
/// A contact this close to a finger is its own, share of the size.
const CLOSE: f64 = 0.1;
