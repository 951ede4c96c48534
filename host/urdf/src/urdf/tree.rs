//! Tree: a robot's links, what they look like, the joints that hold them, and its skins.

use super::{
    check::{Finding, Level, Places, apart, check},
    meshes::{of_link, origin},
    robot::{design, is_skin, joints_onto, link_in, number, root_of, triple},
    solids,
};
use crate::{
    DescriptionError,
    edit::{children, parse, readable},
    error::names,
    link_from_skin,
};
use dermatome_patch::pose::Pose;
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, UnitVector3, Vector3};
use roxmltree::Node;

/// A robot that hangs together.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    /// Its links.
    pub links: Vec<Link>,
    /// Its joints.
    pub joints: Vec<Joint>,
    /// Its skins, as [`super::add`] has put them there.
    pub skins: Vec<Skin>,
    /// What is worth a look.
    pub warnings: Vec<Finding>,
}

/// A part that does not bend.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Its name, which is that of its frame.
    pub name: String,
    /// Triangles of what it shows, of meshes those that could be read, in its frame, m.
    pub shape: Vec<[Point3<f64>; 3]>,
}

/// What holds a link.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// How it moves.
    pub motion: Motion,
    parent: String,
    child: String,
    origin: Isometry3<f64>,
    /// Lowest and highest position.
    limit: Option<[f64; 2]>,
}

/// How a joint moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// Not at all.
    Fixed,
    /// It turns about an axis: its position is an angle, rad.
    Turns(UnitVector3<f64>),
    /// It slides along an axis: its position is a length, m.
    Slides(UnitVector3<f64>),
    /// More than one number says; it is taken to stay where it is.
    Free,
}

/// A skin on a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Skin {
    /// Name of its skin file, which others on the robot may have too.
    pub name: String,
    /// Its own link, which shows it, and whose name is the skin's own on the robot.
    pub frame: String,
    /// The link that it lies on.
    pub link: String,
    link_from_skin: Isometry3<f64>,
}

/// Why a robot is not used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RobotError {
    /// It cannot be read.
    #[error(transparent)]
    Description(#[from] DescriptionError),
    /// It does not hang together: the first of what is wrong.
    #[error("{0}")]
    Broken(Finding),
}

impl Robot {
    /// Reads and checks a robot. Links' mesh files that are not to be found because their package is not are no error.
    pub fn read(text: &str, places: &Places<'_>) -> Result<Self, RobotError> {
        let findings = check(text, places, &[])?.findings;
        if let Some(error) = findings.iter().find(|finding| finding.level == Level::Error) {
            return Err(RobotError::Broken(error.clone()));
        }
        let readable = readable(text);
        let document = parse(&readable)?;
        let robot = root_of(&document)?;
        let sensors = children(robot, "sensor").filter(|sensor| is_skin(*sensor));
        Ok(Self {
            links: children(robot, "link").map(|node| link(node, places)).collect(),
            joints: children(robot, "joint").map(joint).collect(),
            skins: sensors.filter_map(|sensor| skin(robot, sensor)).collect(),
            warnings: findings,
        })
    }

    /// Whether it has a link.
    #[must_use]
    pub fn has_link(&self, name: &str) -> bool {
        self.links.iter().any(|link| link.name == name)
    }

    /// Its links that are no skins', as an error lists them.
    #[must_use]
    pub fn link_names(&self) -> String {
        let is_own = |link: &&Link| self.skins.iter().all(|skin| skin.frame != link.name);
        names(self.links.iter().filter(is_own).map(|link| link.name.as_str()))
    }
}

impl Joint {
    /// Where its child lies on its parent.
    #[must_use]
    pub fn pose(&self, position: f64) -> Pose {
        pose(&self.parent, &(self.origin * self.motion.by(position)))
    }

    /// The link that it holds.
    #[must_use]
    pub fn child(&self) -> &str {
        &self.child
    }

    /// The position in which a robot is drawn that says nothing of itself: zero, or the middle where it cannot be there.
    #[must_use]
    pub fn at_rest(&self) -> f64 {
        match self.limit {
            Some([low, high]) if !(low..=high).contains(&0.0) => (low + high) / 2.0,
            _ => 0.0,
        }
    }
}

impl Motion {
    fn by(self, position: f64) -> Isometry3<f64> {
        match self {
            Self::Fixed | Self::Free => Isometry3::identity(),
            Self::Turns(axis) => {
                let turn = UnitQuaternion::from_axis_angle(&axis, position);
                Isometry3::from_parts(Translation3::identity(), turn)
            }
            Self::Slides(axis) => Isometry3::from(Translation3::from(axis.into_inner() * position)),
        }
    }
}

impl Skin {
    /// Where it lies on its link.
    #[must_use]
    pub fn pose(&self) -> Pose {
        pose(&self.link, &self.link_from_skin)
    }

    /// How far it is from where a pose has it, m and rad.
    #[must_use]
    pub fn off(&self, pose: &Pose) -> (f64, f64) {
        apart(&self.link_from_skin, &link_from_skin(pose))
    }
}

fn link(node: Node<'_, '_>, places: &Places<'_>) -> Link {
    let shown = of_link(node, "visual");
    let meshes = shown.iter().filter_map(|mesh| Some((mesh.origin, mesh.triangles(places)?)));
    let solid = |part| Some((origin(part).ok()?, solids::triangles(solids::geometry(part)?)?));
    let solids = children(node, "visual").filter_map(solid);
    let placed = |(origin, triangles): (Isometry3<f64>, Vec<[Point3<f64>; 3]>)| {
        triangles.into_iter().map(move |corners| corners.map(|corner| origin * corner))
    };
    Link { name: attribute(node, "name"), shape: meshes.chain(solids).flat_map(placed).collect() }
}

