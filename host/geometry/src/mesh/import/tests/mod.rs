mod dae;
mod hostile;
mod readers;
mod round_trips;
mod writers;

use super::*;

fn text(format: Format, content: &str) -> Result<Imported, Problem> {
    parse(format, content.as_bytes(), None)
}

/// The message about content that must be refused.
fn refusal(format: Format, content: impl AsRef<[u8]>) -> String {
    parse(format, content.as_ref(), None).expect_err("must be refused").to_string()
}
