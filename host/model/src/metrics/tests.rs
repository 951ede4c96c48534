use super::{
    parts::{Part, parts},
    *,
};
use crate::pixels::grid;
use dermatome_shared::{
    contact,
    image::{Geometry, pixel_cells},
};
use proptest::prelude::*;
use std::f64::consts::PI;

/// Pixels of equal area at these places.
fn pixels_at(places: &[[f64; 3]], area: f64) -> Pixels {
    Pixels {
        elements: vec![Vec::new(); places.len()],
        neighbours: Vec::new(),
        centres: places.iter().map(|&place| Point3::from(place)).collect(),
        normals: vec![Vector3::z(); places.len()],
        areas: vec![area; places.len()],
        grid: None,
    }
}

/// Pixels of a board's grid on a disc, with their neighbours.
fn board_disc(radius: f64, columns: u8) -> Pixels {
    let geometry = grid(&dermatome_geometry::outline::Outline::disc(radius), columns);
    let places = cells(&geometry);
    let pitch = f64::from(geometry.grid.pitch);
    let close =
        |&[a, b]: &[usize; 2]| (places[a][0] - places[b][0]).hypot(places[a][1] - places[b][1]) < 1.1 * pitch;
    let pairs = (0..places.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
    let neighbours = pairs.filter(close).collect();
    Pixels { neighbours, grid: Some(geometry), ..pixels_at(&places, pitch * pitch) }
}

/// Square pixels of a disc of radius 1, as many across as no board has.
fn fine_disc(columns: u32) -> Pixels {
    let pitch = 2.0 / f64::from(columns);
    let at = |index: u32| (f64::from(index) + 0.5) * pitch - 1.0;
    let places = (0..columns).flat_map(|row| (0..columns).map(move |column| [at(column), at(row), 0.0]));
    let places: Vec<_> = places.filter(|[x, y, _]| x * x + y * y < 1.0).collect();
    pixels_at(&places, pitch * pitch)
}

fn cells(geometry: &Geometry) -> Vec<[f64; 3]> {
    let columns = usize::from(geometry.grid.columns);
    let place = |cell: usize| {
        let place = geometry.grid.position((cell % columns) as f32 + 0.5, (cell / columns) as f32 + 0.5);
        [f64::from(place[0]), f64::from(place[1]), 0.0]
    };
    pixel_cells(&geometry.mask).map(place).collect()
}

fn image_of(pixels: &Pixels, value: impl Fn(Point3<f64>) -> f64) -> Vec<f64> {
    pixels.centres.iter().map(|&centre| value(centre)).collect()
}

fn target(x: f64, y: f64, amount: f64) -> Target {
    Target { position: Point3::new(x, y, 0.0), amount, skin_centre: Point3::origin() }
}

fn assert_close(got: f64, expected: f64, tolerance: f64) {
    assert!((got - expected).abs() <= tolerance, "{got} is not {expected}");
}

#[test]
fn figures_of_a_boards_hand_made_image() {
    let image: Vec<_> = [8, 4, 2, 1, -1, 0, 0, 0].map(|v| RelativeConductivity(v << 10)).to_vec();
    let figures = image_figures(&image, RelativeConductivity(1)).unwrap();
    assert_close(figures.resolution, (2.0_f64 / 8.0).sqrt(), 1e-12);
    assert_close(figures.ringing, 1.0 / 12.0, 1e-12);
    assert_eq!(image_figures(&image, RelativeConductivity(9 << 10)), None);
}

/// Five by five points from -1 to 1, of which EIDORS keeps the 13 with x^2 + y^2 < 1.1, and its area of
/// a pixel, 2 * 2 / 25. Values elsewhere are zero.
fn hand_made() -> (Pixels, Vec<f64>) {
    let steps = [-1.0, -0.5, 0.0, 0.5, 1.0];
    let places = steps.iter().flat_map(|&y| steps.iter().map(move |&x| [x, y, 0.0]));
    let places: Vec<_> = places.filter(|[x, y, _]| x * x + y * y < 1.1).collect();
    let values = [
        ([0.5, 0.0], 8.0),
        ([0.0, 0.0], 4.0),
        ([0.5, 0.5], 2.0),
        ([0.5, -0.5], 2.0),
        ([1.0, 0.0], 1.9),
        ([-1.0, 0.0], -1.0),
        ([0.0, 1.0], -0.5),
    ];
    let value_at = |place: &[f64; 3]| {
        values.iter().find(|(at, _)| at[..] == place[..2]).map_or(0.0, |(_, value)| *value)
    };
    let image = places.iter().map(value_at).collect();
    (pixels_at(&places, 4.0 / 25.0), image)
}

#[test]
fn greit_figures_are_those_worked_out_by_hand_from_eidors_code() {
    let (pixels, image) = hand_made();
    assert_eq!(image.len(), 13);
    let figures = greit::figures(&image, &pixels, &target(0.5, 0.0, 0.16)).unwrap();
    // The set: 8, 4, 2, 2; a quarter of the peak belongs to it. Centre: (3 * 0.5 + 0) / 4.
    assert_eq!(figures.centre, Point3::new(0.375, 0.0, 0.0));
    assert_close(figures.position_error, 0.125, 1e-15);
    assert_close(figures.resolution, (4.0_f64 / 13.0).sqrt(), 1e-15);
    // Circle: r^2 = 4 * 0.16 / pi = 0.204; the 2s are 0.266 away.
    assert_close(figures.shape_deformation, 0.5, 1e-15);
    assert_close(figures.ringing_of_set, 1.5 / 16.0, 1e-15);
    assert_close(figures.ringing.unwrap(), 1.5 / 12.0, 1e-15);
    assert_close(figures.amplitude, 0.16 * 16.4, 1e-15);
    assert_close(figures.amplitude_response, 16.4, 1e-13);
}

#[test]
fn thesis_figures_of_the_same_image_leave_the_quarter_out_and_weigh_the_centre() {
    let (pixels, image) = hand_made();
    let figures = thesis::figures(&image, &pixels, &target(0.0, -0.5, 1.0)).unwrap();
    // The region: 8, 4. Centre: (8 * 0.5 + 4 * 0) / 12.
    assert_close(figures.centre.x, 1.0 / 3.0, 1e-15);
    assert_close(figures.position_error, 0.5 - 1.0 / 3.0, 1e-15);
    assert_close(figures.resolution, (2.0_f64 / 13.0).sqrt(), 1e-15);
    assert_close(figures.ringing, 1.5 / 12.0, 1e-15);
    assert_close(figures.strength, 6.0, 1e-14);
}

#[test]
fn a_gaussian_blob_has_the_figures_of_its_closed_form() {
    let pixels = fine_disc(200);
    let (width, x, y) = (0.1_f64, 0.3, -0.2);
    let image =
        image_of(&pixels, |p| (-((p.x - x).powi(2) + (p.y - y).powi(2)) / (2.0 * width * width)).exp());
    let target = target(x, y, PI * width * width);
    let quarter_radius = width * (2.0 * 4_f64.ln()).sqrt();
    let thesis = thesis::figures(&image, &pixels, &target).unwrap();
    let greit = greit::figures(&image, &pixels, &target).unwrap();
    assert_close(thesis.resolution, quarter_radius, 1e-3);
    assert_close(greit.resolution, quarter_radius, 1e-3);
    assert_close(thesis.position_error, 0.0, 1e-4);
    assert_close(greit.position_error, 0.0, 1e-3);
    // Mean of exp(-r^2 / 2 w^2) inside the radius at which it is a quarter.
    assert_close(thesis.strength, 0.75 / 4_f64.ln(), 2e-3);
    assert_close(greit.amplitude_response, 2.0, 1e-3);
    assert!(greit.shape_deformation < 0.02, "{greit:?}");
    assert_eq!((thesis.ringing, greit.ringing), (0.0, Some(0.0)));
}

#[test]
fn a_disc_with_a_trough_round_it_rings_by_the_ratio_of_their_volumes() {
    let pixels = fine_disc(200);
    // Height 1 to radius 0.2; depth 0.1 from there to 0.4.
    let image = image_of(&pixels, |p| match p.coords.norm() {
        r if r < 0.2 => 1.0,
        r if r < 0.4 => -0.1,
        _ => 0.0,
    });
    let expected = 0.1 * (0.16 - 0.04) / 0.04;
    let target = target(0.0, 0.0, PI * 0.04);
    let greit = greit::figures(&image, &pixels, &target).unwrap();
    assert_close(thesis::figures(&image, &pixels, &target).unwrap().ringing, expected, 5e-3);
    assert_close(greit.ringing_of_set, expected, 5e-3);
    assert_close(greit.ringing.unwrap(), expected, 2e-2);
    assert_close(greit.amplitude_response, 1.0 - expected, 1e-2);
}

#[test]
fn a_ring_lies_wholly_outside_its_circle_and_has_no_ringing_by_the_paper() {
    let pixels = fine_disc(100);
    let image = image_of(&pixels, |p| if (0.5..0.6).contains(&p.coords.norm()) { 1.0 } else { -0.01 });
    let figures = greit::figures(&image, &pixels, &target(0.0, 0.0, 1.0)).unwrap();
    // The circle's radius is sqrt(0.36 - 0.25) = 0.33: all of it lies in the hole.
    assert_close(figures.shape_deformation, 1.0, 0.0);
    assert_eq!(figures.ringing, None);
    assert_close(figures.resolution, 0.11_f64.sqrt(), 3e-3);
    assert_close(figures.position_error, 0.0, 1e-6);
}

#[test]
fn larger_pixels_weigh_more() {
    let mut pixels = pixels_at(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], 1.0);
    pixels.areas[1] = 3.0;
    let image = [1.0, 1.0, -0.5];
    let target = target(0.0, 0.0, 2.0);
    let (thesis, greit) = (
        thesis::figures(&image, &pixels, &target).unwrap(),
        greit::figures(&image, &pixels, &target).unwrap(),
    );
    assert_eq!((thesis.centre.x, greit.centre.x), (0.75, 0.75));
    assert_close(thesis.resolution, 0.8_f64.sqrt(), 1e-15);
    assert_close(greit.ringing_of_set, 0.125, 1e-15);
    assert_close(greit.amplitude_response, 3.5 / 2.0, 1e-15);
}

