//! Contact lines: contacts for a pipe, as text or as JSON.

use dermatome_link::contacts::LinkFrame;
use dermatome_shared::{
    contact::{Contact, Contacts},
    protocol::FrameStamp,
};
use dermatome_view::terminal::flags;
use serde::Serialize;
use std::{
    io::{self, ErrorKind, Write},
    time::{SystemTime, UNIX_EPOCH},
};

/// A frame in the frame of the link, and when it came.
#[derive(Serialize)]
struct Line<'a> {
    #[serde(flatten)]
    frame: &'a LinkFrame,
    /// By this computer's clock; none of a recording.
    #[serde(skip_serializing_if = "Option::is_none")]
    host_time_s: Option<f64>,
}

/// One line of JSON for a frame, in the frame of the link; `came` is when it came, by this computer's clock.
pub(super) fn json_line(frame: &LinkFrame, came: Option<SystemTime>) -> serde_json::Result<String> {
    // Whole microseconds: what a board's time has, and a number of JSON still holds.
    let host_time_s = came.map(|came| (unix(came) * 1e6).round() / 1e6);
    Ok(serde_json::to_string(&Line { frame, host_time_s })? + "\n")
}

/// One line for each contact, in the skin's frame.
pub(super) fn contact_lines(at: FrameStamp, contacts: &Contacts, came: Option<SystemTime>) -> String {
    let came = came.map_or(String::new(), |came| format!("\t{:.6}", unix(came)));
    contacts.iter().map(|contact| line(at, contact) + &came + "\n").collect()
}

/// Seconds since the start of 1970, UTC.
fn unix(time: SystemTime) -> f64 {
    time.duration_since(UNIX_EPOCH).unwrap_or_default().as_secs_f64()
}

/// Prints the lines of a frame.
pub(super) fn print(lines: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(lines.as_bytes())?;
    out.flush()
}

/// Sequence, time, x, y, z, area, strength, pressure and force (empty where no calibration tells them), flags.
fn line(at: FrameStamp, contact: &Contact) -> String {
    let [x, y, z] = contact.position.map(|metres| metres * 1e3);
    let (sequence, time, area) = (at.sequence, seconds(at), contact.area * 1e6);
    let pressure = contact.pressure.map_or(String::new(), |pascal| format!("{:.4}", pascal * 1e-3));
    let force = contact.force().map_or(String::new(), |force| format!("{force:.5}"));
    let (strength, flags) = (contact.strength, flags(at.flags));
    format!(
        "{sequence}\t{time:.6}\t{x:.3}\t{y:.3}\t{z:.3}\t{area:.2}\t{strength:.6}\t{pressure}\t{force}\t{flags}"
    )
}

fn seconds(at: FrameStamp) -> f64 {
    at.timestamp_us as f64 / 1e6
}

/// Whether somebody still reads standard output.
pub(super) fn is_read(written: io::Result<()>) -> io::Result<bool> {
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
        other => other.map(|()| true),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::frame::FrameFlags;

    #[test]
    fn a_line_has_ten_fields_of_which_two_need_a_calibration_and_one_a_fault() {
        let at = FrameStamp { sequence: 7, timestamp_us: 1_250_000, flags: FrameFlags::default() };
        let contact = Contact {
            position: [0.01, -0.002, 0.0],
            normal: [0.0, 0.0, 1.0],
            area: 4e-6,
            strength: 0.5,
            peak: 1.0,
            pressure: None,
            load_area: None,
            evidence: None,
            identity: None,
        };
        assert_eq!(line(at, &contact), "7\t1.250000\t10.000\t-2.000\t0.000\t4.00\t0.500000\t\t\t");
        let contacts: Contacts = [contact].into_iter().collect();
        let came = UNIX_EPOCH + std::time::Duration::from_micros(1_700_000_000_123_457);
        assert!(contact_lines(at, &contacts, Some(came)).ends_with("\t0.500000\t\t\t\t1700000000.123457\n"));
        assert!(contact_lines(at, &contacts, None).ends_with("\t0.500000\t\t\t\n"));
        let calibrated = Contact { pressure: Some(12.5e3), ..contact };
        let mut flags = FrameFlags::SATURATED;
        flags.insert(FrameFlags::MASKED);
        let at = FrameStamp { flags, ..at };
        assert!(line(at, &calibrated).ends_with("\t0.500000\t12.5000\t\tsaturated, bad electrodes masked"));
        let calibrated = Contact { load_area: Some(4e-6), ..calibrated };
        assert!(line(at, &calibrated).ends_with("\t12.5000\t0.05000\tsaturated, bad electrodes masked"));
    }
}
