//! Readings from a board while a machine loads its skin.

use super::{Hold, Reading};
use crate::link::{self, Link, LinkError};
use dermatome_shared::protocol::{Event, Selection};
use std::time::{Duration, Instant};

/// The part of each hold that counts: behind the skin's settling, and before a machine that is a little early.
const COUNTED: [f64; 2] = [0.5, 0.9];

/// Streams contacts while the loads are applied, the first frame at time 0, and averages the strongest
/// contact over the later half of each hold. The last load is held as long as the one before it.
///
/// A frame without contact counts as strength 0. `progress` hears of each reading; silence longer than
/// `patience` ends it with an error.
pub fn measure(
    link: &mut Link,
    loads: &[Hold],
    patience: Duration,
    mut progress: impl FnMut(&Reading),
) -> Result<Vec<Reading>, MeasureError> {
    link::stream(link, Selection { contacts: 1, ..Selection::default() })?;
    let mut hold = Averager::default();
    let (mut readings, mut start, mut last_event) = (Vec::new(), None, Instant::now());
    while readings.len() < loads.len() {
        let Some(event) = link.next_event(patience)? else {
            if last_event.elapsed() >= patience {
                return Err(MeasureError::Silence { seconds: patience.as_secs_f64() });
            }
            continue;
        };
        let Event::Contacts { at, contacts } = event else { continue };
        last_event = Instant::now();
        let since_start = at.timestamp_us.checked_sub(*start.get_or_insert(at.timestamp_us));
        let time = since_start.ok_or(MeasureError::Restarted)? as f64 * 1e-6;
        while readings.len() < loads.len() && time >= end_of(loads, readings.len()) {
            let reading = hold.finish(loads[readings.len()])?;
            progress(&reading);
            readings.push(reading);
        }
        let Some(load) = loads.get(readings.len()) else { break };
        let share = (time - load.time_s) / (end_of(loads, readings.len()) - load.time_s);
        if (COUNTED[0]..COUNTED[1]).contains(&share) {
            hold.add(contacts.first().map_or(0.0, |contact| f64::from(contact.strength)));
        }
    }
    link::stream(link, Selection::default())?;
    Ok(readings)
}

/// When a hold ends, s.
fn end_of(loads: &[Hold], index: usize) -> f64 {
    match loads.get(index + 1) {
        Some(next) => next.time_s,
        None => 2.0 * loads[index].time_s - index.checked_sub(1).map_or(0.0, |before| loads[before].time_s),
    }
}

/// Mean of one hold's frames.
#[derive(Default)]
struct Averager {
    strengths: Vec<f64>,
}

impl Averager {
    fn add(&mut self, strength: f64) {
        self.strengths.push(strength);
    }

    fn finish(&mut self, load: Hold) -> Result<Reading, MeasureError> {
        let strengths = std::mem::take(&mut self.strengths);
        if strengths.is_empty() {
            return Err(MeasureError::NoFrames { time_s: load.time_s });
        }
        let count = strengths.len() as f64;
        let strength = strengths.iter().sum::<f64>() / count;
        let variance = strengths.iter().map(|value| (value - strength).powi(2)).sum::<f64>() / count;
        Ok(Reading { pressure_kpa: load.pressure_kpa, strength, deviation: (variance / count).sqrt() })
    }
}

/// Why there are no readings.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    /// The link failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// A load was held too briefly.
    #[error(
        "no frame came in the later half of the load at `time_s` = {time_s}; allowed: holds of several frames"
    )]
    NoFrames {
        /// When the load was applied, s.
        time_s: f64,
    },
    /// The board's clock went back, and with it its tare is gone.
    #[error("the board started again while the machine loaded the skin; tare and load it again")]
    Restarted,
    /// The board sends nothing any more.
    #[error("the board sent no frame for {seconds} s")]
    Silence {
        /// How long, s.
        seconds: f64,
    },
}
