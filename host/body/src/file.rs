//! Body file: which skins a robot wears, where on it they lie, and where their boards are.
//!
//! ```toml
//! name = "arm"
//!
//! [[patches]]
//! name = "forearm"                  # the skin's, unless it says another
//! skin = "forearm-skin/skin.toml"
//! port = "/dev/ttyACM0"             # or COM5, tcp:HOST:PORT, sim:SKIN.toml, replay:FILE.mcap
//! link = "forearm_link"             # with position and orientation; else as the skin file's [pose] says
//! position = ["0 mm", "0 mm", "40 mm"]
//! orientation = [0, 0, 0, 1]
//! ```
//!
//! Files are named from where the body file lies.

use dermatome_model::skin::{
    Description, Pose, SkinError, is_frame_name,
    quantity::{LENGTH, Quantity},
    syntax,
};
use dermatome_patch::input;
use dermatome_simulate::port::Port;
use serde::Deserialize;
use std::{
    collections::HashSet,
    io,
    path::{Path, PathBuf},
};

/// Most patches of a body.
pub const MAX_PATCHES: usize = 256;
/// How far a quaternion's length may be from 1.
const UNIT: f64 = 1e-3;
/// Farthest that a skin lies from the origin of its link's frame, m.
const FARTHEST: f64 = 1000.0;

/// A robot's skins.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyFile {
    /// Its name, for topics and keys.
    pub name: String,
    /// One at least.
    pub patches: Vec<Patch>,
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
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyTable {
    name: String,
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
    /// Reads and checks a body file and the skin files that it names.
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
        let patches: Vec<Patch> = table
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
        Ok(Self { name: table.name, patches })
    }
}

/// Place of a field of a patch.
fn field(index: usize, name: &str) -> String {
    format!("patches[{index}].{name}")
}

struct Reader<'a> {
    path: &'a Path,
    folder: &'a Path,
}

