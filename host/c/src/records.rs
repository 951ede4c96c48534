//! Records: what goes between a controller and the library, in C's layout. Units are SI; what is not known is NaN, or 0 where
//! it is whole.

use crate::{failure::Failure, words::array};
use core::ffi::c_char;
use dermatome_link::{
    Link, ScanFrame, Totals,
    pose::Pose as LinkPose,
    shared::{
        MAX_CONTACTS,
        contact::Contact as BoardContact,
        drive::{Component, Drive as BoardDrive, Gain},
        frame::FrameFlags,
        protocol::{Identity as BoardIdentity, Info, PatchInfo},
        surface::{Pixel as PatchPixel, Surface},
    },
};

/// Most contacts of a frame.
pub const DERMATOME_MAX_CONTACTS: usize = 8;
/// Most pixels of an image.
pub const DERMATOME_MAX_PIXELS: usize = 1024;
/// Bytes of a name, its NUL included.
pub const DERMATOME_NAME_BYTES: usize = 40;

/// The part of a voltage in phase with the current goes into the image.
pub const DERMATOME_REAL: u8 = 0;
/// The part in quadrature.
pub const DERMATOME_IMAGINARY: u8 = 1;
/// The length of the phasor.
pub const DERMATOME_MAGNITUDE: u8 = 2;

const _: () = {
    assert!(DERMATOME_MAX_CONTACTS == MAX_CONTACTS);
    assert!(DERMATOME_MAX_PIXELS == dermatome_link::shared::MAX_PIXELS);
    // Programs that are built hold these sizes: a record that changes is another version of the library.
    assert!(size_of::<Identity>() == 80 && size_of::<Drive>() == 24 && size_of::<Skin>() == 80);
    assert!(size_of::<Pixel>() == 28 && size_of::<Pose>() == 56 && size_of::<Options>() == 12);
    assert!(size_of::<Contact>() == 84 && size_of::<Counts>() == 64 && size_of::<Frame>() == 760);
};

/// Who a board is.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Identity {
    /// Kind of board, such as "nucleo-g474re" or "simulated".
    pub board: [c_char; DERMATOME_NAME_BYTES],
    /// Version of its firmware.
    pub firmware: [c_char; DERMATOME_NAME_BYTES],
}

impl Identity {
    pub(crate) fn new(identity: &BoardIdentity) -> Self {
        Self { board: array(&identity.board), firmware: array(&identity.firmware) }
    }
}

/// How a skin is driven and measured.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drive {
    /// Carrier frequency, Hz.
    pub frequency: f32,
    /// Current amplitude, A.
    pub amplitude: f32,
    /// Frames a second, at most.
    pub frame_rate: f32,
    /// By how much the in-phase reference lags the current, degrees, 0 to 360.
    pub phase: f32,
    /// Carrier periods between switching and measuring, 0 to 100.
    pub settling: f32,
    /// Carrier periods over which a voltage is measured, 1 to 64.
    pub integration: u8,
    /// Gain of the amplifier: 1, 2, 4, 8, 16, 32 or 64; 0 where the board finds it.
    pub gain: u8,
    /// Which part of a voltage goes into the image: DERMATOME_REAL, _IMAGINARY or _MAGNITUDE.
    pub component: u8,
    /// 0.
    pub reserved: u8,
}

impl Drive {
    pub(crate) fn new(drive: &BoardDrive) -> Self {
        let BoardDrive { frequency, amplitude, frame_rate, phase, settling, integration, .. } = *drive;
        let gain = match drive.gain {
            Gain::Automatic => 0,
            Gain::Fixed(gain) => gain,
        };
        let component = match drive.component {
            Component::Real => DERMATOME_REAL,
            Component::Imaginary => DERMATOME_IMAGINARY,
            Component::Magnitude => DERMATOME_MAGNITUDE,
        };
        Self { frequency, amplitude, frame_rate, phase, settling, integration, gain, component, reserved: 0 }
    }

    pub(crate) fn read(self) -> Result<BoardDrive, Failure> {
        let Self { frequency, amplitude, frame_rate, phase, settling, integration, .. } = self;
        let gain = if self.gain == 0 { Gain::Automatic } else { Gain::Fixed(self.gain) };
        let component = match self.component {
            DERMATOME_REAL => Component::Real,
            DERMATOME_IMAGINARY => Component::Imaginary,
            DERMATOME_MAGNITUDE => Component::Magnitude,
            _ => return Err(Failure::Argument("drive.component (DERMATOME_REAL, _IMAGINARY or _MAGNITUDE)")),
        };
        let drive =
            BoardDrive { frequency, amplitude, frame_rate, phase, settling, integration, gain, component };
        drive.check().map_err(Failure::Argument)?;
        Ok(drive)
    }
}

