//! A curved skin without its third dimension.

use super::Skin;
use dermatome_geometry::shape::NotFlat;

impl Skin {
    /// This skin without its third dimension, as the thesis compares them (section 5.3.3.2): the model of a
    /// flat sheet of the same rim and electrodes as seen from above.
    pub fn flattened(&self) -> Result<Self, NotFlat> {
        let mut flat = Self { shape: self.shape.flattened()?, ..self.clone() };
        flat.material.map = flat.material.map.map(|map| map.flattened());
        Ok(flat)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn shipped(name: &str) -> Skin {
        let file = format!("{}/../../models/{name}/skin.toml", env!("CARGO_MANIFEST_DIR"));
        Skin::load(Path::new(&file)).unwrap().made().unwrap()
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
