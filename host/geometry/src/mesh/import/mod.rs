//! Meshes from files of other programs: STL, OBJ, PLY, COLLADA and Gmsh's MSH 2.2 and 4.1.
//!
//! The readers are ours. `stl_io` 0.11 and `tobj` 4.0 say neither line nor offset of a fault, `mshio`
//! 0.4 reads only MSH 4.1 and panics on some input, `ply-rs-bw` 4.0 alone would not spare the
//! `cursor` that the other three need. COLLADA is XML, which `roxmltree` reads, and tells the line of every element.

mod cursor;
mod dae;
mod error;
mod msh;
mod obj;
mod ply;
mod stl;

use super::weld;
pub use error::{ImportError, MAX_BYTES, MAX_TRIANGLES, Place, Problem};
use nalgebra::Point3;
use std::{
    collections::HashSet,
    fs::File,
    io::{self, Read},
    path::Path,
};

/// Welding tolerance that suits files of single precision, relative to the bounding box's diagonal.
pub const DEFAULT_WELD_TOLERANCE: f64 = 1e-6;

/// A mesh as a file holds it. Every node is the corner of a triangle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Imported {
    /// Corners, in the file's unit, finite: `[node]`.
    pub nodes: Vec<Point3<f64>>,
    /// Node numbers of each triangle, in the file's order. Polygons are fans around their first
    /// corner, which is right for convex ones.
    pub triangles: Vec<[usize; 3]>,
    /// Named parts of the mesh; only MSH files have them.
    pub groups: Vec<Group>,
    /// Metres in the file's unit, where the file says so; only COLLADA does.
    pub unit: Option<f64>,
}

/// A physical group of Gmsh. Groups of one name but different dimensions are one group.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Group {
    /// Its name; `point_7`, `curve_7` or `surface_7` where the file gives only the number 7.
    pub name: String,
    /// Its points, as numbers of nodes.
    pub nodes: Vec<usize>,
    /// Its lines, as numbers of nodes. Each is an edge of a triangle.
    pub edges: Vec<[usize; 2]>,
    /// Its triangles, as places in [`Imported::triangles`].
    pub triangles: Vec<usize>,
    /// Points and lines of the file that are left out, because no triangle has such a corner or edge.
    pub off_mesh: usize,
}

/// A file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Stereolithography, text or binary.
    Stl,
    /// Wavefront.
    Obj,
    /// Polygon file format, text or binary of either byte order.
    Ply,
    /// COLLADA 1.4 or 1.5; the axes are turned so that z is up.
    Dae,
    /// Gmsh 2.2 or 4.1, text or binary of either byte order.
    Msh,
}

/// Reads the mesh in a file, whose ending tells the format.
///
/// `weld` joins vertices closer than this share of the bounding box's diagonal, see
/// [`Imported::weld`]. With `None` only STL files are welded, by [`DEFAULT_WELD_TOLERANCE`]: each of
/// their triangles has vertices of its own.
pub fn read(path: &Path, weld: Option<f64>) -> Result<Imported, ImportError> {
    let format = Format::of(path);
    let mesh = format.and_then(|format| parse(format, &read_bytes(path)?, weld));
    mesh.map_err(|problem| ImportError { file: path.display().to_string(), problem })
}

/// Reads the mesh in the bytes of a file, like [`read`].
pub fn parse(format: Format, bytes: &[u8], weld: Option<f64>) -> Result<Imported, Problem> {
    let mut mesh = match format {
        Format::Stl => stl::parse(bytes),
        Format::Obj => obj::parse(bytes),
        Format::Ply => ply::parse(bytes),
        Format::Dae => dae::parse(bytes),
        Format::Msh => msh::parse(bytes),
    }?;
    if mesh.triangles.is_empty() {
        return Err(Problem::Missing { what: "triangles".into() });
    }
    if let Some(tolerance) = weld.or((format == Format::Stl).then_some(DEFAULT_WELD_TOLERANCE)) {
        mesh.weld(tolerance)?;
    }
    mesh.drop_unused();
    Ok(mesh)
}

