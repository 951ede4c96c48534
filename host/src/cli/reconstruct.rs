//! `dermatome reconstruct`.

/// Arguments of `dermatome reconstruct`.
#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    json: super::JsonReport,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    args.json.write(&())?;
    anyhow::bail!("not built yet")
}
