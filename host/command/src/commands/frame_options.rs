//! Options that say how a file of measured frames is to be read.

use super::choices::SenseOrder;
use dermatome_frames::recorded::{
    order::Arrangement,
    read::{Frames, ReadError, Source, read},
};
use dermatome_model::skin::Skin;

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
}

impl FrameOptions {
    pub(super) fn arrangement(&self) -> Arrangement {
        Arrangement { sense: self.order.into(), rotation: self.rotation, mirrored: self.mirror }
    }

    pub(super) fn offset(&self) -> f64 {
        self.offset
    }

    /// Reads frames of a skin.
    pub(super) fn read(&self, source: &Source, skin: &Skin) -> Result<Frames, ReadError> {
        let frames = read(source)?.with_square(skin.electrodes.count, skin.steps().len());
        Ok(frames.minus(self.offset))
    }
}

fn finite(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|value: &f64| value.is_finite());
    value.ok_or_else(|| "allowed are finite numbers".to_owned())
}
