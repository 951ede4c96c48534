//! Pose: where a skin lies on a robot.

use dermatome_shared::contact::Contact;
use nalgebra::{Isometry3, Point3, Vector3};

/// Where a skin lies on a robot's link.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Name of the link's frame, as the robot's description calls it.
    pub link: String,
    /// Takes points and directions of the skin's frame to the link's, m.
    pub link_from_skin: Isometry3<f64>,
}

impl Pose {
    /// A contact of the skin's frame in the link's: its position and its normal; the rest stays.
    #[must_use]
    pub fn contact(&self, contact: &Contact) -> Contact {
        let position = self.link_from_skin * Point3::from(contact.position.map(f64::from));
        let normal = self.link_from_skin * Vector3::from(contact.normal.map(f64::from));
        let narrow = |values: Vector3<f64>| values.map(|value| value as f32).into();
        Contact { position: narrow(position.coords), normal: narrow(normal), ..*contact }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Translation3, UnitQuaternion};
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn a_contact_is_turned_and_then_moved_and_its_normal_only_turned() {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2);
        let link_from_skin = Isometry3::from_parts(Translation3::new(1.0, 2.0, 3.0), turn);
        let pose = Pose { link: "forearm".to_owned(), link_from_skin };
        let contact = Contact {
            position: [0.1, 0.02, 0.003],
            normal: [0.0, 0.6, 0.8],
            area: 4e-6,
            strength: 0.5,
            peak: 1.0,
            pressure: Some(2e3),
            load_area: Some(1e-6),
        };
        // A quarter turn about x takes y to z, and z to -y.
        let found = pose.contact(&contact);
        let is_near = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(is_near(found.position, [1.1, 1.997, 3.02]), "{found:?}");
        assert!(is_near(found.normal, [0.0, -0.8, 0.6]), "{found:?}");
        assert_eq!(Contact { position: contact.position, normal: contact.normal, ..found }, contact);
    }
}
