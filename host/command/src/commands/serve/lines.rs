//! Lines of JSON: one for each frame, and for each change of a board.

use dermatome_body::{
    Sense,
    contact::{SkinContact, Wrench},
    keeper::State,
};
use dermatome_link::contacts::{LinkContact, LinkReflexes};
use serde::Serialize;

/// The contacts of a frame, and what presses on their link.
#[derive(Serialize)]
struct FrameLine<'a> {
    patch: &'a str,
    link: &'a str,
    sequence: u32,
    /// When the scan ended, s since 1970, by this computer's clock.
    time_s: f64,
    /// By the board's.
    device_time_s: f64,
    /// Whether nothing is known to be wrong.
    valid: bool,
    flags: Vec<&'static str>,
    contacts: Vec<ContactLine<'a>>,
    /// Of all skins on the link, about its origin.
    wrench: Option<WrenchLine>,
}

#[derive(Serialize)]
struct ContactLine<'a> {
    #[serde(flatten)]
    contact: LinkContact,
    geometric_centre_m: [f64; 3],
    /// What it does to the link, about its centre of pressure.
    wrench: Option<WrenchLine>,
    pixels: &'a [u16],
}

#[derive(Serialize)]
struct WrenchLine {
    force_n: [f64; 3],
    moment_n_m: [f64; 3],
}

#[derive(Serialize)]
struct StateLine<'a> {
    patch: &'a str,
    link: &'a str,
    state: &'a State,
}

#[derive(Serialize)]
struct ReflexLine<'a> {
    patch: &'a str,
    link: &'a str,
    reflexes: LinkReflexes,
}

impl<'a> ContactLine<'a> {
    fn of(it: &'a SkinContact) -> Self {
        Self {
            contact: LinkContact::new(it.contact),
            geometric_centre_m: it.geometric_centre,
            wrench: it.wrench.map(WrenchLine::from),
            pixels: &it.pixels,
        }
    }
}

impl From<Wrench> for WrenchLine {
    fn from(wrench: Wrench) -> Self {
        Self { force_n: wrench.force, moment_n_m: wrench.moment }
    }
}

/// The last frame of a skin, and what presses on its link, as a line.
pub(in crate::commands) fn frame(sense: &Sense, wrench: Option<Wrench>) -> serde_json::Result<String> {
    let Some(report) = &sense.report else { return Ok(String::new()) };
    let line = FrameLine {
        patch: &sense.name,
        link: &sense.link,
        sequence: report.at.sequence,
        time_s: report.time_ns as f64 * 1e-9,
        device_time_s: report.at.timestamp_us as f64 * 1e-6,
        valid: report.is_valid(),
        flags: report.at.flags.words().collect(),
        contacts: report.contacts.iter().map(ContactLine::of).collect(),
        wrench: wrench.map(WrenchLine::from),
    };
    Ok(serde_json::to_string(&line)? + "\n")
}

/// How a board stands now, as a line without its end.
pub(in crate::commands) fn state(sense: &Sense) -> serde_json::Result<String> {
    serde_json::to_string(&StateLine { patch: &sense.name, link: &sense.link, state: &sense.state })
}

/// What the reflexes of a board's patch say now, as a line without its end; none without reflexes.
pub(in crate::commands) fn reflexes(sense: &Sense) -> serde_json::Result<Option<String>> {
    let line = |reflexes| ReflexLine { patch: &sense.name, link: &sense.link, reflexes };
    sense.reflexes.as_ref().map(|it| serde_json::to_string(&line(it.into()))).transpose()
}

/// Frames that nobody read in time, as a line without its end.
pub(in crate::commands) fn dropped(frames: u64) -> String {
    format!("{{\"frames_dropped\":{frames}}}")
}
