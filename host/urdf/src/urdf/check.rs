//! Whether a robot hangs together, and has its skins where their files say.

pub use super::meshes::{Places, packages_of_ros};
use super::{
    meshes::{MeshUse, Unknown, all_of_link, farthest, origin, some},
    robot::{is_skin, joints_onto, link_in, named, root_of},
};
use crate::{
    DescriptionError,
    edit::{children, line, parse, readable},
    error::names,
    link_from_skin,
    place::xyz_rpy,
};
use dermatome_geometry::mesh::Mesh;
use dermatome_patch::pose::Pose;
use nalgebra::Isometry3;
use roxmltree::Node;
use serde::Serialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
};

/// A joint that is off its skin's pose by more, m or rad, is another place.
const OFF: f64 = 1e-6;
/// A skin that is farther from its link's mesh, m, lies somewhere else.
const FAR: f64 = 5e-3;
/// A skin's mesh file that is off it by more, m, is that of another skin.
const OTHER_MESH: f64 = 1e-4;

/// Kinds of joints.
const KINDS: [&str; 6] = ["revolute", "continuous", "prismatic", "fixed", "floating", "planar"];
/// Those that need a limit.
const LIMITED: [&str; 2] = ["revolute", "prismatic"];

/// What a skin's file says of it.
#[derive(Clone, Debug)]
pub struct Expected<'a> {
    /// Its name.
    pub name: &'a str,
    /// Where it lies.
    pub pose: &'a Pose,
    /// Its mesh, in its own frame.
    pub mesh: &'a Mesh,
}

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// Programs refuse the robot, or the skin is somewhere else.
    Error,
    /// Worth a look.
    Warning,
}

/// Something about a robot.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// How bad it is.
    pub level: Level,
    /// Line of the file, from 1.
    pub line: Option<u32>,
    /// What it is.
    pub message: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.line.map_or(Ok(()), |line| write!(f, "line {line}: "))?;
        f.write_str(&self.message)
    }
}

/// A skin that is on the robot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OnRobot {
    /// Its name.
    pub skin: String,
    /// Its own link.
    pub frame: String,
    /// The link that it lies on.
    pub link: Option<String>,
    /// How far it is from that link's meshes at most, mm; none where they or its file are not known.
    pub off_link_mm: Option<f64>,
}

/// A robot, and what is wrong with it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Checked {
    /// Its name.
    pub robot: String,
    /// How many links it has.
    pub links: usize,
    /// How many joints.
    pub joints: usize,
    /// The link that no joint holds, if there is one only.
    pub root: Option<String>,
    /// Its skins.
    pub skins: Vec<OnRobot>,
    /// In the order of the checks.
    pub findings: Vec<Finding>,
}

