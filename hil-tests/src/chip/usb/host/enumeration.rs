//! Enumeration: what a host asks of a device that it sees for the first time (USB 2.0, 9.1.2), in the order in which Linux
//! does.

use super::control::{Refused, Request};

/// Address that the host gives.
pub(super) const ADDRESS: u8 = 5;

const DEVICE: u8 = 1;
const CONFIGURATION: u8 = 2;
const STRING: u8 = 3;
/// English of the United States.
const LANGUAGE: u16 = 0x0409;

/// What the device says of itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Described {
    /// Its descriptor.
    pub device: Vec<u8>,
    /// The descriptor of its configuration, with all that belongs to it.
    pub configuration: Vec<u8>,
    /// Manufacturer, product and serial number.
    pub strings: Vec<String>,
}

/// What the host has to do next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// The first bytes of the descriptor, at address 0.
    Look,
    /// Another reset.
    Reset,
    Address,
    Device,
    ConfigurationHeader,
    Configuration,
    Languages,
    Text(u8),
    Configure,
    Done,
}

impl Step {
    /// What is asked in it.
    pub(super) fn request(self, described: &Described) -> Option<Request> {
        let get = |kind: u8, number: u8, language, length| {
            Some(Request::new(0x80, 6, u16::from_le_bytes([number, kind]), language, length))
        };
        match self {
            Self::Look => get(DEVICE, 0, 0, 64),
            Self::Address => Some(Request::new(0, 5, ADDRESS.into(), 0, 0)),
            Self::Device => get(DEVICE, 0, 0, 18),
            Self::ConfigurationHeader => get(CONFIGURATION, 0, 0, 9),
            Self::Configuration => {
                let length = described
                    .configuration
                    .get(2..4)
                    .map_or(0, |bytes| u16::from_le_bytes([bytes[0], bytes[1]]));
                get(CONFIGURATION, 0, 0, length)
            }
            Self::Languages => get(STRING, 0, 0, 255),
            Self::Text(place) => {
                let number = described.device.get(14 + usize::from(place)).copied().unwrap_or(0);
                get(STRING, number, LANGUAGE, 255)
            }
            Self::Configure => {
                Some(Request::new(0, 9, described.configuration.get(5).copied().unwrap_or(0).into(), 0, 0))
            }
            Self::Reset | Self::Done => None,
        }
    }

    /// Takes what came; gives the next step.
    pub(super) fn take(self, brought: Vec<u8>, described: &mut Described) -> Result<Self, Refused> {
        Ok(match self {
            Self::Look if brought.len() < 8 => {
                return Err(Refused::Wrong("too little of a descriptor comes"));
            }
            Self::Look => Self::Reset,
            Self::Reset => Self::Address,
            Self::Address => Self::Device,
            Self::Device => {
                *described = Described { device: brought, ..Described::default() };
                Self::ConfigurationHeader
            }
            Self::ConfigurationHeader => {
                described.configuration = brought;
                Self::Configuration
            }
            Self::Configuration => {
                described.configuration = brought;
                Self::Languages
            }
            Self::Languages if brought != [4, STRING, 0x09, 0x04] => {
                return Err(Refused::Wrong("it speaks another language"));
            }
            Self::Languages => Self::Text(0),
            Self::Text(place) => {
                described.strings.push(text(&brought)?);
                if place == 2 { Self::Configure } else { Self::Text(place + 1) }
            }
            Self::Configure | Self::Done => Self::Done,
        })
    }
}

fn text(descriptor: &[u8]) -> Result<String, Refused> {
    let wrong = Refused::Wrong("a string descriptor is none");
    let [length, STRING, characters @ ..] = descriptor else { return Err(wrong) };
    if usize::from(*length) != descriptor.len() {
        return Err(wrong);
    }
    let units: Vec<u16> = characters
        .chunks(2)
        .map(|pair| u16::from_le_bytes([pair[0], pair.get(1).copied().unwrap_or(0)]))
        .collect();
    String::from_utf16(&units).map_err(|_| wrong)
}
