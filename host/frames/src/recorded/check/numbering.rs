//! Which electrode of the skin each electrode of the file is.

use super::{
    super::{
        diagnose::{RESEMBLING, TIE, another_rotation_ties, best, is_clearly_better},
        order::{Arrangement, OrderError},
    },
    Expected, Readings, Reference,
};
use dermatome_shared::stimulation::Step;
use rayon::prelude::*;
use serde::Serialize;

/// Exchanged electrodes that are looked for.
const MOST_EXCHANGES: usize = 4;
/// Electrodes that are tried against each other: those that fit worst.
const SUSPECTS: usize = 16;
/// An exchange must explain this share of what is unexplained.
const EXPLAINED: f64 = 0.5;

/// What the reference says about the order and the numbers of a file's electrodes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Numbering {
    /// The arrangement asked for.
    pub used: Arrangement,
    /// Its correlation of log magnitudes with the model, -1 to 1.
    pub correlation: f64,
    /// The best arrangement; of those that tie, the one with the fewest changes.
    pub best: Arrangement,
    /// Its correlation.
    pub best_correlation: f64,
    /// Whether another rotation is as good as the best one, as on any disc.
    pub rotation_ambiguous: bool,
    /// Electrodes that seem to be exchanged, besides.
    pub exchanged: Vec<Exchange>,
    /// The correlation once they are put right; that of `best` if there are none.
    pub exchanged_correlation: f64,
}

/// Two electrodes that are exchanged, by the file's numbers from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Exchange {
    /// Which ones.
    pub electrodes: [u8; 2],
    /// Where.
    pub role: Role,
}

/// What an electrode is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// To drive and to sense.
    Both,
    /// To drive.
    Drive,
    /// To sense.
    Sense,
}

/// The model's electrode behind each electrode of the file.
#[derive(Clone, Debug)]
pub(super) struct Wiring {
    pub(super) arrangement: Arrangement,
    drive: Vec<u8>,
    sense: Vec<u8>,
}

impl Wiring {
    pub(super) fn new(arrangement: Arrangement, electrodes: u8) -> Self {
        let on_model: Vec<u8> = (0..electrodes).map(|k| arrangement.on_model(k, electrodes)).collect();
        Self { arrangement, drive: on_model.clone(), sense: on_model }
    }

    pub(super) fn with(&self, exchange: Exchange) -> Self {
        let mut wiring = self.clone();
        let [a, b] = exchange.electrodes.map(usize::from);
        if exchange.role != Role::Sense {
            wiring.drive.swap(a, b);
        }
        if exchange.role != Role::Drive {
            wiring.sense.swap(a, b);
        }
        wiring
    }

    /// A step of the file in the model's numbers.
    pub(super) fn step(&self, step: Step) -> Step {
        let (drive, sense) = (|e: u8| self.drive[usize::from(e)], |e: u8| self.sense[usize::from(e)]);
        Step {
            drive_plus: drive(step.drive_plus),
            drive_minus: drive(step.drive_minus),
            sense_plus: sense(step.sense_plus),
            sense_minus: sense(step.sense_minus),
        }
    }
}

/// A wiring, the exchanges that led to it, and how well it fits.
#[derive(Clone)]
struct Explanation {
    wiring: Wiring,
    exchanged: Vec<Exchange>,
    correlation: f64,
}

/// Finds order, rotation, mirror and exchanged electrodes.
pub(super) fn find(
    expected: &Expected,
    reference: &Reference,
    used: Arrangement,
) -> Result<(Numbering, Wiring), OrderError> {
    let correlations = correlations(expected, reference, used)?;
    let of = |wanted: Arrangement| correlations.iter().find(|(a, _)| *a == wanted).map_or(0.0, |(_, c)| *c);
    let (best, best_correlation) = best(&correlations, used);
    let correlation = of(used);
    let taken = if is_clearly_better(best_correlation, correlation) { best } else { used };
    let explain = |arrangement| explain(expected, reference, arrangement, of(arrangement));
    let mut explanation = explain(taken)?;
    if taken != used {
        // The simpler explanation: electrodes exchanged, but nothing turned round.
        let plain = explain(used)?;
        explanation = if plain.correlation > explanation.correlation - TIE { plain } else { explanation };
    }
    let best = if explanation.exchanged.is_empty() { best } else { explanation.wiring.arrangement };
    let numbering = Numbering {
        used,
        correlation,
        best,
        best_correlation: of(best),
        rotation_ambiguous: another_rotation_ties(&correlations, best),
        exchanged_correlation: if explanation.exchanged.is_empty() {
            of(best)
        } else {
            explanation.correlation
        },
        exchanged: explanation.exchanged,
    };
    Ok((numbering, explanation.wiring))
}

