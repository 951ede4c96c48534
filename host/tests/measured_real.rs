//! Measured frames of real instruments, which are no part of the project: not run where absent.
//!
//! The model is a homogeneous disc with point electrodes, in closed form.

use dermatome::{
    measured::{
        Model,
        diagnose::{Diagnosis, diagnose},
        order::{Arrangement, SenseOrder},
        read::{Frames, Source, read},
        reconstruct::{FrameResult, Polarity, evenly_spaced, reconstruct},
    },
    view::sheet::{Panel, Sheet, reconstruction_sheet},
};
use dermatome_shared::{
    image::{Geometry, PixelGrid, pixel_cells},
    stimulation::{Step, pattern},
};
use num_complex::Complex64;
use std::{ffi::OsString, path::Path};

const PLAIN: Arrangement = Arrangement { sense: SenseOrder::Absolute, rotation: 0, mirrored: false };
const RELATIVE: Arrangement = Arrangement { sense: SenseOrder::Relative, rotation: 0, mirrored: false };

/// Measured frames of a file with its key.
fn frames(name_and_key: &str) -> Option<Frames> {
    frames_in("real", name_and_key)
}

/// Frames of a file with its key; `None`, and says so, where the file is absent.
fn frames_in(folder: &str, name_and_key: &str) -> Option<Frames> {
    let folder = format!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/{}"), folder);
    let (name, _) = name_and_key.split_once(':').unwrap();
    if !Path::new(&folder).join(name).exists() {
        println!("not run: {name} is absent");
        return None;
    }
    Some(read(&Source::new(&OsString::from(format!("{folder}/{name_and_key}")))).unwrap())
}

/// Point electrodes on a homogeneous unit disc: potential -ln(r) / pi round each, with its current.
fn disc_voltage(step: &Step) -> f64 {
    let distance = |a: u8, b: u8| (std::f64::consts::PI * f64::from(a.abs_diff(b)) / 16.0).sin();
    let [p, q, a, b] = step.to_bytes();
    (distance(a, q) * distance(b, p) / (distance(a, p) * distance(b, q))).ln() / std::f64::consts::PI
}

fn check(reference: &[Complex64], drive_distance: u8, used: Arrangement) -> Diagnosis {
    let steps: Vec<_> = pattern(16, drive_distance, 1).collect();
    let voltages: Vec<_> = steps.iter().map(disc_voltage).collect();
    diagnose(&steps, 16, &voltages, reference, used).unwrap()
}

#[test]
fn canonical_tank_data_resemble_a_disc_and_only_in_canonical_order() {
    for (name, shape) in [
        ("iirc_2006.npz:v_ref", (1, 208)),
        ("iirc_2006.npz:v_ref_256", (1, 256)),
        ("ottawa_2005_planeA.npz:vvRef", (1, 208)),
        ("sciospec_tank_adjacent.npz:v", (255, 208)),
    ] {
        let Some(frames) = frames(name) else { continue };
        assert_eq!((frames.frames, frames.measurements), shape, "{name}");
        let diagnosis = check(&frames.mean(), 1, PLAIN);
        assert!(diagnosis.correlation > 0.97, "{name}: {}", diagnosis.correlation);
        assert!(diagnosis.warnings().is_empty(), "{name}: {:?}", diagnosis.warnings());
        let wrong = check(&frames.mean(), 1, RELATIVE);
        assert_eq!(wrong.best, PLAIN, "{name}");
        assert!(wrong.warnings()[0].contains("leave out --order relative"), "{name}");
    }
}

#[test]
fn the_hydrogel_skins_magnitudes_are_nothing_like_a_disc_and_the_user_is_told() {
    let Some(frames) = frames("hydrogel_skin_wam.npz:v_unpressed") else { return };
    assert_eq!((frames.frames, frames.measurements), (400, 192));
    let diagnosis = check(&frames.mean(), 8, PLAIN);
    assert!(diagnosis.magnitudes_only);
    assert!(diagnosis.warnings()[0].contains("only weakly"), "{:?}", diagnosis.warnings());
}

#[test]
fn the_carbon_black_skin_is_read_as_full_squares() {
    let Some(frames) = frames("black_sensor_ert_skin.npz:expX_150mm_8p5wt_7") else { return };
    assert_eq!((frames.frames, frames.measurements), (69, 256));
    let diagnosis = check(&frames.mean(), 1, PLAIN);
    // Raw converter counts with an offset: the U-shape is there, squeezed.
    assert!((0.7..0.9).contains(&diagnosis.correlation), "{}", diagnosis.correlation);
    assert_eq!(diagnosis.best, PLAIN);
}

