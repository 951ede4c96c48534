//! A skin cut out of a robot-like link by the command, and taken through the rest of the program.
#![cfg(unix)]

mod program;

use dermatome::{mesh::soundness::require_sound, skin::Skin};
use nalgebra::{Point3, Vector3};
use program::{Desk, transcript};
use std::f64::consts::TAU;

type Triangle = [Point3<f64>; 3];

/// A bent tube that narrows, mm: unevenly spaced rings, with a cap at either end.
fn tube(rings: usize, around: usize, radii: [f64; 2]) -> Vec<Triangle> {
    let (length, bend) = (260.0, 0.6);
    let axis = |share: f64| {
        let angle = bend * share;
        let centre = Vector3::new(1.0 - angle.cos(), 0.0, angle.sin()) * (length / bend);
        (Point3::from(centre), Vector3::new(angle.cos(), 0.0, -angle.sin()))
    };
    let at = |i: usize, j: usize| {
        let share = (i as f64 / rings as f64).powf(1.5);
        let turn = TAU * (j % around) as f64 / around as f64;
        let turn = turn + 0.4 * turn.sin();
        let (centre, across) = axis(share);
        let radius = radii[0] + (radii[1] - radii[0]) * share;
        centre + (across * turn.cos() + Vector3::y() * turn.sin()) * radius
    };
    let mut triangles = Vec::new();
    for j in 0..around {
        for i in 0..rings {
            triangles.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
        }
        triangles.push([axis(0.0).0, at(0, j + 1), at(0, j)]);
        triangles.push([axis(1.0).0, at(rings, j), at(rings, j + 1)]);
    }
    triangles
}

/// A box of twelve large triangles.
fn block(low: [f64; 3], high: [f64; 3]) -> Vec<Triangle> {
    let corner = |i: usize| {
        Point3::from([0, 1, 2].map(|axis| if i >> axis & 1 == 1 { high[axis] } else { low[axis] }))
    };
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).map(|corners| corners.map(corner)).collect()
}

/// More than 50,000 triangles in several shells, and vertices of their own for each: outer and inner wall,
/// a flange and bolts.
fn robot_link() -> Vec<u8> {
    let mut triangles = tube(120, 220, [55.0, 38.0]);
    triangles.extend(tube(30, 60, [45.0, 30.0]).into_iter().map(|[a, b, c]| [a, c, b]));
    triangles.extend(block([-80.0, -80.0, -12.0], [80.0, 80.0, -2.0]));
    (0..4).for_each(|k| {
        let y = 60.0 - 40.0 * f64::from(k);
        triangles.extend(block([60.0, y, -2.0], [66.0, y + 6.0, 4.0]));
    });
    assert!(triangles.len() > 50_000);
    stl(&triangles)
}

fn stl(triangles: &[Triangle]) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for corners in triangles {
        bytes.extend([0; 12]);
        corners.iter().flat_map(|it| it.iter()).for_each(|it| bytes.extend((*it as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn a_patch_of_a_robot_link_becomes_a_skin_with_a_model() {
    let desk = Desk::empty();
    desk.write("forearm.stl", robot_link());
    let arguments = ["cut", "forearm.stl", "--unit", "mm", "--around", "-45,0,110", "--radius", "40"];
    let more = ["--edge-length", "1.9", "--out", "skin", "--json", "cut.json"];
    let done = desk.run(&[&arguments[..], &more].concat()).success();
    assert_eq!(done.err, "");
    let report = desk.report("cut.json");
    let number = |keys: &[&str]| keys.iter().fold(&report, |value, key| &value[*key]).as_f64().unwrap();
    assert_eq!(report["link"]["shells"], 7);
    assert!(number(&["mesh", "smallest_angle_degrees"]) > 18.0, "{}", done.out);
    assert!(number(&["median_smallest_angle_degrees"]) > 45.0, "{}", done.out);
    assert!((number(&["rim_mm"]) / (40.0 * TAU) - 1.0).abs() < 0.03, "{}", done.out);
    assert!(number(&["deviation_mm"]) < 0.1, "{}", done.out);

    let skin = Skin::load(&desk.path("skin/skin.toml")).unwrap().made().unwrap();
    let dermatome::skin::Shape::Mesh { mesh, .. } = &skin.shape else { panic!("no mesh") };
    require_sound(&mesh.nodes, &mesh.elements, false).unwrap();
    // On the link's outer wall, in the link's frame.
    let pose = skin.pose.as_ref().unwrap();
    assert_eq!(pose.link, "forearm");
    let origin = Point3::from(pose.point([0.0; 3]));
    assert!((origin - Point3::new(-0.0367, 0.0, 0.1074)).norm() < 2e-3, "{origin}");
    let outward = Vector3::from(pose.direction([0.0, 0.0, 1.0]));
    assert!(outward.x < -0.9, "{outward}");

    let built = desk.run(&["build", "skin/skin.toml", "--no-patch"]).success();
    assert!(built.out.contains("16 electrodes, rank 104"), "{}", built.out);
    let evaluated = desk.run(&["evaluate", "skin/skin.toml", "--spacing", "30%"]).success();
    assert!(evaluated.out.contains("contacts found in the voltages"), "{}", evaluated.out);
}

/// A cut of a plate that is right but for what is changed.
fn cut<'a>(changes: &[(&str, &'a str)]) -> Vec<&'a str> {
    let mut options = vec![("--unit", "mm"), ("--around", "0,0,70"), ("--radius", "45"), ("--out", "new")];
    for &(option, value) in changes {
        options.retain(|(other, _)| *other != option);
        if !value.is_empty() {
            options.push((Box::leak(option.to_owned().into_boxed_str()), value));
        }
    }
    ["cut", "plate.stl"]
        .into_iter()
        .chain(options.into_iter().flat_map(|(option, value)| [option, value]))
        .collect()
}

