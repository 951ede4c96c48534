//! Options that say how a file of measured frames is to be read.

use super::choices::SenseOrder;
use anyhow::Context;
use dermatome_frames::{
    learn::presses::Layout,
    recorded::{
        check::Expected,
        order::{self, Arrangement},
        read::{Frames, ReadError, Source, read, read_turned},
        wording::Wording,
    },
};
use dermatome_shared::stimulation::Step;
use std::ffi::OsString;

/// How the file orders its measurements and numbers its electrodes.
#[derive(clap::Args)]
pub(super) struct FrameOptions {
    /// Order of the sense pairs inside each drive: by electrode, or from the driven pair onwards.
    #[arg(long, value_enum, default_value_t)]
    order: SenseOrder,
    /// Electrode of the skin, from 0, that the file calls its first.
    #[arg(long, value_name = "N", default_value_t = 0)]
    rotation: u8,
    /// The file numbers its electrodes the other way round.
    #[arg(long)]
    mirror: bool,
    /// Subtract this from every value first, as from raw counts of a converter.
    #[arg(long, value_name = "VALUE", default_value_t = 0.0, value_parser = finite, allow_hyphen_values = true)]
    offset: f64,
    /// The square holds the potential of each electrode instead of the difference of each pair; Sciospec's always does.
    #[arg(long)]
    single_ended: bool,
    /// Each column of the file is a frame; a MATLAB file is turned round by itself if only that fits.
    #[arg(long)]
    transpose: bool,
}

impl FrameOptions {
    pub(super) fn arrangement(&self) -> Arrangement {
        Arrangement { sense: self.order.into(), rotation: self.rotation, mirrored: self.mirror }
    }

    /// Reads frames of a skin with these steps and so many electrodes.
    pub(super) fn read(&self, source: &Source, steps: &[Step], electrodes: u8) -> anyhow::Result<Frames> {
        let frames = self.read_plain(source, electrodes, steps.len())?;
        if !self.single_ended && !source.holds_potentials() {
            return Ok(frames);
        }
        let apart = frames.apart(steps, electrodes);
        apart.with_context(|| format!("`{source}` as potentials of electrodes"))
    }

    /// What a skin should measure: as good frames say, where there are some, otherwise as its model does.
    pub(super) fn expected(&self, model: Expected, good: Option<&OsString>) -> anyhow::Result<Expected> {
        let Some(good) = good else { return Ok(model) };
        let source = Source::new(good);
        let frames = self.read(&source, &model.steps, model.electrodes())?;
        let measured = model.measured(&frames, self.arrangement());
        measured.with_context(|| format!("--good `{source}`"))
    }

    /// How presses lie in their file.
    pub(super) fn layout(&self) -> Layout {
        Layout { offset: self.offset, turned: self.transpose, potentials: self.single_ended }
    }

    fn read_plain(&self, source: &Source, electrodes: u8, steps: usize) -> Result<Frames, ReadError> {
        let square = usize::from(electrodes).pow(2);
        let frames = if self.transpose {
            read(source)?.transposed()
        } else {
            read_turned(source, |length| length == steps || length == square)?
        };
        Ok(frames.with_square(electrodes, steps).minus(self.offset))
    }
}

/// Names these options in advice.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flags;

impl Wording for Flags {
    fn arrangement(&self, arrangement: &Arrangement) -> String {
        let options = [
            (arrangement.sense == order::SenseOrder::Relative).then(|| "--order relative".to_owned()),
            (arrangement.rotation > 0).then(|| format!("--rotation {}", arrangement.rotation)),
            arrangement.mirrored.then(|| "--mirror".to_owned()),
        ];
        options.into_iter().flatten().collect::<Vec<_>>().join(" ")
    }

    fn offset(&self, value: f64) -> String {
        format!("use --offset {value:.4}")
    }
}

fn finite(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|value: &f64| value.is_finite());
    value.ok_or_else(|| "allowed are finite numbers".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_frames::recorded::wording::Rearrangement;

    #[test]
    fn each_wrong_order_is_told_with_the_options_that_mend_it() {
        let arrangement = |relative: bool, rotation: u8, mirrored: bool| Arrangement {
            sense: if relative { order::SenseOrder::Relative } else { order::SenseOrder::Absolute },
            rotation,
            mirrored,
        };
        let advice = |best, used| Rearrangement { used, best, rotation_ambiguous: false }.told(&Flags);
        let plain = Arrangement::default();
        assert_eq!(advice(arrangement(true, 0, false), plain), "use --order relative");
        assert_eq!(advice(arrangement(false, 3, false), plain), "use --rotation 3");
        assert_eq!(advice(arrangement(false, 0, true), plain), "use --mirror");
        let all = arrangement(true, 5, true);
        assert_eq!(advice(all, plain), "use --order relative --rotation 5 --mirror");
        assert_eq!(advice(plain, all), "leave out --order relative --rotation 5 --mirror");
        let turned = arrangement(false, 5, false);
        assert_eq!(advice(turned, arrangement(false, 5, true)), "use --rotation 5, without --mirror");
    }
}
