//! Where nodes lie.

use super::{child, numbers, wrong};
use crate::mesh::import::Problem;
use nalgebra::{Matrix3, Matrix4, Rotation3, Unit, Vector3};
use roxmltree::Node;

/// Turns the file's axes so that z is up and y points away from the viewer, by the specification's table of
/// `<up_axis>`.
pub(super) fn z_up(asset: Node) -> Result<Matrix4<f64>, Problem> {
    let Some(axis) = child(asset, "up_axis") else { return Ok(y_up()) };
    match axis.text().unwrap_or_default().trim() {
        "Z_UP" => Ok(Matrix4::identity()),
        "Y_UP" => Ok(y_up()),
        "X_UP" => Ok(Matrix3::new(0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0).to_homogeneous()),
        other => Err(wrong(axis, "<up_axis>", other, "X_UP, Y_UP or Z_UP")),
    }
}

/// What the specification takes where a file says nothing.
fn y_up() -> Matrix4<f64> {
    Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0).to_homogeneous()
}

/// A node's transforms, multiplied in the order in which they stand.
pub(super) fn of(node: Node) -> Result<Matrix4<f64>, Problem> {
    let mut placed = Matrix4::identity();
    for part in node.children().filter(Node::is_element) {
        placed *= match part.tag_name().name() {
            "matrix" => matrix(part)?,
            "translate" => Matrix4::new_translation(&triple(part, "<translate>")?),
            "scale" => Matrix4::new_nonuniform_scaling(&triple(part, "<scale>")?),
            "rotate" => rotation(part)?,
            unknown @ ("lookat" | "skew") => {
                return Err(wrong(part, "a node's transform", unknown, "matrix, translate, rotate or scale"));
            }
            _ => continue,
        };
    }
    Ok(placed)
}

fn matrix(part: Node) -> Result<Matrix4<f64>, Problem> {
    let matrix = Matrix4::from_row_slice(&numbers(part, "<matrix>", 16)?);
    let last = [matrix[(3, 0)], matrix[(3, 1)], matrix[(3, 2)], matrix[(3, 3)]];
    if last == [0.0, 0.0, 0.0, 1.0] {
        return Ok(matrix);
    }
    Err(wrong(part, "the last row of <matrix>", &format!("{last:?}"), "0 0 0 1"))
}

fn rotation(part: Node) -> Result<Matrix4<f64>, Problem> {
    let [x, y, z, degrees] = numbers(part, "<rotate>", 4)?.try_into().unwrap_or_default();
    let axis = Unit::try_new(Vector3::new(x, y, z), 1e-12);
    let axis = axis.ok_or_else(|| wrong(part, "the axis of <rotate>", "0 0 0", "a direction"))?;
    Ok(Rotation3::from_axis_angle(&axis, degrees.to_radians()).to_homogeneous())
}

fn triple(part: Node, field: &'static str) -> Result<Vector3<f64>, Problem> {
    Ok(Vector3::from_row_slice(&numbers(part, field, 3)?))
}
