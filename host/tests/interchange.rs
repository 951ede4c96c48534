//! What `export` writes, read back by other readers, against what the library computes.

use dermatome::{
    forward::electrode_unknown,
    interchange::{
        conductivity,
        export::{CONTENTS, Export, prepare_folder},
    },
    jacobian::jacobian,
    mesh::{ElectrodeContact, Lattice, import, triangle},
    model::{self, Model, forward_model},
    pixels::Pixels,
    recorded::read::Source,
    skin::Skin,
};
use faer::Mat;
use matfile::{MatFile, NumericData};
use num_complex::Complex64;
use std::{collections::HashMap, ffi::OsStr, fs::File, path::Path};
use tempfile::TempDir;

const TINY: &str = include_str!("data/tiny.toml");

fn skin(text: &str) -> Skin {
    Skin::parse(Path::new("skin.toml"), text).unwrap().made().unwrap()
}

fn complex_skin() -> Skin {
    let capacitive = "sheet_conductivity = \"5.88 mS\"\nsheet_capacitance = \"5 nF\"";
    skin(&TINY.replace("sheet_conductivity = \"5.88 mS\"", capacitive))
}

fn exported(skin: &Skin) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    prepare_folder(folder.path()).unwrap();
    Export::new(skin, |_| ()).unwrap().write(folder.path()).unwrap();
    folder
}

/// An array as `npyz` reads it: shape, and values in C order.
fn npy<T: npyz::Deserialize>(folder: &TempDir, name: &str) -> (Vec<u64>, Vec<T>) {
    let bytes = std::fs::read(folder.path().join(format!("{name}.npy"))).unwrap();
    let file = npyz::NpyFile::new(&bytes[..]).unwrap();
    (file.shape().to_vec(), file.into_vec().unwrap())
}

fn floats(folder: &TempDir, name: &str) -> Vec<f64> {
    npy(folder, name).1
}

fn indices(folder: &TempDir, name: &str) -> Vec<usize> {
    npy::<i64>(folder, name).1.into_iter().map(|value| usize::try_from(value).unwrap()).collect()
}

fn rows<T: Copy>(matrix: &Mat<T>) -> Vec<T> {
    (0..matrix.nrows()).flat_map(|i| (0..matrix.ncols()).map(move |j| matrix[(i, j)])).collect()
}

#[test]
fn arrays_read_back_are_what_the_library_computes() {
    let skin = skin(TINY);
    let folder = exported(&skin);
    let model = Model::build(&skin, |_| ()).unwrap();
    let mesh = &model.mesh;
    let nodes: Vec<f64> = mesh.nodes.iter().flat_map(|node| [node.x, node.y, node.z]).collect();
    assert_eq!(npy(&folder, "nodes"), (vec![mesh.nodes.len() as u64, 3], nodes));
    assert_eq!(indices(&folder, "elements"), mesh.elements.concat());
    assert_eq!(floats(&folder, "voltages"), model.voltages);
    let forward = forward_model::<f64>(&skin, mesh).unwrap();
    let ones = vec![1.0; mesh.elements.len()];
    assert_eq!(floats(&folder, "conductivity"), ones);
    let fields = forward.solve(&ones).unwrap();
    let expected = jacobian(mesh, &fields, &model.steps, &model.pixels);
    let shape = [expected.nrows() as u64, expected.ncols() as u64];
    assert_eq!(npy(&folder, "jacobian"), (shape.to_vec(), rows(&expected)));
    assert_eq!(floats(&folder, "reconstruction_matrix"), rows(&model.conductivity_from_difference));
    assert_entries(&folder, "system_matrix", &forward.system_matrix(&ones).unwrap());
    assert_entries(&folder, "prior", &model.prior.as_ref().unwrap().entries().unwrap());
    assert_pixels(&folder, &model.pixels);
}

/// Sparse matrices: the same sums, each place once, in order.
fn assert_entries(folder: &TempDir, name: &str, entries: &[(usize, usize, f64)]) {
    let mut sums: HashMap<(usize, usize), f64> = HashMap::new();
    entries.iter().for_each(|&(row, column, value)| *sums.entry((row, column)).or_default() += value);
    let [row, column] = ["row", "col"].map(|part| indices(folder, &format!("{name}_{part}")));
    let places: Vec<_> = row.into_iter().zip(column).collect();
    assert!(places.windows(2).all(|pair| pair[0] < pair[1]), "{name}: places ascend");
    assert_eq!(places.len(), sums.len());
    for (place, value) in places.iter().zip(floats(folder, &format!("{name}_value"))) {
        assert!((sums[place] - value).abs() < 1e-12, "{name} {place:?}");
    }
}

