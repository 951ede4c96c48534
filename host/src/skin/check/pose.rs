//! `[pose]`.

use super::Checker;
use crate::skin::{Pose, SkinError, file::PoseTable, quantity::LENGTH};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

/// How far a quaternion's length may be from 1.
const UNIT: f64 = 1e-3;

impl Checker<'_> {
    pub(super) fn pose(&self, table: Option<&PoseTable>) -> Result<Option<Pose>, SkinError> {
        let Some(table) = table else { return Ok(None) };
        if !is_frame_name(&table.link) {
            let allowed = "1 to 64 letters, digits, \"-\", \"_\", \".\" or \"/\"";
            return self.refuse("pose.link", format!("{:?}", table.link), allowed);
        }
        let read = |axis: usize| self.finite("pose.position", &table.position[axis], LENGTH);
        let position = Translation3::new(read(0)?, read(1)?, read(2)?);
        let [x, y, z, w] = table.orientation;
        let quaternion = Quaternion::new(w, x, y, z);
        if (quaternion.norm() - 1.0).abs() <= UNIT {
            let link_from_skin = Isometry3::from_parts(position, UnitQuaternion::from_quaternion(quaternion));
            return Ok(Some(Pose { link: table.link.clone(), link_from_skin }));
        }
        let allowed = "a quaternion x, y, z, w of length 1";
        self.refuse("pose.orientation", format!("{:?}", table.orientation), allowed)
    }
}

/// Whether a text may name a link's frame.
pub(crate) fn is_frame_name(name: &str) -> bool {
    let allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.' | '/');
    (1..=64).contains(&name.len()) && name.chars().all(allowed)
}
