//! Tables: pixels as a board knows them, in whole numbers; see [`dermatome_shared::surface`].

use dermatome_shared::{
    image::PixelGrid,
    patch::PatchView,
    surface::{NEIGHBOUR_BYTES, PIXEL_BYTES, Pixel, Surface, SurfaceScale},
};

/// The pixels of a patch.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceTables {
    /// What the whole numbers stand for.
    pub scale: SurfaceScale,
    /// The grid whose cells the pixels are, if they are.
    pub grid: Option<PixelGrid>,
    /// `[pixel]`.
    pub pixels: Vec<Pixel>,
    /// Neighbours of all pixels, list after list.
    pub neighbours: Vec<u16>,
    /// The same as bytes of a patch.
    bytes: (Vec<[u8; PIXEL_BYTES]>, Vec<[u8; NEIGHBOUR_BYTES]>),
}

impl SurfaceTables {
    /// Tables of a board's patch.
    #[must_use]
    pub fn read(patch: &PatchView<'_>) -> Self {
        let surface = patch.surface();
        let neighbours = (0..surface.count()).flat_map(|pixel| surface.neighbours(pixel));
        let neighbours = neighbours.map(|pixel| pixel as u16).collect();
        Self::of(surface.scale, patch.header.grid, surface.pixels().collect(), neighbours)
    }

    /// Of whole numbers: `pixels` `[pixel]`, `neighbours` list after list.
    #[must_use]
    pub fn of(
        scale: SurfaceScale,
        grid: Option<PixelGrid>,
        pixels: Vec<Pixel>,
        neighbours: Vec<u16>,
    ) -> Self {
        let bytes = (
            pixels.iter().map(|pixel| pixel.to_bytes()).collect(),
            neighbours.iter().map(|pixel| pixel.to_le_bytes()).collect(),
        );
        Self { scale, grid, pixels, neighbours, bytes }
    }

    /// As the board reads them.
    #[must_use]
    pub fn view(&self) -> Surface<'_> {
        Surface::new(self.scale, self.bytes.0.as_flattened(), self.bytes.1.as_flattened())
    }

    /// Centre of each pixel, m: `[pixel]`.
    pub fn centres(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        let surface = self.view();
        self.pixels.iter().map(move |pixel| surface.centre(pixel).map(f64::from))
    }
}
