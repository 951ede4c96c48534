//! `dermatome urdf add`: a skin becomes a link of a robot.

use super::super::{
    JsonReport,
    mount::{Format, Options, in_file},
};
use dermatome_urdf::urdf;
use std::path::PathBuf;

/// Add a skin to a robot: its frame, its mesh and its sensor.
///
/// The skin becomes a link, fixed to the one that it lies on at the pose in its file. All else in the file stays as it
/// is, byte for byte. docs/robot.md says what is added, and why.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome urdf add arm.urdf forearm-skin/skin.toml --link forearm_link -o arm-with-skin.urdf
  dermatome urdf add arm.urdf forearm-skin/skin.toml --mesh ../meshes/forearm-skin.stl \\
      --mesh-uri package://arm_description/meshes/forearm-skin.stl
  dermatome urdf add arm.urdf forearm-skin/skin.toml --replace
  dermatome urdf add arms.urdf forearm-skin/skin.toml --link left_forearm --name left
  check_urdf arm.urdf")]
pub(super) struct Args {
    /// The robot's URDF; of a xacro file, what `xacro FILE > robot.urdf` writes.
    #[arg(value_name = "ROBOT")]
    robot: PathBuf,
    /// Skin file, with its pose.
    #[arg(value_name = "SKIN")]
    skin: PathBuf,
    /// The link that the skin lies on [default: the one that the skin file names, or where the skin that is replaced under
    /// another `--name` lies].
    #[arg(long, value_name = "LINK")]
    link: Option<String>,
    #[command(flatten)]
    options: Options,
    #[command(flatten)]
    json: JsonReport,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let format = Format { folder: |_| Ok(None), placed: urdf::placed };
    let mounting = args.options.mounting(&args.robot, &args.skin, args.link.as_deref(), &format)?;
    let robot = urdf::add(&mounting.text, &mounting.mount(), mounting.replace);
    mounting.write(&robot.map_err(|error| in_file(&args.robot, error))?)?;
    let report = mounting.report();
    report.print("link");
    args.json.write(&report)
}
