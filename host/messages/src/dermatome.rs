//! Messages of package `dermatome_msgs`; what fields mean stands in `dermatome_msgs/msg/*.msg`.

use crate::standard::{Header, Point, Wrench};
use dermatome_shared::drive::{Component, Drive, Gain};
use serde::{Deserialize, Serialize};

/// Which frame a message belongs to, at its start.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stamp {
    /// When, by the host's clock, and where.
    pub header: Header,
    /// Running number of the frame since the board started.
    pub sequence: u32,
    /// When the scan ended, us of the board's clock.
    pub device_time_us: u64,
    /// Bits of [`dermatome_shared::frame::FrameFlags`].
    pub flags: u16,
}

/// dermatome_msgs/msg/Image
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Image {
    /// Which frame.
    pub stamp: Stamp,
    /// Binary places.
    pub exponent: i8,
    /// `[pixel]`.
    pub mantissas: Vec<i16>,
}

/// dermatome_msgs/msg/Measurements
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Measurements {
    /// Which frame.
    pub stamp: Stamp,
    /// `[step]`.
    pub in_phase: Vec<i32>,
    /// `[step]`, or empty.
    pub quadrature: Vec<i32>,
}

/// dermatome_msgs/msg/Contact
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// Whether it has a number.
    pub is_tracked: bool,
    /// Its number.
    pub id: u32,
    /// Number of the contact that became one with it; 0 for none.
    pub merged: u32,
    /// Number of the contact that it came out of; 0 for none.
    pub split_from: u32,
    /// m
    pub position: Point,
    /// A unit vector.
    pub normal: Point,
    /// m/s
    pub velocity: Point,
    /// m^2
    pub area: f32,
    /// Mean relative conductivity change.
    pub strength: f32,
    /// Greatest relative conductivity change.
    pub peak: f32,
    /// Pa, or NaN.
    pub pressure: f32,
    /// N, or NaN.
    pub force: f32,
    /// m^2, or NaN.
    pub load_area: f32,
    /// Standard deviations above the noise, or NaN.
    pub significance: f32,
    /// m, or NaN.
    pub position_deviation: f32,
    /// Relative, or NaN.
    pub strength_deviation: f32,
}

/// dermatome_msgs/msg/ContactArray
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactArray {
    /// Which frame.
    pub stamp: Stamp,
    /// Strongest first.
    pub contacts: Vec<Contact>,
}

/// dermatome_msgs/msg/SkinContact
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SkinContact {
    /// As the board gives it, in the link's frame.
    pub contact: Contact,
    /// m
    pub geometric_centre: Point,
    /// Whether the next field means anything.
    pub has_wrench: bool,
    /// What it does to the link, about its centre of pressure.
    pub wrench: Wrench,
    /// Of the image.
    pub pixels: Vec<u16>,
}

/// dermatome_msgs/msg/SkinContactArray
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SkinContactArray {
    /// When the scan ended, and the link.
    pub header: Header,
    /// The skin's name on its robot.
    pub patch: String,
    /// Running number of the frame since the board started.
    pub sequence: u32,
    /// When the scan ended, us of the board's clock.
    pub device_time_us: u64,
    /// Bits of [`dermatome_shared::frame::FrameFlags`].
    pub flags: u16,
    /// Whether nothing is known to be wrong.
    pub valid: bool,
    /// Strongest first.
    pub contacts: Vec<SkinContact>,
}

/// dermatome_msgs/msg/Health
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Health {
    /// Which frame.
    pub stamp: Stamp,
    /// ohm: `[electrode]`, or empty.
    pub contact_impedance: Vec<f32>,
    /// Electrodes without contact.
    pub open: u16,
    /// Electrodes connected to a neighbour.
    pub shorted: u16,
    /// Electrodes that touch worse.
    pub worse: u16,
    /// Relative, or NaN.
    pub reciprocity_error: f32,
    /// Degrees Celsius, or NaN.
    pub temperature: f32,
    /// 0 to 1.
    pub load: f32,
    /// Bytes.
    pub free_stack: u32,
    /// Relative.
    pub drift: f32,
    /// Times.
    pub missed: u32,
}

/// dermatome_msgs/msg/Reference
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// When.
    pub header: Header,
    /// First frame that is averaged.
    pub first_sequence: u32,
    /// Frames to average.
    pub frames: u16,
    /// Hz
    pub frequency: f32,
    /// A
    pub amplitude: f32,
    /// 1/s
    pub frame_rate: f32,
    /// Degrees.
    pub phase: f32,
    /// Carrier periods.
    pub settling: f32,
    /// Carrier periods.
    pub integration: u8,
    /// 0: automatic.
    pub gain: u8,
    /// 0 real, 1 imaginary, 2 magnitude.
    pub component: u8,
}

/// A gain as messages tell it: 0 where it is automatic.
#[must_use]
pub fn number_of_gain(gain: Gain) -> u8 {
    match gain {
        Gain::Automatic => 0,
        Gain::Fixed(gain) => gain,
    }
}

/// The gain of such a number.
#[must_use]
pub fn gain_of_number(number: u8) -> Gain {
    if number == 0 { Gain::Automatic } else { Gain::Fixed(number) }
}