/// Checks a robot.
pub fn check(
    text: &str,
    places: &Places<'_>,
    expected: &[Expected<'_>],
) -> Result<Checked, DescriptionError> {
    let readable = readable(text);
    let document = parse(&readable)?;
    let robot = root_of(&document)?;
    let mut check = Check { robot, places, findings: Vec::new(), unknown: BTreeMap::new() };
    ["link", "joint"].into_iter().for_each(|kind| check.names_are_unique(kind));
    children(robot, "joint").for_each(|joint| check.joint(joint));
    let root = check.tree();
    children(robot, "link").for_each(|link| check.link(link, root.as_deref()));
    check.packages();
    let skins = children(robot, "sensor").filter(|sensor| is_skin(*sensor));
    let skins: Vec<_> = skins.filter_map(|sensor| check.skin(sensor, expected)).collect();
    expected.iter().for_each(|skin| check.is_there(skin, &skins));
    Ok(Checked {
        robot: robot.attribute("name").unwrap_or_default().to_owned(),
        links: children(robot, "link").count(),
        joints: children(robot, "joint").count(),
        root,
        skins,
        findings: check.findings,
    })
}

struct Check<'a, 'input> {
    robot: Node<'a, 'input>,
    places: &'a Places<'a>,
    findings: Vec<Finding>,
    /// Packages that are not to be found, and how many files are in them.
    unknown: BTreeMap<String, usize>,
}

impl<'a, 'input> Check<'a, 'input> {
    fn find(&mut self, level: Level, line: impl Into<Option<u32>>, message: String) {
        self.findings.push(Finding { level, line: line.into(), message });
    }

    fn error(&mut self, at: Node<'_, '_>, message: String) {
        self.find(Level::Error, line(at), message);
    }

    fn warn(&mut self, at: Node<'_, '_>, message: String) {
        self.find(Level::Warning, line(at), message);
    }

    fn links(&self) -> impl Iterator<Item = &'a str> + use<'a, 'input> {
        children(self.robot, "link").filter_map(|link| link.attribute("name"))
    }

    fn names_are_unique(&mut self, kind: &'static str) {
        let mut there = BTreeSet::new();
        for node in children(self.robot, kind) {
            match node.attribute("name").filter(|name| !name.is_empty()) {
                None => self.error(node, format!("a {kind} has no `name`")),
                Some(name) if !there.insert(name) => {
                    self.error(node, format!("another {kind} is called {name:?}; allowed: a name for each"));
                }
                Some(_) => {}
            }
        }
    }

    /// Its links are there, and its numbers are numbers.
    fn joint(&mut self, joint: Node<'a, 'input>) {
        let name = joint.attribute("name").unwrap_or_default();
        for which in ["parent", "child"] {
            match link_in(joint, which) {
                None => self.error(joint, format!("joint {name:?} names no {which} link")),
                Some(link) if !self.links().any(|it| it == link) => {
                    let allowed = names(self.links());
                    let message = format!(
                        "the {which} of joint {name:?} is {link:?}, which is no link; allowed: {allowed}"
                    );
                    self.error(joint, message);
                }
                Some(_) => {}
            }
        }
        if let Err(message) = origin(joint) {
            self.error(joint, format!("joint {name:?}: {message}"));
        }
        let kind = joint.attribute("type").unwrap_or_default();
        if !KINDS.contains(&kind) {
            let allowed = names(KINDS.into_iter());
            self.error(joint, format!("the `type` of joint {name:?} is {kind:?}; allowed: {allowed}"));
        }
        if LIMITED.contains(&kind) && children(joint, "limit").next().is_none() {
            self.error(joint, format!("joint {name:?} is {kind} and has no `limit`"));
        }
    }

    /// Links and joints make one tree; its root.
    fn tree(&mut self) -> Option<String> {
        let mut parents: BTreeMap<&str, &str> = BTreeMap::new();
        for joint in children(self.robot, "joint") {
            let (Some(parent), Some(child)) = (link_in(joint, "parent"), link_in(joint, "child")) else {
                continue;
            };
            if let Some(other) = parents.insert(child, parent) {
                self.error(
                    joint,
                    format!("link {child:?} has two parents, {other:?} and {parent:?}; allowed: one"),
                );
            }
        }
        let links: BTreeSet<&str> = self.links().collect();
        let roots: Vec<&str> = self.links().filter(|link| !parents.contains_key(link)).collect();
        let is_held = |link: &&&str| {
            let mut at = **link;
            let steps = (0..=links.len()).find(|_| parents.get(at).map(|parent| at = parent).is_none());
            steps.is_some()
        };
        let circle: Vec<&str> = links.iter().filter(|link| !is_held(link)).copied().collect();
        match roots[..] {
            [] if links.is_empty() => self.find(Level::Error, None, "the robot has no link".to_owned()),
            [] => {}
            [root] if circle.is_empty() => return Some(root.to_owned()),
            [_] => {}
            _ => {
                let message =
                    format!("no joint holds {}; allowed: one such link, the root", names(roots.into_iter()));
                self.find(Level::Error, None, message);
            }
        }
        if !circle.is_empty() {
            let message = format!("joints go in a circle at {}", names(circle.into_iter()));
            self.find(Level::Error, None, message);
        }
        None
    }

    /// Its files are there, and it has a mass where one is needed.
    fn link(&mut self, link: Node<'a, 'input>, root: Option<&str>) {
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
        }
        let is_moved = joints_onto(self.robot, name).any(|joint| joint.attribute("type") != Some("fixed"));
        if is_moved && root != Some(name) && children(link, "inertial").next().is_none() {
            self.warn(link, format!("link {name:?} moves and has no `inertial`: Gazebo leaves it out"));
        }
    }

    /// Packages that links name are there.
    fn packages(&mut self) {
        for (package, files) in std::mem::take(&mut self.unknown) {
            let message = format!(
                "package {package:?} is neither around this file nor known to ROS here, so its {files} mesh files were not \
                 looked for"
            );
            self.find(Level::Warning, None, message);
        }
    }

    /// The skin of a sensor; none if it has no link.
    fn skin(&mut self, sensor: Node<'a, 'input>, expected: &[Expected<'_>]) -> Option<OnRobot> {
        let skin = sensor.attribute("name").unwrap_or_default();
        let frame = link_in(sensor, "parent").unwrap_or_default();
        let Some(link) = named(self.robot, "link", frame).next() else {
            let allowed = names(self.links());
            self.error(
                sensor,
                format!("skin {skin:?} has the link {frame:?}, which is not there; allowed: {allowed}"),
            );
            return None;
        };
        let joint = joints_onto(self.robot, frame).next();
        let on = joint.and_then(|joint| link_in(joint, "parent"));
        let file = expected.iter().find(|file| file.name == skin);
        let off_link = match (joint, file) {
            (None, _) => {
                self.error(link, format!("no joint holds the skin {skin:?}"));
                None
            }
            (Some(joint), Some(file)) => self.lies_right(joint, link, file),
            (Some(_), None) => None,
        };
        let off_link_mm = off_link.map(|off| off * 1e3);
        Some(OnRobot {
            skin: skin.to_owned(),
            frame: frame.to_owned(),
            link: on.map(str::to_owned),
            off_link_mm,
        })
    }

    /// A skin is where its file says, with its own mesh, and on its link; how far it is off the link's meshes, m.
    fn lies_right(
        &mut self,
        joint: Node<'a, 'input>,
        link: Node<'a, 'input>,
        file: &Expected<'_>,
    ) -> Option<f64> {
        let skin = file.name;
        if let Some(kind) = joint.attribute("type").filter(|kind| *kind != "fixed") {
            self.error(joint, format!("the joint of skin {skin:?} is {kind:?}; allowed: \"fixed\""));
        }
        let on = link_in(joint, "parent").unwrap_or_default();
        if on != file.pose.link {
            let message = format!(
                "skin {skin:?} lies on {on:?}, but its file says link = {:?}, the frame of its contacts; allowed: the same in both",
                file.pose.link
            );
            self.warn(joint, message);
        }
        let right = link_from_skin(file.pose);
        // One that is none has been found.
        let place = origin(joint).ok()?;
        let (far, turned) = apart(&place, &right);
        if far > OFF || turned > OFF {
            let [xyz, rpy] = xyz_rpy(&right);
            let message = format!(
                "skin {skin:?} is {:.3} mm and {:.3} degrees off the pose in its file; allowed: <origin xyz=\"{xyz}\" rpy=\"{rpy}\"/>, or that pose in the file",
                far * 1e3,
                turned.to_degrees()
            );
            self.error(joint, message);
        }
        self.mesh_is_its_own(link, file);
        self.off_link(named(self.robot, "link", on).next()?, &place, file, joint)
    }

    fn mesh_is_its_own(&mut self, link: Node<'a, 'input>, file: &Expected<'_>) {
        for mesh in all_of_link(link) {
            let Some(triangles) = mesh.triangles(self.places) else { continue };
            let off = farthest(some(&file.mesh.nodes).map(|node| mesh.origin.inverse() * node), &triangles);
            if off > OTHER_MESH {
                let message = format!(
                    "the mesh {} is up to {:.1} mm off the skin {:?}: it is that of another, or of an older one; allowed: to add the skin anew",
                    mesh.uri,
                    off * 1e3,
                    file.name
                );
                self.error(link, message);
            }
        }
    }

    /// How far the skin lies from the meshes of its link, if they can be read.
    fn off_link(
        &mut self,
        on: Node<'a, 'input>,
        place: &Isometry3<f64>,
        file: &Expected<'_>,
        joint: Node<'_, '_>,
    ) -> Option<f64> {
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
                format!("skin {:?} is up to {:.1} mm off the mesh of {name:?}", file.name, least * 1e3);
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

    /// The skin of a file is on the robot.
    fn is_there(&mut self, skin: &Expected<'_>, there: &[OnRobot]) {
        let name = skin.name;
        let is_named = children(self.robot, "sensor").any(|sensor| sensor.attribute("name") == Some(name));
        if !is_named {
            let allowed = names(there.iter().map(|it| &*it.skin));
            self.find(Level::Error, None, format!("skin {name:?} is not on the robot; there: {allowed}"));
        }
    }
}

/// How far apart two places are, m and rad.
pub(super) fn apart(a: &Isometry3<f64>, b: &Isometry3<f64>) -> (f64, f64) {
    ((a.translation.vector - b.translation.vector).norm(), a.rotation.angle_to(&b.rotation))
}
