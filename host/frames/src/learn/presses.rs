//! Recorded presses: where, how hard, and what was measured before and during each.
//!
//! An archive (`.npz`) holds `v_pressed`, `positions_m`, usually `v_unpressed`, and `force_n` if forces are known; a
//! table (`.csv`, `.txt`) one press a row: x and y in metres, the force in newtons if known, then the frame.

use crate::{
    array::{ArrayError, Source, file},
    recorded::{
        diagnose::dead_below,
        difference::{difference, signed_reference},
        order::{Arrangement, OrderError},
        read::{Frames, ReadError, read},
    },
};
use dermatome_model::{
    inverse::targets::half_side,
    jacobian::combine_voltages,
    model::{Model, TooManyPixels, divisors},
    pixels::Pixels,
};
use dermatome_patch::layout::Layout;
use nalgebra::Point3;
use num_complex::Complex64;
use std::path::Path;

/// Array of an archive: frames of the pressed skin, one for each press.
pub const PRESSED: &str = "v_pressed";
/// Array of an archive: frames of the untouched skin, one for all or one for each press.
pub const UNPRESSED: &str = "v_unpressed";
/// Array of an archive: where each press was, m; x, y, and perhaps more that is not used.
pub const POSITIONS: &str = "positions_m";
/// Array of an archive: force of each press, N.
pub const FORCES: &str = "force_n";

/// Heights and slopes up to this share are none.
const FLAT: f64 = 1e-6;

/// Presses as recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Frames during the presses.
    pub pressed: Frames,
    /// Frames of the untouched skin: one, or one for each press.
    pub unpressed: Frames,
    /// Where, m: `[press]`.
    pub positions: Vec<[f64; 2]>,
    /// How hard, N: `[press]`.
    pub forces: Option<Vec<f64>>,
}

/// Presses as a skin's model sees them.
#[derive(Clone, Debug, PartialEq)]
pub struct Presses {
    /// Difference data of the skin's kind: `[press][measurement]`.
    pub data: Vec<Vec<f64>>,
    /// Where, m: `[press]`.
    pub places: Vec<Point3<f64>>,
    /// How hard, N, above zero: `[press]`.
    pub forces: Option<Vec<f64>>,
    /// What the difference data of the mean reference divide by, in the file's unit:
    /// `[measurement]`.
    pub mean_divisors: Vec<f64>,
    /// Mean frame of the untouched skin, in the file's order.
    pub mean_reference: Vec<Complex64>,
}

/// Why recorded presses cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PressError {
    /// A file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// No frames of the untouched skin.
    #[error("`{file}` holds no frames of the untouched skin: give them as a reference of their own{}", also(.archive))]
    NoReference {
        /// The file.
        file: String,
        /// Whether it could hold them.
        archive: bool,
    },
    /// Not one for each press.
    #[error("{what} holds {found} rows, `{PRESSED}` {presses}; allowed: {allowed}")]
    Rows {
        /// The array.
        what: &'static str,
        /// Its rows.
        found: usize,
        /// Presses.
        presses: usize,
        /// What would do.
        allowed: &'static str,
    },
    /// Positions without two coordinates.
    #[error("`{POSITIONS}` has {0} columns; allowed: 2 or more, x and y first, in metres")]
    Coordinates(usize),
    /// A row that is neither.
    #[error(
        "rows hold {columns} numbers; for this skin allowed are x, y and {steps} or {square} measurements, or x, y, \
         force and as many"
    )]
    Columns {
        /// Columns of the table.
        columns: usize,
        /// Steps of the skin.
        steps: usize,
        /// Electrodes squared.
        square: usize,
    },
    /// Untouched and pressed frames of different instruments.
    #[error(
        "frames of presses hold {pressed} measurements, those of the untouched skin {unpressed}; they must be equal"
    )]
    Lengths {
        /// In a pressed frame.
        pressed: usize,
        /// In an untouched frame.
        unpressed: usize,
    },
    /// A place or force with an imaginary part.
    #[error("{what} of press {press} (counted from 0) is {value}; allowed: a real number")]
    NotReal {
        /// The array.
        what: &'static str,
        /// The press.
        press: usize,
        /// What it is.
        value: Complex64,
    },
    /// A press beside the skin.
    #[error(
        "press {press} (counted from 0) is at ({x}, {y}) m, {far_mm:.1} mm off the skin, which reaches {reach_mm:.1} mm from its \
         centre; allowed: places on the skin, in metres{}", perhaps_millimetres(.x, .y, .reach_mm)
    )]
    OffTheSkin {
        /// The press.
        press: usize,
        /// Its place, m.
        x: f64,
        /// Its place, m.
        y: f64,
        /// From the nearest pixel.
        far_mm: f64,
        /// Half the skin's larger side.
        reach_mm: f64,
    },
    /// A skin on which x and y are no place.
    #[error(
        "the skin is curved, or does not lie in the plane z = 0; allowed: flat skins there, on which x and y of a press say \
         where it is"
    )]
    NotFlat,
    /// A press without force.
    #[error("the force of press {press} (counted from 0) is {force} N; allowed: above zero")]
    Force {
        /// The press.
        press: usize,
        /// Its force.
        force: f64,
    },
    /// Frames that do not fit the skin.
    #[error(transparent)]
    Order(#[from] OrderError),
    /// A skin with more pixels than a board takes.
    #[error(transparent)]
    Pixels(#[from] TooManyPixels),
}

fn also(archive: &bool) -> String {
    if *archive { format!(", or in the archive as `{UNPRESSED}`") } else { String::new() }
}

fn perhaps_millimetres(x: &f64, y: &f64, reach_mm: &f64) -> &'static str {
    let is_on_skin_in_mm = x.hypot(*y) <= 2.0 * reach_mm && x.hypot(*y) * 1e3 > 10.0 * reach_mm;
    if is_on_skin_in_mm { " (these look like millimetres)" } else { "" }
}

