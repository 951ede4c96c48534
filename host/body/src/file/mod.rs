//! Body file: which skins a robot wears, where on it they lie, and where their boards are.
//!
//! ```toml
//! name = "arm"
//! urdf = "arm.urdf"                 # the robot, if there is a description of it
//!
//! [[patches]]
//! name = "forearm"                  # the skin's, unless it says another
//! skin = "forearm-skin/skin.toml"
//! port = "/dev/ttyACM0"             # or COM5, tcp:HOST:PORT, rs485:LINE#ADDRESS, can:BUS#ADDRESS,
//!                                   # sim:SKIN.toml, replay:FILE.mcap
//! link = "forearm_link"             # with position and orientation; else as the skin file's [pose] says
//! position = ["0 mm", "0 mm", "40 mm"]
//! orientation = [0, 0, 0, 1]
//! ```
//!
//! Files are named from where the body file lies.

mod reader;

use dermatome_link as link;
use dermatome_model::skin::{Description, Pose, SkinError, quantity::Quantity, syntax};
use dermatome_patch::input;
use dermatome_simulate::port::Port;
use dermatome_urdf::urdf::tree::Robot;
use reader::Reader;
use serde::Deserialize;
use std::{
    collections::HashSet,
    error::Error,
    io,
    path::{Path, PathBuf},
};

/// Most patches of a body.
pub const MAX_PATCHES: usize = 256;
/// How far a quaternion's length may be from 1.
const UNIT: f64 = 1e-3;
/// Farthest that a skin lies from the origin of its link's frame, m.
const FARTHEST: f64 = 1000.0;
/// How far a skin may be from where the robot's description has it, m and rad: as poses are rounded by hand.
const SAME_PLACE: [f64; 2] = [1e-4, 1e-3];

/// A robot's skins.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyFile {
    /// Its name, for topics and keys.
    pub name: String,
    /// The robot, where the file names its description.
    pub urdf: Option<Urdf>,
    /// One at least.
    pub patches: Vec<Patch>,
}

/// A robot's description.
#[derive(Clone, Debug, PartialEq)]
pub struct Urdf {
    /// The file.
    pub path: PathBuf,
    /// What it says.
    pub robot: Robot,
}

/// A skin on a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Its name on this body; no other has it.
    pub name: String,
    /// The skin file.
    pub path: PathBuf,
    /// What that says.
    pub skin: Description,
    /// Where its board is.
    pub port: Port,
    /// Boards of the body on the bus of that port, with this one.
    pub on_bus: usize,
    /// Where it lies.
    pub pose: Pose,
}

/// Why a body file is not used.
#[derive(Debug, thiserror::Error)]
pub enum BodyError {
    /// It cannot be read.
    #[error("body file `{}`: {reason}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: io::Error,
    },
    /// It is no TOML, or has other fields.
    #[error("body file `{}`: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        message: String,
    },
    /// A field holds what it may not.
    #[error("body file `{}`: `{field}` is {value}; allowed: {allowed}", path.display())]
    Field {
        /// The file.
        path: PathBuf,
        /// Its place.
        field: String,
        /// What stands there.
        value: String,
        /// What may.
        allowed: String,
    },
    /// One of the skin files.
    #[error("body file `{}`: `{field}`: {reason}", path.display())]
    Skin {
        /// The body file.
        path: PathBuf,
        /// Which of its fields names the skin.
        field: String,
        /// What is wrong with it.
        reason: Box<SkinError>,
    },
    /// The robot's description.
    #[error("body file `{}`: `urdf`: `{}`: {reason}", path.display(), urdf.display())]
    Urdf {
        /// The body file.
        path: PathBuf,
        /// The description.
        urdf: PathBuf,
        /// What is wrong with it.
        reason: Box<dyn Error + Send + Sync>,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyTable {
    name: String,
    urdf: Option<PathBuf>,
    patches: Vec<PatchTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PatchTable {
    name: Option<String>,
    skin: PathBuf,
    port: String,
    link: Option<String>,
    position: Option<[Quantity; 3]>,
    orientation: Option<[f64; 4]>,
}

/// Whether a text may name a body or a patch: it becomes part of topics of ROS and keys of Zenoh.
#[must_use]
pub fn is_part_of_topic(name: &str) -> bool {
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '_';
    (1..=32).contains(&name.len())
        && name.chars().all(allowed)
        && !name.starts_with(|c: char| c.is_ascii_digit())
}

/// A skin's name as part of a topic.
fn as_part_of_topic(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if plain.starts_with(|c: char| c.is_ascii_digit()) { format!("_{plain}") } else { plain }
}

impl BodyFile {
    /// Reads and checks a body file, and the skin files and the robot that it names.
    pub fn load(path: &Path) -> Result<Self, BodyError> {
        let read = input::read_text(path);
        let text = read.map_err(|reason| BodyError::Read { path: path.to_owned(), reason })?;
        Self::parse(path, &text)
    }

    /// Checks the text of a body file that lies at `path`.
    pub fn parse(path: &Path, text: &str) -> Result<Self, BodyError> {
        let table: BodyTable = toml::from_str(text).map_err(|error| BodyError::Syntax {
            path: path.to_owned(),
            message: syntax::in_words(&error),
        })?;
        let reader = Reader { path, folder: path.parent().unwrap_or(Path::new("")) };
        let words = "1 to 32 letters, digits and \"_\", no digit first";
        if !is_part_of_topic(&table.name) {
            return reader.refuse("name", format!("{:?}", table.name), words);
        }
        let count = table.patches.len();
        if !(1..=MAX_PATCHES).contains(&count) {
            let value = format!("a list of {count}");
            return reader.refuse("patches", value, format!("1 to {MAX_PATCHES} of them"));
        }
        let mut patches: Vec<Patch> = table
            .patches
            .iter()
            .enumerate()
            .map(|(index, table)| reader.patch(index, table))
            .collect::<Result<_, _>>()?;
        let (mut names, mut ports) = (HashSet::new(), HashSet::new());
        for (index, patch) in patches.iter().enumerate() {
            if !is_part_of_topic(&patch.name) {
                return reader.refuse(&field(index, "name"), format!("{:?}", patch.name), words);
            }
            if !names.insert(&patch.name) {
                return reader.refuse(
                    &field(index, "name"),
                    format!("{:?}", patch.name),
                    "a name that no patch before has; the skin's own unless it is given",
                );
            }
            let port = patch.port.to_string();
            if matches!(patch.port, Port::Board(_)) && !ports.insert(port.clone()) {
                let allowed = "a port that no patch before has";
                return reader.refuse(&field(index, "port"), format!("{port:?}"), allowed);
            }
        }
        count_on_buses(&mut patches);
        let urdf = table.urdf.map(|urdf| reader.urdf(&urdf)).transpose()?;
        if let Some(urdf) = &urdf {
            reader.check_on_robot(urdf, &patches)?;
        }
        Ok(Self { name: table.name, urdf, patches })
    }
}

/// How many boards share a bus.
fn count_on_buses(patches: &mut [Patch]) {
    let bus = |patch: &Patch| match &patch.port {
        Port::Board(link::Port::Bus(bus, _)) => Some(bus.clone()),
        _ => None,
    };
    let buses: Vec<_> = patches.iter().map(bus).collect();
    for (patch, own) in patches.iter_mut().zip(&buses) {
        let others = buses.iter().filter(|bus| own.is_some() && *bus == own);
        patch.on_bus = others.count().max(1);
    }
}

/// Place of a field of a patch.
fn field(index: usize, name: &str) -> String {
    format!("patches[{index}].{name}")
}

#[cfg(test)]
mod tests;
