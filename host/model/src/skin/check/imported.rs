//! A mesh that was made elsewhere, and the electrodes on it: `shape.kind` = "mesh".

use super::Checker;
use crate::skin::{
    SkinError,
    electrodes::Electrodes,
    file::{ElectrodeTable, File, ShapeTable},
    shape::Shape,
};
use dermatome_geometry::{
    mesh::{
        ElectrodeContact, Mesh,
        import::{self, Group, Imported},
        place::{Rim, faces, nearest_node, shared_node},
        quality::quality,
        soundness::{Soundness, require_sound},
    },
    outline::Outline,
    sheet::{EdgeLengths, ElectrodeModel},
};
use nalgebra::{Point2, Point3, Vector3};

/// Units of a mesh file, with their length in metres.
pub const UNITS: [(&str, f64); 5] = [("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("um", 1e-6), ("inch", 0.0254)];
/// Points further away from the mesh than this share of its bounding box's diagonal miss it.
const FARTHEST: f64 = 0.05;
/// Coordinates that differ by less than this share of the diagonal are the same.
const FLAT: f64 = 1e-9;

/// A mesh without electrodes, and what is needed to put them on it.
struct Bare<'a> {
    imported: &'a Imported,
    /// The longest boundary loop, if the surface is not closed.
    rim: Option<Rim<'a>>,
    model: &'a ElectrodeModel,
    diagonal: f64,
}

impl Checker<'_> {
    /// Reads the mesh file and places the electrodes; where groups are electrodes, the widths in
    /// `electrodes` become theirs.
    pub(super) fn imported(
        &self,
        file: &File,
        electrodes: &mut Electrodes,
    ) -> Result<(Shape, EdgeLengths), SkinError> {
        if file.mesh.is_some() {
            let allowed = "nothing (the mesh in `shape.file` is used as it is)";
            return self.refuse("mesh.edge_length", "given".into(), allowed);
        }
        let imported = self.read_mesh(&file.shape)?;
        let soundness = self.sound(&file.shape, &imported)?;
        let order = soundness.boundary_loops.first().cloned();
        let bare = Bare {
            rim: order.map(|order| Rim::new(&imported.nodes, order)),
            model: &electrodes.model,
            diagonal: diagonal(&imported.nodes),
            imported: &imported,
        };
        let contacts = self.contacts(&file.electrodes, &bare)?;
        self.touch_apart(&contacts)?;
        let outline = flat_outline(&imported.nodes, &soundness, bare.diagonal);
        let Imported { nodes, triangles, .. } = imported;
        let mesh = Mesh { nodes, elements: triangles, electrodes: contacts };
        if let ElectrodeModel::Complete { width, .. } = &mut electrodes.model {
            *width = mesh.electrodes.iter().map(|contact| mesh.width(contact)).collect();
        }
        let found = quality(&mesh);
        let edge = (found.area / (0.433 * found.elements as f64)).sqrt();
        Ok((Shape::Mesh { mesh: Box::new(mesh), outline }, EdgeLengths { skin: edge, electrodes: edge }))
    }

    fn read_mesh(&self, table: &ShapeTable) -> Result<Imported, SkinError> {
        let Some(file) = &table.file else {
            return self.refuse("shape.file", "missing".into(), "an STL, OBJ, PLY or MSH file");
        };
        let units: Vec<_> = UNITS.iter().map(|(name, _)| format!("{name:?}")).collect();
        let Some(unit) = &table.unit else {
            return self.refuse("shape.unit", "missing".into(), &units.join(", "));
        };
        let Some((_, metres)) = UNITS.iter().find(|(name, _)| name == unit) else {
            return self.refuse("shape.unit", format!("{unit:?}"), &units.join(", "));
        };
        let mut mesh = import::read(&self.beside(file), table.weld).or_else(|error| {
            self.refuse("shape.file", format!("{:?}", file.display().to_string()), &error.to_string())
        })?;
        mesh.scale(*metres);
        Ok(mesh)
    }

    fn sound(&self, table: &ShapeTable, mesh: &Imported) -> Result<Soundness, SkinError> {
        let allow_cracks = table.allow_cracks.unwrap_or(false);
        require_sound(&mesh.nodes, &mesh.triangles, allow_cracks).or_else(|fault| {
            let file = table.file.as_deref().unwrap_or(self.path).display().to_string();
            self.refuse("shape.file", format!("{file:?}"), &format!("a sound mesh, but {fault}"))
        })
    }

    fn contacts(&self, table: &ElectrodeTable, bare: &Bare<'_>) -> Result<Vec<ElectrodeContact>, SkinError> {
        self.is_placement(table, &["groups", "rim", "points"])?;
        match table.placement.as_str() {
            "groups" => self.only_groups(table)?,
            _ => self.only_fields_of_placement(table)?,
        }
        let count = table.count as usize;
        match table.placement.as_str() {
            "groups" => (0..count).map(|electrode| self.group(bare, electrode, count)).collect(),
            "rim" => self.along_loop(table, bare, count),
            _ => self.at_coordinates(table, bare, count),
        }
    }

    fn only_groups(&self, table: &ElectrodeTable) -> Result<(), SkinError> {
        let given = [
            ("electrodes.pitch", table.pitch.is_some()),
            ("electrodes.positions", table.positions.is_some()),
            ("electrodes.first", table.first.is_some()),
            ("electrodes.direction", table.direction.is_some()),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((field, _)) => self.refuse(
                field,
                "given".into(),
                "nothing (the groups of the mesh say where electrodes lie)",
            ),
            None => Ok(()),
        }
    }

    fn group(&self, bare: &Bare<'_>, electrode: usize, count: usize) -> Result<ElectrodeContact, SkinError> {
        let number = electrode + 1;
        let named = |number: usize| {
            let name = format!("electrode_{number}");
            bare.imported.groups.iter().find(move |group| group.name == name)
        };
        if named(count + 1).is_some() {
            let value = count.to_string();
            let allowed = format!("more: the mesh has a group \"electrode_{}\"", count + 1);
            return self.refuse("electrodes.count", value, &allowed);
        }
        let Some(group) = named(number) else {
            let allowed =
                format!("physical groups \"electrode_1\" to \"electrode_{count}\" in the mesh file");
            return self.refuse(
                "electrodes.placement",
                format!("\"groups\" without electrode_{number}"),
                &allowed,
            );
        };
        if group.off_mesh > 0 {
            let value = format!(
                "\"groups\" with electrode_{number}, of whose points and lines {} are not on the mesh",
                group.off_mesh
            );
            let allowed = "points and lines that are corners and edges of the mesh's triangles";
            return self.refuse("electrodes.placement", value, allowed);
        }
        match contact_of_group(group, bare) {
            Some(contact) => Ok(contact),
            None => {
                let needed = match bare.model {
                    ElectrodeModel::Point => "one point of the mesh for the point model",
                    ElectrodeModel::Complete { .. } => {
                        "edges or triangles of the mesh for the complete model"
                    }
                };
                let value = format!("\"groups\" with electrode_{number} of {}", describe(group));
                self.refuse("electrodes.placement", value, needed)
            }
        }
    }

    fn along_loop(
        &self,
        table: &ElectrodeTable,
        bare: &Bare<'_>,
        count: usize,
    ) -> Result<Vec<ElectrodeContact>, SkinError> {
        let Some(rim) = &bare.rim else {
            let allowed = "\"groups\" or \"points\": the mesh is closed and has no rim";
            return self.refuse("electrodes.placement", "\"rim\"".into(), allowed);
        };
        let (angle, sign) = self.first_angle(table)?;
        let spacing = sign * rim.length() / count as f64;
        let first = rim.position(angle);
        Ok((0..count).map(|e| bare.on_rim(rim, first + spacing * e as f64, e)).collect())
    }

    /// The nearest node, edges of the rim, or the triangles around each position.
    fn at_coordinates(
        &self,
        table: &ElectrodeTable,
        bare: &Bare<'_>,
        count: usize,
    ) -> Result<Vec<ElectrodeContact>, SkinError> {
        let rows = self.positions(table, count)?;
        let place = |(electrode, row): (usize, &Vec<_>)| {
            let position = self.position(if row.len() == 2 { 2 } else { 3 }, electrode, row)?;
            let (_, distance) = nearest_node(&bare.imported.nodes, position);
            let farthest = FARTHEST * bare.diagonal;
            if distance > farthest {
                let value = format!("electrode {} {:.3} mm from the mesh", electrode + 1, distance * 1e3);
                let allowed = format!("at most {:.3} mm from its nearest node", farthest * 1e3);
                return self.refuse("electrodes.positions", value, &allowed);
            }
            Ok(bare.at(position, electrode))
        };
        rows.iter().enumerate().map(place).collect()
    }

    fn touch_apart(&self, contacts: &[ElectrodeContact]) -> Result<(), SkinError> {
        match shared_node(contacts) {
            Some(([a, b], node)) => {
                let value = format!("electrodes {} and {} share node {node} of the mesh", a + 1, b + 1);
                self.refuse("electrodes.placement", value, "electrodes that touch nodes of their own")
            }
            None => Ok(()),
        }
    }
}

