//! One first-order triangle, laid flat by its edge lengths, so that flat sheets and surfaces in
//! space are one code path (thesis equations 2.3 and 5.6 to 5.11; the sign of equation 5.10 is
//! misprinted there: df1/dx = -1/a2).

use nalgebra::{Point3, Vector2, Vector3};

/// Gradients of the three shape functions in the triangle's own plane, times the square root of
/// its area: `[axis][corner]`.
///
/// Row products give the local admittance of unit conductivity, K = G' G: the factor is stored
/// because fields and Jacobian both want it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gradients(pub [[f64; 3]; 2]);

impl Gradients {
    /// Gradients of the triangle with these corners.
    ///
    /// In the plane: corner 0 at (0, 0), corner 1 at (a, 0), corner 2 at (b, c) with c > 0
    /// whatever the orientation.
    #[must_use]
    pub fn of(corners: [Point3<f64>; 3]) -> Self {
        let base = corners[1] - corners[0];
        let side = corners[2] - corners[0];
        let a = base.norm();
        let b = side.dot(&base) / a;
        let c = base.cross(&side).norm() / a;
        // Twice the area is a c; dividing the rows by 2 area / sqrt(area):
        let scale = 1.0 / (2.0 * a * c).sqrt();
        Self([[-c * scale, c * scale, 0.0], [(b - a) * scale, -b * scale, a * scale]])
    }

    /// Local admittance at unit conductivity between corners `i` and `j`, S.
    #[must_use]
    pub fn admittance(&self, i: usize, j: usize) -> f64 {
        self.0[0][i] * self.0[0][j] + self.0[1][i] * self.0[1][j]
    }

    /// Gradient of the field with these corner values, times the square root of the area.
    #[must_use]
    pub fn of_field(&self, values: [f64; 3]) -> [f64; 2] {
        self.0.map(|row| row[0] * values[0] + row[1] * values[1] + row[2] * values[2])
    }
}

/// Area of a triangle in space.
#[must_use]
pub fn area(corners: [Point3<f64>; 3]) -> f64 {
    (corners[1] - corners[0]).cross(&(corners[2] - corners[0])).norm() / 2.0
}

/// Centre of gravity of a triangle.
#[must_use]
pub fn centroid([a, b, c]: [Point3<f64>; 3]) -> Point3<f64> {
    Point3::from((a.coords + b.coords + c.coords) / 3.0)
}

/// Unit normal of a triangle; zero for one without area.
#[must_use]
pub fn normal([a, b, c]: [Point3<f64>; 3]) -> Vector3<f64> {
    (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default()
}

/// Smallest angle of a triangle, rad.
#[must_use]
pub fn smallest_angle(corners: [Point3<f64>; 3]) -> f64 {
    let angle_at = |i: usize| {
        let (u, v) = (corners[(i + 1) % 3] - corners[i], corners[(i + 2) % 3] - corners[i]);
        u.cross(&v).norm().atan2(u.dot(&v))
    };
    (0..3).map(angle_at).fold(f64::INFINITY, f64::min)
}

/// The point of a triangle at x, y, if it has one.
#[must_use]
pub fn point_above([a, b, c]: [Point3<f64>; 3], [x, y]: [f64; 2]) -> Option<Point3<f64>> {
    let (u, v) = ((b - a).xy(), (c - a).xy());
    let to = Vector2::new(x - a.x, y - a.y);
    let area = u.perp(&v);
    let (s, t) = (to.perp(&v) / area, u.perp(&to) / area);
    let inside = s >= -1e-9 && t >= -1e-9 && s + t <= 1.0 + 1e-9;
    inside.then(|| a + (b - a) * s + (c - a) * t)
}

/// The point of a triangle that is nearest to a point (Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
#[must_use]
pub fn nearest([a, b, c]: [Point3<f64>; 3], p: Point3<f64>) -> Point3<f64> {
    let (ab, ac, bc) = (b - a, c - a, c - b);
    let (d1, d2) = (ab.dot(&(p - a)), ac.dot(&(p - a)));
    let (d3, d4) = (ab.dot(&(p - b)), ac.dot(&(p - b)));
    let (d5, d6) = (ab.dot(&(p - c)), ac.dot(&(p - c)));
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    if d1 <= 0.0 && d2 <= 0.0 {
        a
    } else if d3 >= 0.0 && d4 <= d3 {
        b
    } else if d6 >= 0.0 && d5 <= d6 {
        c
    } else if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        a + ab * (d1 / (d1 - d3))
    } else if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        a + ac * (d2 / (d2 - d6))
    } else if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        b + bc * ((d4 - d3) / ((d4 - d3) + (d5 - d6)))
    } else {
        a + ab * (vb / (va + vb + vc)) + ac * (vc / (va + vb + vc))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;
    use proptest::prelude::*;

    fn admittance(corners: [Point3<f64>; 3]) -> [f64; 9] {
        let gradients = Gradients::of(corners);
        std::array::from_fn(|k| gradients.admittance(k / 3, k % 3))
    }

    #[test]
    fn right_triangle_has_the_textbook_admittance() {
        let corners = [Point3::origin(), Point3::new(2.0, 0.0, 0.0), Point3::new(0.0, 2.0, 0.0)];
        let expected = [1.0, -0.5, -0.5, -0.5, 0.5, 0.0, -0.5, 0.0, 0.5];
        for (got, want) in admittance(corners).iter().zip(expected) {
            assert!((got - want).abs() < 1e-15);
        }
    }

    fn corners() -> impl Strategy<Value = [Point3<f64>; 3]> {
        let point = || prop::array::uniform3(-1.0..1.0_f64).prop_map(Point3::from);
        [point(), point(), point()].prop_filter("not a sliver", |corners| smallest_angle(*corners) > 0.05)
    }

    proptest! {
        #[test]
        fn nothing_of_a_triangle_is_nearer_than_its_nearest_point(
            corners in corners(),
            place in prop::array::uniform3(-2.0..2.0_f64),
        ) {
            let ([a, b, c], place) = (corners, Point3::from(place));
            let found = nearest(corners, place);
            let away = (found - place).norm();
            for i in 0..=24 {
                for j in 0..=24 - i {
                    let (s, t) = (f64::from(i) / 24.0, f64::from(j) / 24.0);
                    let other = a + (b - a) * s + (c - a) * t;
                    prop_assert!((other - place).norm() > away - 1e-9, "{} {}", other, found);
                }
            }
            // It is a point of the triangle: the areas round it add up to no more than the whole.
            let parts: f64 = [[a, b, found], [b, c, found], [c, a, found]].map(area).into_iter().sum();
            prop_assert!(parts < area(corners) * (1.0 + 1e-9) + 1e-12);
        }

        #[test]
        fn neither_orientation_nor_pose_nor_size_matters(
            corners in corners(),
            axis in prop::array::uniform3(-3.0..3.0_f64),
            size in 0.01..100.0,
        ) {
            let original = admittance(corners);
            let [p, q, r] = corners;
            let turned = admittance([p, r, q]);
            let swap = [0, 2, 1];
            let rotation = Rotation3::new(Vector3::from(axis));
            let moved = admittance(corners.map(|p| (rotation * p) * size + Vector3::new(1.0, 2.0, 3.0)));
            for k in 0..9 {
                prop_assert!((original[k] - turned[swap[k / 3] * 3 + swap[k % 3]]).abs() < 1e-9 * original[k].abs().max(1.0));
                prop_assert!((original[k] - moved[k]).abs() < 1e-8 * original[k].abs().max(1.0));
            }
        }
    }
}
