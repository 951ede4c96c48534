//! Topics: what is told under which name.

use crate::schema::{self, Schema};
use std::sync::Arc;

/// Something that is told again and again under one name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Topic {
    /// Pixels, electrodes and shape of the skin.
    Skin,
    /// How the session stands.
    Status,
    /// New references.
    Reference,
    /// Raw codes.
    Measurements,
    /// Electrodes, current, board.
    Health,
    /// Images.
    Image,
    /// Contacts.
    Contacts,
    /// Samples of one slot.
    Scope,
    /// Where the skin lies on its link, for programs that know ROS' messages.
    Transforms,
    /// Images as points, likewise.
    Pressure,
    /// Contacts as spheres, arrows and texts, likewise.
    Markers,
    /// Status and health in words, likewise.
    Diagnostics,
    /// Where links that move are now, of a whole robot.
    Joints,
    /// What its links look like.
    Links,
}

/// How a message is encoded.
pub const ENCODING: &str = "cdr";
/// How a schema is written.
pub const SCHEMA_ENCODING: &str = "ros2msg";

impl Topic {
    /// All of them; a topic's place here is its number.
    pub const ALL: [Self; 14] = [
        Self::Skin,
        Self::Status,
        Self::Reference,
        Self::Measurements,
        Self::Health,
        Self::Image,
        Self::Contacts,
        Self::Scope,
        Self::Transforms,
        Self::Pressure,
        Self::Markers,
        Self::Diagnostics,
        Self::Joints,
        Self::Links,
    ];

    /// Its number.
    #[must_use]
    pub fn index(self) -> usize {
        Self::ALL.iter().position(|topic| *topic == self).unwrap_or_default()
    }

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.about().0
    }

    /// Its name for one of several skins: what begins with `/dermatome` for a single one begins with `/` and the skin's
    /// space, such as `arm/palm`. What all skins tell under one name stays.
    #[must_use]
    pub fn name_in(self, space: &str) -> String {
        match self.name().strip_prefix("/dermatome/") {
            Some(rest) => format!("/{space}/{rest}"),
            None => self.name().to_owned(),
        }
    }

    /// The type of its messages.
    #[must_use]
    pub const fn schema(self) -> &'static Schema {
        self.about().1
    }

    /// The topic of this name.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|topic| topic.name() == name)
    }

    /// The topic of this name among those of one of several skins, which have its space; not those that skins share.
    #[must_use]
    pub fn of_name_in(name: &str, space: &str) -> Option<Self> {
        let rest = name.strip_prefix('/')?.strip_prefix(space)?.strip_prefix('/')?;
        Self::ALL.into_iter().find(|topic| topic.name().strip_prefix("/dermatome/") == Some(rest))
    }

    /// Whether the latest message holds until the next: those who come later get it as well.
    #[must_use]
    pub const fn is_lasting(self) -> bool {
        matches!(self, Self::Skin | Self::Status | Self::Transforms | Self::Joints | Self::Links)
    }

    /// Whether all skins tell it under one name.
    #[must_use]
    pub fn is_shared(self) -> bool {
        !self.name().starts_with("/dermatome/")
    }

    /// Whether it is about a whole robot, not about one of its skins.
    #[must_use]
    pub const fn is_of_robot(self) -> bool {
        matches!(self, Self::Joints | Self::Links)
    }

    const fn about(self) -> (&'static str, &'static Schema) {
        match self {
            Self::Skin => ("/dermatome/skin", &schema::SKIN),
            Self::Status => ("/dermatome/status", &schema::STATUS),
            Self::Reference => ("/dermatome/reference", &schema::REFERENCE),
            Self::Measurements => ("/dermatome/measurements", &schema::MEASUREMENTS),
            Self::Health => ("/dermatome/health", &schema::HEALTH),
            Self::Image => ("/dermatome/image", &schema::IMAGE),
            Self::Contacts => ("/dermatome/contacts", &schema::CONTACT_ARRAY),
            Self::Scope => ("/dermatome/scope", &schema::SCOPE),
            Self::Transforms => ("/tf_static", &schema::TF_MESSAGE),
            Self::Pressure => ("/dermatome/pressure", &schema::POINT_CLOUD),
            Self::Markers => ("/dermatome/markers", &schema::MARKER_ARRAY),
            Self::Diagnostics => ("/diagnostics", &schema::DIAGNOSTIC_ARRAY),
            Self::Joints => ("/tf", &schema::TF_MESSAGE),
            Self::Links => ("/links", &schema::MARKER_ARRAY),
        }
    }
}

/// A message as bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Packed {
    /// Of what.
    pub topic: Topic,
    /// When it came, by the host's clock, ns since 1970.
    pub log_time: u64,
    /// What it is about happened then, likewise.
    pub publish_time: u64,
    /// CDR.
    pub bytes: Arc<[u8]>,
}

impl Packed {
    /// Of what is so now, ns since 1970.
    #[must_use]
    pub fn now(topic: Topic, now_ns: u64, bytes: Vec<u8>) -> Self {
        Self { topic, log_time: now_ns, publish_time: now_ns, bytes: bytes.into() }
    }
}