impl Bare<'_> {
    fn on_rim(&self, rim: &Rim<'_>, s: f64, electrode: usize) -> ElectrodeContact {
        match self.model {
            ElectrodeModel::Point => rim.node(s),
            ElectrodeModel::Complete { .. } => rim.edges(s, self.model.width(electrode)),
        }
    }

    fn at(&self, position: Point3<f64>, electrode: usize) -> ElectrodeContact {
        let Imported { nodes, triangles, .. } = self.imported;
        let width = self.model.width(electrode);
        match (self.model, &self.rim) {
            (ElectrodeModel::Point, _) => ElectrodeContact::Node(nearest_node(nodes, position).0),
            (_, Some(rim)) if rim.nearest(position).1 <= width / 2.0 => {
                rim.edges(rim.nearest(position).0, width)
            }
            _ => faces(nodes, triangles, position, width),
        }
    }
}

fn contact_of_group(group: &Group, bare: &Bare<'_>) -> Option<ElectrodeContact> {
    match (bare.model, &group.nodes[..], &group.edges[..], &group.triangles[..]) {
        (ElectrodeModel::Point, [node], [], []) => Some(ElectrodeContact::Node(*node)),
        (ElectrodeModel::Complete { .. }, _, [], [_, ..]) => {
            let triangles = group.triangles.iter().map(|&triangle| bare.imported.triangles[triangle]);
            Some(ElectrodeContact::Faces(triangles.collect()))
        }
        (ElectrodeModel::Complete { .. }, _, [_, ..], []) => {
            Some(ElectrodeContact::Edges(group.edges.clone()))
        }
        _ => None,
    }
}