impl Format {
    fn of(path: &Path) -> Result<Self, Problem> {
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        match ending.to_str() {
            Some("stl") => Ok(Self::Stl),
            Some("obj") => Ok(Self::Obj),
            Some("ply") => Ok(Self::Ply),
            Some("dae") => Ok(Self::Dae),
            Some("msh") => Ok(Self::Msh),
            _ => Err(Problem::Ending),
        }
    }
}

impl Imported {
    /// Multiplies all coordinates, as by 0.001 for a file in mm.
    pub fn scale(&mut self, factor: f64) {
        self.nodes.iter_mut().for_each(|node| *node *= factor);
        self.unit = self.unit.map(|metres| metres / factor);
    }

    /// Joins nodes closer than `tolerance` times the bounding box's diagonal, see
    /// [`weld::weld`]. Triangles that lose a corner by it stay, as degenerate ones.
    pub fn weld(&mut self, tolerance: f64) -> Result<(), Problem> {
        if !weld::TOLERANCES.contains(&tolerance) {
            return Err(Problem::Tolerance { found: tolerance, allowed: weld::TOLERANCES });
        }
        let welded = weld::weld(&self.nodes, tolerance);
        self.nodes = welded.points;
        self.renumber(|node| welded.numbers[node]);
        Ok(())
    }

    /// Adds a polygon as a fan of triangles.
    fn add_polygon(&mut self, corners: &[usize]) -> Result<(), Problem> {
        if self.triangles.len() + corners.len() > MAX_TRIANGLES {
            return Err(Problem::TooLarge);
        }
        self.triangles.extend(corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]));
        Ok(())
    }

    /// Leaves out nodes of no triangle, and what groups say about them.
    fn drop_unused(&mut self) {
        let mut used = vec![false; self.nodes.len()];
        self.triangles.iter().flatten().for_each(|&node| used[node] = true);
        self.keep_groups_on_the_mesh(&used);
        let nodes = std::mem::take(&mut self.nodes);
        let mut numbers = Vec::with_capacity(nodes.len());
        for (node, used) in nodes.into_iter().zip(used) {
            numbers.push(self.nodes.len());
            if used {
                self.nodes.push(node);
            }
        }
        self.renumber(|node| numbers[node]);
    }

    fn keep_groups_on_the_mesh(&mut self, used: &[bool]) {
        let wanted: HashSet<_> = self.groups.iter().flat_map(|group| &group.edges).map(sorted).collect();
        let edges = self.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let there: HashSet<_> =
            edges.map(|edge| sorted(&edge)).filter(|edge| wanted.contains(edge)).collect();
        for group in &mut self.groups {
            let before = group.nodes.len() + group.edges.len();
            group.nodes.retain(|&node| used[node]);
            group.edges.retain(|edge| there.contains(&sorted(edge)));
            group.off_mesh += before - group.nodes.len() - group.edges.len();
        }
    }

    /// Gives each node a new number. What becomes equal in a group stays once, and lines between
    /// nodes that become one vanish.
    fn renumber(&mut self, number: impl Fn(usize) -> usize) {
        self.triangles.iter_mut().flatten().for_each(|node| *node = number(*node));
        for group in &mut self.groups {
            group
                .nodes
                .iter_mut()
                .chain(group.edges.iter_mut().flatten())
                .for_each(|node| *node = number(*node));
            let (mut nodes, mut edges) = (HashSet::new(), HashSet::new());
            group.nodes.retain(|&node| nodes.insert(node));
            group.edges.retain(|edge| edge[0] != edge[1] && edges.insert(sorted(edge)));
        }
    }
}

fn sorted(&[a, b]: &[usize; 2]) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, Problem> {
    let read = || -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        File::open(path)?.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    let bytes = read().map_err(Problem::Io)?;
    log::debug!("read `{}`: {} bytes", path.display(), bytes.len());
    if bytes.len() as u64 > MAX_BYTES { Err(Problem::TooLarge) } else { Ok(bytes) }
}

#[cfg(test)]
mod tests;
