//! Stimulation pattern: which electrode pairs drive and sense, in which order.
//!
//! Electrodes count from 0 here and on the wire. The canonical order and signs are EIDORS': drive
//! k pushes current out of electrode k and into electrode k + 1 (EIDORS: -1 A on k, +1 A on
//! k + 1), and inside each drive the sense pairs m run upwards, plus on m and minus on m + 1,
//! leaving out pairs that touch a driven electrode.

use serde::{Deserialize, Serialize};

/// One step of a frame: where current flows and where voltage is sensed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Step {
    /// Electrode into which the current flows.
    pub drive_plus: u8,
    /// Electrode out of which it returns.
    pub drive_minus: u8,
    /// Electrode on the amplifier's plus input.
    pub sense_plus: u8,
    /// Electrode on the amplifier's minus input.
    pub sense_minus: u8,
}

impl Step {
    /// The same four electrodes as bytes: drive plus, drive minus, sense plus, sense minus.
    #[must_use]
    pub const fn to_bytes(self) -> [u8; 4] {
        [self.drive_plus, self.drive_minus, self.sense_plus, self.sense_minus]
    }

    /// Inverse of [`Self::to_bytes`].
    #[must_use]
    pub const fn from_bytes(bytes: [u8; 4]) -> Self {
        let [drive_plus, drive_minus, sense_plus, sense_minus] = bytes;
        Self { drive_plus, drive_minus, sense_plus, sense_minus }
    }

    /// Whether each pair names two different electrodes below `electrodes`.
    #[must_use]
    pub const fn is_valid(self, electrodes: u8) -> bool {
        self.drive_plus < electrodes
            && self.drive_minus < electrodes
            && self.sense_plus < electrodes
            && self.sense_minus < electrodes
            && self.drive_plus != self.drive_minus
            && self.sense_plus != self.sense_minus
    }

    /// Whether the sense pair touches a driven electrode.
    #[must_use]
    pub const fn senses_driven(self) -> bool {
        self.sense_plus == self.drive_plus
            || self.sense_plus == self.drive_minus
            || self.sense_minus == self.drive_plus
            || self.sense_minus == self.drive_minus
    }

    /// What this step measures, regardless of direction: two steps with equal keys give the same
    /// voltage, up to the sign, on any linear reciprocal body.
    #[must_use]
    pub fn reciprocity(self) -> Reciprocity {
        let (drive, drive_flipped) = ordered(self.drive_plus, self.drive_minus);
        let (sense, sense_flipped) = ordered(self.sense_plus, self.sense_minus);
        Reciprocity {
            pairs: if drive <= sense { [drive, sense] } else { [sense, drive] },
            flipped: drive_flipped != sense_flipped,
        }
    }
}

/// What a step measures once direction and the roles of drive and sense are set aside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reciprocity {
    /// The two electrode pairs, each ascending, the lower pair first.
    pub pairs: [[u8; 2]; 2],
    /// Whether the step reads the voltage with the opposite sign.
    pub flipped: bool,
}

fn ordered(plus: u8, minus: u8) -> ([u8; 2], bool) {
    if plus < minus { ([plus, minus], false) } else { ([minus, plus], true) }
}

/// Whether sense pairs that touch a driven electrode are part of a pattern. Their voltages contain
/// the contact impedance of that electrode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Driven {
    /// They are left out.
    Skipped,
    /// They are measured like any other.
    Measured,
}

/// All steps of the pattern that drives pairs `drive_distance` apart and senses pairs
/// `sense_distance` apart, in canonical order.
///
/// Adjacent is (1, 1), opposite is (electrodes / 2, 1), skip-n is (n + 1, n + 1). Sixteen
/// electrodes give 208 adjacent steps without driven ones (thesis section 2.2.4: n (n - 3)).
pub fn pattern(
    electrodes: u8,
    drive_distance: u8,
    sense_distance: u8,
    driven: Driven,
) -> impl Iterator<Item = Step> {
    let ahead = move |electrode: u8, distance: u8| {
        ((u16::from(electrode) + u16::from(distance)) % u16::from(electrodes.max(1))) as u8
    };
    (0..electrodes).flat_map(move |k| {
        (0..electrodes)
            .map(move |m| Step {
                drive_plus: ahead(k, drive_distance),
                drive_minus: k,
                sense_plus: m,
                sense_minus: ahead(m, sense_distance),
            })
            .filter(move |step| driven == Driven::Measured || !step.senses_driven())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn adjacent_pattern_of_sixteen_electrodes_has_the_canonical_208_steps() {
        let steps: Vec<_> = pattern(16, 1, 1, Driven::Skipped).collect();
        assert_eq!(steps.len(), 208);
        assert_eq!(steps[0].to_bytes(), [1, 0, 2, 3]);
        assert_eq!(steps[12].to_bytes(), [1, 0, 14, 15]);
        assert_eq!(steps[13].to_bytes(), [2, 1, 3, 4]);
        assert_eq!(steps[207].to_bytes(), [0, 15, 13, 14]);
        assert!(steps.iter().all(|step| step.is_valid(16)));
    }

    #[test]
    fn opposite_pattern_of_sixteen_electrodes_has_192_steps() {
        assert_eq!(pattern(16, 8, 1, Driven::Skipped).count(), 192);
    }

    #[test]
    fn measuring_on_driven_electrodes_gives_every_drive_every_sense_pair() {
        let steps: Vec<_> = pattern(16, 1, 1, Driven::Measured).collect();
        assert_eq!(steps.len(), 256);
        assert_eq!(steps.iter().filter(|step| step.senses_driven()).count(), 256 - 208);
    }

    #[test]
    fn exchanging_drive_and_sense_keeps_what_is_measured() {
        for step in pattern(16, 1, 1, Driven::Skipped) {
            let [a, b, c, d] = step.to_bytes();
            let exchanged = Step::from_bytes([c, d, a, b]);
            assert_eq!(step.reciprocity(), exchanged.reciprocity());
            let reversed = Step::from_bytes([b, a, c, d]);
            assert_eq!(step.reciprocity().pairs, reversed.reciprocity().pairs);
            assert_ne!(step.reciprocity().flipped, reversed.reciprocity().flipped);
        }
    }

    #[test]
    fn adjacent_pattern_holds_104_independent_measurements() {
        let mut seen = Vec::new();
        for step in pattern(16, 1, 1, Driven::Skipped) {
            let pairs = step.reciprocity().pairs;
            if !seen.contains(&pairs) {
                seen.push(pairs);
            }
        }
        assert_eq!(seen.len(), 104);
    }
}