impl Recording {
    /// Reads the presses of a file. `reference`, frames that are averaged, goes before the file's own; `offset` is
    /// subtracted from every measurement. A table needs the `electrodes` and `steps` of the skin.
    pub fn read(
        path: &Path,
        reference: Option<Frames>,
        offset: f64,
        electrodes: u8,
        steps: usize,
    ) -> Result<Self, PressError> {
        let reference = reference.map(|frames| averaged(&frames));
        let is_archive = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("npz"));
        if is_archive {
            Self::of_archive(path, reference, offset)
        } else {
            Self::of_table(path, reference, offset, electrodes, steps)
        }
    }

    fn of_archive(path: &Path, reference: Option<Frames>, offset: f64) -> Result<Self, PressError> {
        let source = |key: &str| Source { path: path.into(), key: Some(key.into()) };
        let pressed = read(&source(PRESSED))?.minus(offset);
        let positions = read(&source(POSITIONS))?;
        if positions.measurements < 2 {
            return Err(PressError::Coordinates(positions.measurements));
        }
        check_rows(POSITIONS, positions.frames, pressed.frames)?;
        let positions = places(&positions, [POSITIONS; 2])?;
        let unpressed = match reference {
            Some(reference) => reference,
            None if holds(&source(UNPRESSED)) => read(&source(UNPRESSED))?.minus(offset),
            None => return Err(PressError::NoReference { file: path.display().to_string(), archive: true }),
        };
        let forces = if holds(&source(FORCES)) {
            Some(forces(&read(&source(FORCES))?, pressed.frames)?)
        } else {
            None
        };
        Ok(Self { pressed, unpressed, positions, forces })
    }

    fn of_table(
        path: &Path,
        reference: Option<Frames>,
        offset: f64,
        electrodes: u8,
        steps: usize,
    ) -> Result<Self, PressError> {
        let rows = read(&Source { path: path.into(), key: None })?;
        let square = usize::from(electrodes).pow(2);
        let columns = rows.measurements;
        let is_frame = |leading: usize| columns == steps + leading || columns == square + leading;
        let leading = [2, 3].into_iter().find(|&leading| is_frame(leading));
        let leading = leading.ok_or(PressError::Columns { columns, steps, square })?;
        let Some(unpressed) = reference else {
            return Err(PressError::NoReference { file: path.display().to_string(), archive: false });
        };
        let positions = places(&rows, ["x", "y"])?;
        let forces = if leading == 3 { Some(column(&rows, 2, "the force")?) } else { None };
        let values = rows.iter().flat_map(|row| &row[leading..]).copied().collect();
        let pressed = Frames { values, measurements: columns - leading, ..rows.clone() }.minus(offset);
        Ok(Self { pressed, unpressed, positions, forces })
    }

    /// The presses as `model` sees them, once all of them are checked.
    pub fn on(&self, model: &Model, arrangement: &Arrangement) -> Result<Presses, PressError> {
        self.check(model)?;
        let electrodes = model.mesh.electrodes.len() as u8;
        let map = arrangement.index_map(&model.steps, electrodes, self.pressed.measurements)?;
        let reference_of = |press: usize| {
            let row = if self.unpressed.frames == 1 { 0 } else { press };
            let mut reference = self.unpressed.values[row * self.unpressed.measurements..]
                [..self.unpressed.measurements]
                .to_vec();
            // A dead measurement is exactly zero, and so counts as unchanged.
            let floor = dead_below(&reference, &map);
            reference.iter_mut().filter(|v| v.norm() <= floor).for_each(|v| *v = Complex64::ZERO);
            reference
        };
        let data = |(press, frame): (usize, &[Complex64])| {
            let reference = reference_of(press);
            let signed = signed_reference(&reference, &map, &model.voltages);
            model.difference_data(&difference(&reference, frame, &map, &model.voltages), &signed)
        };
        let mean_reference = self.unpressed.mean();
        let signed = signed_reference(&mean_reference, &map, &model.voltages);
        Ok(Presses {
            data: self.pressed.iter().enumerate().map(data).collect(),
            places: self.positions.iter().map(|&[x, y]| Point3::new(x, y, 0.0)).collect(),
            forces: self.forces.clone(),
            mean_divisors: divisors(model.difference, &combine_voltages(&signed, &model.combination)),
            mean_reference,
        })
    }

    fn check(&self, model: &Model) -> Result<(), PressError> {
        if !is_flat(model) {
            return Err(PressError::NotFlat);
        }
        let lengths = (self.pressed.measurements, self.unpressed.measurements);
        if lengths.0 != lengths.1 {
            return Err(PressError::Lengths { pressed: lengths.0, unpressed: lengths.1 });
        }
        if self.unpressed.frames != 1 && self.unpressed.frames != self.pressed.frames {
            return Err(PressError::Rows {
                what: "`v_unpressed`",
                found: self.unpressed.frames,
                presses: self.pressed.frames,
                allowed: "1, or one for each press",
            });
        }
        if let Some((press, &force)) =
            self.forces.iter().flatten().enumerate().find(|&(_, &force)| force <= 0.0)
        {
            return Err(PressError::Force { press, force });
        }
        let reach = half_side(&model.mesh);
        let pitch = f64::from(Layout::from(&model.surface()?).grid.pitch);
        for (press, &[x, y]) in self.positions.iter().enumerate() {
            let distance = |centre: &Point3<f64>| (centre.x - x).hypot(centre.y - y);
            let nearest = model.pixels.centres.iter().map(distance).fold(f64::INFINITY, f64::min);
            if nearest > pitch {
                return Err(PressError::OffTheSkin {
                    press,
                    x,
                    y,
                    far_mm: nearest * 1e3,
                    reach_mm: reach * 1e3,
                });
            }
        }
        Ok(())
    }
}

