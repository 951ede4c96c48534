//! MJCF, the format of MuJoCo.
//!
//! A skin is a `<body>` without a joint, so that it is one with the body that it lies on and never collides with it. It
//! has a `<geom>` of its mesh and of no mass, and a `<site>`, a box round it, whose `<touch>` sensor gives the sum of the
//! forces on it, N. MuJoCo collides a mesh's convex hull ([`crate::slab::Surface::bulge`]). *Where* it is touched, contacts of the
//! geom say, as docs/mujoco_skin.py reads them, or taxels: a `<touch>` each, in balls that cover the skin together.
//! Neither MuJoCo's plugin `touch_grid`, whose taxels are of equal angles as seen from one point, nor its `tactile`
//! sensor, which older releases do not know, does as much on any skin.

use crate::{
    DescriptionError, Mount, Placed,
    edit::{Edits, children, escaped, is, line, parse, readable},
    error::names,
    place::{number, numbers, pos_quat},
    slab::Spread,
};
use dermatome_geometry::mesh::Mesh;
use nalgebra::{Point3, Vector3};
use roxmltree::Node;
use std::collections::BTreeSet;

/// The world's own body.
const WORLD: &str = "world";
/// How far the box of the sensor reaches beyond the skin, m, for contacts lie a little inside or outside a mesh.
const MARGIN: f64 = 2e-3;

/// The space in which contacts are the skin's: a box in its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zone {
    middle: Point3<f64>,
    half_size: Vector3<f64>,
}

impl Zone {
    /// Round a body.
    #[must_use]
    pub fn round(slab: &Mesh) -> Self {
        let start = slab.nodes.first().copied().unwrap_or_default();
        let (low, high) =
            slab.nodes.iter().fold((start, start), |(low, high), node| (low.inf(node), high.sup(node)));
        let half_size = (high - low) / 2.0 + Vector3::repeat(MARGIN);
        Self { middle: nalgebra::center(&low, &high), half_size }
    }
}

/// The folder of a model's mesh files, relative to its own, if the model says so.
pub fn mesh_folder(text: &str) -> Result<Option<String>, DescriptionError> {
    let readable = readable(text);
    let document = parse(&readable)?;
    let model = root_of(&document)?;
    let said = |name: &str| {
        let compilers = model.descendants().filter(|node| is(*node, "compiler"));
        compilers.filter_map(|compiler| compiler.attribute(name)).next_back().map(str::to_owned)
    };
    Ok(said("meshdir").or_else(|| said("assetdir")))
}

/// How the skin of this name lies on a model, if it is there.
pub fn placed(text: &str, name: &str) -> Result<Option<Placed>, DescriptionError> {
    let readable = readable(text);
    let document = parse(&readable)?;
    let model = root_of(&document)?;
    let Some(sensor) = sensor_of(model, name) else { return Ok(None) };
    let parts = of_skin(model, sensor)?;
    let part = |kind: &str| parts.iter().copied().find(|node| is(*node, kind));
    let on = part("body").and_then(|body| body.parent()).and_then(|holder| match is(holder, "worldbody") {
        true => Some(WORLD),
        false => holder.attribute("name"),
    });
    let mesh = part("mesh").and_then(|mesh| mesh.attribute("file"));
    Ok(Some(Placed { on: on.map(str::to_owned), mesh: mesh.map(str::to_owned) }))
}

/// The text of a model with a skin on one of its bodies. One whose name on the robot is the same is refused, or replaced.
pub fn add(
    text: &str,
    mount: &Mount<'_>,
    zone: Zone,
    taxels: &Spread,
    replace: bool,
) -> Result<String, DescriptionError> {
    let readable = readable(text);
    let document = parse(&readable)?;
    let model = root_of(&document)?;
    let mut edits = Edits::new(text);
    let mut gone = Vec::new();
    if let Some(sensor) = sensor_of(model, mount.frame) {
        if !replace {
            return Err(DescriptionError::Skin { line: line(sensor), name: mount.frame.to_owned() });
        }
        gone = of_skin(model, sensor)?;
        gone.iter().for_each(|node| edits.remove(*node));
    }
    let is_left = |node: &Node<'_, '_>| !node.ancestors().any(|outer| gone.contains(&outer));
    let of_taxels: BTreeSet<_> = taxel_names(mount, taxels).collect();
    let is_taken = |node: &Node<'_, '_>| {
        let is_of_taxel = |name| ["site", "sensor"].contains(&kind(*node)) && of_taxels.contains(name);
        let is_needed = |name| name == mount.frame || is_of_taxel(name);
        clashes(*node) && node.attribute("name").is_some_and(is_needed)
    };
    if let Some(other) = model.descendants().filter(is_left).find(is_taken) {
        let name = other.attribute("name").unwrap_or_default().to_owned();
        return Err(DescriptionError::Taken { line: line(other), kind: kind(other), name });
    }
    let bodies = || model.descendants().filter(|node| is(*node, "body")).filter(is_left);
    let body = match bodies().find(|body| body.attribute("name") == Some(mount.on)) {
        None if mount.on == WORLD => model.children().find(|node| is(*node, "worldbody")),
        found => found,
    };
    let Some(body) = body else {
        let there = bodies().filter_map(|body| body.attribute("name")).chain([WORLD]);
        return Err(absent(model, mount.on, &names(there)));
    };
    edits.append(body, &body_lines(mount, zone, taxels));
    edits.append(model, &rest_lines(mount, taxels));
    Ok(edits.made())
}

