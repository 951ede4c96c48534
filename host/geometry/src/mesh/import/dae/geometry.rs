//! The triangles of a `<geometry>`.

use super::{child, children, named, number, whole, wrong};
use crate::mesh::import::{Imported, MAX_TRIANGLES, Place, Problem, cursor::MAX_COORDINATE};
use nalgebra::{Matrix4, Point3};
use roxmltree::Node;
use std::collections::HashMap;

type Ids<'a, 'i> = HashMap<&'a str, Node<'a, 'i>>;

/// Adds a geometry, placed so, to the mesh.
pub(super) fn add<'a, 'i>(
    geometry: Node<'a, 'i>,
    ids: &Ids<'a, 'i>,
    placed: &Matrix4<f64>,
    mesh: &mut Imported,
) -> Result<(), Problem> {
    if let Some(other) = child(geometry, "convex_mesh").or_else(|| child(geometry, "brep")) {
        return Err(wrong(geometry, "a geometry", other.tag_name().name(), "<mesh>"));
    }
    // A spline is a line.
    let Some(body) = child(geometry, "mesh") else { return Ok(()) };
    let mirrored = placed.fixed_view::<3, 3>(0, 0).determinant() < 0.0;
    let mut of_vertices = HashMap::new();
    for part in body.children().filter(Node::is_element) {
        let name = part.tag_name().name();
        if !matches!(name, "triangles" | "polylist" | "polygons" | "trifans" | "tristrips") {
            continue;
        }
        let Some(corners) = Corners::of(part, ids)? else { continue };
        let (start, nodes) = match of_vertices.get(&corners.vertices.id()) {
            Some(added) => *added,
            None => {
                let start = mesh.nodes.len();
                add_positions(corners.vertices, ids, placed, mesh)?;
                let added = (start, mesh.nodes.len() - start);
                of_vertices.insert(corners.vertices.id(), added);
                added
            }
        };
        for polygon in corners.polygons(part, nodes)? {
            let mut polygon: Vec<usize> = polygon.iter().map(|node| start + node).collect();
            if mirrored {
                polygon.reverse();
            }
            mesh.add_polygon(&polygon)?;
        }
    }
    Ok(())
}

/// Adds the positions of a `<vertices>`.
fn add_positions<'a, 'i>(
    vertices: Node<'a, 'i>,
    ids: &Ids<'a, 'i>,
    placed: &Matrix4<f64>,
    mesh: &mut Imported,
) -> Result<(), Problem> {
    let input = children(vertices, "input").find(|input| input.attribute("semantic") == Some("POSITION"));
    let input = input.ok_or_else(|| wrong(vertices, "<vertices>", "no positions", "an input POSITION"))?;
    let source = named(ids, input, "source", "source")?;
    let accessor = child(source, "technique_common").and_then(|common| child(common, "accessor"));
    let accessor =
        accessor.ok_or_else(|| wrong(source, "<source>", "no accessor", "an accessor of X, Y, Z"))?;
    let array = named(ids, accessor, "source", "float_array")?;
    let text = array.text().unwrap_or_default();
    let values: Vec<f64> = text
        .split_ascii_whitespace()
        .map(|word| number(array, "a number of <float_array>", word))
        .collect::<Result<_, _>>()?;
    let (count, stride) = (whole(accessor, "count", None)?, whole(accessor, "stride", Some(1))?);
    let offset = whole(accessor, "offset", Some(0))?;
    let fits = stride.checked_mul(count).and_then(|length| length.checked_add(offset));
    if stride < 3 || fits.is_none_or(|length| length > values.len()) {
        let found = format!("{count} vertices of {stride} numbers from {offset} on");
        let allowed = format!("3 or more numbers each of the {} in <float_array>", values.len());
        return Err(wrong(accessor, "<accessor>", &found, &allowed));
    }
    for vertex in values[offset..offset + count * stride].chunks_exact(stride) {
        let point = placed.transform_point(&Point3::new(vertex[0], vertex[1], vertex[2]));
        if !point.iter().all(|at| at.abs() <= MAX_COORDINATE) {
            let allowed = format!("coordinates of at most {MAX_COORDINATE:e} where its node lies");
            return Err(wrong(array, "a vertex", &format!("{:?}", point.coords.as_slice()), &allowed));
        }
        mesh.nodes.push(point);
    }
    Ok(())
}

/// How a primitive's numbers name its corners.
struct Corners<'a, 'i> {
    vertices: Node<'a, 'i>,
    /// Place of the vertex among a corner's numbers.
    offset: usize,
    /// Numbers of a corner.
    stride: usize,
}

