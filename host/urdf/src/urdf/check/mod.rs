//! Whether a robot hangs together, and has its skins where their files say.

mod joint;
mod link;
mod parts;
mod skin;
mod tree;

pub use super::meshes::{Places, packages_of_ros};
use super::robot::{is_skin, root_of};
use crate::{
    DescriptionError,
    edit::{children, parse, readable},
};
use dermatome_geometry::mesh::Mesh;
use dermatome_patch::pose::Pose;
use parts::Parts;
use roxmltree::Node;
use serde::Serialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
};

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
    /// Programs refuse the robot, as all of ROS that reads by urdfdom does, or the skin is somewhere else.
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
    /// Name of its skin file.
    pub skin: String,
    /// Its own link, and its name on the robot.
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
    let parts = Parts::of(robot, &readable);
    let mut check = Check { parts, places, findings: Vec::new(), unknown: BTreeMap::new() };
    check.has_a_name(robot);
    ["link", "joint"].into_iter().for_each(|kind| check.names_are_unique(robot, kind));
    children(robot, "joint").for_each(|joint| check.joint(joint));
    let root = check.tree(robot);
    children(robot, "link").for_each(|link| check.link(link, root.as_deref()));
    check.packages();
    let sensors: Vec<_> = children(robot, "sensor").filter(|sensor| is_skin(*sensor)).collect();
    let skins = check.skins(&sensors, expected);
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
    parts: Parts<'a, 'input>,
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
        self.find(Level::Error, self.parts.line(at), message);
    }

    fn warn(&mut self, at: Node<'_, '_>, message: String) {
        self.find(Level::Warning, self.parts.line(at), message);
    }

    fn has_a_name(&mut self, robot: Node<'_, '_>) {
        match robot.attribute("name") {
            None => self.error(robot, "the robot has no `name`".to_owned()),
            Some("") => self.warn(robot, "the `name` of the robot is empty".to_owned()),
            Some(_) => {}
        }
    }

    fn names_are_unique(&mut self, robot: Node<'a, 'input>, kind: &'static str) {
        let mut there = BTreeSet::new();
        for node in children(robot, kind) {
            match node.attribute("name").filter(|name| !name.is_empty()) {
                None => self.error(node, format!("a {kind} has no `name`")),
                Some(name) if !there.insert(name) => {
                    self.error(node, format!("another {kind} is called {name:?}; allowed: a name for each"));
                }
                Some(_) => {}
            }
        }
    }
}

pub(super) use skin::apart;

#[cfg(test)]
mod tests;