#[test]
fn on_a_sphere_the_centre_lies_on_the_surface() {
    // Rings of pixels round the pole, whose plain mean lies 0.02 beneath it.
    let places: Vec<_> = [0.0, 0.1, 0.2, 0.3, 0.4_f64]
        .into_iter()
        .flat_map(|tilt| (0..12).map(move |k| (tilt, f64::from(k) * PI / 6.0)))
        .map(|(tilt, turn)| [tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), tilt.cos()])
        .collect();
    let mut pixels = pixels_at(&places, 1.0);
    pixels.normals = pixels.centres.iter().map(|centre| centre.coords).collect();
    let image = image_of(&pixels, |p| if p.z > 0.3_f64.cos() - 1e-9 { 1.0 } else { 0.0 });
    let pole = Target { position: Point3::new(0.0, 0.0, 1.0), amount: 1.0, skin_centre: Point3::origin() };
    let figures = greit::figures(&image, &pixels, &pole).unwrap();
    assert!((figures.centre - pole.position).norm() < 1e-12, "{figures:?}");
    assert_close(figures.position_error, 0.0, 1e-12);
}

#[test]
fn an_image_that_shows_nothing_has_no_figures() {
    let pixels = board_disc(1.0, 4);
    let count = pixels.count();
    for image in [vec![0.0; count], vec![-1.0; count], vec![f64::NAN; count], vec![f64::INFINITY; count]] {
        assert_eq!(greit::figures(&image, &pixels, &target(0.0, 0.0, 1.0)), None);
        assert_eq!(thesis::figures(&image, &pixels, &target(0.0, 0.0, 1.0)), None);
        assert_eq!(parts(&image, &pixels, 0.0), []);
    }
}