fn root_of<'a, 'input>(
    document: &'a roxmltree::Document<'input>,
) -> Result<Node<'a, 'input>, DescriptionError> {
    let root = document.root_element();
    if is(root, "mujoco") || is(root, "mujocoinclude") {
        return Ok(root);
    }
    let found = root.tag_name().name().to_owned();
    Err(DescriptionError::Root { found, allowed: "<mujoco>, as in an MJCF model, or <mujocoinclude>" })
}

fn absent(model: Node<'_, '_>, name: &str, there: &str) -> DescriptionError {
    let includes =
        model.descendants().filter(|node| is(*node, "include")).filter_map(|it| it.attribute("file"));
    let includes: Vec<_> = includes.collect();
    let elsewhere = match includes.len() {
        0 => String::new(),
        _ => format!(" (others are in {}, which it includes)", names(includes.into_iter())),
    };
    DescriptionError::Absent { kind: "body", name: name.to_owned(), allowed: format!("{there}{elsewhere}") }
}

/// The touch sensor of a skin, and not that of a taxel.
fn sensor_of<'a, 'input>(model: Node<'a, 'input>, name: &str) -> Option<Node<'a, 'input>> {
    let is_named = |node: Node<'_, '_>, kind: &str| is(node, kind) && node.attribute("name") == Some(name);
    let site = model.descendants().find(|node| is_named(*node, "site"))?;
    site.parent().filter(|body| is_named(*body, "body"))?;
    model.descendants().find(|node| is_named(*node, "touch") && node.attribute("site") == Some(name))
}

/// All of a skin: its body, its sensors and its mesh, and sections that hold nothing else.
fn of_skin<'a, 'input>(
    model: Node<'a, 'input>,
    sensor: Node<'a, 'input>,
) -> Result<Vec<Node<'a, 'input>>, DescriptionError> {
    let site = sensor.attribute("site");
    let site = model.descendants().find(|node| is(*node, "site") && node.attribute("name") == site);
    let Some(body) = site.and_then(|site| site.parent()) else { return Ok(vec![sensor]) };
    if let Some(other) = children(body, "body").next() {
        let name = other.attribute("name").unwrap_or_default().to_owned();
        return Err(DescriptionError::Inhabited { line: line(other), kind: "body", name });
    }
    let sites: Vec<_> = children(body, "site").filter_map(|site| site.attribute("name")).collect();
    let meshes: Vec<_> = children(body, "geom").filter_map(|geom| geom.attribute("mesh")).collect();
    let is_one = |names: &[&str], name: Option<&str>| name.is_some_and(|name| names.contains(&name));
    let is_its = |node: &Node<'_, '_>| match node.tag_name().name() {
        "touch" => is_one(&sites, node.attribute("site")),
        "mesh" => is_one(&meshes, node.attribute("name")),
        _ => false,
    };
    let parts: Vec<_> = model.descendants().filter(is_its).collect();
    let sections = parts.iter().filter_map(Node::parent);
    let is_whole =
        |section: &Node<'_, '_>| section.children().filter(Node::is_element).all(|node| is_its(&node));
    Ok(sections.filter(is_whole).chain(parts.iter().copied()).chain([body]).collect())
}

/// Names that a skin needs: MuJoCo has a space of names for each kind of element.
fn clashes(node: Node<'_, '_>) -> bool {
    let in_section = |name: &str| node.parent().is_some_and(|parent| is(parent, name));
    ["body", "geom", "site"].iter().any(|kind| is(node, kind))
        || in_section("sensor")
        || in_section("asset") && is(node, "mesh")
}

