//! Import: the mesh that a skin's description names is read, checked and scaled, and electrodes go on it.

use crate::skin::{Described, Description, MeshFile, Placement, Skin, SkinError, electrodes::Electrodes};
use dermatome_geometry::{
    mesh::{
        ElectrodeContact, Mesh,
        import::{self, Group, Imported},
        place::{BoundaryLoop, faces, nearest_node, shared_node},
        quality::quality,
        soundness::{Soundness, require_sound},
    },
    shape::{Shape, diagonal},
    sheet::{EdgeLengths, ElectrodeModel},
};
use nalgebra::Point3;

/// Points further away from the mesh than this share of its bounding box's diagonal miss it.
const FARTHEST: f64 = 0.05;

impl Description {
    /// The skin described: its mesh file, if it has one, is imported, welded and checked, and its electrodes are
    /// placed, here and nowhere else.
    pub fn made(self) -> Result<Skin, SkinError> {
        let mut made = Made { electrodes: self.electrodes, edges: self.edges };
        let shape = match self.shape {
            Described::Sheet(sheet) => Shape::Sheet(sheet),
            Described::Mesh(file) => made.import(&file)?,
        };
        Ok(Skin {
            shape,
            edges: made.edges,
            electrodes: made.electrodes,
            name: self.name,
            material: self.material,
            drive: self.drive,
            inverse: self.inverse,
            image: self.image,
            contact_threshold: self.contact_threshold,
            contacts_found_in: self.contacts_found_in,
            false_alarms: self.false_alarms,
            averaging: self.averaging,
            drift_time: self.drift_time,
            calibration: self.calibration,
            reflexes: self.reflexes,
            pose: self.pose,
        })
    }
}

/// What a mesh file says about a skin besides its shape.
struct Made {
    electrodes: Electrodes,
    edges: EdgeLengths,
}

impl Made {
    /// The shape in a file; widths of electrodes and lengths of edges become what it says.
    fn import(&mut self, file: &MeshFile) -> Result<Shape, SkinError> {
        let imported = read(file)?;
        let soundness = sound(file, &imported)?;
        let order = soundness.boundary_loops.first().cloned();
        let bare = Bare {
            file,
            boundary: order.map(|order| BoundaryLoop::new(&imported.nodes, order)),
            model: &self.electrodes.model,
            count: usize::from(self.electrodes.count),
            diagonal: diagonal(&imported.nodes),
            imported: &imported,
        };
        let electrodes = bare.contacts()?;
        bare.touch_apart(&electrodes)?;
        let Imported { nodes, triangles, .. } = imported;
        let mesh = Mesh { nodes, elements: triangles, electrodes };
        if let ElectrodeModel::Complete { width, .. } = &mut self.electrodes.model {
            *width = mesh.electrodes.iter().map(|contact| mesh.width(contact)).collect();
        }
        let found = quality(&mesh);
        let edge = (found.area / (0.433 * found.elements as f64)).sqrt();
        self.edges = EdgeLengths { skin: edge, electrodes: edge };
        Ok(Shape::imported(mesh, &soundness))
    }
}

/// The mesh in a file, in metres.
fn read(file: &MeshFile) -> Result<Imported, SkinError> {
    let mut mesh =
        import::read(&file.path, file.weld).or_else(|error| refuse_file(file, &error.to_string()))?;
    if let Some(metres) = mesh.unit.filter(|metres| (metres / file.unit - 1.0).abs() > 1e-6) {
        let allowed = format!("the unit of {:?}, which is {metres} m", file.written.display().to_string());
        return refuse(file, "shape.unit", format!("{} m", file.unit), &allowed);
    }
    mesh.scale(file.unit);
    Ok(mesh)
}

fn sound(file: &MeshFile, mesh: &Imported) -> Result<Soundness, SkinError> {
    let sound = require_sound(&mesh.nodes, &mesh.triangles, file.allow_cracks);
    sound.or_else(|fault| refuse_file(file, &format!("a sound mesh, but {fault}")))
}

fn refuse_file<T>(file: &MeshFile, allowed: &str) -> Result<T, SkinError> {
    refuse(file, "shape.file", format!("{:?}", file.written.display().to_string()), allowed)
}

fn refuse<T>(file: &MeshFile, field: &'static str, value: String, allowed: &str) -> Result<T, SkinError> {
    Err(SkinError::Value { path: file.skin_file.clone(), field, value, allowed: allowed.to_owned() })
}

/// A mesh without electrodes, and what is needed to put them on it.
struct Bare<'a> {
    file: &'a MeshFile,
    imported: &'a Imported,
    /// The longest boundary loop, if the surface is not closed.
    boundary: Option<BoundaryLoop<'a>>,
    model: &'a ElectrodeModel,
    count: usize,
    diagonal: f64,
}