fn assert_pixels(folder: &TempDir, pixels: &Pixels) {
    assert_eq!(floats(folder, "pixel_area"), pixels.areas);
    let flat = |vectors: Vec<[f64; 3]>| vectors.concat();
    assert_eq!(
        floats(folder, "pixel_centre"),
        flat(pixels.centres.iter().map(|c| [c.x, c.y, c.z]).collect())
    );
    assert_eq!(
        floats(folder, "pixel_normal"),
        flat(pixels.normals.iter().map(|n| [n.x, n.y, n.z]).collect())
    );
    let [pixel, element] = ["pixel", "element"].map(|part| indices(folder, &format!("pixel_element_{part}")));
    let mut map = vec![Vec::new(); pixels.count()];
    for ((pixel, element), share) in pixel.iter().zip(element).zip(floats(folder, "pixel_element_share")) {
        map[*pixel].push((element, share));
    }
    assert_eq!(map, pixels.elements);
}

#[test]
fn electrodes_of_both_models_are_listed_with_their_nodes() {
    let complete = exported(&skin(TINY));
    let mesh = model::mesh(&skin(TINY), 1.0, Lattice::default()).unwrap();
    let edges: Vec<usize> = mesh
        .electrodes
        .iter()
        .enumerate()
        .flat_map(|(electrode, contact)| match contact {
            ElectrodeContact::Edges(edges) => edges.iter().flat_map(|&[a, b]| [electrode, a, b]).collect(),
            _ => vec![],
        })
        .collect();
    assert!(!edges.is_empty());
    assert_eq!(indices(&complete, "electrode_edges"), edges);
    assert_eq!(npy::<i64>(&complete, "electrode_points"), (vec![0, 2], vec![]));
    assert_eq!(npy::<i64>(&complete, "electrode_faces"), (vec![0, 4], vec![]));
    assert_eq!(floats(&complete, "contact_impedance"), [0.18 * 5.88e-3; 8]);

    let text = TINY.replace("\"complete\"", "\"point\"").replace("width = \"8 mm\"\n", "");
    let point = skin(&text.replace("contact_impedance = \"0.18 ohm m\"\n", ""));
    let folder = exported(&point);
    let mesh = model::mesh(&point, 1.0, Lattice::default()).unwrap();
    let points: Vec<usize> = (0..8).flat_map(|e| [e, electrode_unknown(&mesh, e)]).collect();
    assert_eq!(indices(&folder, "electrode_points"), points);
    assert_eq!(npy::<i64>(&folder, "electrode_edges").0, [0, 3]);
    assert_eq!(npy::<f64>(&folder, "contact_impedance").0, [0]);
}

const POINT: &str = "model = \"point\"";
const COMPLETE: &str = "model = \"complete\"\nwidth = \"8 mm\"\ncontact_impedance = \"0.18 ohm m\"";

/// The tiny skin with electrodes of another model, the eighth of them inside the skin.
fn one_inside(model: &str) -> Skin {
    let rest = TINY.split_once("[drive]").unwrap();
    let head = rest.0.split_once("[electrodes]").unwrap().0;
    let rim = (0..7).map(|e| f64::from(e) * std::f64::consts::TAU / 8.0);
    let rim = rim.map(|angle| format!("[{}, {}], ", 0.05 * angle.cos(), 0.05 * angle.sin()));
    let positions: String = rim.collect();
    let electrodes = format!(
        "[electrodes]\ncount = 8\nplacement = \"points\"\npositions = [{positions}[0.01, -0.01]]\n{model}\n"
    );
    skin(&format!("{head}{electrodes}[drive]{}", rest.1))
}

