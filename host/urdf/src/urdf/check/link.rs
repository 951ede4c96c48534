//! Link: its shapes, its files and its mass.

use super::{Check, Level};
use crate::{
    edit::{children, is},
    urdf::{
        meshes::{Unknown, all_of_link, origin},
        robot::{number, triple},
        solids::geometry,
    },
};
use roxmltree::Node;
use std::collections::BTreeSet;

impl<'a, 'input> Check<'a, 'input> {
    /// Its files are there, and it has a mass where one is needed.
    pub(super) fn link(&mut self, link: Node<'a, 'input>, root: Option<&str>) {
        let name = link.attribute("name").unwrap_or_default();
        let files: BTreeSet<&str> = all_of_link(link).iter().map(|mesh| mesh.uri).collect();
        for uri in files {
            match self.places.file(uri) {
                Ok(path) if path.is_file() => {}
                Ok(path) => {
                    self.error(link, format!("link {name:?}: there is no file `{}` ({uri})", path.display()));
                }
                Err(Unknown::Package(package)) => *self.unknown.entry(package).or_default() += 1,
                Err(Unknown::Scheme(scheme)) => {
                    self.warn(link, format!("link {name:?}: {uri} was not looked for, as it is by {scheme}"));
                }
            }
        }
        for part in link.children().filter(Node::is_element) {
            if let Err(message) = origin(part) {
                self.error(part, format!("link {name:?}: {message}"));
            }
            if is(part, "visual") || is(part, "collision") {
                self.shape(part, name);
            }
        }
        let is_moved =
            self.parts.joints_onto(name).iter().any(|joint| joint.attribute("type") != Some("fixed"));
        if is_moved && root != Some(name) && children(link, "inertial").next().is_none() {
            self.warn(link, format!("link {name:?} moves and has no `inertial`: Gazebo leaves it out"));
        }
    }

    /// Packages that links name are there.
    pub(super) fn packages(&mut self) {
        for (package, files) in std::mem::take(&mut self.unknown) {
            let message = format!(
                "package {package:?} is neither around this file nor known to ROS here, so its {files} mesh files were not \
                 looked for"
            );
            self.find(Level::Warning, None, message);
        }
    }

    /// A part's shape is there, and has its sizes.
    fn shape(&mut self, part: Node<'a, 'input>, link: &str) {
        let kind = part.tag_name().name();
        let Some(solid) = geometry(part).and_then(|geometry| geometry.children().find(Node::is_element))
        else {
            let message = format!("link {link:?}: a <{kind}> has no shape; allowed: a <geometry> with one");
            return self.error(part, message);
        };
        let sizes = match solid.tag_name().name() {
            "box" => {
                solid.has_attribute("size").then(|| triple(solid, "size", 0.0).ok()).flatten().map(Vec::from)
            }
            "sphere" => lengths(solid, &["radius"]),
            "cylinder" => lengths(solid, &["radius", "length"]),
            "mesh" if !solid.has_attribute("filename") => None,
            // Others are not known to all programs.
            _ => return,
        };
        let shape = solid.tag_name().name();
        match sizes {
            None => {
                let allowed = match shape {
                    "box" => "size = three numbers",
                    "sphere" => "radius = a number",
                    "cylinder" => "radius and length = a number each",
                    _ => "filename",
                };
                let message =
                    format!("link {link:?}: the <{shape}> of a <{kind}> is not complete; allowed: {allowed}");
                self.error(solid, message);
            }
            Some(sizes) if sizes.iter().any(|size| *size <= 0.0) => {
                let sizes: Vec<_> = sizes.iter().map(ToString::to_string).collect();
                let message = format!(
                    "link {link:?}: the <{shape}> of a <{kind}> has the size {}; allowed: above 0",
                    sizes.join(" ")
                );
                self.warn(solid, message);
            }
            Some(_) => {}
        }
    }
}

fn lengths(solid: Node<'_, '_>, names: &[&str]) -> Option<Vec<f64>> {
    names.iter().map(|name| number(solid, name)).collect()
}