impl Bare<'_> {
    fn contacts(&self) -> Result<Vec<ElectrodeContact>, SkinError> {
        match &self.file.placement {
            Placement::Groups => (0..self.count).map(|electrode| self.group(electrode)).collect(),
            Placement::Rim { first, turn } => self.along_boundary(*first, *turn),
            Placement::Points(points) => {
                points.iter().enumerate().map(|(electrode, &point)| self.near(point, electrode)).collect()
            }
        }
    }

    fn group(&self, electrode: usize) -> Result<ElectrodeContact, SkinError> {
        let (number, count) = (electrode + 1, self.count);
        if self.group_of(count + 1).is_some() {
            let allowed = format!("more: the mesh has a group \"electrode_{}\"", count + 1);
            return refuse(self.file, "electrodes.count", count.to_string(), &allowed);
        }
        let Some(group) = self.group_of(number) else {
            let allowed =
                format!("physical groups \"electrode_1\" to \"electrode_{count}\" in the mesh file");
            return self.refuse_placement(format!("\"groups\" without electrode_{number}"), &allowed);
        };
        if group.off_mesh > 0 {
            let value = format!(
                "\"groups\" with electrode_{number}, of whose points and lines {} are not on the mesh",
                group.off_mesh
            );
            let allowed = "points and lines that are corners and edges of the mesh's triangles";
            return self.refuse_placement(value, allowed);
        }
        contact_of_group(group, self).map_or_else(|| self.refuse_group(group, number), Ok)
    }

    /// The group that is an electrode, by its number from 1.
    fn group_of(&self, number: usize) -> Option<&Group> {
        let name = format!("electrode_{number}");
        self.imported.groups.iter().find(|group| group.name == name)
    }

    fn refuse_group(&self, group: &Group, number: usize) -> Result<ElectrodeContact, SkinError> {
        let needed = match self.model {
            ElectrodeModel::Point => "one point of the mesh for the point model",
            ElectrodeModel::Complete { .. } => "edges or triangles of the mesh for the complete model",
        };
        let value = format!("\"groups\" with electrode_{number} of {}", describe(group));
        self.refuse_placement(value, needed)
    }

    fn along_boundary(&self, angle: f64, turn: f64) -> Result<Vec<ElectrodeContact>, SkinError> {
        let Some(boundary) = &self.boundary else {
            let allowed = "\"groups\" or \"points\": the mesh is closed and has no rim";
            return self.refuse_placement("\"rim\"".into(), allowed);
        };
        let spacing = turn * boundary.length() / self.count as f64;
        let first = boundary.position(angle);
        Ok((0..self.count).map(|e| self.on_boundary(boundary, first + spacing * e as f64, e)).collect())
    }

    /// The nearest node, edges of the rim, or the triangles around a position.
    fn near(&self, position: Point3<f64>, electrode: usize) -> Result<ElectrodeContact, SkinError> {
        let (_, distance) = nearest_node(&self.imported.nodes, position);
        let farthest = FARTHEST * self.diagonal;
        if distance > farthest {
            let value = format!("electrode {} {:.3} mm from the mesh", electrode + 1, distance * 1e3);
            let allowed = format!("at most {:.3} mm from its nearest node", farthest * 1e3);
            return refuse(self.file, "electrodes.positions", value, &allowed);
        }
        Ok(self.at(position, electrode))
    }

    fn touch_apart(&self, contacts: &[ElectrodeContact]) -> Result<(), SkinError> {
        match shared_node(contacts) {
            Some(([a, b], node)) => {
                let value = format!("electrodes {} and {} share node {node} of the mesh", a + 1, b + 1);
                self.refuse_placement(value, "electrodes that touch nodes of their own")
            }
            None => Ok(()),
        }
    }

    fn refuse_placement<T>(&self, value: String, allowed: &str) -> Result<T, SkinError> {
        refuse(self.file, "electrodes.placement", value, allowed)
    }

    fn on_boundary(&self, boundary: &BoundaryLoop<'_>, s: f64, electrode: usize) -> ElectrodeContact {
        match self.model {
            ElectrodeModel::Point => boundary.node(s),
            ElectrodeModel::Complete { .. } => boundary.edges(s, self.model.width(electrode)),
        }
    }

    fn at(&self, position: Point3<f64>, electrode: usize) -> ElectrodeContact {
        let Imported { nodes, triangles, .. } = self.imported;
        let width = self.model.width(electrode);
        match (self.model, &self.boundary) {
            (ElectrodeModel::Point, _) => ElectrodeContact::Node(nearest_node(nodes, position).0),
            (_, Some(boundary)) if boundary.nearest(position).1 <= width / 2.0 => {
                boundary.edges(boundary.nearest(position).0, width)
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
