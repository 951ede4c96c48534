//! Whether a check named what is wrong.

use dermatome_frames::recorded::{
    check::{
        Check, Expected,
        findings::{About, Level},
        gain::PairGain,
        reading::Misplacement,
        wiring::{Exchange, Role},
    },
    order::{Arrangement, SenseOrder},
    statistics::median,
};
use std::fmt;

/// An offset is named if it is within this share of what was added.
const OFFSET_ERROR: f64 = 0.25;
/// A gain is named if it is within this factor.
const GAIN_ERROR: f64 = 1.15;

/// Voltages are alike that differ by less than this share in the median.
const ALIKE: f64 = 0.05;

/// What is wrong with frames.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Wrong {
    Nothing,
    Order(Arrangement),
    Misplaced(Vec<Misplacement>),
    Exchanged(Exchange),
    Offset(f64),
    Potentials,
    /// Potentials, and the square is transposed.
    TransposedPotentials,
    Gain {
        pair: [u8; 2],
        drives: bool,
        gain: f64,
    },
    Reversed {
        pair: [u8; 2],
        drives: bool,
    },
    Open(u8),
    Noisy(u8),
    Clipped,
    Repeated,
}

/// Whether the check found it; `good` is that of the frames before they were spoilt.
pub(super) fn is_named(wrong: &Wrong, check: &Check, good: &Check, expected: &Expected) -> bool {
    let numbering = &check.numbering;
    let has = |about: About| check.findings.iter().any(|finding| finding.about == about);
    match wrong {
        Wrong::Nothing => true,
        // Other numbers may be the same on a symmetric skin.
        Wrong::Order(made) => has(About::Order) && alike(expected, *made, numbering.best),
        // On a skin that is the same from every electrode rows that begin early are drives that come late.
        Wrong::Misplaced(made) => match (&made[..], &check.misplaced[..]) {
            ([Misplacement::Shifted(by)], [Misplacement::ColumnsShifted(columns)]) => {
                let n = usize::from(expected.electrodes());
                by % n == 0 && (by / n + columns) % n == 0
            }
            (made, found) => made == found,
        },
        Wrong::Exchanged(made) => numbering.exchanged == [*made],
        Wrong::Offset(made) => {
            let before = good.offset.map_or(0.0, |offset| offset.value);
            check.offset.is_some_and(|offset| ((offset.value - before) / made - 1.0).abs() < OFFSET_ERROR)
        }
        Wrong::Potentials => check.single_ended,
        Wrong::TransposedPotentials => check.single_ended && check.misplaced == [Misplacement::Transposed],
        Wrong::Gain { pair, drives, gain } => {
            let was_there = |it: &PairGain| {
                good.gains.iter().any(|was| was.electrodes == it.electrodes && was.drives == it.drives)
            };
            let made: Vec<&PairGain> = check.gains.iter().filter(|it| !was_there(it)).collect();
            matches!(made[..], [only] if is_gain(only, *pair, *drives, *gain))
        }
        Wrong::Reversed { pair, drives: true } => check.polarity.reversed_drives == [*pair],
        Wrong::Reversed { pair, drives: false } => check.polarity.reversed_senses == [*pair],
        Wrong::Open(electrode) => {
            let off = check.electrodes.iter().filter(|it| it.drive_is_off() || it.sense_is_off());
            let off: Vec<u8> = off.map(|it| it.electrode).collect();
            // Of a pair that only drives together either may be at fault.
            off.contains(electrode) && off.len() <= 2
        }
        Wrong::Noisy(electrode) => {
            check.electrodes.iter().filter(|it| it.is_noisy()).map(|it| it.electrode).eq([*electrode])
        }
        Wrong::Clipped => has(About::Saturation),
        Wrong::Repeated => has(About::Repeats),
    }
}

/// Whether a pair's gain is the one; where it says that it cannot tell which of the two, either.
fn is_gain(found: &PairGain, [a, b]: [u8; 2], drives: bool, gain: f64) -> bool {
    let (pair, gain) = if found.ambiguous && drives { ([b, a], 1.0 / gain) } else { ([a, b], gain) };
    let is_side = found.ambiguous || found.drives == drives;
    is_side && found.electrodes == pair && (found.gain / gain).ln().abs() < GAIN_ERROR.ln()
}

