//! Above: a curved skin as it looks from above, along z, and the flat skin of the same looks.

use super::{
    Skin,
    shape::{NotFlat, Shape},
};
use dermatome_geometry::{
    embedding::Embedding,
    mesh::{Mesh, soundness::inspect},
    outline::Outline,
    sheet::{Place, Sheet},
};
use nalgebra::Point2;
use std::borrow::Cow;

/// Points of a rim that is not a polygon, from which its shadow is drawn.
const RIM_POINTS: u32 = 240;
/// An electrode closer to the rim's shadow than this share of the skin's diameter lies on it.
const ON_RIM: f64 = 0.02;

impl Shape {
    /// Rim of the skin as seen from above: of a flat skin its own. A skin whose rim crosses itself there,
    /// or that has none, is refused.
    pub fn from_above(&self) -> Result<Cow<'_, Outline>, NotFlat> {
        match self {
            // The rim of half a sphere is that of its development.
            Self::Sheet(Sheet {
                outline, embedding: Embedding::Flat | Embedding::Hemisphere { .. }, ..
            })
            | Self::Mesh { outline: Some(outline), .. } => Ok(Cow::Borrowed(outline)),
            Self::Sheet(sheet) => shadow(&laid_rim(sheet)),
            Self::Mesh { mesh, .. } => shadow(&longest_rim(mesh)),
        }
    }

    /// The flat skin of the same rim and electrodes, seen from above: z is dropped.
    pub fn flattened(&self) -> Result<Self, NotFlat> {
        let outline = self.from_above()?.into_owned();
        let centres = self.electrode_centres();
        let place = |electrode: usize| match self {
            Self::Sheet(Sheet {
                places, embedding: Embedding::Flat | Embedding::Hemisphere { .. }, ..
            }) if matches!(places[electrode], Place::Rim(_)) => places[electrode],
            _ => place_on(&outline, centres[electrode].xy()),
        };
        let places = (0..centres.len()).map(place).collect();
        Ok(Self::Sheet(Sheet { outline, embedding: Embedding::Flat, places }))
    }
}

impl Skin {
    /// This skin without its third dimension, as the thesis compares them (section 5.3.3.2): the model of a
    /// flat sheet of the same rim and electrodes as seen from above.
    pub fn flattened(&self) -> Result<Self, NotFlat> {
        Ok(Self { shape: self.shape.flattened()?, ..self.clone() })
    }
}

fn laid_rim(sheet: &Sheet) -> Vec<Point2<f64>> {
    let step = sheet.outline.perimeter() / f64::from(RIM_POINTS);
    let at = |i: u32| sheet.embedding.lay(sheet.outline.rim_point(f64::from(i) * step)).xy();
    (0..RIM_POINTS).map(at).collect()
}

fn longest_rim(mesh: &Mesh) -> Vec<Point2<f64>> {
    let rims = inspect(&mesh.nodes, &mesh.elements).boundary_loops;
    rims.first().map_or(Vec::new(), |rim| rim.iter().map(|&node| mesh.nodes[node].xy()).collect())
}

fn shadow(rim: &[Point2<f64>]) -> Result<Cow<'static, Outline>, NotFlat> {
    Outline::polygon(rim, &[]).map(Cow::Owned).map_err(|_| NotFlat)
}

/// On the rim if it is close to it, at the nearest of many arc lengths; else inside.
fn place_on(outline: &Outline, point: Point2<f64>) -> Place {
    let steps = 40 * RIM_POINTS;
    let at = |i: u32| f64::from(i) * outline.perimeter() / f64::from(steps);
    let distance = |i: u32| (outline.rim_point(at(i)) - point).norm();
    let nearest = (0..steps).min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
    if distance(nearest) < ON_RIM * outline.diameter() {
        Place::Rim(at(nearest))
    } else {
        Place::Inside(point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn shipped(name: &str) -> Skin {
        let file = format!("{}/../../models/{name}/skin.toml", env!("CARGO_MANIFEST_DIR"));
        Skin::load(Path::new(&file)).unwrap()
    }

    #[test]
    fn a_flat_skin_is_its_own_view_from_above() {
        let disc = shipped("disc-210mm");
        assert_eq!(disc.flattened().unwrap(), disc);
    }

    #[test]
    fn hemispheres_from_a_file_and_from_a_formula_flatten_to_the_same_disc() {
        for name in ["hemisphere-120mm", "hemisphere-210mm"] {
            let skin = shipped(name);
            let flat = skin.flattened().unwrap();
            let outline = flat.shape.flat().unwrap();
            assert!((outline.diameter() / skin.shape.from_above().unwrap().diameter() - 1.0).abs() < 1e-12);
            let centres = skin.shape.electrode_centres();
            for (flat, centre) in flat.shape.electrode_centres().iter().zip(&centres) {
                assert!((flat.xy() - centre.xy()).norm() < 3e-4 * outline.diameter(), "{flat} {centre}");
                assert_eq!(flat.z, 0.0);
            }
        }
    }
}
