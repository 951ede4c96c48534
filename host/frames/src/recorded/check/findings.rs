//! What a check found, in words: what is wrong, and what to change.

use super::{
    super::{
        diagnose::{LEAST_FIT, RESEMBLING, first_few},
        wording::{Advice, Rearrangement},
    },
    Check, Expected, KnownBy,
    gain::PairGain,
    numbering::Numbering,
    reading::Misplacement,
    reciprocity::Agreement,
    wiring::{Exchange, Role},
};
use serde::Serialize;

/// Median error between steps that must agree which is a fault, %; saline tanks reach 5.
const DISAGREEMENT_PERCENT: f64 = 10.0;
/// The same where they are compared with what they were in good frames, which never agreed by themselves.
const CHANGED_PERCENT: f64 = 30.0;
/// Mean logarithm of measured over expected from which on frames are unlike the model: between steps that are the same
/// but for a turn, and of such steps together.
const UNLIKE: f64 = 0.25;
const UNLIKE_TOGETHER: f64 = 0.4;
/// Share of signs that may disagree where no pair is reversed.
const SIGNS: f64 = 0.02;
/// A single pair is worth a word from so many times the median error on.
const OUTSTANDING: f64 = 5.0;
/// Signal-to-noise ratio below which single presses drown, dB.
const LOW_SNR_DB: f64 = 40.0;
/// Change over the file that is worth a word, %.
const CHANGE_PERCENT: f64 = 2.0;

/// One thing that is worth knowing.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Whether something must be changed.
    pub level: Level,
    /// What it is about.
    pub about: About,
    /// What was found.
    pub found: String,
    /// What to change.
    pub advice: Advice,
}

/// How serious a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// Images will be wrong or poor.
    Fault,
    /// Good to know.
    Note,
}

/// What a finding is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum About {
    /// Order of the measurements, rotation, mirror.
    Order,
    /// Nothing fits the model.
    Resemblance,
    /// Potentials instead of differences.
    SingleEnded,
    /// Rows and columns of a square the other way round.
    Transposed,
    /// Values that begin late in the frame or in its rows.
    Shift,
    /// Exchanged drives.
    Rows,
    /// Exchanged columns of a square.
    Columns,
    /// Exchanged electrodes.
    Exchange,
    /// Signs.
    Polarity,
    /// A constant in every value.
    Offset,
    /// A pair that reads too much or too little.
    Gain,
    /// An electrode that is off or noisy.
    Electrode,
    /// Measurements that are zero.
    Dead,
    /// Drive and sense exchanged.
    Reciprocity,
    /// Pairs the other way round.
    Reversal,
    /// Noise.
    Noise,
    /// From the first frames to the last.
    Change,
    /// Clipped values.
    Saturation,
    /// Repeated frames.
    Repeats,
}

/// Everything that is worth a word, faults first.
pub(super) fn all(expected: &Expected, check: &Check) -> Vec<Finding> {
    let mut findings: Vec<Finding> =
        [single_ended(check), order(expected, check), offset(check)].into_iter().flatten().collect();
    findings.extend(misplaced(check));
    findings.extend(exchanged(check));
    findings.extend(polarity(check));
    findings.extend(gains(check));
    findings.extend(electrodes(check));
    findings.extend(dead(check));
    findings.extend(agreement(check));
    findings.extend(signal(check));
    findings.sort_by_key(|finding| finding.level == Level::Note);
    findings
}

fn fault(about: About, found: String, advice: impl Into<Advice>) -> Finding {
    Finding { level: Level::Fault, about, found, advice: advice.into() }
}

fn note(about: About, found: String, advice: impl Into<Advice>) -> Finding {
    Finding { level: Level::Note, about, found, advice: advice.into() }
}

fn order(expected: &Expected, check: &Check) -> Option<Finding> {
    let numbering = &check.numbering;
    let (before, known_by) = (numbering.correlation, check.compared_with);
    if numbering.best != numbering.used {
        let can_be_read =
            numbering.best.index_map(&expected.steps, expected.electrodes(), check.measurements).is_ok();
        let Numbering { used, best, rotation_ambiguous, .. } = *numbering;
        let advice = if can_be_read {
            Advice::Rearrange(Rearrangement { used, best, rotation_ambiguous })
        } else {
            let rotation = if rotation_ambiguous {
                "; the rotation cannot be told from these frames, others fit as well"
            } else {
                ""
            };
            Advice::Plain(format!(
                "the table has no such order; number the skin file's electrodes anew \
                 (`electrodes.first`, `electrodes.direction`){rotation}"
            ))
        };
        let best = numbering.best_correlation;
        let found =
            format!("another order fits {known_by} better (correlation {best:.3} instead of {before:.3})");
        return Some(fault(About::Order, found, advice));
    }
    (check.sound_correlation < RESEMBLING && (check.scatter > UNLIKE || check.bias > UNLIKE_TOGETHER))
        .then(|| resemblance(numbering, known_by))
}