/// Whether the pixels lie in the plane z = 0.
fn is_flat(model: &Model) -> bool {
    let Pixels { centres, normals, .. } = &model.pixels;
    let height = centres.iter().map(|centre| centre.z.abs()).fold(0.0, f64::max);
    height < FLAT * half_side(&model.mesh) && normals.iter().all(|normal| normal.z > 1.0 - FLAT)
}

impl Presses {
    /// Number of each press's place, from 0 in the order of their first presses: presses closer than `same`, m, to the
    /// first press of a place are at it.
    #[must_use]
    pub fn place_numbers(&self, same: f64) -> Vec<usize> {
        let mut firsts: Vec<Point3<f64>> = Vec::new();
        let number = |place: &Point3<f64>| {
            let near = firsts.iter().position(|first| (first - place).norm() < same);
            near.unwrap_or_else(|| {
                firsts.push(*place);
                firsts.len() - 1
            })
        };
        self.places.iter().map(number).collect()
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// Measurements of the skin.
    #[must_use]
    pub fn measurements(&self) -> usize {
        self.mean_divisors.len()
    }
}

fn averaged(frames: &Frames) -> Frames {
    Frames { values: frames.mean(), frames: 1, ..frames.clone() }
}

/// Whether an archive holds an array of this name.
fn holds(source: &Source) -> bool {
    !matches!(file::read(source), Err(ArrayError::NoKey { .. }))
}

/// The first two columns, by what errors call them.
fn places(rows: &Frames, [x, y]: [&'static str; 2]) -> Result<Vec<[f64; 2]>, PressError> {
    Ok(column(rows, 0, x)?.into_iter().zip(column(rows, 1, y)?).map(|(x, y)| [x, y]).collect())
}

fn column(rows: &Frames, column: usize, what: &'static str) -> Result<Vec<f64>, PressError> {
    rows.iter().enumerate().map(|(press, row)| real(what, press, row[column])).collect()
}

/// One number for each press, as a row or a column.
fn forces(values: &Frames, presses: usize) -> Result<Vec<f64>, PressError> {
    check_rows(FORCES, values.values.len(), presses)?;
    values.values.iter().enumerate().map(|(press, &value)| real(FORCES, press, value)).collect()
}

fn check_rows(what: &'static str, found: usize, presses: usize) -> Result<(), PressError> {
    if found == presses {
        return Ok(());
    }
    Err(PressError::Rows { what, found, presses, allowed: "one for each press" })
}

fn real(what: &'static str, press: usize, value: Complex64) -> Result<f64, PressError> {
    if value.im == 0.0 { Ok(value.re) } else { Err(PressError::NotReal { what, press, value }) }
}
