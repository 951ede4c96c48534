//! `dermatome mjcf`: skins in a robot's model for MuJoCo.

use super::{
    JsonReport,
    mount::{Format, Options, in_file},
};
use dermatome_urdf::mjcf::{self, Zone};
use std::path::PathBuf;

/// A hull that reaches further beyond the skin is worth a word, mm.
const BULGE_MM: f64 = 1.0;

/// Put skins on a robot's model for MuJoCo.
#[derive(clap::Args)]
#[command(
    arg_required_else_help = true,
    disable_help_subcommand = true,
    after_help = "Examples:
  dermatome mjcf add arm.xml forearm-skin/skin.toml --body forearm -o arm-with-skin.xml
  dermatome mjcf add arm.xml forearm-skin/skin.toml --body forearm --taxels 32 --replace"
)]
pub(super) struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(clap::Subcommand)]
enum What {
    Add(Add),
}

/// Add a skin to a robot: a body with its mesh, and touch sensors.
///
/// The skin becomes a body without a joint on the one that it lies on, at the pose in its file. All else in the file stays
/// as it is, byte for byte. docs/robot.md says what is added, and how a contact in MuJoCo becomes one of a simulated board.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome mjcf add arm.xml forearm-skin/skin.toml --body forearm -o arm-with-skin.xml
  dermatome mjcf add arm.xml forearm-skin/skin.toml --body forearm --taxels 32 --replace
  python3 -m mujoco.viewer --mjcf=arm-with-skin.xml")]
struct Add {
    /// The robot's MJCF file.
    #[arg(value_name = "ROBOT")]
    robot: PathBuf,
    /// Skin file, with its pose.
    #[arg(value_name = "SKIN")]
    skin: PathBuf,
    /// The body that the skin lies on [default: the link that the skin file names, or where the skin that is replaced under
    /// another `--name` lies].
    #[arg(long, value_name = "BODY")]
    body: Option<String>,
    /// Add so many touch sensors more, of equal balls that cover the skin together.
    #[arg(long, value_name = "COUNT", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
    taxels: u16,
    #[command(flatten)]
    options: Options,
    #[command(flatten)]
    json: JsonReport,
}

pub(super) fn run(Args { what: What::Add(args) }: &Args) -> anyhow::Result<()> {
    let format = Format { folder: mjcf::mesh_folder, placed: mjcf::placed };
    let mounting = args.options.mounting(&args.robot, &args.skin, args.body.as_deref(), &format)?;
    let taxels = mounting.surface.spread(args.taxels.into());
    let zone = Zone::round(&mounting.slab);
    let robot = mjcf::add(&mounting.text, &mounting.mount(), zone, &taxels, mounting.replace);
    mounting.write(&robot.map_err(|error| in_file(&args.robot, error))?)?;
    let bulge_mm = mounting.surface.bulge() * 1e3;
    let mut report = mounting.report();
    report.bulge_mm = Some(bulge_mm);
    report.print("body");
    if bulge_mm > BULGE_MM {
        eprintln!(
            "warning: MuJoCo collides a mesh's convex hull, which reaches {bulge_mm:.1} mm beyond this skin: there it is \
             touched too early"
        );
    }
    args.json.write(&report)
}
