//! The frame of a cutout: where a skin lies on its link.

use super::{
    error::CutError,
    surface::{Surface, vector_area},
};
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};

/// Below this sine of the angle between two directions none of them is up for the other.
const PARALLEL: f64 = 0.1;

/// Takes points of the cutout to points of the link. The origin is the seed, z is the cutout's mean outward
/// normal, and y is `up` laid into the cutout; without it the link's z, or its y where that points out.
pub(super) fn frame(
    piece: &Surface,
    seed: Point3<f64>,
    up: Option<Vector3<f64>>,
) -> Result<Isometry3<f64>, CutError> {
    let sum: Vector3<f64> = piece.faces().map(|face| vector_area(piece.corners(face))).sum();
    // Nearly closed cutouts have no mean normal.
    let normal = sum.try_normalize(1e-3 * piece.area()).unwrap_or_else(|| normal_at(piece, seed));
    let across = |up: Vector3<f64>| {
        let up = up.try_normalize(0.0).filter(|up| up.iter().all(|it| it.is_finite()))?;
        up.cross(&normal).try_normalize(PARALLEL)
    };
    let x = match up {
        Some(asked) => across(asked).ok_or_else(|| CutError::Value {
            option: "up",
            value: format!("{}, {}, {}", asked.x, asked.y, asked.z),
            allowed: format!(
                "a direction more than 6 degrees from the patch's normal ({:.3}, {:.3}, {:.3})",
                normal.x, normal.y, normal.z
            ),
        })?,
        None => across(Vector3::z()).or_else(|| across(Vector3::y())).unwrap_or_else(Vector3::x),
    };
    let axes = Matrix3::from_columns(&[x, normal.cross(&x), normal]);
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
    Ok(Isometry3::from_parts(Translation3::from(seed.coords), rotation))
}

fn normal_at(piece: &Surface, seed: Point3<f64>) -> Vector3<f64> {
    let face = super::clip::closest_face(piece, seed);
    let normal = face.and_then(|face| vector_area(piece.corners(face)).try_normalize(0.0));
    normal.unwrap_or_else(Vector3::z)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangle facing along x.
    fn facing_x() -> Surface {
        let points = [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0]].map(Point3::from);
        Surface::new(points.to_vec(), vec![[0, 1, 2]])
    }

    #[test]
    fn z_points_out_of_the_link_and_y_up() {
        let seed = Point3::new(1.0, 0.2, 0.3);
        let frame = frame(&facing_x(), seed, None).unwrap();
        assert!((frame * Point3::origin() - seed).norm() < 1e-12);
        assert!((frame * Vector3::z() - Vector3::x()).norm() < 1e-12);
        assert!((frame * Vector3::y() - Vector3::z()).norm() < 1e-12);
        let tilted = super::frame(&facing_x(), seed, Some(Vector3::new(5.0, 1.0, 0.0))).unwrap();
        assert!((tilted * Vector3::y() - Vector3::y()).norm() < 1e-12);
    }

    #[test]
    fn up_must_not_point_out_of_the_patch() {
        let error = frame(&facing_x(), Point3::origin(), Some(Vector3::x())).unwrap_err().to_string();
        assert!(error.contains("`up`") && error.contains("normal (1.000, 0.000, 0.000)"), "{error}");
    }
}
