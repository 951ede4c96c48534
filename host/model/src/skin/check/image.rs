//! Table `[image]`.

use super::Checker;
use crate::skin::{
    ImageLayout, SkinError,
    file::{ImageTable, PixelCount},
};
use dermatome_shared::MAX_GRID_SIDE;

/// Patches of elements that an image may have.
const MOST_PATCHES: i64 = 100_000;

impl Checker<'_> {
    pub(super) fn image(&self, table: &ImageTable) -> Result<ImageLayout, SkinError> {
        match (table.columns, &table.pixels) {
            (Some(columns), None) => {
                let columns = self.count("image.columns", columns, 4, MAX_GRID_SIDE)?;
                Ok(ImageLayout::Grid { columns })
            }
            (None, Some(pixels)) => self.pixels(pixels),
            (None, None) => self.refuse("image.columns", "missing".into(), "`columns` or `pixels`"),
            (Some(_), Some(_)) => {
                self.refuse("image.pixels", "given".into(), "nothing (`columns` says how many pixels)")
            }
        }
    }

    fn pixels(&self, pixels: &PixelCount) -> Result<ImageLayout, SkinError> {
        let allowed = format!("\"elements\", or a number of pixels from 4 to {MOST_PATCHES}");
        match pixels {
            PixelCount::Word(word) if word == "elements" => Ok(ImageLayout::Elements),
            PixelCount::Count(count) if (4..=MOST_PATCHES).contains(count) => {
                Ok(ImageLayout::ElementPatches { count: *count as usize })
            }
            PixelCount::Word(word) => self.refuse("image.pixels", format!("{word:?}"), &allowed),
            PixelCount::Count(count) => self.refuse("image.pixels", count.to_string(), &allowed),
        }
    }
}