#[test]
fn a_flat_patch_goes_to_a_board_and_is_not_overwritten() {
    let desk = Desk::empty();
    desk.write("plate.stl", stl(&block([-50.0, -60.0, -70.0], [50.0, 60.0, 70.0])));
    let done = desk.run(&cut(&[])).success();
    let mut settings = insta::Settings::clone_current();
    settings.set_omit_expression(true);
    settings.add_filter(r"\d+\.\d ms", "[TIME] ms");
    settings.add_filter(r"\d+ elements, \d+ nodes", "[COUNT] elements, [COUNT] nodes");
    settings.add_filter(r"\d\.\d{3} to \d\.\d{3} mm found", "[EDGES] mm found");
    settings.add_filter(r"\d+\.\d degrees", "[ANGLE] degrees");
    settings.bind(|| insta::assert_snapshot!("cut", done.out));
    desk.run(&["build", "new/skin.toml", "-o", "flat.dermatome"]).success();
    let before = desk.read("new/skin.toml");
    let refused = desk.run(&cut(&[("--radius", "30")])).refused();
    assert!(refused.contains("new/skin.toml") && refused.contains("--force"), "{refused}");
    assert_eq!(desk.read("new/skin.toml"), before);
    desk.run(&[&cut(&[("--radius", "30")])[..], &["--overwrite"]].concat()).success();
    assert_ne!(desk.read("new/skin.toml"), before);
}

#[test]
fn errors_of_cut() {
    let desk = Desk::empty();
    desk.write("plate.stl", stl(&block([-50.0, -60.0, -70.0], [50.0, 60.0, 70.0])));
    desk.write("empty.stl", stl(&[]));
    desk.write("nan.stl", stl(&[[Point3::new(f64::NAN, 0.0, 0.0), Point3::origin(), Point3::origin()]]));
    let planes = |text| cut(&[("--radius", ""), ("--between-planes", text)]);
    let polygon = |text| cut(&[("--radius", ""), ("--polygon", text)]);
    let swap = |file| cut(&[]).into_iter().map(|it| if it == "plate.stl" { file } else { it }).collect();
    let cases: Vec<Vec<&str>> = vec![
        swap("missing.stl"),
        swap("empty.stl"),
        swap("nan.stl"),
        cut(&[("--unit", "yard")]),
        cut(&[("--unit", "m"), ("--around", "0,0,1m")]),
        cut(&[("--around", "0,0,300")]),
        cut(&[("--around", "0,0")]),
        cut(&[("--around", "0,nan,0")]),
        cut(&[("--radius", "-3")]),
        cut(&[("--radius", "3 kg")]),
        cut(&[("--radius", "1000")]),
        cut(&[("--radius", "")]),
        cut(&[("--polygon", "0,0,0 1,0,0 0,1,0")]),
        polygon("-20,-20,70 20,20,70 20,-20,70 -20,25,70"),
        polygon("-20,-20,70 20,20,70"),
        planes("0,0,1,300,400"),
        planes("0,0,1,0,50"),
        planes("0,0,0,0,50"),
        planes("0,0,1,50,0"),
        cut(&[("--radius", ""), ("--around", "50,0,0"), ("--between-planes", "0,0,1,-20,20")]),
        cut(&[("--edge-length", "5")]),
        cut(&[("--width", "20")]),
        cut(&[("--electrodes", "2")]),
        cut(&[("--up", "0,0,1")]),
        cut(&[("--frame", "the forearm")]),
        cut(&[("--name", "a skin")]),
    ];
    let commands: Vec<&[&str]> = cases.iter().map(Vec::as_slice).collect();
    let words = transcript(&desk, &commands);
    let mut settings = insta::Settings::clone_current();
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!("errors_cut", words));
    assert!(!desk.path("new").exists(), "nothing is written");
}