/// Whether a skin measures the same whichever of the two ways its electrodes are numbered.
pub(super) fn alike(expected: &Expected, a: Arrangement, b: Arrangement) -> bool {
    let electrodes = expected.electrodes();
    let voltages = |arrangement: Arrangement| -> Option<Vec<f64>> {
        let map = arrangement.index_map(&expected.steps, electrodes, expected.steps.len()).ok()?;
        let mut file = vec![0.0; map.len()];
        for (place, &step) in map.iter().zip(&expected.steps) {
            file[place.index] = expected.voltage(step) * if place.flipped { -1.0 } else { 1.0 };
        }
        Some(file)
    };
    let (Some(a), Some(b)) = (voltages(a), voltages(b)) else { return false };
    let apart = median(a.iter().zip(&b).map(|(a, b)| (a - b).abs() / a.abs().max(b.abs())));
    apart < ALIKE
}

/// Faults about something else than what is wrong and what was known before.
pub(super) fn others(wrong: &Wrong, check: &Check, known: &[About]) -> Vec<About> {
    let meant: &[About] = match wrong {
        Wrong::Nothing | Wrong::Repeated => &[],
        Wrong::Order(_) => &[About::Order],
        Wrong::Misplaced(_) => &[About::Transposed, About::Shift, About::Rows, About::Columns],
        Wrong::Exchanged(_) => &[About::Exchange],
        Wrong::Offset(_) => &[About::Offset],
        Wrong::Potentials => &[About::SingleEnded],
        Wrong::TransposedPotentials => &[About::SingleEnded, About::Transposed],
        Wrong::Gain { .. } => &[About::Gain],
        Wrong::Reversed { .. } => &[About::Polarity],
        Wrong::Open(_) | Wrong::Noisy(_) => &[About::Electrode, About::Dead],
        Wrong::Clipped => &[About::Saturation],
    };
    let faults = check.findings.iter().filter(|finding| finding.level == Level::Fault);
    faults
        .map(|finding| finding.about)
        .filter(|about| !meant.contains(about) && !known.contains(about))
        .collect()
}

impl fmt::Display for Wrong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let person = |electrode: u8| u16::from(electrode) + 1;
        let pair = |[a, b]: [u8; 2]| format!("{}-{}", person(a), person(b));
        let side = |drives: bool| if drives { "drive" } else { "sense" };
        match self {
            Self::Nothing => write!(f, "nothing"),
            Self::Order(Arrangement { sense, rotation, mirrored }) => {
                let relative = *sense == SenseOrder::Relative;
                write!(f, "order: relative {relative}, rotation {rotation}, mirrored {mirrored}")
            }
            Self::Misplaced(made) => write!(f, "values misplaced: {made:?}"),
            Self::Exchanged(Exchange { electrodes: [a, b], role }) => {
                let role = match role {
                    Role::Both => "electrodes",
                    Role::Drive => "drive wires",
                    Role::Sense => "sense wires",
                };
                write!(f, "{role} {} and {} exchanged", person(*a), person(*b))
            }
            Self::Offset(value) => write!(f, "offset {value:.4}"),
            Self::Potentials => write!(f, "potentials"),
            Self::TransposedPotentials => write!(f, "potentials, transposed"),
            Self::Gain { pair: electrodes, drives, gain } => {
                write!(f, "{} pair {} times {gain}", side(*drives), pair(*electrodes))
            }
            Self::Reversed { pair: electrodes, drives } => {
                write!(f, "{} pair {} reversed", side(*drives), pair(*electrodes))
            }
            Self::Open(electrode) => write!(f, "electrode {} open", person(*electrode)),
            Self::Noisy(electrode) => write!(f, "electrode {} noisy", person(*electrode)),
            Self::Clipped => write!(f, "clipped"),
            Self::Repeated => write!(f, "repeated frames"),
        }
    }
}