#[test]
fn relative_voltage_change_is_the_mean_of_the_ratios_and_leaves_dead_ones_out() {
    let change = thesis::relative_voltage_change(&[1.1, -1.8, 0.5], &[1.0, -2.0, 0.0]);
    assert_close(change, (0.1 - 0.1) / 2.0, 1e-15);
    let change = thesis::relative_voltage_change(&[0.9, -1.8], &[1.0, -2.0]);
    assert_close(change, -0.1, 1e-15);
    assert_eq!(thesis::relative_voltage_change(&[], &[]), 0.0);
}

#[test]
fn mean_and_largest_of_nothing_do_not_exist() {
    assert_eq!(mean_and_max([].into_iter()), None);
    assert_eq!(mean_and_max([1.0, 3.0].into_iter()), Some((2.0, 3.0)));
}

/// GREIT's figures another way: counting pixels of equal size in a table, as a script would.
fn counted(image: &[f64], places: &[[f64; 3]], pixel: f64, at: [f64; 2]) -> [f64; 6] {
    let largest = image.iter().copied().fold(f64::MIN, f64::max);
    let inside = |value: f64| u8::from(value >= 0.25 * largest);
    let count: f64 = image.iter().map(|&value| f64::from(inside(value))).sum();
    let mean = |axis: usize| {
        image.iter().zip(places).map(|(&v, place)| f64::from(inside(v)) * place[axis]).sum::<f64>() / count
    };
    let (x, y) = (mean(0), mean(1));
    let mut outside_circle = 0.0;
    let (mut in_circle, mut opposite, mut in_set, mut opposite_of_set) = (0.0, 0.0, 0.0, 0.0);
    for (&value, place) in image.iter().zip(places) {
        let far = (place[0] - x).powi(2) + (place[1] - y).powi(2) >= pixel * count / PI;
        outside_circle += f64::from(u8::from(far) * inside(value));
        *if far { &mut opposite } else { &mut in_circle } += if far { (-value).max(0.0) } else { value };
        if inside(value) == 1 { in_set += value } else { opposite_of_set += (-value).max(0.0) }
    }
    [
        at[0].hypot(at[1]) - x.hypot(y),
        (count / image.len() as f64).sqrt(),
        outside_circle / count,
        opposite / in_circle,
        opposite_of_set / in_set,
        image.iter().sum::<f64>() * pixel,
    ]
}

