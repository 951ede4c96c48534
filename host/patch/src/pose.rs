//! Pose: where a skin lies on a robot.

use dermatome_shared::{contact::Contact, track::Identity};

/// Where a skin lies on a robot's link: points of its frame are turned, then moved into the link's.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Name of the link's frame, as the robot's description calls it.
    pub link: String,
    /// The skin's origin in the link's frame, m.
    pub position: [f64; 3],
    /// Turn from the skin's frame to the link's, a unit quaternion x, y, z, w.
    pub orientation: [f64; 4],
}

impl Pose {
    /// A point of the skin's frame in the link's, m.
    #[must_use]
    pub fn point(&self, point: [f64; 3]) -> [f64; 3] {
        let turned = self.direction(point);
        [0, 1, 2].map(|axis| turned[axis] + self.position[axis])
    }

    /// A direction of the skin's frame in the link's.
    #[must_use]
    pub fn direction(&self, direction: [f64; 3]) -> [f64; 3] {
        // v + w t + q x t with t = 2 q x v, for a unit quaternion of vector q and scalar w.
        let [x, y, z, w] = self.orientation;
        let twice = cross([x, y, z], direction).map(|value| 2.0 * value);
        let across = cross([x, y, z], twice);
        [0, 1, 2].map(|axis| twice[axis] * w + across[axis] + direction[axis])
    }

    /// A contact of the skin's frame in the link's: its position, normal and velocity; the rest stays.
    #[must_use]
    pub fn contact(&self, contact: &Contact) -> Contact {
        let narrow = |values: [f64; 3]| values.map(|value| value as f32);
        let turned = |direction: [f32; 3]| narrow(self.direction(direction.map(f64::from)));
        let identity = |identity: Identity| Identity { velocity: turned(identity.velocity), ..identity };
        Contact {
            position: narrow(self.point(contact.position.map(f64::from))),
            normal: turned(contact.normal),
            identity: contact.identity.map(identity),
            ..*contact
        }
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_1_SQRT_2;

    #[test]
    fn a_contact_is_turned_and_then_moved_and_its_normal_and_velocity_only_turned() {
        let pose = Pose {
            link: "forearm".to_owned(),
            position: [1.0, 2.0, 3.0],
            orientation: [FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2],
        };
        let contact = Contact {
            position: [0.1, 0.02, 0.003],
            normal: [0.0, 0.6, 0.8],
            area: 4e-6,
            strength: 0.5,
            peak: 1.0,
            pressure: Some(2e3),
            load_area: Some(1e-6),
            evidence: None,
            identity: Some(Identity {
                number: 7,
                velocity: [0.0, 0.06, 0.08],
                merged: None,
                split_from: Some(3),
            }),
        };
        // A quarter turn about x takes y to z, and z to -y.
        let found = pose.contact(&contact);
        let is_near = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(is_near(found.position, [1.1, 1.997, 3.02]), "{found:?}");
        assert!(is_near(found.normal, [0.0, -0.8, 0.6]), "{found:?}");
        let Some(identity) = found.identity else { panic!("{found:?}") };
        assert!(is_near(identity.velocity, [0.0, -0.08, 0.06]), "{identity:?}");
        assert_eq!((identity.number, identity.split_from), (7, Some(3)));
        let Contact { position, normal, identity, .. } = contact;
        assert_eq!(Contact { position, normal, identity, ..found }, contact);
    }

    #[test]
    fn the_turn_is_that_of_the_quaternions_matrix() {
        // Third of a turn about the diagonal: x goes to y, y to z, z to x.
        let pose = Pose { link: String::new(), position: [0.0; 3], orientation: [0.5; 4] };
        assert_eq!(pose.point([1.0, 2.0, 3.0]), [3.0, 1.0, 2.0]);
        let [x, y, z, w] = [0.1_f64, -0.7, 0.5, 0.5];
        let pose = Pose { orientation: [x, y, z, w], ..pose };
        let matrix = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
            [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
            [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
        ];
        let v = [0.3, -1.1, 0.8];
        let turned = pose.direction(v);
        for (row, found) in matrix.iter().zip(turned) {
            let expected: f64 = row.iter().zip(v).map(|(m, v)| m * v).sum();
            assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        }
    }
}
