//! What is where in a robot's file.

use crate::{
    DescriptionError,
    edit::{children, is, line},
};
use roxmltree::{Document, Node};

/// The robot; a file of another kind, or one that makes a robot, is refused.
pub(super) fn root_of<'a, 'input>(
    document: &'a Document<'input>,
) -> Result<Node<'a, 'input>, DescriptionError> {
    let root = document.root_element();
    if !is(root, "robot") {
        let found = root.tag_name().name().to_owned();
        return Err(DescriptionError::Root { found, allowed: "<robot>, as in a URDF" });
    }
    match root.descendants().find_map(xacro) {
        Some((line, what)) => Err(DescriptionError::Xacro { line, what }),
        None => Ok(root),
    }
}

/// What makes something; calls of what is nowhere made are left over in some robots, and do nothing.
const XACRO: [&str; 6] = ["include", "macro", "property", "arg", "if", "unless"];

/// What shows that an element is xacro: its name, or a value that is yet to be computed.
fn xacro(node: Node<'_, '_>) -> Option<(u32, String)> {
    let name = node.tag_name();
    let is_xacro = || name.namespace().is_some_and(|space| space.contains("xacro"));
    if node.is_element() && XACRO.contains(&name.name()) && is_xacro() {
        return Some((line(node), format!("<xacro:{}>", name.name())));
    }
    let is_computed = |value: &str| value.contains("${") || value.contains("$(");
    let attribute = node.attributes().find(|attribute| is_computed(attribute.value()))?;
    Some((line(node), format!("{}={:?}", attribute.name(), attribute.value())))
}

/// Elements of the robot of this kind and name.
pub(super) fn named<'a, 'input: 'a>(
    robot: Node<'a, 'input>,
    kind: &'a str,
    name: &'a str,
) -> impl Iterator<Item = Node<'a, 'input>> + 'a {
    children(robot, kind).filter(move |node| node.attribute("name") == Some(name))
}

/// Whether a sensor is a skin.
pub(super) fn is_skin(sensor: Node<'_, '_>) -> bool {
    children(sensor, "tactile").next().is_some()
}

/// Name of the skin file of a skin, which is that of its sensor unless that says another.
pub(super) fn design<'a>(sensor: Node<'a, '_>) -> &'a str {
    let tactile = sensor.children().find(|child| is(*child, "tactile"));
    let said = tactile.and_then(|tactile| tactile.attribute("skin"));
    said.or_else(|| sensor.attribute("name")).unwrap_or_default()
}

/// The link that a joint's `parent` or `child`, or a sensor's `parent`, names.
pub(super) fn link_in<'a>(node: Node<'a, '_>, which: &str) -> Option<&'a str> {
    node.children().find(|child| is(*child, which))?.attribute("link")
}

/// Joints that hold a link.
pub(super) fn joints_onto<'a, 'input: 'a>(
    robot: Node<'a, 'input>,
    link: &'a str,
) -> impl Iterator<Item = Node<'a, 'input>> + 'a {
    children(robot, "joint").filter(move |joint| link_in(*joint, "child") == Some(link))
}

/// Joints that a link holds.
pub(super) fn joints_under<'a, 'input: 'a>(
    robot: Node<'a, 'input>,
    link: &'a str,
) -> impl Iterator<Item = Node<'a, 'input>> + 'a {
    children(robot, "joint").filter(move |joint| link_in(*joint, "parent") == Some(link))
}

/// The number of an attribute; none where it is not there, or is none.
pub(super) fn number(node: Node<'_, '_>, name: &str) -> Option<f64> {
    node.attribute(name)?.trim().parse().ok().filter(|it: &f64| it.is_finite())
}

/// The three numbers of an attribute; the default where it is not there.
pub(super) fn triple(node: Node<'_, '_>, name: &str, default: f64) -> Result<[f64; 3], String> {
    let Some(text) = node.attribute(name) else { return Ok([default; 3]) };
    let numbers = text.split_whitespace().map(|piece| piece.parse().ok().filter(|it: &f64| it.is_finite()));
    let numbers: Option<Vec<f64>> = numbers.collect();
    numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| {
        format!("`{name}` of <{}> is {text:?}; allowed: three numbers", node.tag_name().name())
    })
}
