//! Skins whose mesh was made elsewhere: `shape.kind` = "mesh".

use dermatome::{
    mesh::{ElectrodeContact, Lattice, Mesh, export::msh},
    model::{self, Model},
    skin::Skin,
};
use std::{fmt::Write, path::Path};
use tempfile::TempDir;

const DISC: &str = include_str!("../../models/disc-210mm/skin.toml");
const POINT: [(&str, &str); 3] = [
    ("model = \"complete\"", "model = \"point\""),
    ("width = \"11 mm\"", ""),
    ("contact_impedance = \"0.18 ohm m\"", ""),
];

fn replaced(text: &str, pairs: &[(&str, &str)]) -> String {
    pairs.iter().fold(text.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    })
}

/// The disc's skin file with a mesh file instead of a shape.
fn with_mesh(text: &str, file: &str, unit: &str, electrodes: &[(&str, &str)]) -> String {
    let shape = format!("kind = \"mesh\"\nfile = \"{file}\"\nunit = \"{unit}\"");
    let text = replaced(
        text,
        &[
            ("kind = \"disc\"\ndiameter = \"210 mm\"", &shape),
            ("[mesh]\nedge_length = \"4.5 mm\"            # about 4,000 elements", ""),
        ],
    );
    replaced(&text, electrodes)
}

const GROUPS: [(&str, &str); 3] = [
    ("placement = \"rim\"                 # equal arc lengths", "placement = \"groups\""),
    ("first = \"90 deg\"                  # electrode 1 at the top,", ""),
    ("direction = \"clockwise\"           # numbered as in EIDORS", ""),
];

struct Folder(TempDir);

impl Folder {
    fn with(name: &str, bytes: &[u8]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(name), bytes).unwrap();
        Self(folder)
    }

    fn load(&self, text: &str) -> Result<Skin, String> {
        let skin = Skin::parse(&self.0.path().join("skin.toml"), text);
        skin.and_then(Skin::made).map_err(|error| error.to_string())
    }
}

fn generated(text: &str) -> (Skin, Mesh) {
    let skin = Skin::parse(Path::new("disc.toml"), text).unwrap().made().unwrap();
    let mesh = model::mesh(&skin, 1.5, Lattice::default()).unwrap();
    (skin, mesh)
}

fn voltages(skin: &Skin, mesh: &Mesh) -> Vec<f64> {
    let forward = model::forward_model::<f64>(skin, mesh).unwrap();
    forward.solve(&vec![1.0; mesh.elements.len()]).unwrap().voltages(&skin.steps())
}

