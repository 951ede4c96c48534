use super::*;
use proptest::prelude::*;

fn points(corners: &[[f64; 2]]) -> Vec<Point2<f64>> {
    corners.iter().copied().map(Point2::from).collect()
}

/// An L, seen from within its corner.
fn angle_iron() -> Outline {
    let corners = [[-1.0, -1.0], [2.0, -1.0], [2.0, 1.0], [1.0, 1.0], [1.0, 0.5], [-1.0, 0.5]];
    Outline::polygon(&points(&corners), &[]).unwrap()
}

/// A square with a square hole, far from the origin.
fn frame() -> Outline {
    let rim = points(&[[5.0, 5.0], [9.0, 5.0], [9.0, 9.0], [5.0, 9.0]]);
    let hole = points(&[[6.0, 6.0], [6.0, 8.0], [8.0, 8.0], [8.0, 6.0]]);
    Outline::polygon(&rim, &[hole]).unwrap()
}

fn round() -> impl Strategy<Value = Outline> {
    prop_oneof![
        (0.01..1.0).prop_map(Outline::disc),
        (0.01..1.0, 0.01..1.0).prop_map(|(width, height)| Outline::rectangle(width, height)),
        (0.1..1.0, 0.1..1.0).prop_map(|(width, height)| Outline::ellipse(width, height)),
    ]
}

fn outlines() -> impl Strategy<Value = Outline> {
    prop_oneof![
        round(),
        (0.0..0.8, 0.3..6.0).prop_map(|(inner, angle)| Outline::sector(inner, 1.0, angle)),
        Just(Outline::sector(0.0, 1.0, 2.0)),
        Just(angle_iron()),
        Just(frame()),
    ]
}

proptest! {
    #[test]
    fn a_ray_meets_the_rim_where_its_arc_length_says(outline in round(), angle in 0.0..TAU) {
        let point = outline.rim_point(outline.rim_position(angle));
        prop_assert!(outline.depth(point).abs() < 1e-12);
        let turn = (point.y.atan2(point.x) - angle).rem_euclid(TAU);
        prop_assert!(turn.min(TAU - turn) < 1e-9);
    }

    #[test]
    fn arc_length_is_the_length_walked(outline in outlines(), s in 0.0..20.0) {
        let step = 1e-4 * outline.perimeter();
        let [a, b, c] = [s - step, s, s + step].map(|s| outline.rim_point(s));
        let bends = outline.corners().iter().any(|corner| {
            let ahead = (corner - s).rem_euclid(outline.perimeter());
            ahead < step || ahead > outline.perimeter() - step
        });
        let walked = (c - b).norm() + (b - a).norm();
        prop_assert!(bends || (walked / (2.0 * step) - 1.0).abs() < 1e-4, "{}", walked / step);
    }

    #[test]
    fn a_point_of_the_rim_is_its_own_nearest(outline in outlines(), share in 0.0..1.0) {
        let s = share * outline.perimeter();
        let foot = outline.rim().nearest(outline.rim_point(s));
        prop_assert!(foot.distance < 1e-12 * outline.diameter());
        let off = (foot.arc_length - s).abs();
        prop_assert!(off.min(outline.perimeter() - off) < 1e-9 * outline.perimeter());
    }

    /// Depth is a distance: it changes by no more than one moves, and it is right or left by sign.
    #[test]
    fn depth_is_the_distance_to_the_rim(outline in outlines(), u in -1.2..1.2, v in -1.2..1.2) {
        let [x, y] = outline.half_size();
        let point = outline.middle() + nalgebra::Vector2::new(u * x, v * y);
        let depth = outline.depth(point);
        let samples = (0..4000).map(|i| f64::from(i) / 4000.0 * outline.perimeter());
        let to_rim = samples.map(|s| (outline.rim_point(s) - point).norm()).fold(f64::INFINITY, f64::min);
        let slack = outline.perimeter() / 4000.0;
        let to_rim = outline.holes().iter().map(|hole| hole.nearest(point).distance).fold(to_rim, f64::min);
        prop_assert!((depth.abs() - to_rim).abs() < slack, "{depth} against {to_rim}");
        let winding = winding(outline.rim(), point);
        let in_hole = outline.holes().iter().any(|hole| winding_is_one(hole, point));
        prop_assert!(depth.abs() < slack || (depth > 0.0) == (winding && !in_hole));
    }
}

fn winding(curve: &Curve, point: Point2<f64>) -> bool {
    winding_is_one(curve, point)
}

/// By adding up the angles under which 4,000 steps of the curve are seen.
fn winding_is_one(curve: &Curve, point: Point2<f64>) -> bool {
    let seen = |i: u32| curve.point(f64::from(i) / 4000.0 * curve.length()) - point;
    let turn: f64 = (0..4000).map(|i| seen(i).perp(&seen(i + 1)).atan2(seen(i).dot(&seen(i + 1)))).sum();
    turn.abs() > 3.0
}

