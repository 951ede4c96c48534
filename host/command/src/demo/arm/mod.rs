//! Arm: the robot of `demo --robot`: its files, what touches it, and how what it felt is scored.

mod felt;
mod touches;

pub(crate) use felt::{Felt, Scores, TouchScore};
pub(crate) use touches::{SECONDS, Trail};

use std::{
    fs, io,
    path::{Path, PathBuf},
};

/// A file of models/arm with its name there.
macro_rules! file {
    ($name:literal) => {
        ($name, include_bytes!(concat!("../../../../../models/arm/", $name)).as_slice())
    };
}

/// The arm, built in, so that the command works from any folder.
const FILES: [(&str, &[u8]); 15] = [
    file!("robot.toml"),
    file!("robot.urdf"),
    file!("meshes/base.stl"),
    file!("meshes/upper_arm.stl"),
    file!("meshes/forearm.stl"),
    file!("meshes/hand.stl"),
    file!("meshes/upper-arm-skin.stl"),
    file!("meshes/forearm-skin.stl"),
    file!("meshes/hand-skin.stl"),
    file!("upper-arm-skin/skin.toml"),
    file!("upper-arm-skin/skin.msh"),
    file!("forearm-skin/skin.toml"),
    file!("forearm-skin/skin.msh"),
    file!("hand-skin/skin.toml"),
    file!("hand-skin/skin.msh"),
];

/// Writes the arm's files into a folder; gives its body file.
pub(crate) fn unpack(folder: &Path) -> io::Result<PathBuf> {
    for (name, bytes) in FILES {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap_or(folder))?;
        fs::write(path, bytes)?;
    }
    Ok(folder.join(FILES[0].0))
}