proptest! {
    #[test]
    fn greit_figures_agree_with_counting_pixels(
        values in prop::collection::vec(-1.0..1.0_f64, 64),
        at in prop::array::uniform2(-0.5..0.5_f64),
    ) {
        let pixels = board_disc(1.0, 8);
        let image = &values[..pixels.count()];
        let places: Vec<[f64; 3]> = pixels.centres.iter().map(|centre| centre.coords.into()).collect();
        let expected = counted(image, &places, pixels.areas[0], at);
        let figures = greit::figures(image, &pixels, &target(at[0], at[1], 2.0)).unwrap();
        let got = [
            figures.position_error,
            figures.resolution,
            figures.shape_deformation,
            figures.ringing.unwrap_or(expected[3]),
            figures.ringing_of_set,
            figures.amplitude,
        ];
        for (got, expected) in got.iter().zip(expected) {
            prop_assert!((got - expected).abs() < 1e-9 * expected.abs().max(1.0), "{got} {expected}");
        }
        prop_assert!((figures.amplitude_response - figures.amplitude / 2.0).abs() < 1e-12);
    }

    #[test]
    fn parts_are_the_contacts_that_a_board_finds(values in prop::collection::vec(-50_i32..100, 64)) {
        let pixels = board_disc(0.1, 8);
        let tables = pixels.surface_tables().unwrap();
        let codes: Vec<_> =
            values[..pixels.count()].iter().map(|&v| RelativeConductivity(v * 10_000)).collect();
        let image: Vec<f64> = codes.iter().map(|code| code.to_f64()).collect();
        let threshold = RelativeConductivity(500_000);
        let contacts = contact::find(&tables.view(), &codes, threshold);
        let parts = parts(&image, &pixels, threshold.to_f64());
        // A board may find several contacts in a part, and leaves none out that is nearly as strong as the strongest.
        let strong = parts.iter().filter(|part| part.peak > 0.75 * parts[0].peak).count();
        prop_assert!(contacts.len() >= strong.min(dermatome_shared::MAX_CONTACTS));
        let peaks = (contacts.first().map(|contact| f64::from(contact.peak)), parts.first().map(|part| part.peak));
        if let (Some(contact), Some(part)) = peaks {
            prop_assert!((contact - part).abs() < 1e-6);
        }
        // Of equal peaks either may come first, and a board may divide a part, or leave a weak one out.
        let is_whole = |(contact, part): (&contact::Contact, &Part)| {
            (f64::from(contact.area) / part.area - 1.0).abs() < 1e-5
                && (f64::from(contact.peak) - part.peak).abs() < 1e-6
        };
        if parts.windows(2).all(|pair| pair[0].peak > pair[1].peak)
            && contacts.iter().zip(&parts).all(is_whole)
        {
            for (contact, part) in contacts.iter().zip(&parts) {
                let [x, y] = contact.from_above();
                prop_assert!((part.centre - Point3::new(x, y, 0.0)).norm() < 1e-6);
            }
        }
    }
}
