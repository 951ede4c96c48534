//! Skins in descriptions of robots: [`urdf`] for ROS and its tools, [`mjcf`] for MuJoCo.
//!
//! A skin is a link, or a body, of its own that is fixed to the one it lies on, with a [`slab`] for its mesh, and a
//! sensor, all of its name on the robot. What is added is text put into the file: the rest of it stays as it was, byte for byte, with its
//! comments and its line ends. XML is read by `roxmltree`, which tells where everything stands. The crate `urdf-rs` (0.10)
//! does not: its structs keep neither places nor elements they do not know, and it takes two more XML parsers along.
#![forbid(unsafe_code)]

mod edit;
mod error;
pub mod mjcf;
mod place;
pub mod slab;
pub mod urdf;

use dermatome_patch::pose::Pose;
pub use error::DescriptionError;
use nalgebra::Isometry3;
pub use place::link_from_skin;

/// A skin as it is put on a robot.
#[derive(Clone, Debug)]
pub struct Mount<'a> {
    /// Name in its skin file: a robot may have several of one.
    pub skin: &'a str,
    /// Its name on the robot, which no other has: that of its link or body, which is its frame, and of its sensor.
    pub frame: &'a str,
    /// The link or body that it lies on.
    pub on: &'a str,
    /// Where it lies there.
    pub pose: &'a Pose,
    /// How the description names the file of the skin's [`slab`], which is in metres.
    pub mesh: &'a str,
    /// Frames a second.
    pub frame_rate: f64,
}

/// How a skin lies on a robot already.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Placed {
    /// The link or body that it lies on; none where the description holds it by nothing that has a name.
    pub on: Option<String>,
    /// How the description names the file of its mesh.
    pub mesh: Option<String>,
}

impl Mount<'_> {
    fn link_from_skin(&self) -> Isometry3<f64> {
        link_from_skin(self.pose)
    }
}
