//! URDF, the format of robots in ROS.
//!
//! A skin is a `<link>`, which is its frame and shows its mesh, a fixed `<joint>` from the link that it lies on, and a
//! `<sensor>` of the robot with a `<tactile>` in it. URDF has had `<sensor>` for cameras and lasers only; programs that
//! know no other (urdfdom, and with it all of ROS; yourdfpy, MuJoCo) pass it over. Its form here is that of CITEC's
//! `urdf_tactile` (<https://github.com/ubi-agni/tactile_toolbox>), the one extension for tactile sensors that has tools.
//! The skin has neither mass nor `<collision>`: the link under it has both, and a `<collision>` of its own would be in
//! collision with that one for ever.

pub mod check;
mod meshes;
mod robot;
mod solids;
pub mod tree;

use crate::{
    DescriptionError, Mount, Placed,
    edit::{Edits, children, escaped, line, parse, readable},
    place::{number, xyz_rpy},
};
use robot::{is_skin, joints_onto, joints_under, link_in, named, root_of};
use roxmltree::Node;

/// The text of a robot with a skin on it. One whose name on the robot is the same is refused, or replaced: its link with
/// all that is in it, its joint and its sensor.
pub fn add(text: &str, mount: &Mount<'_>, replace: bool) -> Result<String, DescriptionError> {
    let readable = readable(text);
    let document = parse(&readable)?;
    let robot = root_of(&document)?;
    let mut edits = Edits::new(text);
    let mut gone = Vec::new();
    if let Some(sensor) = sensor_of(robot, mount.frame) {
        if !replace {
            return Err(DescriptionError::Skin { line: line(sensor), name: mount.frame.to_owned() });
        }
        gone = of_skin(robot, sensor, mount)?;
        gone.iter().for_each(|node| edits.remove(*node));
    }
    let is_left = |node: &Node<'_, '_>| !gone.contains(node);
    for (kind, name) in [("link", mount.frame), ("joint", &*joint_name(mount)), ("sensor", mount.frame)] {
        if let Some(other) = named(robot, kind, name).find(is_left) {
            return Err(DescriptionError::Taken { line: line(other), kind, name: name.to_owned() });
        }
    }
    if !named(robot, "link", mount.on).any(|link| is_left(&link)) {
        let there = children(robot, "link").filter(is_left).filter_map(|link| link.attribute("name"));
        return Err(DescriptionError::absent("link", mount.on, there));
    }
    edits.append(robot, &lines(mount));
    Ok(edits.made())
}

/// How the skin of this name lies on a robot, if it is there.
pub fn placed(text: &str, name: &str) -> Result<Option<Placed>, DescriptionError> {
    let readable = readable(text);
    let document = parse(&readable)?;
    let robot = root_of(&document)?;
    let Some(sensor) = sensor_of(robot, name) else { return Ok(None) };
    let frame = link_in(sensor, "parent").unwrap_or_default();
    let on = joints_onto(robot, frame).next().and_then(|joint| link_in(joint, "parent"));
    let link = named(robot, "link", frame).next();
    let mesh = link.and_then(|link| meshes::of_link(link, "visual").into_iter().next());
    Ok(Some(Placed { on: on.map(str::to_owned), mesh: mesh.map(|mesh| mesh.uri.to_owned()) }))
}

/// The sensor of a skin.
fn sensor_of<'a, 'input: 'a>(robot: Node<'a, 'input>, name: &'a str) -> Option<Node<'a, 'input>> {
    named(robot, "sensor", name).find(|sensor| is_skin(*sensor))
}

/// All elements of a skin that is there: its sensor, its link, its joint.
fn of_skin<'a, 'input>(
    robot: Node<'a, 'input>,
    sensor: Node<'a, 'input>,
    mount: &Mount<'_>,
) -> Result<Vec<Node<'a, 'input>>, DescriptionError> {
    let frame = link_in(sensor, "parent").unwrap_or_default();
    let holds_more = joints_under(robot, frame).next().filter(|_| frame != mount.frame);
    if let Some(joint) = holds_more {
        return Err(DescriptionError::Inhabited { line: line(joint), kind: "link", name: frame.to_owned() });
    }
    let link = named(robot, "link", frame);
    Ok(link.chain(joints_onto(robot, frame)).chain([sensor]).collect())
}

