//! Patch: what a board holds of a skin, and where its pixels lie.

use crate::{
    array::{list, numbers, rows, table},
    drive::Drive,
    error::raised,
};
use dermatome_patch::{
    input::{self, MAX_PATCH_BYTES},
    output::write_whole,
    tables::SurfaceTables,
};
use dermatome_shared::{
    patch::{PatchError, PatchHeader, PatchView},
    stimulation::Step,
};
use numpy::{PyArray1, PyArray2};
use pyo3::{exceptions::PyValueError, prelude::*, types::PyBytes};
use std::path::{Path, PathBuf};

/// A patch: what a board holds of a skin. `Patch.load(PATH)`, `Skin.build_patch()`, `Board.patch()`, `Recording.patch`.
#[pyclass(frozen, module = "dermatome")]
pub(crate) struct Patch {
    bytes: Vec<u8>,
    header: PatchHeader,
    crc: u32,
    surface: SurfaceTables,
}

impl Patch {
    /// Of a patch's bytes, which are checked.
    pub(crate) fn new(bytes: Vec<u8>) -> Result<Self, PatchError> {
        let patch = PatchView::validate(&bytes)?;
        let (header, crc, surface) = (patch.header.clone(), patch.crc(), SurfaceTables::read(&patch));
        Ok(Self { bytes, header, crc, surface })
    }

    pub(crate) fn read(path: &Path) -> PyResult<Self> {
        let name = path.display();
        let bytes = input::read(path, MAX_PATCH_BYTES)
            .map_err(|error| raised(format!("cannot read patch file `{name}`: {error}")))?;
        Self::new(bytes).map_err(|error| raised(format!("patch file `{name}`: {error}")))
    }

    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Of bytes that were checked.
    pub(crate) fn view(&self) -> PyResult<PatchView<'_>> {
        PatchView::open(&self.bytes).map_err(raised)
    }

    /// Row and column of each pixel, of a skin with a grid. Centres there are odd numbers of half a pitch.
    fn cells(&self) -> Option<Vec<[usize; 2]>> {
        let grid = self.header.grid?;
        let cell = |steps: i16, most: u8| usize::try_from((steps - 1) / 2).ok().filter(|&n| n < most.into());
        let pixels = self.surface.pixels.iter();
        pixels
            .map(|pixel| Some([cell(-pixel.centre[1], grid.rows)?, cell(pixel.centre[0], grid.columns)?]))
            .collect()
    }
}

#[pymethods]
impl Patch {
    /// Reads a patch file.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        Self::read(&path)
    }

    /// Writes it to a file, whole or not at all. A file with a calibration that this patch does not have stays.
    pub(crate) fn save(&self, path: PathBuf) -> PyResult<()> {
        let is_calibrated =
            |header: &PatchHeader| !header.calibration.points.is_empty() || header.play_operators > 0;
        let there = Self::read(&path).ok().filter(|there| is_calibrated(&there.header));
        if there.is_some_and(|there| there.bytes != self.bytes && !is_calibrated(&self.header)) {
            let name = path.display();
            return Err(raised(format!(
                "patch file `{name}` holds a calibration, which would be lost; allowed: another path, or remove the file"
            )));
        }
        write_whole(&path, &self.bytes).map_err(raised)
    }

    /// Name of the skin.
    #[getter]
    fn skin(&self) -> &str {
        &self.header.skin
    }

    /// Checksum, which identifies it.
    #[getter]
    fn crc(&self) -> u32 {
        self.crc
    }

    /// How the skin is driven.
    #[getter]
    fn drive(&self) -> Drive {
        Drive::new(&self.header.drive)
    }

    /// Electrodes.
    #[getter]
    fn electrodes(&self) -> u8 {
        self.header.electrodes
    }

    /// Pixels of an image.
    #[getter]
    fn pixels(&self) -> u16 {
        self.header.pixels
    }

    /// Stimulation table: uint8 [step][drive plus, drive minus, sense plus, sense minus], electrodes from 0.
    #[getter]
    fn steps<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u8>>> {
        rows(py, self.view()?.steps().map(Step::to_bytes))
    }

    /// Centres of the pixels in the skin's frame, m: float64 [pixel][x, y, z].
    #[getter]
    fn pixel_centre<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, self.surface.centres())
    }

    /// Unit normals of the surface: float32 [pixel][x, y, z].
    #[getter]
    fn pixel_normal<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let surface = self.surface.view();
        rows(py, self.surface.pixels.iter().map(|pixel| surface.normal(pixel)))
    }

    /// Areas of the pixels, m^2: float32 [pixel].
    #[getter]
    fn pixel_area<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        let surface = self.surface.view();
        list(py, self.surface.pixels.iter().map(|pixel| surface.area(pixel)).collect())
    }

    /// An image as a picture: float64 [row][column], row 0 on top, NaN where there is no skin. None where pixels are no
    /// cells of a grid, as on a curved skin.
    fn picture<'py>(
        &self,
        py: Python<'py>,
        image: &Bound<'py, PyAny>,
    ) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let Some((grid, cells)) = self.header.grid.zip(self.cells()) else { return Ok(None) };
        let image = numbers::<f64>(image, "image")?;
        if image.len() != cells.len() {
            let (found, pixels) = (image.len(), cells.len());
            return Err(PyValueError::new_err(format!("image has {found} pixels, the patch {pixels}")));
        }
        let columns = usize::from(grid.columns);
        let mut picture = vec![f64::NAN; grid.cells()];
        for ([row, column], value) in cells.into_iter().zip(image) {
            picture[row * columns + column] = value;
        }
        table(py, picture, columns).map(Some)
    }

    /// Left, right, bottom and top edge of a picture, m; None where there is none.
    #[getter]
    fn extent(&self) -> Option<[f32; 4]> {
        let grid = self.header.grid?;
        let [right, bottom] = grid.position(grid.columns.into(), grid.rows.into());
        Some([grid.left, right, bottom, grid.top])
    }

    /// As a file holds it.
    fn __bytes__<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &self.bytes)
    }

    fn __repr__(&self) -> String {
        let PatchHeader { skin, measurements, pixels, .. } = &self.header;
        format!("<Patch {skin}, {measurements} measurements, {pixels} pixels, crc {:#010x}>", self.crc)
    }
}