#[test]
fn triangles_under_an_electrode_inside_the_skin_are_listed_as_its_faces() {
    let skin = one_inside(COMPLETE);
    let folder = exported(&skin);
    let mesh = model::mesh(&skin, 1.0, Lattice::default()).unwrap();
    let ElectrodeContact::Faces(inside) = &mesh.electrodes[7] else { panic!("electrode 8 is on the rim") };
    let rows: Vec<usize> = inside.iter().flat_map(|&[a, b, c]| [7, a, b, c]).collect();
    assert_eq!(npy::<i64>(&folder, "electrode_faces").0, [inside.len() as u64, 4]);
    assert_eq!(indices(&folder, "electrode_faces"), rows);
    let area: f64 = inside.iter().map(|&face| triangle::area(mesh.points(face))).sum();
    let disc = std::f64::consts::PI * 0.004_f64.powi(2);
    assert!((area / disc - 1.0).abs() < 0.15, "{area} of {disc}: all of a disc 8 mm wide, as a polygon");
    let edges = indices(&folder, "electrode_edges");
    assert!(edges.chunks(3).all(|row| row[0] < 7), "electrode 8 has none");
}

#[test]
fn the_gmsh_file_is_a_skin_with_the_same_electrodes_and_voltages() {
    for (model, electrodes) in [(COMPLETE, "complete\"\ncontact_impedance = \"0.18 ohm m"), (POINT, "point")]
    {
        let original = one_inside(model);
        let folder = exported(&original);
        let shape = "[shape]\nkind = \"mesh\"\nfile = \"skin.msh\"\nunit = \"m\"\n";
        let (head, rest) = TINY.split_once("[shape]").unwrap();
        let material = rest.split_once("[material]").unwrap().1.split_once("[electrodes]").unwrap().0;
        let drive = rest.split_once("[drive]").unwrap().1;
        let text = format!(
            "{head}{shape}[material]{material}[electrodes]\ncount = 8\nplacement = \"groups\"\n\
             model = \"{electrodes}\"\n[drive]{drive}"
        );
        let again = Skin::parse(&folder.path().join("skin.toml"), &text).unwrap().made().unwrap();
        let [before, after] = [&original, &again].map(|s| model::mesh(s, 1.0, Lattice::default()).unwrap());
        assert_eq!(after.nodes, before.nodes);
        assert_eq!(after.electrodes, before.electrodes);
        let [before, after] = [original, again].map(|skin| Model::build(&skin, |_| ()).unwrap().voltages);
        let largest = before.iter().fold(0.0, |largest: f64, v| largest.max(v.abs()));
        for (before, after) in before.iter().zip(after) {
            assert!((before - after).abs() < 1e-11 * largest, "{before} {after}");
        }
    }
}

#[test]
fn the_ply_file_holds_the_same_mesh() {
    let skin = skin(TINY);
    let folder = exported(&skin);
    let mesh = model::mesh(&skin, 1.0, Lattice::default()).unwrap();
    let read = import::read(&folder.path().join("skin.ply"), None).unwrap();
    assert_eq!((read.nodes, read.triangles), (mesh.nodes, mesh.elements));
}

#[test]
fn the_stimulation_table_is_read_back_by_a_skin_file() {
    for drive in ["adjacent", "opposite", "skip-1"] {
        let original = skin(&TINY.replace("\"adjacent\"", &format!("\"{drive}\"")));
        let folder = exported(&original);
        let text = TINY.replace("pattern = \"adjacent\"", "pattern = \"table\"\ntable = \"stimulation.csv\"");
        let again = Skin::parse(&folder.path().join("skin.toml"), &text).unwrap().made().unwrap();
        assert_eq!(again.steps(), original.steps(), "{drive}");
        let steps: Vec<usize> = original.steps().iter().flat_map(|s| s.to_bytes().map(usize::from)).collect();
        assert_eq!(indices(&folder, "stimulation"), steps);
        let combination = original.stimulation().combination;
        let signs = combination.iter().map(|target| if target.flipped { -1 } else { 1 }).collect();
        assert_eq!(npy::<i64>(&folder, "step_sign"), (vec![combination.len() as u64], signs));
        let measurements: Vec<_> = combination.iter().map(|target| usize::from(target.measurement)).collect();
        assert_eq!(indices(&folder, "step_measurement"), measurements);
    }
}

