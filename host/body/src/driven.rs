//! Driven: how a board drives its skin, and what it can be asked for instead.

use dermatome_shared::{
    acquire::FrontEnd,
    drive::{Drive, Gain},
    scan::Timing,
};

/// How a board drives its skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Driven {
    /// Now.
    pub drive: Drive,
    /// What it can; none where it does not tell.
    pub front_end: Option<FrontEnd>,
}

/// Why a skin cannot be driven like that.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{field}` is {value}; allowed: {allowed}")]
pub struct DriveError {
    /// The field of the drive.
    pub field: String,
    /// What it is.
    pub value: String,
    /// What it may be.
    pub allowed: String,
}

impl Driven {
    /// Whether the board can drive its skin like this.
    pub fn check(&self, drive: &Drive) -> Result<(), DriveError> {
        drive.check().map_err(|words| in_words(words, drive))?;
        let Some(front_end) = &self.front_end else { return Ok(()) };
        let refuse = |field: &str, allowed| {
            Err(DriveError { field: field.to_owned(), value: value_of(field, drive), allowed })
        };
        if !front_end.reaches(drive.amplitude) {
            return refuse("amplitude", format!("above 0 to {} A", front_end.full_scale_current));
        }
        if !drive.gain.is_within(front_end.largest_gain) {
            return refuse("gain", format!("automatic, or at most {}", front_end.largest_gain));
        }
        if Timing::new(drive, front_end.sample_rate).is_none() {
            let rate = front_end.sample_rate;
            let allowed =
                format!("one of which a period is an even number of samples, 8 to 160, at {rate} a second");
            return refuse("frequency", allowed);
        }
        Ok(())
    }
}

/// What [`Drive::check`] says, `drive.FIELD (ALLOWED)`, with the value.
fn in_words(words: &str, drive: &Drive) -> DriveError {
    let (field, allowed) = words.split_once(" (").unwrap_or((words, ""));
    let field = field.trim_start_matches("drive.");
    DriveError {
        field: field.to_owned(),
        value: value_of(field, drive),
        allowed: allowed.trim_end_matches(')').to_owned(),
    }
}

fn value_of(field: &str, drive: &Drive) -> String {
    match field {
        "frequency" => format!("{} Hz", drive.frequency),
        "amplitude" => format!("{} A", drive.amplitude),
        "frame_rate" => format!("{} a second", drive.frame_rate),
        "phase" => format!("{} degrees", drive.phase),
        "settling" => drive.settling.to_string(),
        "integration" => drive.integration.to_string(),
        _ => match drive.gain {
            Gain::Automatic => "automatic".to_owned(),
            Gain::Fixed(gain) => gain.to_string(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::acquire::trim::Trim;

    const FRONT_END: FrontEnd = FrontEnd {
        sample_rate: 2_000_000,
        volts_per_code: 1e-4,
        full_scale_current: 1e-3,
        small_range: None,
        gain_bandwidth: 13e6,
        largest_gain: 64,
        bandwidths: [f32::INFINITY; 4],
        lead_corner: f32::INFINITY,
        waveform_rate: 3_200_000,
        lead: 0.0,
        trim: Trim::NONE,
    };

    #[test]
    fn what_a_board_cannot_do_is_refused_in_words() {
        let drive = Drive::new(50e3, 1e-3, 50.0);
        let driven = Driven { drive, front_end: Some(FRONT_END) };
        assert_eq!(driven.check(&drive), Ok(()));
        let cases = [
            (Drive { frequency: -1.0, ..drive }, "`frequency` is -1 Hz; allowed: more than 0 Hz"),
            (Drive { frequency: 51e3, ..drive }, "`frequency` is 51000 Hz; allowed: one of which a period"),
            (Drive { amplitude: 5.0, ..drive }, "`amplitude` is 5 A; allowed: above 0 to"),
            (
                Drive { frame_rate: f32::INFINITY, ..drive },
                "`frame_rate` is inf a second; allowed: more than",
            ),
            (
                Drive { frame_rate: 1e9, ..drive },
                "`frame_rate` is 1000000000 a second; allowed: more than 0 Hz, at most 100 kHz",
            ),
            (Drive { gain: Gain::Fixed(3), ..drive }, "`gain` is 3; allowed: automatic, 1, 2"),
        ];
        for (drive, words) in cases {
            let error = driven.check(&drive).unwrap_err().to_string();
            assert!(error.starts_with(words), "{error}");
        }
    }
}
