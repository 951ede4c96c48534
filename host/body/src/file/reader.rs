//! Reader: the parts of a body file, and whether they fit together.

use super::{BodyError, FARTHEST, Patch, PatchTable, SAME_PLACE, UNIT, Urdf, as_part_of_topic, field};
use dermatome_model::skin::{Description, Pose, is_frame_name, quantity::LENGTH};
use dermatome_patch::input;
use dermatome_simulate::port::Port;
use dermatome_urdf::urdf::{
    check::{Places, packages_of_ros},
    tree::{Robot, Skin},
};
use std::{error::Error, path::Path};

/// Reads the parts of a body file.
pub(super) struct Reader<'a> {
    /// The file.
    pub(super) path: &'a Path,
    /// From where it names others.
    pub(super) folder: &'a Path,
}

impl Reader<'_> {
    pub(super) fn refuse<T>(
        &self,
        field: &str,
        value: String,
        allowed: impl Into<String>,
    ) -> Result<T, BodyError> {
        Err(BodyError::Field {
            path: self.path.to_owned(),
            field: field.to_owned(),
            value,
            allowed: allowed.into(),
        })
    }

    pub(super) fn patch(&self, index: usize, table: &PatchTable) -> Result<Patch, BodyError> {
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
        Ok(Patch { name, path: skin_path, skin, port, on_bus: 1, pose })
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

    pub(super) fn urdf(&self, urdf: &Path) -> Result<Urdf, BodyError> {
        let path = self.folder.join(urdf);
        let packages = packages_of_ros();
        let places = Places { folder: path.parent().unwrap_or(Path::new("")), packages: &packages };
        let text = input::read_text(&path).map_err(|reason| self.refuse_urdf(&path, reason))?;
        let robot = Robot::read(&text, &places).map_err(|reason| self.refuse_urdf(&path, reason))?;
        Ok(Urdf { path, robot })
    }

    fn refuse_urdf(&self, urdf: &Path, reason: impl Error + Send + Sync + 'static) -> BodyError {
        BodyError::Urdf { path: self.path.to_owned(), urdf: urdf.to_owned(), reason: Box::new(reason) }
    }

    /// Every patch lies on a link of the robot, where the robot has it.
    pub(super) fn check_on_robot(&self, urdf: &Urdf, patches: &[Patch]) -> Result<(), BodyError> {
        for (index, patch) in patches.iter().enumerate() {
            let link = &patch.pose.link;
            let field = |name| field(index, name);
            if !urdf.robot.has_link(link) {
                let allowed = format!("a link of `{}`: {}", urdf.path.display(), urdf.robot.link_names());
                return self.refuse(&field("link"), format!("{link:?}"), allowed);
            }
            match skin_of(&urdf.robot, patch, patches) {
                Some(skin) if skin.link != *link => {
                    let path = urdf.path.display();
                    let allowed = format!("{:?}, on which `{path}` has the skin {:?}", skin.link, skin.name);
                    return self.refuse(&field("link"), format!("{link:?}"), allowed);
                }
                // It is worn there; a second one of that file may lie elsewhere.
                Some(skin)
                    if patches.iter().any(|it| it.skin.name == skin.name && lies_at(skin, &it.pose)) => {}
                Some(skin) => return self.refuse_place(urdf, skin, &patch.pose, &field("position")),
                None => {}
            }
        }
        Ok(())
    }

    /// A patch lies elsewhere than where the robot has its skin.
    fn refuse_place(&self, urdf: &Urdf, skin: &Skin, pose: &Pose, field: &str) -> Result<(), BodyError> {
        let (far, turned) = skin.off(pose);
        let value = format!("{:?} with orientation {:?}", pose.position, pose.orientation);
        let Pose { position, orientation, .. } = skin.pose();
        let allowed = format!(
            "where `{}` has the skin {:?}, which is {:.1} mm and {:.2} degrees off: position = {position:.6?}, \
             orientation = {orientation:.6?}; or add it to the robot anew",
            urdf.path.display(),
            skin.name,
            far * 1e3,
            turned.to_degrees()
        );
        self.refuse(field, value, allowed)
    }

    fn frame_name(&self, field: &str, link: &str) -> Result<(), BodyError> {
        if is_frame_name(link) {
            return Ok(());
        }
        self.refuse(field, format!("{link:?}"), "1 to 64 letters, digits, \"-\", \"_\", \".\" or \"/\"")
    }
}

/// Whether a pose has a skin where the robot has it.
fn lies_at(skin: &Skin, pose: &Pose) -> bool {
    let (far, turned) = skin.off(pose);
    skin.link == pose.link && far <= SAME_PLACE[0] && turned <= SAME_PLACE[1]
}

/// The skin of a patch as a robot has it: on the same link, or on one where no patch of that skin lies. Both may
/// have several of one skin file.
fn skin_of<'a>(robot: &'a Robot, patch: &Patch, patches: &[Patch]) -> Option<&'a Skin> {
    let named = || robot.skins.iter().filter(|skin| skin.name == patch.skin.name);
    let is_worn = |skin: &&Skin| {
        let mut same = patches.iter().filter(|other| other.skin.name == skin.name);
        same.any(|other| other.pose.link == skin.link)
    };
    named().find(|skin| skin.link == patch.pose.link).or_else(|| named().find(|skin| !is_worn(skin)))
}