/// A variable of the MATLAB file: sides, and values column after column.
fn variable(folder: &TempDir, name: &str) -> (Vec<usize>, Vec<Complex64>) {
    let file = MatFile::parse(File::open(folder.path().join("skin.mat")).unwrap()).unwrap();
    let array = file.find_by_name(name).unwrap_or_else(|| panic!("no {name}"));
    let NumericData::Double { real, imag } = array.data() else { panic!("{name} is not double") };
    let imaginary = |i: usize| imag.as_ref().map_or(0.0, |imag| imag[i]);
    let values = real.iter().enumerate().map(|(i, &re)| Complex64::new(re, imaginary(i))).collect();
    (array.size().clone(), values)
}

/// Everything of an array read by NumPy's format, column after column.
fn columns(folder: &TempDir, name: &str, kind: &str) -> (Vec<usize>, Vec<Complex64>) {
    let (shape, values): (Vec<u64>, Vec<Complex64>) = match kind {
        "<c16" => npy(folder, name),
        "<i8" => {
            let (shape, values) = npy::<i64>(folder, name);
            (shape, values.into_iter().map(|value| (value as f64).into()).collect())
        }
        _ => {
            let (shape, values) = npy::<f64>(folder, name);
            (shape, values.into_iter().map(Complex64::from).collect())
        }
    };
    let [rows, columns] = [shape[0] as usize, shape.get(1).map_or(1, |&side| side as usize)];
    let by_column = (0..columns).flat_map(|c| (0..rows).map(move |r| (r, c)));
    (vec![rows, columns], by_column.map(|(r, c)| values[r * columns + c]).collect())
}

#[test]
fn the_matlab_file_holds_the_same_arrays() {
    for skin in [skin(TINY), complex_skin()] {
        let folder = exported(&skin);
        let contents: serde_json::Value =
            serde_json::from_slice(&std::fs::read(folder.path().join(CONTENTS)).unwrap()).unwrap();
        let arrays = contents["arrays"].as_object().unwrap();
        assert!(arrays.len() >= 26);
        for (name, entry) in arrays {
            let expected = columns(&folder, name, entry["type"].as_str().unwrap());
            let sides: Vec<u64> =
                entry["shape"].as_array().unwrap().iter().map(|s| s.as_u64().unwrap()).collect();
            assert_eq!(expected.0[..sides.len()], sides.iter().map(|&s| s as usize).collect::<Vec<_>>());
            // The reader takes no empty matrix.
            if !expected.1.is_empty() {
                assert_eq!(variable(&folder, name), expected, "{name}");
            }
        }
        let one = |name: &str| variable(&folder, name).1[0].re;
        assert_eq!(one("volts_per_unit"), 1e-3 / 5.88e-3);
        assert_eq!(one("ground"), contents["ground"].as_f64().unwrap());
    }
}

#[test]
fn a_skin_with_capacitance_has_complex_arrays() {
    let skin = complex_skin();
    let folder = exported(&skin);
    let mesh = model::mesh(&skin, 1.0, Lattice::default()).unwrap();
    let admittivity = vec![skin.admittivity(); mesh.elements.len()];
    assert_eq!(npy::<Complex64>(&folder, "conductivity").1, admittivity);
    let fields = forward_model::<Complex64>(&skin, &mesh).unwrap().solve(&admittivity).unwrap();
    let voltages: Vec<Complex64> = npy(&folder, "voltages").1;
    assert_eq!(voltages, fields.voltages(&skin.steps()));
    assert!(voltages.iter().all(|voltage| voltage.im.abs() > 1e-6));
    let (shape, values): (_, Vec<Complex64>) = npy(&folder, "jacobian");
    assert_eq!(shape[0], 40);
    assert!(values.iter().any(|value| value.im.abs() > 1e-6));
    assert!(npy::<Complex64>(&folder, "system_matrix_value").1.iter().any(|value| value.im != 0.0));
}

#[test]
fn exported_conductivities_give_the_exported_voltages() {
    for skin in [skin(TINY), complex_skin()] {
        let folder = exported(&skin);
        let mesh = model::mesh(&skin, 1.0, Lattice::default()).unwrap();
        let source = Source::new(folder.path().join("conductivity.npy").as_os_str());
        let conductivity = conductivity::read(&source, mesh.elements.len()).unwrap();
        let voltages = conductivity::voltages(&skin, &mesh, &conductivity).unwrap();
        let expected = columns(&folder, "voltages", if voltages.complex { "<c16" } else { "<f8" }).1;
        assert_eq!(voltages.values, expected);
    }
}