fn describe(group: &Group) -> String {
    let [nodes, edges, triangles] = [group.nodes.len(), group.edges.len(), group.triangles.len()];
    format!("{nodes} points, {edges} edges and {triangles} triangles")
}

fn diagonal(nodes: &[Point3<f64>]) -> f64 {
    let first = nodes.first().map_or(Vector3::zeros(), |node| node.coords);
    let (low, high) = nodes
        .iter()
        .fold((first, first), |(low, high), node| (low.inf(&node.coords), high.sup(&node.coords)));
    (high - low).norm()
}

/// Rim and holes of a mesh in the plane z = 0; none of a mesh in space, or of one whose boundary is
/// too long to be an outline.
fn flat_outline(nodes: &[Point3<f64>], soundness: &Soundness, diagonal: f64) -> Option<Outline> {
    if nodes.iter().any(|node| node.z.abs() > FLAT * diagonal) {
        return None;
    }
    let corners =
        |order: &Vec<usize>| corners(&order.iter().map(|&node| nodes[node].xy()).collect::<Vec<_>>());
    let loops: Vec<Vec<Point2<f64>>> = soundness.boundary_loops.iter().map(corners).collect();
    let (rim, holes) = loops.split_first()?;
    Outline::polygon(rim, holes).ok()
}

/// The points of a closed line at which it bends.
fn corners(points: &[Point2<f64>]) -> Vec<Point2<f64>> {
    let count = points.len();
    let bends = |&i: &usize| {
        let (before, after) =
            (points[i] - points[(i + count - 1) % count], points[(i + 1) % count] - points[i]);
        before.perp(&after).abs() > 1e-9 * before.norm() * after.norm()
    };
    (0..count).filter(bends).map(|i| points[i]).collect()
}
