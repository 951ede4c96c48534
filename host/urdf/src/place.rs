//! Places as descriptions write them: roll, pitch and yaw about fixed axes in URDF, a quaternion in MJCF.

use dermatome_patch::pose::Pose;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

/// Finest step of a coordinate, m, and of an angle, rad: a thousandth of what anybody measures.
const STEP: f64 = 1e-9;

/// Takes points of the skin's frame to the link's.
#[must_use]
pub fn link_from_skin(pose: &Pose) -> Isometry3<f64> {
    let [x, y, z, w] = pose.orientation;
    let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    Isometry3::from_parts(Translation3::from(pose.position), turn)
}

/// Numbers with spaces between.
pub(crate) fn numbers(values: impl IntoIterator<Item = f64>) -> String {
    values.into_iter().map(number).collect::<Vec<_>>().join(" ")
}

/// A number to the finest step, never `-0`.
pub(crate) fn number(value: f64) -> String {
    let rounded = (value / STEP).round() * STEP;
    let text = format!("{rounded:.9}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

/// `xyz` and `rpy` of a URDF's `origin`.
pub(crate) fn xyz_rpy(place: &Isometry3<f64>) -> [String; 2] {
    [numbers(place.translation.vector.iter().copied()), numbers(roll_pitch_yaw(place.rotation))]
}

/// Exact where the pitch is a right angle as well, near which `nalgebra`'s own are off by 1e-4: there any yaw will do, as
/// long as the roll goes with it.
fn roll_pitch_yaw(turn: UnitQuaternion<f64>) -> [f64; 3] {
    let turn = turn.to_rotation_matrix();
    let at = |row, column| turn[(row, column)];
    let pitch = (-at(2, 0)).atan2(at(0, 0).hypot(at(1, 0)));
    let yaw: f64 = at(1, 0).atan2(at(0, 0));
    let (sin, cos) = yaw.sin_cos();
    let roll = (sin * at(0, 2) - cos * at(1, 2)).atan2(cos * at(1, 1) - sin * at(0, 1));
    [roll, pitch, yaw]
}

/// The place that `xyz` and `rpy` give.
pub(crate) fn of_xyz_rpy(xyz: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Isometry3::from_parts(Translation3::from(Vector3::from(xyz)), turn)
}

/// `pos` and `quat` (w first) of a body in MJCF.
pub(crate) fn pos_quat(place: &Isometry3<f64>) -> [String; 2] {
    let turn = place.rotation;
    [numbers(place.translation.vector.iter().copied()), numbers([turn.w, turn.i, turn.j, turn.k])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn what_is_written_leads_back_to_the_same_place_at_every_attitude() {
        let steps: Vec<f64> =
            (-4..=4).map(|i| f64::from(i) * PI / 4.0).chain([0.3, FRAC_PI_2 - 1e-7]).collect();
        for &roll in &steps {
            for &pitch in &steps {
                for &yaw in &steps {
                    let place = of_xyz_rpy([0.1, -0.02, 1e-4], [roll, pitch, yaw]);
                    let read = |text: &str| -> [f64; 3] {
                        let values: Vec<f64> = text.split(' ').map(|it| it.parse().unwrap()).collect();
                        values.try_into().unwrap()
                    };
                    let [xyz, rpy] = xyz_rpy(&place);
                    let back = of_xyz_rpy(read(&xyz), read(&rpy));
                    assert!(place.rotation.angle_to(&back.rotation) < 1e-8, "{roll} {pitch} {yaw}: {rpy}");
                    assert!((place.translation.vector - back.translation.vector).amax() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn numbers_are_short_and_have_no_minus_zero() {
        assert_eq!(
            numbers([0.0, -0.0, 1.0, -1e-12, 0.1 + 0.2, 1e-9, -120.5]),
            "0 0 1 0 0.3 0.000000001 -120.5"
        );
    }
}