/// Says how little the frames resemble the model.
fn resemblance(numbering: &Numbering, known_by: KnownBy) -> Finding {
    let Numbering { best_correlation: best, exchanged_correlation: correlation, .. } = numbering;
    let found = if *best < LEAST_FIT && *correlation < LEAST_FIT {
        format!(
            "nothing fits: no order of the measurements correlates with {known_by} by {LEAST_FIT} or more (best \
             {best:.3})"
        )
    } else {
        format!("the frames resemble {known_by} only weakly (correlation {correlation:.3}), in any order")
    };
    let advice = match known_by {
        KnownBy::Model => {
            "check that the skin file's shape, electrodes and stimulation pattern are those of the measurement"
        }
        KnownBy::GoodFrames => "check that both files are of the same skin, instrument and drive",
    };
    fault(About::Resemblance, found, advice)
}

fn single_ended(check: &Check) -> Option<Finding> {
    let found = "the square holds the potential of each electrode, not the difference of a pair (the rest is \
                 about their differences)";
    let advice = "subtract from each column the one of the pair's other electrode before reconstructing";
    check.single_ended.then(|| fault(About::SingleEnded, found.to_owned(), advice))
}

fn misplaced(check: &Check) -> impl Iterator<Item = Finding> + '_ {
    check.misplaced.iter().map(|&misplacement| misplacement_found(check, misplacement))
}

fn misplacement_found(check: &Check, misplacement: Misplacement) -> Finding {
    let fit = format!(
        "(correlation {:.3} instead of {:.3})",
        check.numbering.exchanged_correlation, check.plain_correlation
    );
    match misplacement {
        Misplacement::Transposed => fault(
            About::Transposed,
            format!("the square is transposed: its rows are sense pairs and its columns are drives {fit}"),
            "exchange rows and columns of each frame",
        ),
        Misplacement::Shifted(by) => {
            let late = (by * 2 > check.measurements).then(|| check.measurements - by);
            let found = match late {
                Some(early) => format!(
                    "the frame begins {early} values too early: its first {early} are at its end {fit}"
                ),
                None => format!("the frame begins {by} values late: its last {by} are at its start {fit}"),
            };
            fault(About::Shift, found, format!("begin each frame with its value {by} (counted from 0)"))
        }
        Misplacement::ColumnsShifted(by) => {
            let columns = check.measurements.isqrt();
            let when = if 2 * by > columns {
                format!("{} columns early", columns - by)
            } else {
                format!("{by} columns late")
            };
            fault(
                About::Shift,
                format!("each drive's values begin {when} and go on at the row's other end {fit}"),
                format!("begin each row with its column {by} (counted from 0)"),
            )
        }
        Misplacement::Rows([a, b]) => {
            let [a, b] = [a + 1, b + 1];
            fault(
                About::Rows,
                format!("the values of drives {a} and {b} are in each other's place {fit}"),
                format!("exchange rows {a} and {b} of each frame, all values of a drive"),
            )
        }
        Misplacement::Columns([a, b]) => {
            let [a, b] = [a + 1, b + 1];
            fault(
                About::Columns,
                format!("columns {a} and {b} of the square are in each other's place {fit}"),
                "exchange the two columns, or the channels of these sense pairs",
            )
        }
    }
}

fn gains(check: &Check) -> impl Iterator<Item = Finding> + '_ {
    check.gains.iter().map(|&PairGain { electrodes: [a, b], drives, gain, ambiguous }| {
        let [a, b] = [a, b].map(person);
        let side = if drives { "drive" } else { "sense" };
        let mut found = format!("{side} pair {a}-{b} reads {gain:.2} times what it should, throughout");
        if ambiguous {
            found += &format!(" (or drive pair {b}-{a} {:.2} times: reciprocity does not tell)", 1.0 / gain);
        }
        let advice = match (drives, ambiguous) {
            (_, true) => "check the gain of its sense channel, and the current of its drive",
            (true, _) => "check the current of this drive",
            (false, _) => "check the gain of its channel",
        };
        fault(About::Gain, found, advice)
    })
}

