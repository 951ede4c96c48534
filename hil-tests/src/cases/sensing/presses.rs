//! Presses: where the board finds them, and whether it keeps track of them.

use super::{
    super::{Failure, pipeline::compare},
    ensure, next_with,
    session::{Session, stamps, tare},
};
use crate::rig::Rig;
use dermatome::{link::Subscription, simulate::Press, skin::FoundIn};
use dermatome_shared::{
    calibration::{Calibration, CalibrationPoint},
    contact::{Contact, Contacts},
    protocol::{FrameStamp, Selection},
};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

/// Presses tried.
const PRESSES: usize = 40;
/// Frames compared with the host's, so few in a second that the line has room for image and codes of each.
const COMPARED: usize = 100;
const COMPARED_RATE: f64 = 25.0;
/// The same frames of a finger that stretches the skin by this share.
const STRETCHED: usize = 40;
const STRETCH: f64 = 0.01;
/// Noise, over that of the parts: 60 dB at the median channel, where the parts alone leave 65.4 dB.
const NOISE: f64 = 1.86;
/// Largest normalised radius at which they lie.
const LARGEST_RADIUS: f64 = 0.75;

pub(super) fn in_image(rig: &Rig) -> Result<String, Failure> {
    positions(rig, FoundIn::Image, 0.02, 0.5)
}

/// A fingertip, of which an image shows little.
pub(super) fn in_voltages(rig: &Rig) -> Result<String, Failure> {
    let found = positions(rig, FoundIn::Voltages, 0.0084, 1.0)?;
    let (session, mut link) = Session::open(rig, |skin| {
        skin.drive.frame_rate = COMPARED_RATE;
        skin.contacts_found_in = FoundIn::Voltages;
    })?;
    session.world.noise(NOISE);
    let three = [[0.05, 0.02], [-0.05, 0.03], [0.0, -0.06]].map(|place| Press::finger(place, 0.0126, 1.0));
    let frames = compare(&mut link, &session.patch(), COMPARED, || session.world.press(&three))?;
    session.world.press(&[]);
    let pressed = [0.035, -0.04];
    let mut stretched = Ok(());
    let beside = compare(&mut link, &session.patch(), STRETCHED, || {
        session.world.press(&[Press::finger(pressed, 0.0084, 1.0)]);
        stretched = session.world.stretch(STRETCH);
    })?;
    stretched.map_err(Failure::wrong)?;
    let mut stream = link.subscribe(Selection { contacts: 1, ..Selection::default() })?;
    let (_, contacts) = contacts(&mut stream)?;
    let off = |contact: &Contact| {
        let [x, y, _] = contact.position.map(f64::from);
        (x - pressed[0]).hypot(y - pressed[1])
    };
    let is_there = matches!(&contacts[..], [one] if off(one) < 0.01);
    ensure(is_there, || format!("a finger that stretches the skin is found as {contacts:?}"))?;
    Ok(format!(
        "{found}; {frames} frames of three as the host finds them, bit for bit, and {beside} of one that stretches the skin by {:.0} %",
        100.0 * STRETCH
    ))
}

fn positions(rig: &Rig, found_in: FoundIn, finger: f64, depth: f64) -> Result<String, Failure> {
    let (session, mut link) = Session::open(rig, |skin| {
        skin.drive.frame_rate = 10_000.0;
        skin.contacts_found_in = found_in;
    })?;
    session.world.noise(NOISE);
    tare(&mut link, 20)?;
    let radius = 0.105;
    let mut random = Pcg64::seed_from_u64(21);
    let mut errors = Vec::new();
    let mut stream = link.subscribe(Selection { contacts: 1, ..Selection::default() })?;
    for _ in 0..PRESSES {
        let (angle, distance) = (
            random.random_range(0.0..std::f64::consts::TAU),
            radius * LARGEST_RADIUS * random.random::<f64>().sqrt(),
        );
        let position = [distance * angle.cos(), distance * angle.sin()];
        session.world.press(&[Press::finger(position, finger, depth)]);
        // The frame under way, and those that wait.
        stamps(&mut stream, 4)?;
        let (_, contacts) = contacts(&mut stream)?;
        let contact =
            contacts.first().ok_or_else(|| Failure::wrong(format!("no contact at {position:?}")))?;
        let [x, y, _] = contact.position.map(f64::from);
        errors.push((x - position[0]).hypot(y - position[1]) / (2.0 * radius));
        session.world.press(&[]);
        stamps(&mut stream, 4)?;
    }
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    let worst = errors.iter().copied().fold(0.0, f64::max);
    ensure(mean <= 0.04, || format!("mean error {:.2} % of the diameter", 100.0 * mean))?;
    Ok(format!(
        "{PRESSES} presses of {:.0} mm within {:.0} % of the radius, 60 dB: mean error {:.2} %, worst {:.2} % of the diameter",
        2e3 * finger,
        100.0 * LARGEST_RADIUS,
        100.0 * mean,
        100.0 * worst
    ))
}

/// Ten minutes under a finger, while the sheet's conductivity grows by 1 % a minute; one frame a second.
pub(super) fn long(rig: &Rig) -> Result<String, Failure> {
    let (session, mut link) = Session::open(rig, |skin| {
        skin.drive.frame_rate = 1.0;
        let points =
            [(0.2, 20e3), (0.4, 60e3)].map(|(strength, pressure)| CalibrationPoint { strength, pressure });
        skin.calibration = Calibration { points: points.into_iter().collect(), load_share: Some(0.5) };
    })?;
    tare(&mut link, 5)?;
    let mut stream = link.subscribe(Selection { contacts: 1, ..Selection::default() })?;
    session.world.drift(0.01);
    stamps(&mut stream, 20)?;
    session.world.press(&[Press::finger([0.03, 0.02], 0.025, 0.5)]);
    stamps(&mut stream, 3)?;
    let first = force(&mut stream)?;
    let (mut last, mut largest) = (first, 0.0_f64);
    for _ in 0..600 {
        last = force(&mut stream)?;
        largest = largest.max((last / first - 1.0).abs());
    }
    ensure(largest <= 0.1, || format!("the force is off by up to {:.1} %", 100.0 * largest))?;
    session.world.press(&[]);
    stamps(&mut stream, 5)?;
    let (_, left) = contacts(&mut stream)?;
    ensure(left.is_empty(), || "the contact stays after the finger has gone".to_owned())?;
    Ok(format!(
        "reported in all of 600 frames, {first:.1} N at first and {last:.1} N at last, off by at most {:.1} %; gone \
         when released",
        100.0 * largest
    ))
}

/// Force of the one contact in the next frame.
fn force(stream: &mut Subscription<'_>) -> Result<f64, Failure> {
    let (at, contacts) = contacts(stream)?;
    ensure(contacts.len() == 1, || format!("in frame {}: {contacts:.4?}", at.sequence))?;
    let force = contacts[0].force().ok_or_else(|| Failure::wrong("a contact without a force"))?;
    Ok(force.into())
}

fn contacts(stream: &mut Subscription<'_>) -> Result<(FrameStamp, Contacts), Failure> {
    next_with(stream, |frame| frame.contacts)
}
