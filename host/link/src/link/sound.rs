//! What a board says, before anybody uses it: numbers that are none make a packet a damaged one, and words are only words.

use crate::{error::Damage, words::escaped_within};
use dermatome_shared::{
    acquire::FrontEnd,
    contact::Contact,
    drive::Drive,
    health::{Health, Vitals},
    protocol::{BoardPacket, Event, Info, Reply},
};

/// The packet with its words escaped, unless a number in it is none.
pub(super) fn sound(mut packet: BoardPacket) -> Result<BoardPacket, Damage> {
    if !has_numbers(&packet) {
        return Err(Damage::NotANumber);
    }
    match &mut packet {
        BoardPacket::Reply { reply: Reply::Hello { identity, .. }, .. } => {
            identity.board = escaped_within(&identity.board);
            identity.firmware = escaped_within(&identity.firmware);
        }
        BoardPacket::Reply { reply: Reply::Info(Info { patch: Some(patch), .. }), .. } => {
            patch.skin = escaped_within(&patch.skin);
        }
        _ => {}
    }
    Ok(packet)
}

fn has_numbers(packet: &BoardPacket) -> bool {
    match packet {
        BoardPacket::Reply { reply: Reply::Info(info), .. } => {
            let of_patch = info.patch.as_ref().map(|patch| &patch.drive);
            info.front_end.as_ref().is_none_or(of_front_end)
                && info.drive.iter().chain(of_patch).all(of_drive)
        }
        BoardPacket::Event { event: Event::Contacts { contacts, .. }, .. } => contacts.iter().all(of_contact),
        BoardPacket::Event { event: Event::Health { health, vitals, drift, .. }, .. } => {
            of_health(health) && of_vitals(vitals) && drift.is_finite()
        }
        _ => true,
    }
}

/// Bandwidths of what has none are infinite.
fn of_front_end(front_end: &FrontEnd) -> bool {
    let FrontEnd { volts_per_code, full_scale_current, gain_bandwidth, lead_corner, lead, .. } = *front_end;
    let bandwidths = front_end.bandwidths.iter().chain([&gain_bandwidth, &lead_corner]);
    let range = front_end.small_range.iter().flat_map(|range| [range.full_current, range.bandwidth]);
    let trim = front_end.trim.0.as_flattened().as_flattened();
    let finite =
        [volts_per_code, full_scale_current, lead].iter().chain(trim).all(|number| number.is_finite());
    finite && bandwidths.copied().chain(range).all(|number| !number.is_nan())
}

fn of_drive(drive: &Drive) -> bool {
    let Drive { frequency, amplitude, frame_rate, phase, settling, .. } = *drive;
    [frequency, amplitude, frame_rate, phase, settling].iter().all(|number| number.is_finite())
}

/// Of a contact that says nothing of its place the deviation is infinite.
fn of_contact(contact: &Contact) -> bool {
    let Contact { position, normal, area, strength, peak, pressure, load_area, evidence, identity } = contact;
    let velocity = identity.iter().flat_map(|identity| identity.velocity);
    let places = position.iter().chain(normal).copied().chain(velocity);
    let sizes = [*area, *strength, *peak].into_iter().chain(*pressure).chain(*load_area);
    let mut evidence = evidence.iter().flat_map(|evidence| {
        [evidence.significance, evidence.position_deviation, evidence.strength_deviation]
    });
    places.chain(sizes).all(f32::is_finite) && evidence.all(|number| !number.is_nan())
}

/// An infinite contact impedance is one: its test was clipped.
fn of_health(health: &Health) -> bool {
    let is_known = health.contact_impedance.iter().all(|ohms| !ohms.is_nan());
    is_known && health.reciprocity_error.is_none_or(f32::is_finite)
}

fn of_vitals(vitals: &Vitals) -> bool {
    vitals.load.is_finite() && vitals.temperature.is_none_or(f32::is_finite)
}
