//! Skin: whether it lies where its file says, on its link, with its own mesh.

use super::{Check, Expected, Level, OnRobot};
use crate::{
    error::names,
    link_from_skin,
    place::xyz_rpy,
    urdf::{
        meshes::{MeshUse, all_of_link, farthest, origin, some},
        robot::{design, link_in},
    },
};
use nalgebra::Isometry3;
use roxmltree::Node;

/// A joint that is off its skin's pose by more, m or rad, is another place.
const OFF: f64 = 1e-6;
/// A skin that is farther from its link's mesh, m, lies somewhere else.
const FAR: f64 = 5e-3;
/// A skin's mesh file that is off it by more, m, is that of another skin.
const OTHER_MESH: f64 = 1e-4;

impl<'a, 'input> Check<'a, 'input> {
    /// The skins of sensors that have a link; all of some files are there.
    pub(super) fn skins(&mut self, sensors: &[Node<'a, 'input>], expected: &[Expected<'_>]) -> Vec<OnRobot> {
        let worn: Vec<_> = expected.iter().map(|file| (file, self.is_worn(sensors, file))).collect();
        let skins: Vec<_> = sensors.iter().filter_map(|sensor| self.skin(*sensor, &worn)).collect();
        for file in expected {
            if !sensors.iter().any(|sensor| design(*sensor) == file.name) {
                let allowed = names(skins.iter().map(|it| &*it.skin));
                let message = format!("skin {:?} is not on the robot; there: {allowed}", file.name);
                self.find(Level::Error, None, message);
            }
        }
        skins
    }

    /// Whether any skin of a file lies where the file says: others of it may then lie elsewhere, as a body file may say.
    fn is_worn(&self, sensors: &[Node<'a, 'input>], file: &Expected<'_>) -> bool {
        let right = link_from_skin(file.pose);
        let mut own = sensors.iter().filter(|sensor| design(**sensor) == file.name);
        own.any(|sensor| {
            let joint = link_in(*sensor, "parent").and_then(|frame| self.parts.joints_onto(frame).first());
            joint.is_some_and(|joint| {
                let is_right = |place| is_at(&place, &right);
                link_in(*joint, "parent") == Some(&*file.pose.link) && origin(*joint).is_ok_and(is_right)
            })
        })
    }

    /// The skin of a sensor; none if it has no link.
    fn skin(&mut self, sensor: Node<'a, 'input>, expected: &[(&Expected<'_>, bool)]) -> Option<OnRobot> {
        let skin = sensor.attribute("name").unwrap_or_default();
        let frame = link_in(sensor, "parent").unwrap_or_default();
        let Some(link) = self.parts.link(frame) else {
            let allowed = self.parts.listed();
            self.error(
                sensor,
                format!("skin {skin:?} has the link {frame:?}, which is not there; allowed: {allowed}"),
            );
            return None;
        };
        let joint = self.parts.joints_onto(frame).first().copied();
        let on = joint.and_then(|joint| link_in(joint, "parent"));
        let file = expected.iter().find(|(file, _)| file.name == design(sensor));
        let off_link = match (joint, file) {
            (None, _) => {
                self.error(link, format!("no joint holds the skin {skin:?}"));
                None
            }
            (Some(joint), Some((file, is_worn))) => {
                self.lies_where_it_says(joint, skin, file, *is_worn);
                self.mesh_is_its_own(link, skin, file);
                on.and_then(|on| self.off_link(self.parts.link(on)?, joint, skin, file))
            }
            (Some(_), None) => None,
        };
        let off_link_mm = off_link.map(|off| off * 1e3);
        Some(OnRobot {
            skin: design(sensor).to_owned(),
            frame: frame.to_owned(),
            link: on.map(str::to_owned),
            off_link_mm,
        })
    }

    /// A skin is fixed where its file says, or another of that file is.
    fn lies_where_it_says(
        &mut self,
        joint: Node<'a, 'input>,
        skin: &str,
        file: &Expected<'_>,
        is_worn: bool,
    ) {
        if let Some(kind) = joint.attribute("type").filter(|kind| *kind != "fixed") {
            self.error(joint, format!("the joint of skin {skin:?} is {kind:?}; allowed: \"fixed\""));
        }
        let on = link_in(joint, "parent").unwrap_or_default();
        if on != file.pose.link && !is_worn {
            let message = format!(
                "skin {skin:?} lies on {on:?}, but its file says link = {:?}, the frame of its contacts; allowed: the same in both",
                file.pose.link
            );
            self.warn(joint, message);
        }
        let right = link_from_skin(file.pose);
        // One that is none has been found.
        let Ok(place) = origin(joint) else { return };
        if !is_at(&place, &right) {
            let [xyz, rpy] = xyz_rpy(&right);
            let (far, turned) = apart(&place, &right);
            let message = format!(
                "skin {skin:?} is {:.3} mm and {:.3} degrees off the pose in its file; allowed: <origin xyz=\"{xyz}\" rpy=\"{rpy}\"/>, or that pose in the file",
                far * 1e3,
                turned.to_degrees()
            );
            let level = if is_worn { Level::Warning } else { Level::Error };
            self.find(level, self.parts.line(joint), message);
        }
    }

    fn mesh_is_its_own(&mut self, link: Node<'a, 'input>, skin: &str, file: &Expected<'_>) {
        for mesh in all_of_link(link) {
            let Some(triangles) = mesh.triangles(self.places) else { continue };
            let off = farthest(some(&file.mesh.nodes).map(|node| mesh.origin.inverse() * node), &triangles);
            if off > OTHER_MESH {
                let message = format!(
                    "the mesh {} is up to {:.1} mm off the skin {skin:?}: it is that of another, or of an older one; allowed: to add the skin anew",
                    mesh.uri,
                    off * 1e3
                );
                self.error(link, message);
            }
        }
    }

    /// How far the skin lies from the meshes of its link, if they can be read.
    fn off_link(
        &mut self,
        on: Node<'a, 'input>,
        joint: Node<'_, '_>,
        skin: &str,
        file: &Expected<'_>,
    ) -> Option<f64> {
        let place = &origin(joint).ok()?;
        let meshes = all_of_link(on);
        let read: Vec<_> =
            meshes.iter().filter_map(|mesh| Some((mesh, mesh.triangles(self.places)?))).collect();
        let off = |place: &Isometry3<f64>, (mesh, triangles): &(&MeshUse<'_>, Vec<_>)| {
            let mesh_from_skin = mesh.origin.inverse() * place;
            farthest(some(&file.mesh.nodes).map(|node| mesh_from_skin * node), triangles)
        };
        let least = read.iter().map(|mesh| off(place, mesh)).min_by(f64::total_cmp)?;
        if least > FAR {
            let name = on.attribute("name").unwrap_or_default();
            let mut message =
                format!("skin {skin:?} is up to {:.1} mm off the mesh of {name:?}", least * 1e3);
            // As it is where the skin was cut out of a mesh that the link shows elsewhere than at its own origin.
            let as_cut = read.iter().map(|mesh| (mesh.0.origin * place, mesh));
            if let Some((right, _)) = as_cut.into_iter().find(|(right, mesh)| off(right, mesh) < FAR) {
                let ([x, y, z], turn) = (right.translation.vector.into(), right.rotation);
                let place: [f64; 3] = [x, y, z];
                let turn = [turn.i, turn.j, turn.k, turn.w];
                message += &format!(
                    ": its pose is that in the mesh, which the link shows elsewhere; in the link's frame it is position = {place:.6?}, \
                     orientation = {turn:.6?}"
                );
            }
            self.warn(joint, message);
        }
        Some(least)
    }
}

fn is_at(place: &Isometry3<f64>, right: &Isometry3<f64>) -> bool {
    let (far, turned) = apart(place, right);
    far <= OFF && turned <= OFF
}

/// How far apart two places are, m and rad.
pub(in crate::urdf) fn apart(a: &Isometry3<f64>, b: &Isometry3<f64>) -> (f64, f64) {
    ((a.translation.vector - b.translation.vector).norm(), a.rotation.angle_to(&b.rotation))
}