fn offset(check: &Check) -> Option<Finding> {
    let offset = check.offset.as_ref()?;
    let imaginary =
        if offset.imaginary == 0.0 { String::new() } else { format!("{:+.4}i", offset.imaginary) };
    let found = format!(
        "every value seems to hold an offset of {:.4}{imaginary}, {:.0} % of the middle value without it (correlation \
         {:.3} without it instead of {:.3})",
        offset.value, offset.share_percent, offset.correlation, offset.correlation_before
    );
    let advice = if offset.imaginary == 0.0 {
        Advice::Subtract(offset.value)
    } else {
        "subtract it from every value before".into()
    };
    Some(fault(About::Offset, found, advice))
}

fn exchanged(check: &Check) -> impl Iterator<Item = Finding> + '_ {
    check.numbering.exchanged.iter().map(|&Exchange { electrodes: [a, b], role }| {
        let (what, wires) = match role {
            Role::Both => ("electrodes", "wires"),
            Role::Drive => ("the drive side of electrodes", "drive wires"),
            Role::Sense => ("the sense side of electrodes", "sense wires"),
        };
        let [a, b] = [a, b].map(person);
        let numbering = &check.numbering;
        fault(
            About::Exchange,
            format!(
                "{what} {a} and {b} seem exchanged (correlation {:.3} instead of {:.3})",
                numbering.exchanged_correlation, numbering.best_correlation
            ),
            format!("exchange the {wires} of electrodes {a} and {b}"),
        )
    })
}

/// Electrodes as people count them.
fn person(electrode: u8) -> u16 {
    u16::from(electrode) + 1
}

fn polarity(check: &Check) -> Vec<Finding> {
    let polarity = &check.polarity;
    let mut findings = Vec::new();
    if polarity.magnitudes_only {
        let found = format!("the values have no signs, those of {} do", check.compared_with);
        findings.push(note(
            About::Polarity,
            found,
            "nothing to change, `reconstruct` takes the model's signs",
        ));
    }
    if polarity.reversed {
        let found = format!(
            "all signs are the opposite of those of {}: drive or sense pairs are the other way round",
            check.compared_with
        );
        findings.push(note(About::Polarity, found, "nothing to change, images do not depend on it"));
    }
    let pairs = |pairs: &[[u8; 2]]| {
        let pairs: Vec<_> = pairs.iter().map(|&[a, b]| format!("{}-{}", person(a), person(b))).collect();
        pairs.join(", ")
    };
    let (drives, senses) = (pairs(&polarity.reversed_drives), pairs(&polarity.reversed_senses));
    let advice = "check their direction; `reconstruct` takes the model's signs";
    if !senses.is_empty() {
        findings.push(fault(
            About::Polarity,
            format!("the signs of sense pairs {senses} are reversed"),
            advice,
        ));
    } else if !drives.is_empty() {
        findings.push(fault(
            About::Polarity,
            format!("the signs of drive pairs {drives} are reversed"),
            advice,
        ));
    } else if !polarity.disagreements.is_empty() && check.numbering.exchanged_correlation > RESEMBLING {
        let found = format!(
            "{} of {} signs disagree with those of {} (steps {})",
            polarity.disagreements.len(),
            polarity.compared,
            check.compared_with,
            first_few(&polarity.disagreements)
        );
        let advice = "check the direction of the sense pairs";
        let many = polarity.disagreements.len() as f64 > SIGNS * polarity.compared as f64;
        findings.push(if many {
            fault(About::Polarity, found, advice)
        } else {
            note(About::Polarity, found, advice)
        });
    }
    findings
}