impl Reader<'_> {
    fn refuse<T>(&self, field: &str, value: String, allowed: impl Into<String>) -> Result<T, BodyError> {
        Err(BodyError::Field {
            path: self.path.to_owned(),
            field: field.to_owned(),
            value,
            allowed: allowed.into(),
        })
    }

    fn patch(&self, index: usize, table: &PatchTable) -> Result<Patch, BodyError> {
        let skin_path = self.folder.join(&table.skin);
        let skin = Description::load(&skin_path).map_err(|reason| BodyError::Skin {
            path: self.path.to_owned(),
            field: field(index, "skin"),
            reason: Box::new(reason),
        })?;
        let port = match table.port.parse() {
            Ok(Port::Simulated(path)) => Port::Simulated(self.folder.join(path)),
            Ok(Port::Recorded(path)) => Port::Recorded(self.folder.join(path)),
            Ok(port) => port,
            Err(error) => {
                return self.refuse(
                    &field(index, "port"),
                    format!("{:?}", table.port),
                    format!("a port ({error})"),
                );
            }
        };
        let pose = self.pose(index, table, &skin)?;
        let name = table.name.clone().unwrap_or_else(|| as_part_of_topic(&skin.name));
        Ok(Patch { name, path: skin_path, skin, port, pose })
    }

    fn pose(&self, index: usize, table: &PatchTable, skin: &Description) -> Result<Pose, BodyError> {
        let field = |name| field(index, name);
        let in_skin_file = skin.pose.clone();
        let (link, position, orientation) = match (
            &table.link,
            &table.position,
            table.orientation,
            in_skin_file,
        ) {
            (None, None, None, Some(pose)) => return Ok(pose),
            // The same place on another link: a robot with two arms.
            (Some(link), None, None, Some(pose)) => {
                self.frame_name(&field("link"), link)?;
                return Ok(Pose { link: link.clone(), ..pose });
            }
            (Some(link), Some(position), Some(orientation), _) => (link, position, orientation),
            (link, ..) => {
                let value = link.as_ref().map_or("missing".to_owned(), |link| format!("{link:?}"));
                return self.refuse(
                        &field("link"),
                        value,
                        "`link` with `position` and `orientation`; or `link` alone, or none of them, where the skin file \
                         has a [pose]",
                    );
            }
        };
        self.frame_name(&field("link"), link)?;
        let read: Option<Vec<f64>> = position
            .iter()
            .map(|length| LENGTH.read(length).filter(|length| length.abs() <= FARTHEST))
            .collect();
        let Some(Ok(position)) = read.map(<[f64; 3]>::try_from) else {
            let value = position.each_ref().map(ToString::to_string).join(", ");
            let allowed = "three lengths of at most 1000 m, such as [\"0 mm\", \"0 mm\", \"40 mm\"]";
            return self.refuse(&field("position"), format!("[{value}]"), allowed);
        };
        let length = orientation.iter().map(|part| part * part).sum::<f64>().sqrt();
        // Also not where a part is NaN.
        let is_unit = (length - 1.0).abs() <= UNIT;
        if !is_unit {
            let value = format!("{orientation:?}");
            return self.refuse(&field("orientation"), value, "a quaternion x, y, z, w of length 1");
        }
        Ok(Pose { link: link.clone(), position, orientation: orientation.map(|part| part / length) })
    }

    fn frame_name(&self, field: &str, link: &str) -> Result<(), BodyError> {
        if is_frame_name(link) {
            return Ok(());
        }
        self.refuse(field, format!("{link:?}"), "1 to 64 letters, digits, \"-\", \"_\", \".\" or \"/\"")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SKIN: &str = include_str!("../../../models/square-50mm/skin.toml");

    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("skin.toml"), SKIN).unwrap();
        let posed = format!(
            "{SKIN}\n[pose]\nlink = \"palm\"\nposition = [\"1 mm\", \"2 mm\", \"3 mm\"]\norientation = [0, 0, 0, 1]\n"
        );
        std::fs::write(folder.path().join("posed.toml"), posed).unwrap();
        folder
    }

    fn parse(folder: &tempfile::TempDir, text: &str) -> Result<BodyFile, String> {
        BodyFile::parse(&folder.path().join("robot.toml"), text).map_err(|error| error.to_string())
    }

    #[test]
    fn skins_lie_where_their_files_say_or_where_the_body_file_says() {
        let folder = folder();
        let body = parse(
            &folder,
            r#"
            name = "arm"
            [[patches]]
            skin = "posed.toml"
            port = "sim:posed.toml"
            [[patches]]
            name = "other"
            skin = "posed.toml"
            port = "tcp:127.0.0.1:7000"
            link = "palm_left"
            [[patches]]
            name = "third"
            skin = "skin.toml"
            port = "COM5"
            link = "forearm"
            position = ["0 mm", "1 cm", "-0.5 m"]
            orientation = [0.0, 0.0, 0.7071, 0.7071]
            "#,
        )
        .unwrap();
        let [a, b, c] = body.patches.as_slice() else { panic!("{body:?}") };
        assert_eq!(
            (a.name.as_str(), a.pose.link.as_str(), a.pose.position),
            ("square_50mm", "palm", [0.001, 0.002, 0.003])
        );
        assert_eq!(a.port, Port::Simulated(folder.path().join("posed.toml")));
        assert_eq!((b.pose.link.as_str(), b.pose.position), ("palm_left", a.pose.position));
        assert_eq!((c.pose.link.as_str(), c.pose.position), ("forearm", [0.0, 0.01, -0.5]));
        assert!((c.pose.orientation[2] - 0.5_f64.sqrt()).abs() < 1e-4);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place_and_what_is_allowed() {
        let folder = folder();
        let patch = "[[patches]]\nskin = \"posed.toml\"\nport = \"COM5\"\n";
        let cases = [
            ("name = \"a b\"\n".to_owned() + patch, "`name` is \"a b\"; allowed: 1 to 32 letters"),
            ("name = \"a\"\npatches = []\n".to_owned(), "`patches` is a list of 0; allowed: 1 to 256"),
            (
                format!("name = \"a\"\n{patch}{patch}"),
                "`patches[1].name` is \"square_50mm\"; allowed: a name that no patch before has",
            ),
            (
                format!("name = \"a\"\n{patch}{patch}name = \"b\"\n"),
                "`patches[1].port` is \"COM5\"; allowed: a port that no",
            ),
            (
                format!("name = \"a\"\n{patch}link = \"a b\"\n"),
                "`patches[0].link` is \"a b\"; allowed: 1 to 64",
            ),
            (
                format!("name = \"a\"\n{patch}position = [0, 0, 0]\n"),
                "`patches[0].link` is missing; allowed: `link` with `position`",
            ),
            (
                "name = \"a\"\n[[patches]]\nskin = \"skin.toml\"\nport = \"COM5\"\n".to_owned(),
                "`patches[0].link` is missing",
            ),
            (
                "name = \"a\"\n[[patches]]\nskin = \"skin.toml\"\nport = \"usb\"\n".to_owned(),
                "`patches[0].port` is \"usb\"; allowed: a port",
            ),
            (
                "name = \"a\"\n[[patches]]\nskin = \"none.toml\"\nport = \"COM5\"\n".to_owned(),
                "`patches[0].skin`:",
            ),
            (
                format!(
                    "name = \"a\"\n{patch}link = \"l\"\nposition = [\"1 kg\", 0, 0]\norientation = [0, 0, 0, 1]\n"
                ),
                "`patches[0].position` is",
            ),
            (
                format!(
                    "name = \"a\"\n{patch}link = \"l\"\nposition = [0, 0, 0]\norientation = [0, 0, 0, 2]\n"
                ),
                "`patches[0].orientation` is",
            ),
            (format!("name = \"a\"\ncolour = 3\n{patch}"), "colour"),
        ];
        for (text, words) in cases {
            let error = parse(&folder, &text).unwrap_err();
            assert!(error.contains(words) && error.contains("robot.toml"), "{error}\n{text}");
        }
    }

    #[test]
    fn names_become_parts_of_topics() {
        assert_eq!(as_part_of_topic("disc-210mm"), "disc_210mm");
        assert!(is_part_of_topic(&as_part_of_topic("7 up")));
        assert!(!is_part_of_topic("") && !is_part_of_topic("a/b") && !is_part_of_topic("1a"));
    }
}