/// Every arrangement with its correlation.
pub(super) fn correlations(
    expected: &Expected,
    reference: &Reference,
    used: Arrangement,
) -> Result<Vec<(Arrangement, f64)>, OrderError> {
    // What `used` cannot be read as is an error; another order that cannot be is only left out.
    let fit =
        |arrangement: Arrangement| fit(expected, reference, &Wiring::new(arrangement, expected.electrodes));
    fit(used)?;
    let all: Vec<_> = Arrangement::all(expected.electrodes).collect();
    Ok(all.into_par_iter().filter_map(|arrangement| Some((arrangement, fit(arrangement).ok()?))).collect())
}

fn fit(expected: &Expected, reference: &Reference, wiring: &Wiring) -> Result<f64, OrderError> {
    Ok(Readings::of(expected, reference, wiring)?.correlation())
}

/// Exchanges electrodes one pair after the other, as long as each explains much of what is left.
fn explain(
    expected: &Expected,
    reference: &Reference,
    arrangement: Arrangement,
    correlation: f64,
) -> Result<Explanation, OrderError> {
    let wiring = Wiring::new(arrangement, expected.electrodes);
    let mut explanation = Explanation { wiring, exchanged: Vec::new(), correlation };
    let mut last = explanation.clone();
    let unexplained = |explanation: &Explanation| 1.0 - explanation.correlation;
    for _ in 0..MOST_EXCHANGES {
        if unexplained(&last) < TIE {
            break;
        }
        let Some(next) = best_exchange(expected, reference, &last)? else { break };
        last = next;
        let much = unexplained(&last) < EXPLAINED * unexplained(&explanation)
            && last.correlation > explanation.correlation + TIE;
        if much && last.correlation > RESEMBLING {
            explanation = last.clone();
        }
    }
    Ok(explanation)
}

/// The exchange that helps most; `None` if none does.
fn best_exchange(
    expected: &Expected,
    reference: &Reference,
    last: &Explanation,
) -> Result<Option<Explanation>, OrderError> {
    let suspects = suspects(expected, &Readings::of(expected, reference, &last.wiring)?);
    let mut best: Option<Explanation> = None;
    for (i, &a) in suspects.iter().enumerate() {
        for &b in &suspects[..i] {
            for role in [Role::Both, Role::Drive, Role::Sense] {
                let exchange = Exchange { electrodes: [a.min(b), a.max(b)], role };
                let wiring = last.wiring.with(exchange);
                let correlation = fit(expected, reference, &wiring)?;
                if correlation > best.as_ref().unwrap_or(last).correlation + 1e-9 {
                    let exchanged = [&last.exchanged[..], &[exchange]].concat();
                    best = Some(Explanation { wiring, exchanged, correlation });
                }
            }
        }
    }
    Ok(best)
}

/// Electrodes whose steps fit worst.
fn suspects(expected: &Expected, readings: &Readings) -> Vec<u8> {
    let mut sums = vec![(0.0, 0_u32); usize::from(expected.electrodes)];
    for (step, residual) in expected.steps.iter().zip(readings.residuals()) {
        for electrode in step.to_bytes() {
            let (sum, count) = &mut sums[usize::from(electrode)];
            *sum += residual.unwrap_or(0.0).abs();
            *count += 1;
        }
    }
    let mean = |electrode: &u8| {
        let (sum, count) = sums[usize::from(*electrode)];
        sum / f64::from(count.max(1))
    };
    let mut electrodes: Vec<u8> = (0..expected.electrodes).collect();
    electrodes.sort_by(|a, b| mean(b).total_cmp(&mean(a)));
    electrodes.truncate(SUSPECTS);
    electrodes
}
