//! `trace`.
use std::{error::Error, process::ExitCode};
#[derive(clap::Args)]
pub(crate) struct Trace {}
impl Trace { pub(crate) fn run(self) -> Result<ExitCode, Box<dyn Error>> { Ok(ExitCode::SUCCESS) } }
