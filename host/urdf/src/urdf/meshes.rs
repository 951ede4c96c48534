//! Mesh files that a robot names: where they are, and how far a skin lies from them.

use super::robot::triple;
use crate::{
    edit::{children, is},
    place::of_xyz_rpy,
};
use dermatome_geometry::mesh::{import, triangle};
use nalgebra::{Isometry3, Point3, Vector3};
use roxmltree::Node;
use std::path::{Path, PathBuf};

/// Points of a skin that are looked at.
const POINTS: usize = 150;

/// Where to look for files.
#[derive(Clone, Debug)]
pub struct Places<'a> {
    /// The folder of the robot's file.
    pub folder: &'a Path,
    /// Folders that hold packages of ROS, or whose `share` does.
    pub packages: &'a [PathBuf],
}

/// A file that cannot be looked for here.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Unknown {
    /// No package of this name.
    Package(String),
    /// By `http` or the like.
    Scheme(String),
}

/// Where ROS says its packages are.
const PACKAGES: [&str; 2] = ["AMENT_PREFIX_PATH", "ROS_PACKAGE_PATH"];

/// Folders that hold packages of ROS, by the environment.
#[must_use]
pub fn packages_of_ros() -> Vec<PathBuf> {
    let lists = PACKAGES.into_iter().filter_map(std::env::var_os);
    lists.flat_map(|list| std::env::split_paths(&list).collect::<Vec<_>>()).collect()
}

impl Places<'_> {
    /// The file that a URI means, if it is there.
    #[must_use]
    pub fn find(&self, uri: &str) -> Option<PathBuf> {
        self.file(uri).ok().filter(|path| path.is_file())
    }

    /// The file that a URI means, whether it is there or not.
    pub(super) fn file(&self, uri: &str) -> Result<PathBuf, Unknown> {
        match uri.split_once("://") {
            None => Ok(self.folder.join(uri)),
            Some(("file", path)) => Ok(PathBuf::from(path)),
            Some(("package", path)) => {
                let (package, inner) = path.split_once('/').unwrap_or((path, ""));
                let folder = self.package(package).ok_or_else(|| Unknown::Package(package.to_owned()))?;
                Ok(folder.join(inner))
            }
            Some((scheme, _)) => Err(Unknown::Scheme(scheme.to_owned())),
        }
    }

    /// The folder of a package: one that the robot's file is in, or one that ROS knows.
    fn package(&self, name: &str) -> Option<PathBuf> {
        let absolute = std::path::absolute(self.folder).ok()?;
        let around = absolute.ancestors().find(|folder| folder.ends_with(name)).map(Path::to_owned);
        let known = self.packages.iter().flat_map(|place| [place.join("share").join(name), place.join(name)]);
        around.or_else(|| known.into_iter().find(|folder| folder.is_dir()))
    }
}

/// A mesh that a link shows or collides with.
pub(super) struct MeshUse<'a> {
    pub(super) uri: &'a str,
    /// In the link's frame.
    pub(super) origin: Isometry3<f64>,
    scale: [f64; 3],
}

/// Those that a link shows and collides with.
pub(super) fn all_of_link<'a>(link: Node<'a, '_>) -> Vec<MeshUse<'a>> {
    ["visual", "collision"].into_iter().flat_map(|kind| of_link(link, kind)).collect()
}

/// Those of one kind that are well-formed; the others have findings of their own.
pub(super) fn of_link<'a>(link: Node<'a, '_>, kind: &str) -> Vec<MeshUse<'a>> {
    link.children().filter(|part| is(*part, kind)).filter_map(of_part).collect()
}

fn of_part<'a>(part: Node<'a, '_>) -> Option<MeshUse<'a>> {
    let geometry = part.children().find(|child| is(*child, "geometry"))?;
    let mesh = geometry.children().find(|child| is(*child, "mesh"))?;
    let origin = origin(part).ok()?;
    Some(MeshUse { uri: mesh.attribute("filename")?, origin, scale: triple(mesh, "scale", 1.0).ok()? })
}

/// The `origin` of a joint or a part of a link.
pub(super) fn origin(node: Node<'_, '_>) -> Result<Isometry3<f64>, String> {
    let Some(origin) = children(node, "origin").next() else { return Ok(Isometry3::identity()) };
    Ok(of_xyz_rpy(triple(origin, "xyz", 0.0)?, triple(origin, "rpy", 0.0)?))
}

impl MeshUse<'_> {
    /// Its triangles in its own frame, m; none where the file cannot be read.
    pub(super) fn triangles(&self, places: &Places<'_>) -> Option<Vec<[Point3<f64>; 3]>> {
        let mut mesh = import::read(&places.file(self.uri).ok()?, None).ok()?;
        mesh.scale(mesh.unit.unwrap_or(1.0));
        let scale = Vector3::from(self.scale);
        let point = |node: usize| Point3::from(mesh.nodes[node].coords.component_mul(&scale));
        Some(mesh.triangles.iter().map(|corners| corners.map(point)).collect())
    }
}

/// The farthest that any of some points is from a mesh, m.
pub(super) fn farthest(points: impl Iterator<Item = Point3<f64>>, triangles: &[[Point3<f64>; 3]]) -> f64 {
    let away = |point: Point3<f64>| {
        let squares =
            triangles.iter().map(|corners| (triangle::nearest(*corners, point) - point).norm_squared());
        squares.fold(f64::INFINITY, f64::min).sqrt()
    };
    points.map(away).fold(0.0, f64::max)
}

/// Some points of a skin, evenly taken.
pub(super) fn some(nodes: &[Point3<f64>]) -> impl Iterator<Item = Point3<f64>> + Clone + '_ {
    nodes.iter().step_by(nodes.len().div_ceil(POINTS).max(1)).copied()
}
