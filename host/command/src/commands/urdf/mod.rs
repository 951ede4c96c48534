//! `dermatome urdf`: skins in a robot's URDF.

mod add;
mod check;

/// Put skins on a robot's URDF, and check that they lie right.
#[derive(clap::Args)]
#[command(
    arg_required_else_help = true,
    disable_help_subcommand = true,
    after_help = "Examples:
  dermatome urdf add arm.urdf forearm-skin/skin.toml --link forearm_link -o arm-with-skin.urdf
  dermatome urdf check arm-with-skin.urdf forearm-skin/skin.toml"
)]
pub(super) struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(clap::Subcommand)]
enum What {
    Add(add::Args),
    Check(check::Args),
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    match &args.what {
        What::Add(args) => add::run(args),
        What::Check(args) => check::run(args),
    }
}