fn electrodes(check: &Check) -> Vec<Finding> {
    let numbers = |chosen: &dyn Fn(&super::ElectrodeCheck) -> bool| -> Vec<u16> {
        check.electrodes.iter().filter(|e| chosen(e)).map(|e| person(e.electrode)).collect()
    };
    let both = numbers(&|e| e.drive_is_off() && e.sense_is_off());
    let drive = numbers(&|e| e.drive_is_off() && !e.sense_is_off());
    let sense = numbers(&|e| !e.drive_is_off() && e.sense_is_off());
    let noisy = numbers(&|e| e.is_noisy() && !e.drive_is_off() && !e.sense_is_off());
    let list = |numbers: &[u16]| numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
    let finding = |electrodes: &[u16], found: &str, advice: &str| {
        let found = format!("electrode {}: nearly all measurements that {found}", list(electrodes));
        (!electrodes.is_empty()).then(|| fault(About::Electrode, found, advice))
    };
    let off = format!("zero or far from {}", check.compared_with);
    [
        finding(&both, &format!("use it are {off}"), "check its wire and contact; it may be open or shorted"),
        finding(
            &drive,
            &format!("drive it are {off}"),
            "check its drive wire and switch; of a pair that only drives together either may be at fault",
        ),
        finding(&sense, &format!("sense it are {off}"), "check its sense wire and switch"),
        finding(&noisy, "use it are far noisier than others", "check its contact"),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Dead measurements that no dead electrode explains.
fn dead(check: &Check) -> Option<Finding> {
    let explained = check.electrodes.iter().any(|e| e.drive_is_off() || e.sense_is_off());
    let found =
        format!("{} measurements are zero (steps {})", check.dead_steps.len(), first_few(&check.dead_steps));
    (!check.dead_steps.is_empty() && !explained)
        .then(|| fault(About::Dead, found, "`reconstruct` leaves them out; check what they have in common"))
}

fn agreement(check: &Check) -> Vec<Finding> {
    let mut findings = Vec::new();
    let told = |median_percent: f64| match check.compared_with {
        KnownBy::GoodFrames if median_percent < CHANGED_PERCENT => note,
        _ => fault,
    };
    let against = match check.compared_with {
        KnownBy::Model => "",
        KnownBy::GoodFrames => ", other than in the good frames",
    };
    if let Some(reversal) = check.reversal.as_ref().filter(|it| it.median_percent > DISAGREEMENT_PERCENT) {
        let found = format!(
            "the same pairs the other way round differ by {:.0} % (median of {} pairs of steps){against}: the values \
             are not differences between two electrodes of a linear body alone",
            reversal.median_percent,
            reversal.pairs.len()
        );
        let advice =
            "check common-mode rejection, leakage, and that the sense pair is what the skin file says";
        findings.push(told(reversal.median_percent)(About::Reversal, found, advice));
    }
    let Some(reciprocity) = &check.reciprocity else { return findings };
    if reciprocity.median_percent > DISAGREEMENT_PERCENT {
        let found = format!(
            "drive and sense exchanged give voltages that differ by {:.0} % (median of {} pairs of steps){against}",
            reciprocity.median_percent,
            reciprocity.pairs.len()
        );
        let advice = "check the order of the steps, gain and settling of each channel, and contacts";
        findings.push(told(reciprocity.median_percent)(About::Reciprocity, found, advice));
    }
    findings.extend(outstanding(reciprocity));
    findings
}

fn outstanding(reciprocity: &Agreement) -> Option<Finding> {
    let limit = DISAGREEMENT_PERCENT.max(OUTSTANDING * reciprocity.median_percent);
    let worst = reciprocity.worst(limit);
    let first = worst.first()?;
    let found = format!(
        "{} of {} reciprocal pairs disagree by more than {limit:.0} %, steps {} and {} the most ({:.0} %)",
        worst.len(),
        reciprocity.pairs.len(),
        first.step,
        first.other,
        first.error_percent
    );
    Some(note(
        About::Reciprocity,
        found,
        "check the electrodes of these steps, see `reciprocity` in the report",
    ))
}

fn signal(check: &Check) -> Vec<Finding> {
    let mut findings = Vec::new();
    if let Some(saturation) = &check.saturation {
        let found = format!(
            "{} values in {} frames stand at the same limit, {}: they are clipped (steps {})",
            saturation.values,
            saturation.frames,
            saturation.limit,
            first_few(&saturation.steps)
        );
        findings.push(fault(About::Saturation, found, "lower the gain or the drive current"));
    }
    if check.repeats.frames > 0 {
        let found = format!(
            "{} of {} frames repeat an earlier one, {} of them the one just before",
            check.repeats.frames,
            check.frames,
            check.repeats.in_a_row.len()
        );
        findings.push(note(
            About::Repeats,
            found,
            "store a frame only when the instrument has measured a new one",
        ));
    }
    let Some(steadiness) = &check.steadiness else { return findings };
    if let Some(snr) = steadiness.snr_db.filter(|&snr| snr < LOW_SNR_DB) {
        let found = format!("the signal-to-noise ratio is only {snr:.0} dB");
        findings.push(note(About::Noise, found, "average frames, or raise `inverse.hyperparameter`"));
    }
    if steadiness.change_percent > CHANGE_PERCENT {
        let found = format!("the frames change by {:.1} % from first to last", steadiness.change_percent);
        let advice = "if nothing touched the skin it drifts: take the reference just before the press";
        findings.push(note(About::Change, found, advice));
    }
    findings
}