fn kind(node: Node<'_, '_>) -> &'static str {
    let kinds = ["body", "geom", "site", "mesh"];
    kinds.into_iter().find(|kind| is(node, kind)).unwrap_or("sensor")
}

/// Names of the taxels' sites and sensors.
fn taxel_names(mount: &Mount<'_>, taxels: &Spread) -> impl Iterator<Item = String> {
    (0..taxels.points.len()).map(|at| format!("{}_{at}", mount.frame))
}

fn body_lines(mount: &Mount<'_>, zone: Zone, taxels: &Spread) -> Vec<String> {
    let frame = escaped(mount.frame);
    let [pos, quat] = pos_quat(&mount.link_from_skin());
    let [middle, size] = [zone.middle.coords, zone.half_size].map(|it| numbers(it.iter().copied()));
    let mut lines = vec![
        format!(r#"<body name="{frame}" pos="{pos}" quat="{quat}">"#),
        format!(
            r#"  <geom name="{frame}" type="mesh" mesh="{frame}" mass="0" contype="1" conaffinity="1" rgba="0.2 0.2 0.25 1"/>"#
        ),
        format!(r#"  <site name="{frame}" type="box" pos="{middle}" size="{size}" group="4"/>"#),
    ];
    let radius = number(taxels.radius + MARGIN);
    lines.extend(taxels.points.iter().zip(taxel_names(mount, taxels)).map(|(point, name)| {
        let (name, pos) = (escaped(&name), numbers(point.coords.iter().copied()));
        format!(r#"  <site name="{name}" type="sphere" pos="{pos}" size="{radius}" group="4"/>"#)
    }));
    lines.push("</body>".to_owned());
    lines
}

fn rest_lines(mount: &Mount<'_>, taxels: &Spread) -> Vec<String> {
    let [frame, mesh] = [mount.frame, mount.mesh].map(escaped);
    let mut lines = vec![
        "<asset>".to_owned(),
        // The model's defaults may scale its own meshes.
        format!(r#"  <mesh name="{frame}" file="{mesh}" scale="1 1 1"/>"#),
        "</asset>".to_owned(),
        "<sensor>".to_owned(),
        format!(r#"  <touch name="{frame}" site="{frame}"/>"#),
    ];
    lines.extend(taxel_names(mount, taxels).map(|name| {
        let name = escaped(&name);
        format!(r#"  <touch name="{name}" site="{name}"/>"#)
    }));
    lines.push("</sensor>".to_owned());
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_patch::pose::Pose;

    const MODEL: &str = "<mujoco model=\"arm\">\n  <!-- mine -->\n  <compiler meshdir=\"assets\"/>\n  <worldbody>\n    \
                         <body name=\"base\">\n      <geom size=\"0.1\"/>\n      <body name=\"hand\"/>\n    </body>\n  \
                         </worldbody>\n  <sensor>\n    <clock/>\n  </sensor>\n</mujoco>\n";

    fn made(text: &str, on: &str, taxels: usize, replace: bool) -> Result<String, DescriptionError> {
        let pose =
            Pose { link: "base".into(), position: [0.1, 0.0, -0.25], orientation: [0.5, 0.5, 0.5, 0.5] };
        let mount =
            Mount { skin: "palm", frame: "palm", on, pose: &pose, mesh: "palm.stl", frame_rate: 50.0 };
        let zone = Zone { middle: Point3::origin(), half_size: Vector3::new(0.1, 0.1, 0.003) };
        let taxels = Spread { points: vec![Point3::new(0.01, 0.0, 0.0); taxels], radius: 0.02 };
        add(text, &mount, zone, &taxels, replace)
    }

    #[test]
    fn a_body_and_two_sections_are_added_and_all_else_stays() {
        for on in ["base", "hand", WORLD] {
            let text = made(MODEL, on, 0, false).unwrap();
            let document = parse(&text).unwrap();
            let skin =
                document.descendants().find(|it| is(*it, "body") && it.attribute("name") == Some("palm"));
            let holder = skin.unwrap().parent().unwrap();
            assert_eq!(holder.attribute("name").unwrap_or(WORLD), on, "{text}");
            let added = |line: &&str| {
                !["palm", "<asset>", "</asset>", "<sensor>", "</sensor>"].iter().any(|it| line.contains(it))
            };
            let left: Vec<_> =
                text.lines().filter(added).filter(|line| *line != "      </body>" || on == "hand").collect();
            assert!(left.len() >= MODEL.lines().count() - 3, "{text}");
            assert!(text.contains("pos=\"0.1 0 -0.25\" quat=\"0.5 0.5 0.5 0.5\""), "{text}");
        }
        assert_eq!(mesh_folder(MODEL), Ok(Some("assets".to_owned())));
    }

    #[test]
    fn the_same_skin_again_is_refused_or_replaced() {
        let once = made(MODEL, "base", 3, false).unwrap();
        assert!(
            matches!(made(&once, "base", 0, false), Err(DescriptionError::Skin { line: 24, .. })),
            "{once}"
        );
        assert_eq!(made(&once, "base", 3, true).unwrap(), once);
        assert_eq!(made(&once, "base", 0, true), made(MODEL, "base", 0, false));
        let moved = made(&once, WORLD, 0, true).unwrap();
        assert_eq!(moved, made(MODEL, WORLD, 0, false).unwrap());
        let shared = once.replace("<touch name=\"palm\"", "<gyro site=\"palm\"/><touch name=\"palm\"");
        let replaced = made(&shared, "base", 0, true).unwrap();
        assert!(replaced.contains("<gyro") && replaced.matches("<touch").count() == 1, "{replaced}");
        let held = once
            .replace("group=\"4\"/>\n      </body>", "group=\"4\"/>\n<body name=\"tip\"/>\n      </body>");
        assert!(
            held != once && matches!(made(&held, "base", 0, true), Err(DescriptionError::Inhabited { .. }))
        );
    }

    #[test]
    fn one_skin_file_is_on_a_model_twice_by_names_of_their_own() {
        let named = |text: &str, frame: &str, taxels: usize, replace: bool| {
            let pose = Pose { link: "base".into(), position: [0.0; 3], orientation: [0.0, 0.0, 0.0, 1.0] };
            let mount = Mount { skin: "palm", frame, on: "base", pose: &pose, mesh: frame, frame_rate: 50.0 };
            let zone = Zone { middle: Point3::origin(), half_size: Vector3::new(0.1, 0.1, 0.003) };
            let taxels = Spread { points: vec![Point3::origin(); taxels], radius: 0.02 };
            add(text, &mount, zone, &taxels, replace)
        };
        let left = named(MODEL, "left", 3, false).unwrap();
        let both = named(&left, "right", 3, false).unwrap();
        assert!(!both.contains("palm"), "{both}");
        let right = Placed { on: Some("base".to_owned()), mesh: Some("right".to_owned()) };
        assert_eq!(placed(&both, "right"), Ok(Some(right)));
        assert_eq!((placed(&both, "palm"), placed(&both, "left_0")), (Ok(None), Ok(None)));
        assert!(matches!(named(&both, "left", 3, false), Err(DescriptionError::Skin { .. })));
        let anew = named(&both, "left", 0, true).unwrap();
        assert_eq!(anew.matches("\"right").count(), both.matches("\"right").count());
        assert!(!anew.contains("left_0"), "{anew}");
        // A taxel is no skin, and takes no name of one.
        assert!(matches!(named(&both, "left_0", 0, true), Err(DescriptionError::Taken { kind: "site", .. })));
        let first = named(MODEL, "left_0", 0, false).unwrap();
        assert!(matches!(named(&first, "left", 1, false), Err(DescriptionError::Taken { kind: "site", .. })));
    }

    #[test]
    fn what_takes_no_skin_says_why() {
        let with = |inner: &str| MODEL.replace("<geom size", &format!("{inner}\n      <geom size"));
        for (text, on, expected) in [
            ("no".to_owned(), "base", "it is no XML"),
            ("<robot/>".to_owned(), "base", "<robot>; allowed: <mujoco>"),
            (MODEL.to_owned(), "arm", "no body \"arm\"; allowed for `body`: \"base\", \"hand\", \"world\""),
            (
                with("<include file=\"arm.xml\"/>"),
                "arm",
                "\"world\" (others are in \"arm.xml\", which it includes)",
            ),
            (with("<site name=\"palm\"/>"), "base", "line 6: there is a site \"palm\" already"),
            (with("<geom name=\"palm\"/>"), "base", "a geom \"palm\" already"),
            (MODEL.replace("hand", "palm"), "base", "a body \"palm\" already"),
            (MODEL.replace("<clock", "<clock name=\"palm\""), "base", "a sensor \"palm\" already"),
            (
                MODEL.replace("<sensor>", "<asset><mesh name=\"palm\"/></asset><sensor>"),
                "base",
                "a mesh \"palm\" already",
            ),
        ] {
            let error = made(&text, on, 0, false).unwrap_err().to_string();
            assert!(error.contains(expected), "{expected}: {error}");
        }
    }
}
