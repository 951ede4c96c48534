//! Hysteresis: takes it out of the strength of contacts, before the calibration curve.
//!
//! A sheet that was pressed harder conducts better than it should until it is let go. The inverse is an
//! operator of a few plays in the sense of the generalised Prandtl-Ishlinskii model (Al Janaideh, Rakheja, Su,
//! IEEE/ASME Trans. Mechatronics 16, 2011): one envelope of each play is the strength x itself, the other
//! is a multiple of it,
//!
//! ```text
//! h_i <- max(x, min(h_i, reach_i x))          what play i still holds of the highest strength
//! v    = max(0, x - sum_i weight_i (h_i - x))
//! ```
//!
//! so that a first press passes unchanged and the loop's shape is the same at every height. Where the sum
//! exceeds x, nothing presses: what reads is what the last press left. The plays are then pulled back until v is
//! exactly 0, so that memory fades as its trace in the skin does. No clock is needed: the operator follows
//! the order of strengths, not their times.
//!
//! Hysteresis belongs to a place of the skin, so [`Places`] keeps one [`Memory`] for each place that was
//! pressed lately; a contact uses the memory of the place that it is on.

use crate::{
    contact::{Contact, Contacts},
    limits::MAX_CONTACTS,
    patch::PatchView,
    units::RelativeConductivity,
};

/// Most plays.
pub const MAX_PLAYS: usize = 6;
/// Bytes of one play in a patch.
pub const PLAY_BYTES: usize = 4;
const REACH_BITS: u32 = 12;
const WEIGHT_BITS: u32 = 11;
/// Noise is averaged over about two to the power of this many frames.
const SMOOTHING_BITS: u32 = 3;

/// One play of the operator, in fixed point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Play {
    /// What is held is at most so many times the strength, in steps of 2^-12: 1 to 15.99.
    pub reach: u16,
    /// Weight of what is held beyond the strength, in steps of 2^-11: 0 to 31.99.
    pub weight: u16,
}

impl Play {
    /// Nearest play to these numbers, which are limited to what it can hold.
    #[must_use]
    pub fn from_f64(reach: f64, weight: f64) -> Self {
        let scale = |value: f64, bits: u32| (value * f64::from(1_u32 << bits) + 0.5) as u16;
        Self { reach: scale(reach.max(1.0), REACH_BITS), weight: scale(weight.max(0.0), WEIGHT_BITS) }
    }

    /// As it lies in a patch, little-endian.
    #[must_use]
    pub fn to_bytes(self) -> [u8; PLAY_BYTES] {
        (u32::from(self.weight) << 16 | u32::from(self.reach)).to_le_bytes()
    }

    /// Inverse of [`Self::to_bytes`].
    #[must_use]
    pub fn from_bytes(bytes: [u8; PLAY_BYTES]) -> Self {
        let word = u32::from_le_bytes(bytes);
        Self { reach: word as u16, weight: (word >> 16) as u16 }
    }

    /// Whether it holds at least the strength itself.
    #[must_use]
    pub fn is_valid(self) -> bool {
        u32::from(self.reach) >= 1 << REACH_BITS
    }
}

/// What one place remembers of its presses. Strengths are in steps of 2^-20.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    strength: i32,
    held: [i32; MAX_PLAYS],
}

impl Memory {
    /// Takes the next strength in, and gives it without hysteresis.
    ///
    /// Changes up to `noise` are averaged; larger ones count at once.
    pub fn compensate(
        &mut self,
        plays: &(impl Iterator<Item = Play> + Clone),
        strength: RelativeConductivity,
        noise: RelativeConductivity,
    ) -> RelativeConductivity {
        self.smooth(strength.0, noise.0);
        let x = self.strength.max(0);
        let mut excess = 0_i64;
        for (held, play) in self.held.iter_mut().zip(plays.clone()) {
            let most = (i64::from(x) * i64::from(play.reach)) >> REACH_BITS;
            *held = i64::from(*held).min(most).max(x.into()).min(i32::MAX.into()) as i32;
            excess += i64::from(*held - x) * i64::from(play.weight);
        }
        let excess = (excess >> WEIGHT_BITS).min(i32::MAX.into()) as i32;
        if excess > x {
            self.fade(x, x as f32 / excess as f32);
        }
        RelativeConductivity((x - excess).max(0))
    }

    /// A step of a low-pass filter that follows all but the last `noise` of a jump.
    fn smooth(&mut self, strength: i32, noise: i32) {
        let gap = strength.saturating_sub(self.strength);
        let small = gap.clamp(-noise.max(0), noise.max(0));
        let step = (gap - small).saturating_add(small >> SMOOTHING_BITS);
        self.strength = self.strength.saturating_add(step);
    }

    /// Keeps this share of what is held beyond the strength.
    fn fade(&mut self, x: i32, share: f32) {
        for held in &mut self.held {
            *held = x.saturating_add(((*held - x).max(0) as f32 * share) as i32);
        }
    }
}

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
    /// Pressure of all contacts of a frame, by the patch's plays and calibration curve, and the area it acts on.
    ///
    /// `level`: strength that a place without contact has at most; asked for only where there are plays.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    pub fn press(
        &mut self,
        patch: &PatchView<'_>,
        contacts: &mut Contacts,
        level: impl FnOnce() -> RelativeConductivity,
    ) {
        let calibration = &patch.header.calibration;
        if let Some(share) = calibration.load_share {
            contacts.iter_mut().for_each(|contact| contact.load_area = Some(share * contact.area));
        }
        if patch.header.plays == 0 {
            return contacts.iter_mut().for_each(|c| c.pressure = calibration.pressure(c.strength));
        }
        let noise = RelativeConductivity(patch.header.contact_threshold.0 / 2);
        for contact in contacts {
            let strength = RelativeConductivity((contact.strength * RelativeConductivity::ONE as f32) as i32);
            let memory = &mut self.place_of(contact).memory;
            let clean = memory.compensate(&patch.plays(), strength, noise);
            contact.pressure = calibration.pressure(clean.to_f32());
        }
        let level = level();
        for place in &mut self.0 {
            if !core::mem::take(&mut place.is_seen) {
                let most = RelativeConductivity(place.memory.strength.min(level.0));
                place.memory.compensate(&patch.plays(), most, RelativeConductivity(0));
            }
        }
    }

    /// The nearest place within a contact, or a new one instead of the place with the least memory.
    fn place_of(&mut self, contact: &Contact) -> &mut Place {
        let distance = |place: &Place| {
            let [x, y, z] = [0, 1, 2].map(|axis| place.position[axis] - contact.position[axis]);
            x * x + y * y + z * z
        };
        // The radius of a disc of the contact's area, squared.
        let reach = contact.area * core::f32::consts::FRAC_1_PI;
        let mut best = 0;
        let mut best_rank = f32::INFINITY;
        for (index, place) in self.0.iter().enumerate() {
            let is_here = distance(place) < reach && place.memory.strength > 0;
            // Ranks of places that are here lie below 0, and of all others at what they remember.
            let rank = if is_here { distance(place) - reach } else { place.memory.strength as f32 };
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

#[cfg(test)]
mod tests;