#[test]
fn a_softer_element_changes_the_voltages_as_its_column_of_the_jacobian_says() {
    let skin = skin(&TINY.replace("columns = 16", "pixels = \"elements\""));
    let folder = exported(&skin);
    let mesh = model::mesh(&skin, 1.0, Lattice::default()).unwrap();
    let (shape, jacobian): (_, Vec<f64>) = npy(&folder, "jacobian");
    let (pixels, element, change) = (shape[1] as usize, 17, 1e-5);
    let mut conductivity = vec![Complex64::ONE; mesh.elements.len()];
    let at = |change: f64, conductivity: &mut Vec<Complex64>| {
        conductivity[element] = (1.0 + change).into();
        conductivity::voltages(&skin, &mesh, conductivity).unwrap().values
    };
    let (more, less) = (at(change, &mut conductivity), at(-change, &mut conductivity));
    let largest = (0..40).map(|step| jacobian[step * pixels + element].abs()).fold(0.0, f64::max);
    for (step, (more, less)) in more.iter().zip(less).enumerate() {
        let expected = (more - less).re / (2.0 * change);
        let error = (jacobian[step * pixels + element] - expected).abs() / largest;
        assert!(error < 1e-6, "step {step}: {error:e}");
    }
}

#[test]
fn conductivity_files_that_do_not_fit_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let error = conductivity::read(&Source::new(path.as_os_str()), 3).unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
        error
    };
    assert!(
        refused("two.csv", "1\n2\n")
            .contains("shape is (2, 1); allowed is one value for each of the mesh's 3")
    );
    assert!(refused("square.csv", "1,2,3\n1,2,3\n").contains("shape is (2, 3)"));
    assert!(refused("zero.csv", "1\n0\n2\n").contains("element 1 (counted from 0) is 0"));
    assert!(refused("minus.csv", "1,2,-3+1j\n").contains("element 2"));
    assert!(refused("nan.csv", "1,nan,1\n").contains("element 1"));
    assert!(refused("word.csv", "1,one,1\n").contains("`one` is not a number"));
    assert!(refused("skin.obj", "").contains("must end in .npy"));
    assert!(refused("skin.mat", "").contains("not a MATLAB file"));
    assert!(conductivity::read(&Source::new(OsStr::new("nowhere.npy")), 3).is_err());
    let good = folder.path().join("good.csv");
    std::fs::write(&good, "conductivity\n1\n0.5\n(2+0.25j)\n").unwrap();
    let values = conductivity::read(&Source::new(good.as_os_str()), 3).unwrap();
    assert_eq!(values, [1.0.into(), 0.5.into(), Complex64::new(2.0, 0.25)]);
}

#[test]
fn other_files_of_the_folder_are_left_alone_and_an_export_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("notes.txt"), "mine").unwrap();
    std::fs::write(folder.path().join("voltages.npy"), "old").unwrap();
    std::fs::write(folder.path().join(CONTENTS), "old").unwrap();
    let skin = skin(TINY);
    prepare_folder(folder.path()).unwrap();
    Export::new(&skin, |_| ()).unwrap().write(folder.path()).unwrap();
    assert_eq!(std::fs::read(folder.path().join("notes.txt")).unwrap(), b"mine");
    assert_eq!(npy::<f64>(&folder, "voltages").0, [40]);
    assert!(std::fs::read(folder.path().join(CONTENTS)).unwrap().starts_with(b"{"));
}

/// A folder whose disk is full at one of the files: what is there is whole, and no list claims the rest.
#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_is_full_half_way_leaves_no_half_file_and_no_list() {
    let folder = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink("/dev/full", folder.path().join("voltages.npy")).unwrap();
    std::fs::write(folder.path().join(CONTENTS), "old").unwrap();
    let skin = skin(TINY);
    let error = Export::new(&skin, |_| ()).unwrap().write(folder.path()).unwrap_err().to_string();
    assert!(error.contains("voltages.npy`: No space left"), "{error}");
    assert!(!folder.path().join(CONTENTS).exists());
    assert!(!npy::<f64>(&folder, "nodes").1.is_empty(), "what was written before is whole");
}