impl<'a, 'i> Corners<'a, 'i> {
    /// None if the primitive has none.
    fn of(part: Node<'a, 'i>, ids: &Ids<'a, 'i>) -> Result<Option<Self>, Problem> {
        if part.attribute("count").is_some_and(|count| count.trim() == "0") {
            return Ok(None);
        }
        let mut stride = 0;
        let mut vertex = None;
        for input in children(part, "input") {
            let offset = whole(input, "offset", Some(0))?;
            if offset > 255 {
                return Err(wrong(input, "`offset` of an input", &offset.to_string(), "0 to 255"));
            }
            stride = stride.max(offset + 1);
            if input.attribute("semantic") == Some("VERTEX") {
                vertex = Some((named(ids, input, "source", "vertices")?, offset));
            }
        }
        let (vertices, offset) =
            vertex.ok_or_else(|| wrong(part, "a primitive", "no vertices", "an input VERTEX"))?;
        Ok(Some(Self { vertices, offset, stride }))
    }

    /// Nodes of each polygon, numbers below `nodes`.
    fn polygons(&self, part: Node, nodes: usize) -> Result<Vec<Vec<usize>>, Problem> {
        let lists = children(part, "p").map(|list| self.nodes(list, nodes)).collect::<Result<Vec<_>, _>>()?;
        match part.tag_name().name() {
            "triangles" => {
                lists.iter().map(|list| in_threes(part, list)).collect::<Result<Vec<_>, _>>().map(flat)
            }
            "polylist" => polylist(part, lists.first().map_or(&[][..], Vec::as_slice)),
            "tristrips" => Ok(lists.iter().flat_map(|list| strip(list)).collect()),
            _ => {
                if let Some(hole) = child(part, "ph") {
                    return Err(wrong(hole, "a polygon", "one with holes", "polygons without"));
                }
                let short = lists.iter().find(|list| list.len() < 3);
                short.map_or(Ok(()), |list| Err(few(part, list.len())))?;
                Ok(lists)
            }
        }
    }

    fn nodes(&self, list: Node, nodes: usize) -> Result<Vec<usize>, Problem> {
        let words: Vec<&str> = list.text().unwrap_or_default().split_ascii_whitespace().collect();
        if !words.len().is_multiple_of(self.stride) || words.len() / self.stride > 4 * MAX_TRIANGLES {
            let allowed = format!("{} for each corner", self.stride);
            return Err(wrong(list, "the numbers of <p>", &format!("{} of them", words.len()), &allowed));
        }
        let node = |corner: &[&str]| {
            let word = corner[self.offset];
            let read = word.parse().ok().filter(|node| *node < nodes);
            read.ok_or_else(|| {
                wrong(list, "a vertex of <p>", word, &format!("0 to {}", nodes.saturating_sub(1)))
            })
        };
        words.chunks_exact(self.stride).map(node).collect()
    }
}

fn flat(lists: Vec<Vec<Vec<usize>>>) -> Vec<Vec<usize>> {
    lists.into_iter().flatten().collect()
}

fn in_threes(part: Node, list: &[usize]) -> Result<Vec<Vec<usize>>, Problem> {
    if !list.len().is_multiple_of(3) {
        return Err(wrong(part, "the corners of <triangles>", &list.len().to_string(), "three for each"));
    }
    Ok(list.chunks_exact(3).map(<[usize]>::to_vec).collect())
}

/// Every other triangle of a strip runs backwards.
fn strip(list: &[usize]) -> Vec<Vec<usize>> {
    let turned = |(at, three): (usize, &[usize])| match at % 2 {
        0 => three.to_vec(),
        _ => vec![three[1], three[0], three[2]],
    };
    list.windows(3).enumerate().map(turned).collect()
}

fn polylist(part: Node, mut list: &[usize]) -> Result<Vec<Vec<usize>>, Problem> {
    let Some(counts) = child(part, "vcount") else {
        return Err(wrong(part, "<polylist>", "no counts", "a <vcount>"));
    };
    let mut polygons = Vec::new();
    for word in counts.text().unwrap_or_default().split_ascii_whitespace() {
        let count = word.parse::<usize>().map_err(|_| wrong(counts, "<vcount>", word, "whole numbers"))?;
        if count < 3 {
            return Err(few(counts, count));
        }
        let (polygon, rest) = list.split_at_checked(count).ok_or_else(|| {
            let row = part.document().text_pos_at(part.range().start).row;
            let place = Place::Line(row as usize);
            Problem::Count {
                place,
                field: "the number of a polygon's corners",
                found: count,
                most: list.len(),
            }
        })?;
        polygons.push(polygon.to_vec());
        list = rest;
    }
    if list.is_empty() {
        return Ok(polygons);
    }
    Err(wrong(part, "the corners of <p>", &format!("{} too many", list.len()), "as many as <vcount> says"))
}

fn few(part: Node, corners: usize) -> Problem {
    wrong(part, "the number of a polygon's corners", &corners.to_string(), "3 or more")
}
