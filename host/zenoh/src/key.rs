//! Key: under which name a skin is known on the network.
//!
//! `dermatome/ROBOT/LINK/PATCH`, below it what the skin tells. A link's `/` is `:` there, which no link's name has.

use dermatome_body::file::is_part_of_topic;
use std::fmt;

const ROOT: &str = "dermatome";
/// Most letters of a link's name.
const MOST_OF_LINK: usize = 64;

/// What a skin tells, or is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// [`crate::message::Contacts`] of each frame.
    Contacts,
    /// [`crate::message::Image`], 30 a second at most.
    Image,
    /// [`crate::message::Health`], of one frame in 25.
    Health,
    /// [`crate::message::State`], at each change and twice a second; also to be asked for.
    State,
    /// [`crate::message::Skin`], only to be asked for.
    Skin,
    /// [`crate::message::Tare`], only to be asked for.
    Tare,
    /// The computer's time, ns since 1970, only to be asked for.
    Clock,
}

impl Topic {
    /// The last part of its key.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Contacts => "contacts",
            Self::Image => "image",
            Self::Health => "health",
            Self::State => "state",
            Self::Skin => "skin",
            Self::Tare => "tare",
            Self::Clock => "clock",
        }
    }
}

/// What a skin is asked to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Make a new reference.
    Tare,
    /// Be driven as [`dermatome_messages::dermatome::DriveRequest`] says.
    Drive,
}

impl Order {
    /// The last part of its key.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tare => "tare",
            Self::Drive => "drive",
        }
    }
}

/// A skin of a robot.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Space {
    /// The robot's name.
    pub robot: String,
    /// The link that the skin lies on.
    pub link: String,
    /// The skin's name on the robot.
    pub patch: String,
}

impl fmt::Display for Space {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{ROOT}/{}/{}/{}", self.robot, self.link.replace('/', ":"), self.patch)
    }
}

impl Space {
    /// The key of what it tells.
    #[must_use]
    pub fn of(&self, topic: Topic) -> String {
        format!("{self}/{}", topic.name())
    }

    /// The key of whatever it is asked for.
    pub(crate) fn of_queries(&self) -> String {
        format!("{self}/*")
    }

    /// The key under which it is asked to do this.
    #[must_use]
    pub fn of_order(&self, order: Order) -> String {
        format!("{self}/ask/{}", order.name())
    }

    /// The key of whatever it is asked to do.
    pub(crate) fn of_orders(&self) -> String {
        format!("{self}/ask/*")
    }

    /// The key that is there as long as this run of a program serves it.
    pub(crate) fn alive(&self, run: u64) -> String {
        format!("{self}/alive/{run:016x}")
    }

    /// The skin that a key is about, and what follows; none where it is no such key.
    #[must_use]
    pub fn of_key(key: &str) -> Option<(Self, &str)> {
        let mut parts = key.splitn(5, '/');
        let (root, robot, link) = (parts.next()?, parts.next()?, parts.next()?);
        let (patch, rest) = (parts.next()?, parts.next()?);
        let space = Self { robot: robot.to_owned(), link: link.replace(':', "/"), patch: patch.to_owned() };
        let is_allowed = root == ROOT && is_part_of_topic(robot) && is_part_of_topic(patch) && is_link(link);
        is_allowed.then_some((space, rest))
    }

    /// The skin that is served, and by which run, as the key says that is there meanwhile.
    pub(crate) fn of_alive(key: &str) -> Option<(Self, u64)> {
        let (space, rest) = Self::of_key(key)?;
        let run = rest.strip_prefix("alive/").filter(|run| run.len() == 16)?;
        Some((space, u64::from_str_radix(run, 16).ok()?))
    }
}

/// The keys that this is told under by all skins of a robot.
pub(crate) fn of_all(robot: &str, topic: Topic) -> String {
    format!("{ROOT}/{robot}/*/*/{}", topic.name())
}

/// The keys that are there as long as skins of a robot, or of any, are served.
pub(crate) fn all_alive(robot: Option<&str>) -> String {
    format!("{ROOT}/{}/*/*/alive/*", robot.unwrap_or("*"))
}

/// Whether a part of a key may stand for a link.
fn is_link(part: &str) -> bool {
    let allowed = |c: char| c.is_ascii_alphanumeric() || "-_.:".contains(c);
    (1..=MOST_OF_LINK).contains(&part.len()) && part.chars().all(allowed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn palm() -> Space {
        Space { robot: "arm".to_owned(), link: "hand/palm.left".to_owned(), patch: "palm".to_owned() }
    }

    #[test]
    fn a_key_names_robot_link_and_patch_and_gives_them_back() {
        let key = palm().of(Topic::Contacts);
        assert_eq!(key, "dermatome/arm/hand:palm.left/palm/contacts");
        assert_eq!(Space::of_key(&key), Some((palm(), "contacts")));
        let alive = palm().alive(0xfe);
        assert_eq!(Space::of_alive(&alive), Some((palm(), 0xfe)));
        zenoh::key_expr::KeyExpr::try_from(alive).unwrap();
    }

    #[test]
    fn other_keys_are_none() {
        for key in [
            "dermatome/arm/hand/palm",
            "other/arm/hand/palm/contacts",
            "dermatome/1arm/hand/palm/contacts",
            "dermatome/arm/ha nd/palm/contacts",
            "dermatome/arm/hand/pa\u{1b}lm/contacts",
        ] {
            assert_eq!(Space::of_key(key), None, "{key}");
        }
        for key in ["dermatome/arm/hand/palm/alive/1", "dermatome/arm/hand/palm/alive/gggggggggggggggg"] {
            assert_eq!(Space::of_alive(key), None, "{key}");
        }
    }

    proptest! {
        #[test]
        fn no_key_panics(key in "[a-z/*:$@]{0,40}|\\PC{0,40}|dermatome/[a-z]{1,3}/\\PC{1,9}/[a-z]{1,3}/alive/\\PC{0,17}") {
            let _ = (Space::of_key(&key), Space::of_alive(&key));
        }
    }
}