/// The skin that a board knows, by its patch.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Skin {
    /// Name.
    pub name: [c_char; DERMATOME_NAME_BYTES],
    /// Checksum of the patch, which identifies it: the last four bytes of its file, the lowest first.
    pub patch_crc: u32,
    /// Electrodes.
    pub electrodes: u16,
    /// Steps in a frame.
    pub steps: u16,
    /// Pixels of the image.
    pub pixels: u16,
    /// 1 where there is a reference, so that contacts can be found; else 0.
    pub has_reference: u8,
    /// 0.
    pub reserved: [u8; 5],
    /// How it is driven.
    pub drive: Drive,
}

impl Skin {
    pub(crate) fn new(info: &Info, patch: &PatchInfo) -> Self {
        Self {
            name: array(&patch.skin),
            patch_crc: patch.crc,
            electrodes: patch.electrodes.into(),
            steps: patch.steps,
            pixels: patch.pixels,
            has_reference: info.tared.into(),
            reserved: [0; 5],
            drive: Drive::new(info.drive.as_ref().unwrap_or(&patch.drive)),
        }
    }
}

/// A pixel of a skin's image, in the skin's frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    /// Centre, m.
    pub centre: [f32; 3],
    /// Unit normal.
    pub normal: [f32; 3],
    /// Area, m^2.
    pub area: f32,
}

impl Pixel {
    pub(crate) fn new(surface: &Surface<'_>, pixel: &PatchPixel) -> Self {
        Self { centre: surface.centre(pixel), normal: surface.normal(pixel), area: surface.area(pixel) }
    }
}

/// Where a skin lies on a link of a robot: points of its frame are turned, then moved into the link's. As `[pose]` in its skin
/// file.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    /// The skin's origin in the link's frame, m.
    pub position: [f64; 3],
    /// Turn from the skin's frame to the link's, a unit quaternion x, y, z, w.
    pub orientation: [f64; 4],
}

impl Pose {
    pub(crate) fn read(self) -> Result<LinkPose, Failure> {
        let Self { position, orientation } = self;
        let length = orientation.iter().map(|part| part * part).sum::<f64>().sqrt();
        if !position.iter().all(|part| part.is_finite()) {
            return Err(Failure::Argument("pose.position (three numbers, m)"));
        }
        // As exact as what people write with four digits.
        let is_unit = (length - 1.0).abs() <= 1e-3;
        if !is_unit {
            return Err(Failure::Argument("pose.orientation (a quaternion x, y, z, w of length 1)"));
        }
        Ok(LinkPose { link: String::new(), position, orientation: orientation.map(|part| part / length) })
    }
}

/// What is streamed.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Contacts of every so many frames; 0 for none.
    pub contacts_every: u16,
    /// Images of every so many frames; 0 for none.
    pub images_every: u16,
    /// Checksum of the patch that the board must hold; 0 for any.
    pub patch_crc: u32,
    /// After so long without a frame polling says DERMATOME_SILENT, ms; 0 for five frames, and at least a second.
    pub silence_ms: u32,
}

impl Default for Options {
    /// The contacts of each frame, of any patch.
    fn default() -> Self {
        Self { contacts_every: 1, images_every: 0, patch_crc: 0, silence_ms: 0 }
    }
}

/// One place where the skin is pressed.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// Its number, the same from frame to frame; 0 where it has none yet.
    pub id: u32,
    /// Number of the contact that became one with it, as long as they are one; 0 for none.
    pub merged: u32,
    /// Number of the contact that it came out of; 0 for none.
    pub split_from: u32,
    /// Centre of pressure, m.
    pub position: [f32; 3],
    /// Unit normal of the skin there, outward: what presses pushes against it.
    pub normal: [f32; 3],
    /// Velocity, m/s.
    pub velocity: [f32; 3],
    /// Area, m^2.
    pub area: f32,
    /// Mean relative conductivity change.
    pub strength: f32,
    /// Greatest relative conductivity change.
    pub peak: f32,
    /// Pressure, Pa; NaN on a skin that is not calibrated.
    pub pressure: f32,
    /// Force along the normal, N; NaN on a skin whose calibration does not tell it.
    pub force: f32,
    /// Area that bears the load, m^2; NaN likewise.
    pub load_area: f32,
    /// By how many standard deviations it is above the noise; NaN where contacts are found in the image.
    pub significance: f32,
    /// Standard deviation of the position along the skin, m; NaN likewise.
    pub position_deviation: f32,
    /// Standard deviation of the strength; NaN likewise.
    pub strength_deviation: f32,
}

