//! `dermatome urdf check`: whether a robot hangs together, and has its skins where their files say.

use super::super::{
    JsonReport,
    link_frame::on_link,
    mount::{in_file, read_robot},
};
use anyhow::{Context, bail};
use dermatome_geometry::mesh::{Lattice, Mesh};
use dermatome_model::{
    model::mesh,
    skin::{Pose, Skin},
};
use dermatome_urdf::urdf::check::{Checked, Expected, Level, Places, check, packages_of_ros};
use std::path::{Path, PathBuf};

/// Check a robot: its links and joints, its mesh files, and its skins.
///
/// Links and joints must make one tree, and mesh files be there. Of each skin whose file is given: it is on the robot, at
/// the pose in its file, with its own mesh, and touches the mesh of its link. Errors make the exit code 1, warnings do not.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome urdf check arm.urdf
  dermatome urdf check arm.urdf forearm-skin/skin.toml palm-skin/skin.toml --json report.json")]
pub(super) struct Args {
    /// The robot's URDF.
    #[arg(value_name = "ROBOT")]
    robot: PathBuf,
    /// Files of skins that should be on it.
    #[arg(value_name = "SKIN")]
    skins: Vec<PathBuf>,
    #[command(flatten)]
    json: JsonReport,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let text = read_robot(&args.robot)?;
    let skins = args.skins.iter().map(|path| read_skin(path)).collect::<anyhow::Result<Vec<_>>>()?;
    let expected: Vec<_> =
        skins.iter().map(|(skin, pose, mesh)| Expected { name: &skin.name, pose, mesh }).collect();
    let packages = packages_of_ros();
    let places = Places { folder: args.robot.parent().unwrap_or(Path::new("")), packages: &packages };
    let checked = check(&text, &places, &expected).map_err(|error| in_file(&args.robot, error))?;
    print(&checked);
    args.json.write(&checked)?;
    match checked.findings.iter().filter(|finding| finding.level == Level::Error).count() {
        0 => Ok(()),
        1 => bail!("one thing is wrong with the robot `{}`: see above", args.robot.display()),
        many => bail!("{many} things are wrong with the robot `{}`: see above", args.robot.display()),
    }
}

fn read_skin(path: &Path) -> anyhow::Result<(Skin, Pose, Mesh)> {
    let (skin, pose) = on_link(path)?;
    let mesh =
        mesh(&skin, 1.0, Lattice::default()).with_context(|| format!("skin file `{}`", path.display()))?;
    Ok((skin, pose, mesh))
}

fn print(checked: &Checked) {
    say!("robot         {}: {} links, {} joints", checked.robot, checked.links, checked.joints);
    say!("root          {}", checked.root.as_deref().unwrap_or("none"));
    for skin in &checked.skins {
        let on = skin.link.as_deref().unwrap_or("no link");
        let off = skin.off_link_mm.map_or(String::new(), |off| format!(", {off:.2} mm off its mesh at most"));
        say!("skin          {} on {on}, frame {}{off}", skin.skin, skin.frame);
    }
    for finding in &checked.findings {
        let level = match finding.level {
            Level::Error => "error",
            Level::Warning => "warning",
        };
        say!("{level:13} {finding}");
    }
    if checked.findings.is_empty() {
        say!("all is well");
    }
}
