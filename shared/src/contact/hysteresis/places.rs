//! Places: which memory a contact uses, that of the place it is on.

use super::{Memory, PlayOperator};
use crate::{contact::Contact, limits::MAX_CONTACTS, units::RelativeConductivity};
use heapless::Vec;

/// Strengths of contacts: `[contact]`.
pub type Strengths = Vec<f32, MAX_CONTACTS>;

/// Places that were pressed lately, each with its memory.
#[derive(Clone, Debug, Default)]
pub struct Places([Place; MAX_CONTACTS]);

#[derive(Clone, Copy, Debug, Default)]
struct Place {
    /// Where it was first pressed, m.
    position: [f32; 3],
    memory: Memory,
    /// Whether a contact of this frame is on it.
    is_seen: bool,
}

impl Places {
    /// Strengths of a frame's contacts without hysteresis: `[contact]`. Without operators they are as they were.
    ///
    /// `noise`: changes up to this are averaged. `level`: strength that a place without contact has at most;
    /// asked for only where there are operators.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    pub fn compensate(
        &mut self,
        operators: &(impl Iterator<Item = PlayOperator> + Clone),
        contacts: &[Contact],
        noise: RelativeConductivity,
        level: impl FnOnce() -> RelativeConductivity,
    ) -> Strengths {
        let contacts = contacts.iter().take(MAX_CONTACTS);
        if operators.clone().next().is_none() {
            return contacts.map(|contact| contact.strength).collect();
        }
        let strengths = contacts
            .map(|contact| {
                let strength =
                    RelativeConductivity((contact.strength * RelativeConductivity::ONE as f32) as i32);
                self.place_of(contact).memory.compensate(operators, strength, noise).to_f32()
            })
            .collect();
        self.release(operators, level());
        strengths
    }

    /// Places without contact read `level` at most, and fade.
    fn release(
        &mut self,
        operators: &(impl Iterator<Item = PlayOperator> + Clone),
        level: RelativeConductivity,
    ) {
        for place in &mut self.0 {
            if !core::mem::take(&mut place.is_seen) {
                let most = place.memory.strength().min(level);
                place.memory.compensate(operators, most, RelativeConductivity(0));
            }
        }
    }

    /// The nearest place within a contact, or a new one instead of the place with the least memory.
    fn place_of(&mut self, contact: &Contact) -> &mut Place {
        let distance = |place: &Place| {
            let [x, y, z] = [0, 1, 2].map(|axis| place.position[axis] - contact.position[axis]);
            x * x + y * y + z * z
        };
        let square = contact.square_reach();
        let mut best = 0;
        let mut best_rank = f32::INFINITY;
        for (index, place) in self.0.iter().enumerate() {
            let is_here = distance(place) < square && place.memory.strength().0 > 0;
            // Ranks of places that are here lie below 0, and of all others at what they remember.
            let rank = if is_here { distance(place) - square } else { place.memory.strength().0 as f32 };
            if !place.is_seen && rank < best_rank {
                (best, best_rank) = (index, rank);
            }
        }
        let place = &mut self.0[best];
        if best_rank >= 0.0 {
            *place = Place { position: contact.position, ..Place::default() };
        }
        place.is_seen = true;
        place
    }
}