fn joint_name(mount: &Mount<'_>) -> String {
    format!("{}_mount", mount.frame)
}

fn lines(mount: &Mount<'_>) -> Vec<String> {
    let [skin, frame, on, mesh] = [mount.skin, mount.frame, mount.on, mount.mesh].map(escaped);
    let joint = escaped(&joint_name(mount));
    let [xyz, rpy] = xyz_rpy(&mount.link_from_skin());
    let rate = number(mount.frame_rate);
    // `robot::design` reads it.
    let design = if mount.skin == mount.frame { String::new() } else { format!(r#" skin="{skin}""#) };
    let text = format!(
        r#"<link name="{frame}">
  <visual>
    <geometry>
      <mesh filename="{mesh}"/>
    </geometry>
    <material name="{frame}_fabric">
      <color rgba="0.2 0.2 0.25 1"/>
    </material>
  </visual>
</link>
<joint name="{joint}" type="fixed">
  <parent link="{on}"/>
  <child link="{frame}"/>
  <origin xyz="{xyz}" rpy="{rpy}"/>
</joint>
<sensor name="{frame}" update_rate="{rate}">
  <parent link="{frame}"/>
  <origin xyz="0 0 0" rpy="0 0 0"/>
  <tactile channel="{frame}"{design}>
    <taxel idx="0" xyz="0 0 0" rpy="0 0 0">
      <geometry>
        <mesh filename="{mesh}"/>
      </geometry>
    </taxel>
  </tactile>
</sensor>"#
    );
    text.lines().map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_patch::pose::Pose;

    const ROBOT: &str = "<?xml version=\"1.0\"?>\r\n<!-- \u{e4} -->\r\n<robot name='r'>\r\n\t<link name='base'/>\r\n\
                         \t<link name=\"a&lt;b\"  ></link><!-- last -->\r\n</robot>\r\n<!-- after -->";

    fn pose() -> Pose {
        Pose { link: "base".into(), position: [0.1, 0.0, -0.25], orientation: [0.5, 0.5, 0.5, 0.5] }
    }

    fn mount<'a>(pose: &'a Pose, on: &'a str) -> Mount<'a> {
        Mount { skin: "palm", frame: "palm", on, pose, mesh: "package://r/palm&1.stl", frame_rate: 50.0 }
    }

    #[test]
    fn a_skin_is_put_at_the_end_and_all_else_stays_byte_for_byte() {
        let pose = pose();
        let made = add(ROBOT, &mount(&pose, "a<b"), false).unwrap();
        let (before, after) = ROBOT.split_at(ROBOT.find("</robot>").unwrap());
        let block = made.strip_prefix(before).and_then(|rest| rest.strip_suffix(after)).unwrap();
        assert!(block.lines().count() == 26 && block.replace("\r\n", "").find(['\r', '\n']).is_none());
        assert!(block.starts_with("\t<link name=\"palm\">\r\n"), "{block}");
        for piece in [
            "<parent link=\"a&lt;b\"/>",
            "<origin xyz=\"0.1 0 -0.25\" rpy=\"1.570796327 0 1.570796327\"/>",
            "filename=\"package://r/palm&amp;1.stl\"",
            "<sensor name=\"palm\" update_rate=\"50\">",
        ] {
            assert!(block.contains(piece), "{piece}: {block}");
        }
    }

    #[test]
    fn the_same_skin_again_is_refused_or_replaced() {
        let pose = pose();
        let once = add(ROBOT, &mount(&pose, "base"), false).unwrap();
        let refused = add(&once, &mount(&pose, "base"), false).unwrap_err();
        assert!(matches!(refused, DescriptionError::Skin { line: 21, .. }), "{refused}");
        assert_eq!(add(&once, &mount(&pose, "base"), true).unwrap(), once);
        let mut held = once.clone();
        let camera =
            "<link name='c'/><joint name='j' type='fixed'><parent link='palm'/><child link='c'/></joint>";
        held.insert_str(held.find("</robot>").unwrap(), camera);
        add(&held, &mount(&pose, "base"), true).unwrap();
        let elsewhere = held.replace("=\"palm\"/>", "=\"base\"/>").replace("link='palm'", "link='base'");
        let refused = add(&elsewhere, &mount(&pose, "base"), true).unwrap_err();
        assert!(matches!(refused, DescriptionError::Inhabited { .. }), "{refused}");
    }

    #[test]
    fn one_skin_file_is_on_a_robot_twice_by_names_of_their_own() {
        let pose = pose();
        let one = |name| Mount { frame: name, mesh: name, ..mount(&pose, "base") };
        let left = add(ROBOT, &one("left"), false).unwrap();
        let both = add(&left, &one("right"), false).unwrap();
        assert!(both.contains("<tactile channel=\"right\" skin=\"palm\">"), "{both}");
        let on_base = |mesh: &str| Some(Placed { on: Some("base".to_owned()), mesh: Some(mesh.to_owned()) });
        assert_eq!(placed(&both, "right"), Ok(on_base("right")));
        assert_eq!((placed(&both, "palm"), placed(ROBOT, "left")), (Ok(None), Ok(None)));
        assert!(matches!(add(&both, &one("left"), false), Err(DescriptionError::Skin { .. })));
        assert_eq!(add(&both, &one("right"), true).unwrap(), both);
        // What is replaced goes to the end.
        let anew = add(&both, &Mount { mesh: "new", ..one("left") }, true).unwrap();
        assert_eq!(placed(&anew, "left"), Ok(on_base("new")));
        assert_eq!(anew.matches("\"right\"").count(), both.matches("\"right\"").count());
        let places = check::Places { folder: std::path::Path::new("."), packages: &[] };
        let robot = left.replace("<mesh filename=\"left\"/>", "<sphere radius='1'/>");
        let skins = tree::Robot::read(&hung(&robot), &places).unwrap().skins;
        assert_eq!([(&*skins[0].name, &*skins[0].frame)], [("palm", "left")]);
    }

    /// The robot's two links as one tree.
    fn hung(robot: &str) -> String {
        let joint =
            "<joint name='j' type='fixed'><parent link='base'/><child link='a&lt;b'/></joint></robot>";
        robot.replace("</robot>", joint)
    }

    #[test]
    fn what_takes_no_skin_says_why() {
        let pose = pose();
        let robot = |inner: &str| format!("<robot name='r'><link name='base'/>{inner}</robot>");
        for (text, expected) in [
            ("no".to_owned(), "it is no XML"),
            (robot("<link name='x'"), "it is no XML"),
            ("<mujoco/>".to_owned(), "its outermost element is <mujoco>; allowed: <robot>"),
            (robot("<link name='palm'/>"), "a link \"palm\" already"),
            (robot("\n<joint name='palm_mount'/>"), "line 2: there is a joint \"palm_mount\" already"),
            (robot("<sensor name='palm'><camera/></sensor>"), "a sensor \"palm\" already"),
            (robot("\n<link name='${side}'/>"), "line 2: name=\"${side}\" is xacro"),
            (
                "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'>\n<xacro:include filename='arm'/></robot>".to_owned(),
                "line 2: <xacro:include> is xacro",
            ),
            (robot("").replace("base", "torso"), "no link \"base\"; allowed for `link`: \"torso\""),
            ("<robot name='r'/>".to_owned(), "no link \"base\"; allowed for `link`: none"),
            ("<!DOCTYPE a [<!ENTITY b 'c'>]><robot/>".to_owned(), "it is no XML: XML with DTD"),
        ] {
            let error = add(&text, &mount(&pose, "base"), false).unwrap_err().to_string();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}