impl Reference {
    /// Of frames from this one on, driven like this.
    #[must_use]
    pub fn new(header: Header, first_sequence: u32, frames: u16, drive: &Drive) -> Self {
        Self {
            header,
            first_sequence,
            frames,
            frequency: drive.frequency,
            amplitude: drive.amplitude,
            frame_rate: drive.frame_rate,
            phase: drive.phase,
            settling: drive.settling,
            integration: drive.integration,
            gain: number_of_gain(drive.gain),
            component: match drive.component {
                Component::Real => 0,
                Component::Imaginary => 1,
                Component::Magnitude => 2,
            },
        }
    }

    /// How the skin was driven.
    #[must_use]
    pub fn drive(&self) -> Drive {
        Drive {
            frequency: self.frequency,
            amplitude: self.amplitude,
            frame_rate: self.frame_rate,
            phase: self.phase,
            settling: self.settling,
            integration: self.integration,
            gain: gain_of_number(self.gain),
            component: match self.component {
                0 => Component::Real,
                1 => Component::Imaginary,
                _ => Component::Magnitude,
            },
        }
    }
}

/// dermatome_msgs/msg/Scope
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Scope {
    /// When.
    pub header: Header,
    /// Slot of the scan.
    pub slot: u16,
    /// Of the amplifier.
    pub gain: u8,
    /// Samples.
    pub settling: u16,
    /// Samples.
    pub period: u16,
    /// 1/s
    pub sample_rate: u32,
    /// Codes.
    pub samples: Vec<u16>,
}

/// dermatome_msgs/msg/Skin
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Skin {
    /// In which frame.
    pub header: Header,
    /// Its name.
    pub name: String,
    /// Which patch.
    pub patch_crc: u32,
    /// m: `[vertex][x, y, z]`.
    pub vertices: Vec<f32>,
    /// Vertices: `[triangle][3]`.
    pub triangles: Vec<u32>,
    /// `[vertex]`.
    pub vertex_pixels: Vec<u16>,
    /// m: `[pixel][x, y, z]`.
    pub pixel_centres: Vec<f32>,
    /// m^2: `[pixel]`.
    pub pixel_areas: Vec<f32>,
    /// m: `[electrode][x, y, z]`, or empty.
    pub electrodes: Vec<f32>,
    /// Electrodes: `[step][drive +, drive -, sense +, sense -]`.
    pub steps: Vec<u8>,
    /// m: `[vertex][x, y, z]`, or empty.
    pub link_vertices: Vec<f32>,
    /// Vertices: `[triangle][3]`.
    pub link_triangles: Vec<u32>,
    /// Relative conductivity change.
    pub contact_threshold: f32,
    /// Whether contacts have a pressure.
    pub is_calibrated: bool,
}

/// dermatome_msgs/msg/Status
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Status {
    /// When.
    pub header: Header,
    /// One of the words in Status.msg.
    pub state: String,
    /// What is.
    pub text: String,
    /// What to do.
    pub advice: String,
    /// What is wrong with frames.
    pub warnings: Vec<String>,
    /// Where the board is.
    pub port: String,
    /// Kind of board.
    pub board: String,
    /// Its version.
    pub firmware: String,
    /// Name.
    pub skin: String,
    /// Which patch.
    pub patch_crc: u32,
    /// Which of `patches` makes the images.
    pub patch: u16,
    /// Names.
    pub patches: Vec<String>,
    /// Hz
    pub frequency: f32,
    /// A
    pub amplitude: f32,
    /// A
    pub largest_amplitude: f32,
    /// 0: automatic.
    pub gain: u8,
    /// 1/s, as the drive has it.
    pub frame_rate: f32,
    /// Since the start.
    pub frames: u64,
    /// 1/s, as they come.
    pub frames_per_second: f32,
    /// Since the start.
    pub frames_lost: u64,
    /// Since the start.
    pub packets_damaged: u64,
    /// dB, or NaN.
    pub signal_to_noise: f32,
    /// File, or empty.
    pub recording: String,
    /// Its length.
    pub recorded_bytes: u64,
    /// Frames in it.
    pub recorded_frames: u64,
}

/// dermatome_msgs/srv/Drive_Request
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DriveRequest {
    /// Hz, or NaN.
    pub frequency: f32,
    /// A, or NaN.
    pub amplitude: f32,
    /// 1/s, or NaN.
    pub frame_rate: f32,
    /// 0: automatic; 255: as it is.
    pub gain: u8,
}

impl DriveRequest {
    /// What asks for no change.
    pub const AS_IT_IS: Self =
        Self { frequency: f32::NAN, amplitude: f32::NAN, frame_rate: f32::NAN, gain: u8::MAX };

    /// This drive with the changes that are asked for.
    #[must_use]
    pub fn of(&self, drive: &Drive) -> Drive {
        let or = |wanted: f32, before: f32| if wanted.is_nan() { before } else { wanted };
        Drive {
            frequency: or(self.frequency, drive.frequency),
            amplitude: or(self.amplitude, drive.amplitude),
            frame_rate: or(self.frame_rate, drive.frame_rate),
            gain: if self.gain == u8::MAX { drive.gain } else { gain_of_number(self.gain) },
            ..*drive
        }
    }
}