impl Contact {
    pub(crate) fn new(contact: &BoardContact) -> Self {
        let BoardContact { position, normal, area, strength, peak, identity, evidence, .. } = *contact;
        let or_nan = |value: Option<f32>| value.unwrap_or(f32::NAN);
        Self {
            id: identity.map_or(0, |identity| identity.number),
            merged: identity.and_then(|identity| identity.merged).unwrap_or(0),
            split_from: identity.and_then(|identity| identity.split_from).unwrap_or(0),
            position,
            normal,
            velocity: identity.map_or([f32::NAN; 3], |identity| identity.velocity),
            area,
            strength,
            peak,
            pressure: or_nan(contact.pressure),
            force: or_nan(contact.force()),
            load_area: or_nan(contact.load_area),
            significance: or_nan(evidence.map(|evidence| evidence.significance)),
            position_deviation: or_nan(evidence.map(|evidence| evidence.position_deviation)),
            strength_deviation: or_nan(evidence.map(|evidence| evidence.strength_deviation)),
        }
    }

    /// A contact of the skin's frame in the link's.
    pub(crate) fn placed(self, pose: &LinkPose) -> Self {
        let narrow = |values: [f64; 3]| values.map(|value| value as f32);
        let turned = |direction: [f32; 3]| narrow(pose.direction(direction.map(f64::from)));
        Self {
            position: narrow(pose.point(self.position.map(f64::from))),
            normal: turned(self.normal),
            velocity: turned(self.velocity),
            ..self
        }
    }
}

/// What has come since the stream began, and what has not. Nothing is lost that is not counted here.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Frames that came, complete or not.
    pub frames: u64,
    /// Frames that were due and of which nothing came: lost, or not made, as while the board makes its reference.
    pub frames_missing: u64,
    /// Contacts and images that are missing in frames that came.
    pub parts_missing: u64,
    /// Contacts and images that came too late to be used.
    pub parts_unused: u64,
    /// Messages that the board sent and that did not come, since the port was opened.
    pub events_lost: u64,
    /// Packets that were not readable, since the port was opened.
    pub packets_damaged: u64,
    /// References that the board made.
    pub tares: u64,
    /// Of so many frames one has an image; 0: none. On a bus with other boards that may be more than was asked for.
    pub images_every: u64,
}

impl Counts {
    pub(crate) fn new(totals: Totals, images_every: u16, link: &Link) -> Self {
        let Totals { frames, frames_missing, parts_missing, parts_unused, tares, .. } = totals;
        let (events_lost, packets_damaged) = (link.events_lost(), link.packets_damaged());
        let images_every = images_every.into();
        Self {
            frames,
            frames_missing,
            parts_missing,
            parts_unused,
            events_lost,
            packets_damaged,
            tares,
            images_every,
        }
    }
}

/// One scan of the skin.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// When the scan ended, us of the board's own clock.
    pub time_us: u64,
    /// Running number of the scan since the board started.
    pub sequence: u32,
    /// What was wrong with the scan: DERMATOME_SATURATED and the like.
    pub flags: u16,
    /// 1 where nothing is known to be wrong with the contacts; else 0.
    pub valid: u8,
    /// 1 where contacts came with the frame, be they none; else 0.
    pub has_contacts: u8,
    /// 1 where an image came, which `dermatome_image` gives; else 0.
    pub has_image: u8,
    /// 0.
    pub reserved: [u8; 3],
    /// How many contacts there are.
    pub contact_count: u32,
    /// What has come so far.
    pub counts: Counts,
    /// Contacts, strongest first, in the skin's frame; beyond the count all zero.
    pub contacts: [Contact; DERMATOME_MAX_CONTACTS],
}

impl Frame {
    pub(crate) fn new(frame: &ScanFrame, counts: Counts) -> Self {
        let mut contacts = [Contact::default(); DERMATOME_MAX_CONTACTS];
        let found = frame.contacts.as_deref().unwrap_or_default();
        for (place, contact) in contacts.iter_mut().zip(found) {
            *place = Contact::new(contact);
        }
        let flags = frame.at.map_or(FrameFlags::default(), |at| at.flags);
        Self {
            time_us: frame.at.map_or(0, |at| at.timestamp_us),
            sequence: frame.at.map_or(0, |at| at.sequence),
            flags: flags.0,
            valid: (frame.contacts.is_some() && flags.leaves_contacts_valid()).into(),
            has_contacts: frame.contacts.is_some().into(),
            has_image: frame.image.is_some().into(),
            reserved: [0; 3],
            contact_count: found.len() as u32,
            counts,
            contacts,
        }
    }
}