/// One that has been checked.
fn joint(node: Node<'_, '_>) -> Joint {
    let limit = children(node, "limit").next();
    let end = |name| number(limit?, name);
    let ends = |limit: Node<'_, '_>| {
        let either = limit.has_attribute("lower") || limit.has_attribute("upper");
        either.then(|| [end("lower").unwrap_or(0.0), end("upper").unwrap_or(0.0)])
    };
    Joint {
        name: attribute(node, "name"),
        motion: motion(node),
        parent: link_in(node, "parent").unwrap_or_default().to_owned(),
        child: link_in(node, "child").unwrap_or_default().to_owned(),
        origin: origin(node).unwrap_or_default(),
        limit: limit.and_then(ends),
    }
}

fn motion(joint: Node<'_, '_>) -> Motion {
    match joint.attribute("type") {
        Some("revolute" | "continuous") => axis(joint).map_or(Motion::Free, Motion::Turns),
        Some("prismatic") => axis(joint).map_or(Motion::Free, Motion::Slides),
        Some("fixed") => Motion::Fixed,
        _ => Motion::Free,
    }
}

/// x unless the joint says another; none that is no direction.
fn axis(joint: Node<'_, '_>) -> Option<UnitVector3<f64>> {
    let Some(axis) = children(joint, "axis").next().filter(|axis| axis.has_attribute("xyz")) else {
        return Some(Vector3::x_axis());
    };
    UnitVector3::try_new(Vector3::from(triple(axis, "xyz", 0.0).ok()?), 1e-6)
}

fn skin(robot: Node<'_, '_>, sensor: Node<'_, '_>) -> Option<Skin> {
    let frame = link_in(sensor, "parent")?;
    let joint = joints_onto(robot, frame).next()?;
    Some(Skin {
        name: design(sensor).to_owned(),
        frame: frame.to_owned(),
        link: link_in(joint, "parent")?.to_owned(),
        link_from_skin: origin(joint).ok()?,
    })
}

fn pose(link: &str, place: &Isometry3<f64>) -> Pose {
    let turn = place.rotation;
    let orientation = [turn.i, turn.j, turn.k, turn.w];
    Pose { link: link.to_owned(), position: place.translation.vector.into(), orientation }
}

fn attribute(node: Node<'_, '_>, name: &str) -> String {
    node.attribute(name).unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{f64::consts::FRAC_PI_2, path::Path};

    fn read(text: &str) -> Result<Robot, RobotError> {
        Robot::read(text, &Places { folder: Path::new("."), packages: &[] })
    }

    fn robot(joint: &str) -> Result<Robot, RobotError> {
        let text = format!(
            "<robot name='r'><link name='base'/><link name='arm'/><joint name='j' {joint}<parent link='base'/><child \
             link='arm'/></joint></robot>"
        );
        read(&text)
    }

    fn moved(joint: &str, position: f64) -> [f64; 3] {
        let robot = robot(joint).unwrap();
        let pose = robot.joints[0].pose(position);
        assert_eq!((pose.link.as_str(), robot.joints[0].child()), ("base", "arm"));
        pose.point([1.0, 0.0, 0.0])
    }

    fn assert_near(a: [f64; 3], b: [f64; 3]) {
        assert!((0..3).all(|axis| (a[axis] - b[axis]).abs() < 1e-12), "{a:?} {b:?}");
    }

    #[test]
    fn joints_turn_about_their_axis_and_slide_along_it_in_their_own_frame() {
        let turned = "<origin xyz='0 0 1' rpy='0 0 1.5707963267948966'/>";
        let limit = "<limit lower='-2' upper='2'/>";
        let joint = |kind: &str, axis: &str| format!("type='{kind}'>{turned}{axis}{limit}");
        let axis = "<axis xyz='0 0 2'/>";
        assert_near(moved(&joint("fixed", ""), 0.7), [0.0, 1.0, 1.0]);
        assert_near(moved(&joint("revolute", axis), FRAC_PI_2), [-1.0, 0.0, 1.0]);
        assert_near(moved(&joint("continuous", ""), FRAC_PI_2), [0.0, 1.0, 1.0]);
        assert_near(moved(&joint("prismatic", axis), 0.25), [0.0, 1.0, 1.25]);
        assert_near(moved(&joint("prismatic", ""), 0.25), [0.0, 1.25, 1.0]);
        assert_near(moved(&joint("floating", ""), 0.25), [0.0, 1.0, 1.0]);
    }

    #[test]
    fn a_joint_that_cannot_be_at_zero_rests_in_its_middle() {
        let rest = |limit: &str| robot(&format!("type='revolute'>{limit}")).unwrap().joints[0].at_rest();
        assert_eq!(rest("<limit lower='-1' upper='2'/>"), 0.0);
        assert_eq!(rest("<limit lower='1' upper='2'/>"), 1.5);
        assert_eq!(rest("<limit effort='1'/>"), 0.0);
    }

    #[test]
    fn what_does_not_hang_together_is_refused_with_its_line() {
        let error = robot("type='hinge'>").unwrap_err().to_string();
        assert!(error.starts_with("line 1: the `type` of joint \"j\" is \"hinge\"; allowed: "), "{error}");
        let error = read("<mujoco/>").unwrap_err().to_string();
        assert!(error.contains("allowed: <robot>"), "{error}");
    }
}
