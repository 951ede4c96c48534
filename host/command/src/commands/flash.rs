//! `dermatome flash`.

use super::{BoardReport, board::open, progress};
use anyhow::Context;
use dermatome_link::{self as link, Link};
use dermatome_patch::input::{self, MAX_PATCH_BYTES};
use dermatome_shared::protocol::PatchInfo;
use dermatome_simulate::port::Port;
use serde::Serialize;
use std::{
    path::PathBuf,
    time::{Duration, Instant},
};

/// Send a patch to a board, which keeps it.
///
/// The patch is checked before, on the way and after; whatever fails, the board keeps the patch it had.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    dermatome flash disc-210mm.dermatome --port /dev/ttyACM0\n  \
    dermatome flash disc-210mm.dermatome --port tcp:127.0.0.1:7000 --json flash.json")]
pub(super) struct Args {
    /// Patch to send, as `dermatome build` writes it.
    patch: PathBuf,
    /// Where the board is: /dev/ttyACM0, COM5, tcp:HOST:PORT, rs485:LINE#ADDRESS, can:BUS#ADDRESS or sim:SKIN.toml.
    #[arg(long)]
    port: Port,
    #[command(flatten)]
    json: super::JsonReport,
}

#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    board: BoardReport<'a>,
    patch_bytes: usize,
    patch_crc: String,
    duration_s: f64,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let path = args.patch.display();
    let bytes =
        input::read(&args.patch, MAX_PATCH_BYTES).with_context(|| format!("cannot read patch `{path}`"))?;
    let mut link = open(&args.port)?;
    let started = Instant::now();
    let bar = progress::sending(bytes.len());
    let result = link::upload(&mut link, &bytes, |sent| bar.inc(sent as u64));
    bar.finish_and_clear();
    let used = result.with_context(|| format!("`{path}` was not sent"))?;
    report(args, &link, &used, bytes.len(), started.elapsed())
}

fn report(
    args: &Args,
    link: &Link,
    used: &PatchInfo,
    patch_bytes: usize,
    took: Duration,
) -> anyhow::Result<()> {
    let port = link.port();
    say!("{} at {port} now uses patch `{}` ({patch_bytes} bytes)", link.identity().board, used.skin);
    let next = match args.port {
        Port::Simulated(_) => {
            "this simulated board ends with the command; `dermatome simulate` runs one that stays".into()
        }
        _ => format!("next: dermatome tare --port {port}"),
    };
    say!("{next}");
    args.json.write(&Report {
        board: BoardReport::new(link, used),
        patch_bytes,
        patch_crc: super::patch_id(used.crc),
        duration_s: took.as_secs_f64(),
    })
}
