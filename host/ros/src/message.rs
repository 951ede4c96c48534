//! Message: what a body knows, as ROS says it.

use dermatome_body::{
    Report, Sense,
    contact::{self, Wrench},
    file::BodyFile,
    keeper::Phase,
};
use dermatome_messages::{
    dermatome::{Contact, SkinContact, SkinContactArray},
    scene::{ERROR, WARN, health_values, transform, tripped_value},
    standard::{self, DiagnosticStatus, Header, KeyValue, TfMessage, Time, WrenchStamped},
};
use dermatome_shared::frame::FrameFlags;

use crate::names::skin_frame;

/// Level of a diagnostic.
const OK: u8 = 0;

fn header(link: &str, time_ns: u64) -> Header {
    Header { stamp: Time::of_nanoseconds(time_ns), frame_id: link.to_owned() }
}

/// The contacts of a frame.
pub(crate) fn contacts(sense: &Sense, report: &Report) -> SkinContactArray {
    SkinContactArray {
        header: header(&sense.link, report.time_ns),
        patch: sense.name.clone(),
        sequence: report.at.sequence,
        device_time_us: report.at.timestamp_us,
        flags: report.at.flags.0,
        valid: report.is_valid(),
        contacts: report.contacts.iter().map(skin_contact).collect(),
    }
}

/// That the contacts before are over.
pub(crate) fn no_contacts(sense: &Sense, time_ns: u64) -> SkinContactArray {
    let header = header(&sense.link, time_ns);
    SkinContactArray { header, patch: sense.name.clone(), ..SkinContactArray::default() }
}

fn skin_contact(it: &contact::SkinContact) -> SkinContact {
    SkinContact {
        contact: Contact::new(&it.contact),
        geometric_centre: it.geometric_centre.into(),
        has_wrench: it.wrench.is_some(),
        wrench: it.wrench.map(wrench).unwrap_or_default(),
        pixels: it.pixels.clone(),
    }
}

fn wrench(wrench: Wrench) -> standard::Wrench {
    standard::Wrench { force: wrench.force.into(), torque: wrench.moment.into() }
}

/// What presses on a link, about its origin; NaN where that is no longer known.
pub(crate) fn link_wrench(link: &str, known: Option<Wrench>, time_ns: u64) -> WrenchStamped {
    let unknown = Wrench { force: [f64::NAN; 3], moment: [f64::NAN; 3] };
    WrenchStamped { header: header(link, time_ns), wrench: wrench(known.unwrap_or(unknown)) }
}

/// Where all skins lie.
pub(crate) fn transforms(file: &BodyFile, time_ns: u64) -> TfMessage {
    let each = file.patches.iter();
    let placed = each.map(|patch| transform(&patch.pose, &skin_frame(&file.name, &patch.name), time_ns));
    TfMessage { transforms: placed.collect() }
}

/// How a skin stands, with what was wrong with its frames, and which reflexes were tripped, since the last time.
pub(crate) fn status(
    robot: &str,
    port: String,
    sense: &Sense,
    (flags, tripped): (FrameFlags, u8),
) -> DiagnosticStatus {
    let is_blind = sense.reflexes.as_ref().is_some_and(|reflexes| reflexes.is_blind);
    let of_reflexes = [(tripped > 0, "reflex tripped"), (is_blind, "reflexes blind")];
    let of_reflexes = of_reflexes.into_iter().filter_map(|(is_so, words)| is_so.then_some(words));
    let problems: Vec<&str> = flags.words().chain(of_reflexes).collect();
    let state = &sense.state;
    let (level, message) = match state.phase {
        Phase::Live if !problems.is_empty() => (WARN, problems.join(", ")),
        Phase::Live if state.text.is_empty() => (OK, "all is well".to_owned()),
        Phase::Live | Phase::NotTared | Phase::Taring => (WARN, state.text.clone()),
        Phase::NoBoard | Phase::Lost | Phase::NoPatch | Phase::OtherPatch | Phase::Ended => {
            let text = if state.text.is_empty() { "nothing has come from its board" } else { &state.text };
            (ERROR, text.to_owned())
        }
    };
    let name = format!("{robot}: {}", sense.name);
    DiagnosticStatus { level, name, message, hardware_id: port, values: values(sense, tripped) }
}

fn values(sense: &Sense, tripped: u8) -> Vec<KeyValue> {
    let value = |key: &str, value: String| KeyValue { key: key.to_owned(), value };
    let mut values = vec![
        value("link", sense.link.clone()),
        value("frames", sense.frames.to_string()),
        value("frames missing", sense.missing.to_string()),
        value("losses", sense.losses.to_string()),
    ];
    if let Some(jitter) = sense.jitter() {
        let ms = |ns: u64| format!("{:.3}", ns as f64 * 1e-6);
        values.push(value("jitter, median, ms", ms(jitter.median_ns)));
        values.push(value("jitter, largest, ms", ms(jitter.largest_ns)));
        values.push(value("clock skew, ppm", format!("{:.1}", jitter.skew * 1e6)));
    }
    values.extend(sense.health.as_ref().map(health_values).unwrap_or_default());
    values.extend(sense.reflexes.as_ref().map(|_| tripped_value(tripped)));
    values
}
