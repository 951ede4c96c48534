//! `[pose]`.

use super::Checker;
use crate::skin::{
    Pose, SkinError,
    file::{Exactly, PoseTable},
    quantity::LENGTH,
};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use std::fmt::Display;

/// How far a quaternion's length may be from 1.
const UNIT: f64 = 1e-3;
/// Farthest that a skin lies from the origin of its link's frame, m.
const FARTHEST: f64 = 1000.0;

impl Checker<'_> {
    pub(super) fn pose(&self, table: Option<&PoseTable>) -> Result<Option<Pose>, SkinError> {
        let Some(table) = table else { return Ok(None) };
        if !is_frame_name(&table.link) {
            let allowed = "1 to 64 letters, digits, \"-\", \"_\", \".\" or \"/\"";
            return self.refuse("pose.link", format!("{:?}", table.link), allowed);
        }
        let Exactly(written) = &table.position;
        let read = |axis: usize| self.finite("pose.position", &written[axis], LENGTH);
        let position = Vector3::new(read(0)?, read(1)?, read(2)?);
        if position.amax() > FARTHEST {
            let allowed = "three lengths of at most 1000 m";
            return self.refuse("pose.position", list(written), allowed);
        }
        let Exactly(orientation) = table.orientation;
        let [x, y, z, w] = orientation;
        let quaternion = Quaternion::new(w, x, y, z);
        if (quaternion.norm() - 1.0).abs() <= UNIT {
            let unit = UnitQuaternion::from_quaternion(quaternion);
            let (position, orientation) = (position.into(), unit.coords.into());
            return Ok(Some(Pose { link: table.link.clone(), position, orientation }));
        }
        let allowed = "a quaternion x, y, z, w of length 1";
        self.refuse("pose.orientation", format!("{orientation:?}"), allowed)
    }
}

/// A list as it stands in the file.
fn list(values: &[impl Display]) -> String {
    format!("[{}]", values.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "))
}

/// Whether a text may name a link's frame.
#[must_use]
pub fn is_frame_name(name: &str) -> bool {
    let allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.' | '/');
    (1..=64).contains(&name.len()) && name.chars().all(allowed)
}
