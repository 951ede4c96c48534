//! The board that a command talks to, and what this program can do where it cannot be reached.

use dermatome_link::{Link, LinkError, LinkErrorKind};
use dermatome_simulate::port::{self, OpenError, Port};

/// Opens `port`; a simulated board starts first, and lives as long as the link.
pub(super) fn open(port: &Port) -> anyhow::Result<Link> {
    port::open(port).map_err(|error| match error {
        OpenError::Link(error) => advised(error),
        error => error.into(),
    })
}

/// The error of a link, with the command that helps.
pub(super) fn advised(error: LinkError) -> anyhow::Error {
    match error.kind {
        LinkErrorKind::Missing => anyhow::anyhow!("{error} (`dermatome devices` lists the ports there are)"),
        LinkErrorKind::NoTare { .. } => anyhow::anyhow!("{error}: `dermatome check` says what is wrong"),
        _ => error.into(),
    }
}

/// As [`advised`], for what may be the error of a link.
pub(super) fn advise(error: anyhow::Error) -> anyhow::Error {
    error.downcast().map_or_else(|error| error, advised)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn where_a_command_helps_it_is_named_and_elsewhere_not() {
        let words = |kind| advised(LinkError::new("COM5", kind)).to_string();
        let missing = "port `COM5` does not exist (`dermatome devices` lists the ports there are)";
        assert_eq!(words(LinkErrorKind::Missing), missing);
        assert_eq!(
            words(LinkErrorKind::NoTare { frames: 20, timeout: Duration::from_millis(3500) }),
            "the board at `COM5` did not average 20 frames within 3.5 s: `dermatome check` says what is wrong"
        );
        assert_eq!(words(LinkErrorKind::InUse), "port `COM5` is in use by another program");
    }
}
