//! Pose: where a skin lies on a robot.

use nalgebra::Isometry3;

/// Where a skin lies on a robot's link.
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// Name of the link's frame, as the robot's description calls it.
    pub link: String,
    /// Takes points and directions of the skin's frame to the link's, m.
    pub link_from_skin: Isometry3<f64>,
}
