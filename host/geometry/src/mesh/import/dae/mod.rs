//! COLLADA 1.4 and 1.5 (.dae), as robots' visual meshes often are.
//!
//! The geometries that the file's visual scene shows are one mesh, each as often as it is shown, in the order of the
//! scene, through the transforms of the nodes above it. The axes are turned so that z is up, by `<up_axis>`;
//! coordinates stay in the file's unit, which `<unit>` tells. Materials, normals, cameras and lights are passed over,
//! and so are lines. What would make another mesh if it were passed over is refused: skeletons, `<lookat>`, `<skew>`,
//! splines' and hulls' surfaces, polygons with holes, files outside.

mod geometry;
mod transform;

use super::{Imported, MAX_TRIANGLES, Place, Problem};
use nalgebra::Matrix4;
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::HashMap;

/// Most elements of a file, and nodes of its scene as they are shown.
const MAX_ELEMENTS: u32 = 1 << 21;
/// Most nodes inside one another.
const MAX_DEPTH: usize = 64;

/// Reads a COLLADA file.
pub(super) fn parse(bytes: &[u8]) -> Result<Imported, Problem> {
    let text = std::str::from_utf8(bytes).map_err(|error| Problem::Text {
        place: Place::Byte(error.valid_up_to()),
        fault: "no UTF-8".into(),
    })?;
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MAX_ELEMENTS, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let place = Place::Line(error.pos().row as usize);
        Problem::Text { place, fault: format!("no XML that can be read: {error}") }
    })?;
    let root = document.root_element();
    if root.tag_name().name() != "COLLADA" {
        return Err(wrong(root, "the outermost element", root.tag_name().name(), "COLLADA"));
    }
    let mut scene = Scene { ids: ids(root), mesh: Imported::default(), shown: 0 };
    let asset = child(root, "asset");
    scene.mesh.unit = Some(asset.map_or(Ok(1.0), unit)?);
    let up = asset.map_or(Ok(Matrix4::identity()), transform::z_up)?;
    scene.show_all(root, &up)?;
    Ok(scene.mesh)
}

/// Metres in the file's unit.
fn unit(asset: Node) -> Result<f64, Problem> {
    let Some((unit, written)) = child(asset, "unit").and_then(|unit| Some((unit, unit.attribute("meter")?)))
    else {
        return Ok(1.0);
    };
    let metres = written.trim().parse().ok().filter(|metres| (1e-9..=1e9).contains(metres));
    metres.ok_or_else(|| wrong(unit, "`meter` of <unit>", written, "1e-9 to 1e9"))
}

/// All elements that can be named.
fn ids<'a, 'i>(root: Node<'a, 'i>) -> HashMap<&'a str, Node<'a, 'i>> {
    root.descendants().filter_map(|node| Some((node.attribute("id")?, node))).collect()
}

struct Scene<'a, 'i> {
    ids: HashMap<&'a str, Node<'a, 'i>>,
    mesh: Imported,
    /// Nodes shown so far.
    shown: u32,
}

impl<'a, 'i> Scene<'a, 'i> {
    fn show_all(&mut self, root: Node<'a, 'i>, up: &Matrix4<f64>) -> Result<(), Problem> {
        let instance = child(root, "scene").and_then(|scene| child(scene, "instance_visual_scene"));
        let scene = match instance {
            Some(instance) => self.named(instance, "url", "visual_scene")?,
            None => {
                let library = child(root, "library_visual_scenes");
                let first = library.and_then(|library| child(library, "visual_scene"));
                first.ok_or_else(|| Problem::Missing { what: "<visual_scene>".into() })?
            }
        };
        children(scene, "node").try_for_each(|node| self.show(node, up, 0))
    }

    /// Adds what a node shows, and the nodes in it.
    fn show(&mut self, node: Node<'a, 'i>, above: &Matrix4<f64>, depth: usize) -> Result<(), Problem> {
        self.shown += 1;
        if depth > MAX_DEPTH || self.shown > MAX_ELEMENTS {
            let allowed = format!("at most {MAX_DEPTH}, and {MAX_ELEMENTS} nodes in all");
            return Err(wrong(node, "the depth of nodes in nodes", &depth.to_string(), &allowed));
        }
        let placed = above * transform::of(node)?;
        for part in node.children().filter(Node::is_element) {
            match part.tag_name().name() {
                "node" => self.show(part, &placed, depth + 1)?,
                "instance_node" => self.show(self.named(part, "url", "node")?, &placed, depth + 1)?,
                "instance_geometry" => {
                    let shape = self.named(part, "url", "geometry")?;
                    geometry::add(shape, &self.ids, &placed, &mut self.mesh)?;
                }
                "instance_controller" => {
                    return Err(wrong(
                        part,
                        "a node's content",
                        "<instance_controller>",
                        "a mesh without skeleton",
                    ));
                }
                _ => {}
            }
        }
        if self.mesh.triangles.len() > MAX_TRIANGLES { Err(Problem::TooLarge) } else { Ok(()) }
    }

    fn named(
        &self,
        from: Node<'a, 'i>,
        attribute: &'static str,
        what: &str,
    ) -> Result<Node<'a, 'i>, Problem> {
        named(&self.ids, from, attribute, what)
    }
}

/// The element of this kind that an attribute names as `#id`.
fn named<'a, 'i>(
    ids: &HashMap<&'a str, Node<'a, 'i>>,
    from: Node<'a, 'i>,
    attribute: &'static str,
    what: &str,
) -> Result<Node<'a, 'i>, Problem> {
    let written = from.attribute(attribute).unwrap_or_default();
    let found = written.strip_prefix('#').and_then(|id| ids.get(id)).copied();
    found
        .filter(|node| node.tag_name().name() == what)
        .ok_or_else(|| wrong(from, attribute, written, &format!("# and the id of a <{what}> in this file")))
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| child.tag_name().name() == name)
}

fn children<'a, 'i: 'a>(node: Node<'a, 'i>, name: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |child| child.tag_name().name() == name)
}

/// Numbers with spaces between, exactly `count` of them.
fn numbers(node: Node, field: &'static str, count: usize) -> Result<Vec<f64>, Problem> {
    let text = node.text().unwrap_or_default();
    let read: Vec<f64> =
        text.split_ascii_whitespace().map(|word| number(node, field, word)).collect::<Result<_, _>>()?;
    if read.len() == count {
        return Ok(read);
    }
    Err(wrong(node, field, &format!("{} numbers", read.len()), &count.to_string()))
}

fn number(node: Node, field: &'static str, word: &str) -> Result<f64, Problem> {
    let read = word.parse().ok().filter(|number: &f64| number.is_finite());
    read.ok_or_else(|| wrong(node, field, word, "a finite number"))
}

/// A whole number in an attribute.
fn whole(node: Node, attribute: &'static str, default: Option<usize>) -> Result<usize, Problem> {
    let written = node.attribute(attribute);
    let read = written.map_or(default, |text| text.trim().parse().ok());
    read.ok_or_else(|| wrong(node, attribute, written.unwrap_or("missing"), "a whole number"))
}

fn wrong(node: Node, field: &'static str, found: &str, allowed: &str) -> Problem {
    let row = node.document().text_pos_at(node.range().start).row;
    let shown = |text: &str| text.chars().take(40).collect();
    Problem::Value {
        place: Place::Line(row as usize),
        field,
        found: shown(found),
        allowed: allowed.to_owned(),
    }
}
