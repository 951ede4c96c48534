//! The current before a tare: lowered where it clips, unless it is to be kept.

use super::{board::advised, drive::rounded};
use dermatome_link::{Link, health::fit_current, silence_timeout};
use dermatome_shared::protocol::PatchInfo;

/// What a command does to the current before it tares.
#[derive(Default, clap::Args)]
pub(super) struct Current {
    /// Lower a current that clips before a tare, or keep it as it is.
    #[arg(long, value_name = "CHOICE", value_enum, default_value_t)]
    amplitude: Amplitude,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
enum Amplitude {
    /// Halved until nothing clips.
    #[default]
    Auto,
    /// As it is.
    Keep,
}

impl Current {
    /// Lowers a current that clips, and says so; `patch` then has the drive in effect. Boards that measure nothing keep
    /// theirs.
    pub(super) fn fit(
        &self,
        link: &mut Link,
        patch: &mut PatchInfo,
        go_on: impl Fn() -> bool,
    ) -> anyhow::Result<()> {
        if self.amplitude == Amplitude::Keep || link.info()?.front_end.is_none() {
            return Ok(());
        }
        let fitted = fit_current(link, patch.drive, silence_timeout(patch), go_on).map_err(advised)?;
        let Some(fitted) = fitted else { return Ok(()) };
        patch.drive.amplitude = fitted.amplitude;
        let milliamperes = |amplitude: f32| rounded(1e3 * amplitude);
        if fitted.is_lowered() {
            eprintln!(
                "{} mA is too much for this skin or its contacts: measuring with {} mA (`dermatome setup` keeps that)",
                milliamperes(fitted.before),
                milliamperes(fitted.amplitude)
            );
        } else if fitted.clips {
            eprintln!("warning: voltages clip, however small the current: `dermatome check` says more");
        }
        Ok(())
    }
}
