use super::*;
use crate::mesh::{
    import::{Format, parse},
    soundness::require_sound,
};
use nalgebra::Rotation3;
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

/// Triangles of a surface over a grid that closes round in the first direction: `rows` rings of `around`.
fn rings(rows: usize, around: usize, at: impl Fn(f64, f64) -> Point3<f64>) -> Vec<[Point3<f64>; 3]> {
    let node = |i: usize, j: usize| at(TAU * (j % around) as f64 / around as f64, i as f64 / rows as f64);
    let quads = (0..rows).flat_map(|i| (0..around).map(move |j| (i, j)));
    quads
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [node(i, j), node(i, j + 1), node(i + 1, j + 1), node(i + 1, j)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

/// A link as an STL file holds it: no triangle shares a vertex.
fn link(triangles: &[[Point3<f64>; 3]]) -> Imported {
    let mut bytes = vec![0; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for corners in triangles {
        bytes.extend([0; 12]);
        corners.iter().flat_map(|it| it.iter()).for_each(|it| bytes.extend((*it as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    parse(Format::Stl, &bytes, None).unwrap()
}

/// A ball with bumps, in metres; triangles get narrow towards its poles.
fn ball(radius: f64, bump: f64, centre: Vector3<f64>, fineness: usize) -> Vec<[Point3<f64>; 3]> {
    rings(fineness, 2 * fineness, |longitude, share| {
        let latitude = PI * (share.powf(1.3) - 0.5);
        let size = radius * (1.0 + bump * (3.0 * longitude).sin() * (4.0 * latitude).cos() * latitude.cos());
        let unit =
            Vector3::new(latitude.cos() * longitude.cos(), latitude.cos() * longitude.sin(), latitude.sin());
        Point3::from(size * unit + centre)
    })
}

fn disc(around: [f64; 3], radius: f64) -> Request {
    Request {
        around: around.into(),
        region: Region::Disc { radius },
        up: None,
        electrodes: 16,
        width: None,
        edge_length: None,
    }
}

/// Area and boundary of a good cutout, after all that must hold of one is checked.
fn checked(patch: &Cutout) -> (f64, f64) {
    let Mesh { nodes, elements, electrodes } = &patch.mesh;
    let found = require_sound(nodes, elements, false).unwrap();
    assert_eq!((found.boundary_loops.len(), found.flipped), (1, 0));
    let quality = crate::mesh::quality::quality(&patch.mesh);
    assert!(quality.smallest_angle_degrees > 15.0, "{quality:?}");
    assert!(quality.longest_edge < 2.0 * patch.edge_length, "{quality:?}");
    let pitch = patch.boundary / electrodes.len() as f64;
    for (i, contact) in electrodes.iter().enumerate() {
        let width = patch.mesh.width(contact);
        assert!((width / patch.width - 1.0).abs() < 0.02, "electrode {i}: {width} of {}", patch.width);
        let next = patch.mesh.centre(&electrodes[(i + 1) % electrodes.len()]);
        assert!((patch.mesh.centre(contact) - next).norm() < 1.01 * pitch, "electrode {i}");
    }
    (quality.area, patch.boundary)
}

#[test]
fn a_disc_on_a_ball_has_the_area_and_boundary_of_a_cap() {
    let radius = 0.05;
    let link = link(&ball(radius, 0.0, Vector3::zeros(), 60));
    let patch = cut(&link, &disc([radius, 0.0, 0.0], 0.06)).unwrap();
    let (area, boundary) = checked(&patch);
    let angle = 0.06 / radius;
    assert!((area / (TAU * radius * radius * (1.0 - angle.cos())) - 1.0).abs() < 0.01, "{area}");
    assert!((boundary / (TAU * radius * angle.sin()) - 1.0).abs() < 0.01, "{boundary}");
    assert!(!patch.flat && patch.deviation < 2e-4, "{}", patch.deviation);
    // Electrode 1 at the top, electrode 5 to the right as seen from outside.
    let [first, fifth] = [0, 4].map(|i| patch.mesh.centre(&patch.mesh.electrodes[i]));
    assert!(first.y > 0.04 && first.x.abs() < 0.003, "{first}");
    assert!(fifth.x > 0.04 && fifth.y.abs() < 0.003, "{fifth}");
    assert!((patch.link_from_skin * Vector3::y() - Vector3::z()).norm() < 0.02);
    let on_link = patch.mesh.nodes.iter().map(|node| (patch.link_from_skin * node).coords.norm());
    assert!(on_link.clone().all(|it| (it / radius - 1.0).abs() < 2e-3));
}

#[test]
fn a_disc_on_strips_a_hundred_times_as_long_as_wide_is_a_disc() {
    let tube = rings(1, 64, |angle, share| Point3::new(0.04 * angle.cos(), 0.04 * angle.sin(), 0.3 * share));
    let (area, boundary) = checked(&cut(&link(&tube), &disc([0.04, 0.0, 0.15], 0.05)).unwrap());
    assert!((area / (PI * 0.05 * 0.05) - 1.0).abs() < 0.005, "{area}");
    assert!((boundary / (TAU * 0.05) - 1.0).abs() < 0.005, "{boundary}");
}

/// A tube as CAD writes it: triangles as long as its rows.
fn tube(rows: usize, around: usize, turn: &Rotation3<f64>) -> Imported {
    let at =
        |angle: f64, share: f64| Point3::new(0.04 * angle.cos(), 0.04 * angle.sin(), 0.3 * (share - 0.5));
    let turned = rings(rows, around, at).into_iter().map(|corners| corners.map(|it| turn * it));
    link(&turned.collect::<Vec<_>>())
}

#[test]
fn slivers_hundreds_of_times_as_long_as_wide_do_not_become_slivers_of_their_own_shape() {
    let turn = Rotation3::from_euler_angles(0.4, -0.7, 1.1);
    let around = turn * Point3::new(0.04, 0.0, 0.01);
    for (rows, sides, most) in [(1, 400, 40_000), (1, 2500, 100_000), (3, 1000, 60_000)] {
        let request = disc(around.coords.into(), 0.03);
        let crop = shell::crop(&tube(rows, sides, &turn), around, |_, _| true).unwrap();
        let (even, _) = even_triangles(crop.surface, &request.region, crop.seed);
        // Nodes that have gone since the last level keep their number, so this counts the last splits, too.
        let made = even.points.len();
        assert!(made < most, "{rows} x {sides}: {made}");
        let (area, boundary) = checked(&cut(&tube(rows, sides, &turn), &request).unwrap());
        assert!((area / (PI * 0.03 * 0.03) - 1.0).abs() < 0.005, "{area}");
        assert!((boundary / (TAU * 0.03) - 1.0).abs() < 0.005, "{boundary}");
    }
}

#[test]
fn planes_and_polygons_cut_where_they_are() {
    let tube =
        link(&rings(40, 96, |angle, share| Point3::new(0.04 * angle.cos(), 0.04 * angle.sin(), 0.3 * share)));
    let half: f64 = 0.02;
    let slabs = [Slab::new(Vector3::z(), 0.1, 0.2), Slab::new(Vector3::y() * 3.0, -half, half)];
    let region = Region::Slabs(slabs.map(Result::unwrap).to_vec());
    let between = cut(&tube, &Request { region, ..disc([0.04, 0.0, 0.15], 0.0) }).unwrap();
    let whole = 0.1 * 2.0 * 0.04 * (half / 0.04).asin();
    let (area, _) = checked(&between);
    assert!((area / whole - 1.0).abs() < 0.01, "{area} {whole}");
    let corners = [[0.1, -half, 0.1], [0.1, half, 0.1], [0.1, half, 0.2], [0.1, -half, 0.2]];
    let region = Region::Polygon(Cutter::new(&corners.map(Point3::from)).unwrap());
    let (area, _) = checked(&cut(&tube, &Request { region, ..disc([0.04, 0.0, 0.15], 0.0) }).unwrap());
    assert!((area / whole - 1.0).abs() < 0.01, "{area} {whole}");
}

#[test]
fn a_patch_of_a_plate_is_flat_however_the_plate_lies() {
    let turn = Rotation3::from_euler_angles(0.4, -0.7, 1.1);
    let plate = ball(0.1, 0.0, Vector3::zeros(), 20).into_iter();
    let plate: Vec<_> = plate.map(|corners| corners.map(|it| turn * Point3::new(it.x, it.y, 0.3))).collect();
    // The ball pressed flat lies double; one side is enough.
    let link = link(&plate[..plate.len() / 2]);
    let patch = cut(&link, &disc((turn * Point3::new(0.01, 0.0, 0.3)).coords.into(), 0.04)).unwrap();
    let (area, _) = checked(&patch);
    assert!(patch.flat && (area / (PI * 0.04 * 0.04) - 1.0).abs() < 0.003, "{area}");
    assert!(patch.mesh.nodes.iter().all(|node| node.z == 0.0));
}

#[test]
fn what_cannot_be_a_patch_is_refused_with_what_is_allowed() {
    let tube =
        link(&rings(60, 96, |angle, share| Point3::new(0.04 * angle.cos(), 0.04 * angle.sin(), 0.6 * share)));
    let middle = [0.04, 0.0, 0.3];
    let closed = link(&ball(0.05, 0.0, Vector3::zeros(), 30));
    let slab = |from, to| Region::Slabs(vec![Slab::new(Vector3::z(), from, to).unwrap()]);
    let wanted = |change: fn(&mut Request)| {
        let mut request = disc(middle, 0.05);
        change(&mut request);
        request
    };
    let cases: [(&Imported, Request, &[&str]); 13] = [
        (&tube, disc(middle, 0.15), &["no disc", "wraps round", "`radius` up to about 12"]),
        (&tube, disc([0.04, 0.0, 0.55], 0.1), &["an opening", "a radius below 50.", "`weld`"]),
        // Both ends are openings; the nearer one counts.
        (&tube, disc([0.04, 0.0, 0.1], 0.55), &["an opening", "a radius below 100."]),
        (&tube, disc([0.04, 0.0, 0.5], 0.55), &["an opening", "a radius below 100."]),
        (&tube, disc([0.3, 0.0, 0.3], 0.1), &["`around`", "260.0", "`unit`"]),
        (&tube, disc(middle, f64::NAN), &["`radius`", "above zero"]),
        (&closed, disc([0.05, 0.0, 0.0], 0.3), &["all of the link"]),
        (&tube, Request { region: slab(0.7, 0.8), ..disc(middle, 0.0) }, &["misses the link", "600.000 mm"]),
        (&tube, Request { region: slab(0.4, 0.5), ..disc(middle, 0.0) }, &["outside `between_planes`"]),
        (
            &tube,
            Request { region: slab(0.2, 0.4), ..disc(middle, 0.0) },
            &["wraps round", "one boundary", "a second `between_planes`"],
        ),
        (&tube, wanted(|it| it.edge_length = Some(0.004)), &["`edge_length`", "two edges"]),
        (&tube, wanted(|it| it.width = Some(0.02)), &["`width`", "mm to 17."]),
        (&tube, wanted(|it| it.electrodes = 3), &["`electrodes`", "4 to 250"]),
    ];
    for (link, request, expected) in cases {
        let error = cut(link, &request).err().map(|error| error.to_string()).unwrap_or_default();
        for part in expected {
            assert!(error.contains(part), "{part:?} is not in {error:?}");
        }
    }
}

/// A bumpy ball, with an inner wall, a screw far away, and some triangles twice; one in three the other way round if
/// `reversed`.
fn bumpy_link(bump: f64, fineness: usize, reversed: bool) -> Imported {
    let mut triangles = ball(0.05, bump, Vector3::zeros(), fineness);
    triangles.extend(ball(0.04, 0.0, Vector3::zeros(), 12).into_iter().map(|[a, b, c]| [a, c, b]));
    triangles.extend(ball(0.004, 0.0, Vector3::new(0.1, 0.1, 0.0), 8));
    let turned = |i: usize| i.is_multiple_of(3) && reversed;
    let mixed = triangles.iter().enumerate();
    let mut mixed: Vec<_> =
        mixed.map(|(i, &[a, b, c])| if turned(i) { [a, c, b] } else { [a, b, c] }).collect();
    mixed.extend_from_within(..10);
    link(&mixed)
}

#[test]
fn a_sliver_between_nodes_of_the_boundary_is_flipped_though_it_has_no_clear_side() {
    let link = bumpy_link(0.08782501693451428, 30, true);
    let direction = Vector3::<f64>::new(-0.28677156574292223, -0.5965708985334383, 0.4835590090436574);
    let request = Request { electrodes: 14, ..disc((0.05 * direction.normalize()).into(), 0.02) };
    checked(&cut(&link, &request).unwrap());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]
    #[test]
    fn patches_of_bumpy_links_of_several_shells_are_good(
        bump in 0.0..0.12_f64,
        direction in prop::array::uniform3(-1.0..1.0_f64).prop_filter("no direction", |it| Vector3::from(*it).norm() > 0.2),
        radius in 0.02..0.05_f64,
        fineness in 20..70_usize,
        electrodes in 6..24_usize,
        reversed in any::<bool>(),
    ) {
        let link = bumpy_link(bump, fineness, reversed);
        let around = 0.05 * Vector3::from(direction).normalize();
        let request = Request { electrodes, ..disc(around.into(), radius) };
        let patch = cut(&link, &request).map_err(|error| TestCaseError::fail(error.to_string()))?;
        let (area, boundary) = checked(&patch);
        prop_assert_eq!(patch.shells, 3);
        prop_assert!(area > 0.5 * PI * radius * radius && boundary < 1.5 * TAU * radius, "{area} {boundary}");
        prop_assert!(patch.deviation < 0.05 * radius, "{}", patch.deviation);
        let top = patch.link_from_skin * Vector3::z();
        prop_assert!(top.dot(&around) > 0.0, "z points out of the link");
    }
}