#[test]
fn a_rod_in_a_tank_is_found_where_eidors_shows_it() {
    let (Some(reference), Some(moving)) = (frames("iirc_2006.npz:v_ref"), frames("iirc_2006.npz:v_rotate"))
    else {
        return;
    };
    let Some(skin) = EidorsDisc::load() else { return };
    let results = skin.reconstruct(&reference, &moving);
    if let Some(path) = std::env::var_os("DERMATOME_SHEET") {
        std::fs::write(path, skin.sheet(&results)).unwrap();
    }
    // Read off EIDORS' pictures of these frames, as shares of the radius.
    for (frame, [x, y]) in [
        (0, [0.22, 0.46]),
        (12, [0.27, -0.38]),
        (25, [-0.51, 0.17]),
        (37, [0.38, 0.35]),
        (50, [-0.33, -0.36]),
        (62, [-0.32, 0.37]),
        (75, [0.51, -0.11]),
        (87, [-0.41, -0.35]),
    ] {
        let object = results[frame].objects[0];
        let error = (object.x_mm / 1e3 - x).hypot(object.y_mm / 1e3 - y);
        println!("frame {frame}: {error:.3} of the radius away");
        assert!(error < 0.1, "frame {frame}: {object:?}");
        assert_eq!(results[frame].polarity, Polarity::Down, "the rod insulates");
    }
}

/// EIDORS' one-step matrix for a unit disc, sampled on a pixel grid.
struct EidorsDisc {
    voltages: Vec<f64>,
    geometry: Geometry,
    /// `[pixel][step]`
    conductivity_from_difference: Vec<Vec<f64>>,
}

impl EidorsDisc {
    fn load() -> Option<Self> {
        let array = |key: &str| {
            let real = |frames: Frames| -> Vec<Vec<f64>> {
                frames.iter().map(|row| row.iter().map(|value| value.re).collect()).collect()
            };
            frames_in("reference", &format!("c2c_pem.npz:{key}")).map(real)
        };
        let (nodes, elements, rows) = (array("nodes")?, array("elems")?, array("RM_laplace_n0")?);
        let geometry = unit_disc(32);
        let element_at = |cell| {
            let point = centre(&geometry.grid, cell);
            elements.iter().position(|element| {
                let corners: Vec<_> =
                    element.iter().map(|node| nodes[*node as usize - 1].as_slice()).collect();
                contains(&corners, point)
            })
        };
        // The polygon of the mesh lies a little inside the disc: pixels beyond stay 0.
        let row = |cell| element_at(cell).map_or(vec![0.0; 208], |element| rows[element].clone());
        let conductivity_from_difference = pixel_cells(&geometry.mask).map(row).collect();
        Some(Self { voltages: array("vh")?.concat(), geometry, conductivity_from_difference })
    }

    fn reconstruct(&self, reference: &Frames, frames: &Frames) -> Vec<FrameResult> {
        let steps: Vec<_> = pattern(16, 1, 1).collect();
        let product = |row: &Vec<f64>, dv: &[f64]| row.iter().zip(dv).map(|(r, v)| r * v).sum();
        let matrix =
            |dv: &[f64]| self.conductivity_from_difference.iter().map(|row| product(row, dv)).collect();
        let model = Model {
            steps: &steps,
            electrodes: 16,
            voltages: &self.voltages,
            geometry: self.geometry.clone(),
            rim: &[],
            matrix: &matrix,
        };
        reconstruct(&model, reference, frames, &PLAIN, Polarity::Auto).unwrap()
    }

    fn sheet(&self, results: &[FrameResult]) -> Vec<u8> {
        let angle = |k: u8| std::f64::consts::PI * (0.5 - f64::from(k) / 8.0);
        let rim: Vec<_> = (0..16).map(|k| [angle(k).cos(), angle(k).sin()]).collect();
        let panel = |result: &'_ FrameResult| Panel {
            caption: vec![format!("frame {}", result.frame)],
            values: &[],
            found: result.objects.iter().map(|object| [object.x_mm / 1e3, object.y_mm / 1e3]).collect(),
            truth: vec![],
        };
        let shown = evenly_spaced(results.len(), 10);
        let panels =
            shown.iter().map(|&index| Panel { values: &results[index].image, ..panel(&results[index]) });
        let (title, panels) = ("iirc_2006.npz:v_rotate", panels.collect());
        let sheet = Sheet { title, geometry: &self.geometry, electrodes: &rim, panels };
        reconstruction_sheet(&sheet).encode().unwrap()
    }
}

/// Whether a triangle of either orientation contains a point.
fn contains(corners: &[&[f64]], [x, y]: [f64; 2]) -> bool {
    let side = |a: &[f64], b: &[f64]| (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
    let sides = [(0, 1), (1, 2), (2, 0)].map(|(a, b)| side(corners[a], corners[b]));
    sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0)
}

fn unit_disc(side: u8) -> Geometry {
    let grid = PixelGrid { columns: side, rows: side, pitch: 2.0 / f32::from(side), left: -1.0, top: 1.0 };
    let mut mask = vec![0_u8; grid.mask_bytes()];
    for cell in 0..grid.cells() {
        let [x, y] = centre(&grid, cell);
        if x.hypot(y) < 1.0 {
            mask[cell / 8] |= 1 << (cell % 8);
        }
    }
    Geometry { grid, mask: mask.into_iter().collect() }
}

fn centre(grid: &PixelGrid, cell: usize) -> [f64; 2] {
    let columns = usize::from(grid.columns);
    grid.position((cell % columns) as f32 + 0.5, (cell / columns) as f32 + 0.5).map(f64::from)
}
