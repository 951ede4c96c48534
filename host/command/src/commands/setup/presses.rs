//! Presses: what a person's finger, or a simulated one, does on the skin, and where the board sees it.

use super::super::interrupt;
use dermatome_link::{Link, LinkError};
use dermatome_shared::protocol::Selection;
use nalgebra::Point2;
use std::time::{Duration, Instant};

/// Frames in which a press must be seen, one after the other, and be gone before the next one.
const HELD: usize = 8;

/// Where so many presses were seen from above, m, one after the other, each lifted before the next; fewer where `within`
/// goes by without one, or Ctrl-C comes. `announce` is called before each with its number, from 0.
pub(super) fn watch(
    link: &mut Link,
    count: usize,
    within: Duration,
    silence: Duration,
    mut announce: impl FnMut(usize),
) -> Result<Vec<Point2<f64>>, LinkError> {
    let go_on = || !interrupt::requested();
    let mut stream = link.subscribe(Selection { contacts: 1, ..Selection::default() })?;
    let (mut seen, mut held) = (Vec::new(), Held::default());
    announce(0);
    let mut asked = Instant::now();
    while seen.len() < count && asked.elapsed() < within && go_on() {
        let Some(frame) = stream.next_while(silence, go_on)? else { break };
        let Some(contacts) = frame.contacts else { continue };
        let strongest = contacts.first().map(|contact| Point2::from(contact.from_above()));
        if let Some(at) = held.see(strongest) {
            seen.push(at);
            asked = Instant::now();
            if seen.len() < count {
                announce(seen.len());
            }
        }
    }
    stream.stop()?;
    Ok(seen)
}

/// A press from its first frame on.
#[derive(Debug, Default)]
struct Held {
    /// Places of the frames in which it was seen.
    places: Vec<Point2<f64>>,
    /// Frames without one since.
    free: usize,
    /// It was told, and is still there.
    is_told: bool,
}

impl Held {
    /// The strongest contact of the next frame; gives the mean place of a press once it is held.
    fn see(&mut self, contact: Option<Point2<f64>>) -> Option<Point2<f64>> {
        let Some(at) = contact else {
            self.free += 1;
            if self.free >= HELD {
                *self = Self { free: self.free, ..Self::default() };
            }
            return None;
        };
        self.free = 0;
        self.places.push(at);
        let is_held = self.places.len() >= HELD && !self.is_told;
        self.is_told |= is_held;
        is_held.then(|| {
            let sum = self.places.iter().fold(Point2::origin(), |sum, place| sum + place.coords);
            sum / self.places.len() as f64
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn presses(frames: &[(usize, Option<f64>)]) -> Vec<f64> {
        let mut held = Held::default();
        let all = frames.iter().flat_map(|&(count, x)| std::iter::repeat_n(x, count));
        all.filter_map(|x| held.see(x.map(|x| Point2::new(x, 0.0)))).map(|place| place.x).collect()
    }

    #[test]
    fn a_press_counts_once_however_long_it_is_held_and_a_flicker_is_none() {
        let none = (HELD, None);
        assert_eq!(presses(&[none, (100, Some(1.0)), none, (HELD, Some(2.0))]), [1.0, 2.0]);
        assert_eq!(presses(&[(HELD - 1, Some(1.0)), none, (1, Some(3.0)), none]), [0.0; 0]);
        // A frame without it is no lift.
        assert_eq!(presses(&[(HELD, Some(1.0)), (1, None), (HELD, Some(1.0)), none]), [1.0]);
    }
}