#[test]
fn areas_and_lengths_are_those_of_the_closed_forms() {
    let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} against {b}");
    close(Outline::disc(2.0).area(), 2.0 * TAU);
    close(Outline::rectangle(2.0, 3.0).area(), 6.0);
    close(Outline::ellipse(2.0, 6.0).area(), 3.0 * TAU / 2.0);
    // 4 a E(e^2) with a = 3 and e^2 = 8/9, from tables of elliptic integrals.
    close(Outline::ellipse(2.0, 6.0).perimeter(), 13.364_893_220_555_26);
    close(Outline::sector(1.0, 2.0, 1.5).area(), 1.5 / 2.0 * 3.0);
    close(Outline::sector(1.0, 2.0, 5.0).perimeter(), 5.0 * 3.0 + 2.0);
    close(Outline::sector(0.0, 2.0, 5.0).area(), 5.0 / 2.0 * 4.0);
    close(angle_iron().area(), 3.0 + 1.5 + 0.5);
    close(frame().area(), 12.0);
}

#[test]
fn what_lies_left_of_a_disc_at_the_height_of_its_middle_is_off_it() {
    let disc = Curve::circle(Point2::origin(), 0.105);
    // Rounding puts points of a lattice a hair below the middle.
    for x in [-0.2, -0.1051, -0.1049, -0.05, 0.05, 0.1049, 0.1051_f64] {
        assert_eq!(disc.encloses(Point2::new(x, -1e-18)), x.abs() < 0.105, "{x}");
    }
}

#[test]
fn arc_length_starts_where_the_x_axis_leaves_the_sheet() {
    let start = |outline: &Outline| outline.rim_point(0.0);
    assert!((start(&Outline::disc(2.0)) - Point2::new(2.0, 0.0)).norm() < 1e-15);
    assert!((start(&Outline::rectangle(2.0, 3.0)) - Point2::new(1.0, 0.0)).norm() < 1e-15);
    assert!((start(&angle_iron()) - Point2::new(2.0, 0.0)).norm() < 1e-15);
    // The origin lies outside: seen from the middle of the box.
    assert!((start(&frame()) - Point2::new(9.0, 7.0)).norm() < 1e-15);
    let corners = Outline::rectangle(2.0, 3.0).corners();
    let expected = [1.5, 3.5, 6.5, 8.5];
    assert!(corners.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{corners:?}");
}

/// A C that opens to the right: the ray from its middle to the right meets nothing.
#[test]
fn a_ray_that_misses_the_sheet_gives_the_corner_closest_to_it() {
    let corners =
        [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [3.0, 2.0], [3.0, 3.0], [0.0, 3.0]];
    let outline = Outline::polygon(&points(&corners), &[]).unwrap();
    let first = outline.rim_point(outline.rim_position(0.0));
    assert_eq!([first.x, (first.y - 1.5).abs()], [3.0, 0.5]);
    let left = outline.rim_point(outline.rim_position(TAU / 2.0));
    assert!((left - Point2::new(0.0, 1.5)).norm() < 1e-12);
}

#[test]
fn a_polygon_reads_the_same_either_way_round() {
    let corners = points(&[[0.0, -1.0], [2.0, 1.0], [-2.0, 1.0]]);
    let backwards: Vec<_> = corners.iter().rev().copied().collect();
    let [one, other] = [corners, backwards].map(|corners| Outline::polygon(&corners, &[]).unwrap());
    for s in [0.0, 1.0, 3.0, 7.0] {
        assert!((one.rim_point(s) - other.rim_point(s)).norm() < 1e-12);
    }
}

#[test]
fn points_that_are_no_polygon_are_refused_by_row() {
    let square: &[[f64; 2]] = &[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
    let big: &[[f64; 2]] = &[[1.0, 1.0], [3.0, 1.0], [3.0, 3.0], [1.0, 3.0]];
    let refused = |rim: &[[f64; 2]], holes: &[&[[f64; 2]]]| {
        let holes: Vec<_> = holes.iter().map(|hole| points(hole)).collect();
        Outline::polygon(&points(rim), &holes).unwrap_err().to_string()
    };
    let rims: [(&[[f64; 2]], &str); 6] = [
        (&square[..2], "the rim has 2 corners"),
        (&[[0.0, 0.0], [1.0, f64::NAN], [1.0, 1.0]], "row 2 of the rim is not a number"),
        (&[[0.0, 0.0], [4.0, 4.0], [4.0, 0.0], [0.0, 4.0]], "rows 1 and 3 cross"),
        (&[[0.0, 0.0], [0.0, 0.0], [4.0, 0.0], [4.0, 4.0]], "row 1 of the rim touches the side"),
        (&[[0.0, 0.0], [2.0, 0.0], [4.0, 0.0]], "touches the side"),
        (
            &[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 0.0]],
            "row 4 of the rim touches the side of the rim that starts at row 1",
        ),
    ];
    for (rim, expected) in rims {
        let message = refused(rim, &[]);
        assert!(message.contains(expected), "{expected:?} is not in {message:?}");
    }
    let holes: [(&[&[[f64; 2]]], &str); 5] = [
        (&[&square[..2]], "hole 1 has 2 corners"),
        (&[&[[1.0, 1.0], [5.0, 1.0], [1.0, 2.0]]], "the sides of hole 1 and of the rim"),
        (&[&[[5.0, 5.0], [6.0, 5.0], [5.0, 6.0]]], "hole 1 does not lie on the sheet"),
        (&[&[[0.0, 1.0], [1.0, 1.0], [1.0, 2.0]]], "row 1 of hole 1 touches the side of the rim"),
        (&[big, &[[1.5, 1.5], [2.0, 1.5], [2.0, 2.0]]], "hole 2 does not lie on the sheet"),
    ];
    for (holes, expected) in holes {
        let message = refused(square, holes);
        assert!(message.contains(expected), "{expected:?} is not in {message:?}");
    }
}