/// Binary STL: nodes are stored with every triangle, in single precision, here in mm.
fn stl(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((mesh.elements.len() as u32).to_le_bytes());
    for element in 0..mesh.elements.len() {
        bytes.extend([0; 12]);
        for corner in mesh.corners(element) {
            corner.iter().for_each(|x| bytes.extend(((x * 1e3) as f32).to_le_bytes()));
        }
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn a_mesh_that_went_through_gmsh_gives_the_same_voltages_by_its_groups() {
    for text in [DISC.to_owned(), replaced(DISC, &POINT)] {
        let (skin, mesh) = generated(&text);
        let folder = Folder::with("disc.msh", &msh(&mesh));
        let without_width = if text.contains("width = \"11 mm\"") {
            replaced(&text, &[("width = \"11 mm\"                   # thesis section 5.3.2", "")])
        } else {
            text.clone()
        };
        let imported = folder.load(&with_mesh(&without_width, "disc.msh", "m", &GROUPS)).unwrap();
        let again = model::mesh(&imported, 1.0, Lattice::default()).unwrap();
        assert_eq!(again.electrodes.len(), 16);
        for (a, b) in voltages(&imported, &again).iter().zip(voltages(&skin, &mesh)) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
    }
}

#[test]
fn electrodes_along_the_rim_of_an_stl_file_lie_where_those_of_a_sheet_do() {
    let (skin, mesh) = generated(DISC);
    let folder = Folder::with("disc.stl", &stl(&mesh));
    let imported = folder.load(&with_mesh(DISC, "disc.stl", "mm", &[])).unwrap();
    assert!(imported.shape.flat().is_ok(), "a flat mesh has an outline");
    for (a, b) in imported.shape.electrode_centres().iter().zip(skin.shape.electrode_centres()) {
        assert!((a - b).norm() < 3e-3, "{a} {b}");
    }
    let model = Model::build(&imported, |_| ()).unwrap();
    assert!(model.surface().is_ok());
    assert_eq!(model.mesh.elements.len(), mesh.elements.len());
}

#[test]
fn electrodes_at_coordinates_take_the_nearest_node_or_the_triangles_around() {
    let (_, mesh) = generated(DISC);
    let folder = Folder::with("disc.stl", &stl(&mesh));
    let mut rows = String::from("positions = [");
    for i in 0..16 {
        let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 16.0).sin_cos();
        let radius = if i == 5 { 0.05 } else { 0.105 };
        write!(rows, "[{}, {}], ", radius * cos, radius * sin).unwrap();
    }
    rows.push(']');
    let points = [
        ("placement = \"rim\"                 # equal arc lengths", "placement = \"points\""),
        ("first = \"90 deg\"                  # electrode 1 at the top,", &*rows),
        ("direction = \"clockwise\"           # numbered as in EIDORS", ""),
    ];
    let imported = folder.load(&with_mesh(DISC, "disc.stl", "mm", &points)).unwrap();
    let mesh = model::mesh(&imported, 1.0, Lattice::default()).unwrap();
    let kinds = |contact: &ElectrodeContact| match contact {
        ElectrodeContact::Node(_) => 'n',
        ElectrodeContact::Edges(_) => 'e',
        ElectrodeContact::Faces(_) => 'f',
    };
    assert_eq!(mesh.electrodes.iter().map(kinds).collect::<String>(), "eeeeefeeeeeeeeee");
    let at_nodes = folder.load(&with_mesh(&replaced(DISC, &POINT), "disc.stl", "mm", &points)).unwrap();
    let mesh = model::mesh(&at_nodes, 1.0, Lattice::default()).unwrap();
    assert_eq!(mesh.electrodes.iter().map(kinds).collect::<String>(), "n".repeat(16));
    let far = replaced(&rows, &[("[0.105, 0], ", "[0.2, 0], ")]);
    let missing = [points[0], (points[1].0, &*far), points[2]];
    let error = folder.load(&with_mesh(DISC, "disc.stl", "mm", &missing)).unwrap_err();
    assert!(error.contains("`electrodes.positions`") && error.contains("electrode 1 95.0"), "{error}");
}

#[test]
fn a_curved_mesh_makes_images_of_patches_but_no_grid() {
    let (_, mut mesh) = generated(DISC);
    mesh.nodes
        .iter_mut()
        .for_each(|node| node.z = 2.0 * (0.105_f64.powi(2) - node.coords.xy().norm_squared()));
    let folder = Folder::with("dome.stl", &stl(&mesh));
    let text = with_mesh(DISC, "dome.stl", "mm", &[]);
    let grid = folder.load(&text).unwrap();
    let error = Model::build(&grid, |_| ()).unwrap_err().to_string();
    assert!(error.contains("curved"), "{error}");
    let patches = replaced(&text, &[("columns = 32 ", "pixels = 100 ")]);
    let model = Model::build(&folder.load(&patches).unwrap(), |_| ()).unwrap();
    assert_eq!(model.conductivity_from_difference.nrows(), 100);
    assert!(model.pixels.normals.iter().all(|normal| normal.z > 0.8));
}

#[test]
fn unsound_meshes_and_wrong_fields_are_refused_by_name() {
    let (_, mesh) = generated(DISC);
    let folder = Folder::with("disc.stl", &stl(&mesh));
    let good = with_mesh(DISC, "disc.stl", "mm", &[]);
    let cases: [(&str, &str, &[&str]); 7] = [
        ("file = \"disc.stl\"", "file = \"no.stl\"", &["`shape.file`", "no.stl"]),
        ("file = \"disc.stl\"", "", &["`shape.file`", "missing", "STL"]),
        ("unit = \"mm\"", "", &["`shape.unit`", "missing", "mm"]),
        ("unit = \"mm\"", "unit = \"yard\"", &["`shape.unit`", "yard", "inch"]),
        ("unit = \"mm\"", "unit = \"mm\"\nweld = 2.0", &["`shape.file`", "2"]),
        ("placement = \"rim\"", "placement = \"sides\"", &["`electrodes.placement`", "sides", "groups"]),
        ("[material]", "[mesh]\nedge_length = 1\n[material]", &["`mesh.edge_length`", "as it is"]),
    ];
    for (from, to, expected) in cases {
        let error = folder.load(&replaced(&good, &[(from, to)])).unwrap_err();
        for part in expected {
            assert!(error.contains(part), "{to}: {part:?} is not in {error:?}");
        }
    }
    let mut holed = mesh.clone();
    holed.elements.remove(mesh.elements.len() / 2);
    let folder = Folder::with("disc.stl", &stl(&holed));
    let error = folder.load(&good).unwrap_err();
    assert!(error.contains("`shape.file`") && error.contains("crack"), "{error}");
    let allowed = replaced(&good, &[("unit = \"mm\"", "unit = \"mm\"\nallow_cracks = true")]);
    folder.load(&allowed).unwrap();
}

#[test]
fn groups_that_are_not_electrodes_are_refused_by_name() {
    let (_, mesh) = generated(DISC);
    let folder = Folder::with("disc.msh", &msh(&mesh));
    let without_width = replaced(DISC, &[("width = \"11 mm\"                   # thesis section 5.3.2", "")]);
    let good = with_mesh(&without_width, "disc.msh", "m", &GROUPS);
    let cases: [(&str, &str, &[&str]); 4] = [
        ("count = 16", "count = 15", &["`electrodes.count`", "15", "electrode_16"]),
        ("count = 16", "count = 18", &["`electrodes.placement`", "electrode_17", "physical groups"]),
        ("model = \"complete\"", "model = \"complete\"\nwidth = 1", &["`electrodes.width`", "groups"]),
        ("count = 16", "count = 16\nfirst = 1", &["`electrodes.first`", "groups"]),
    ];
    for (from, to, expected) in cases {
        let error = folder.load(&replaced(&good, &[(from, to)])).unwrap_err();
        for part in expected {
            assert!(error.contains(part), "{to}: {part:?} is not in {error:?}");
        }
    }
    let points = replaced(&good, &[POINT[0], POINT[2]]);
    let error = folder.load(&points).unwrap_err();
    assert!(error.contains("edges") && error.contains("one point"), "{error}");
    // A line from node to node that no triangle has for an edge.
    let mut off = mesh;
    let ElectrodeContact::Edges(edges) = &mut off.electrodes[2] else { panic!("no edges") };
    edges.push([0, 200]);
    let error = Folder::with("disc.msh", &msh(&off)).load(&good).unwrap_err();
    for part in ["`electrodes.placement`", "electrode_3, of whose points and lines 1 are not on the mesh"] {
        assert!(error.contains(part), "{part:?} is not in {error:?}");
    }
}
