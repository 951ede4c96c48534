//! Reflexes of a patch, in owned form.

use dermatome_shared::patch::{
    PatchView,
    reflexes::{ReflexRow, ReflexRule, Weights},
};

/// Rules by which a board acts by itself, and their rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reflexes {
    /// The rules.
    pub rules: Vec<ReflexRule>,
    /// Their rows, one rule's after the other's, with weights `[measurement]`.
    pub rows: Vec<ReflexRow<Vec<f32>>>,
}

impl Reflexes {
    /// Those of a patch.
    #[must_use]
    pub fn read(patch: &PatchView<'_>) -> Self {
        let owned = |row: ReflexRow<Weights<'_>>| ReflexRow {
            area: row.area,
            places: row.places,
            weights: row.weights.iter().collect(),
        };
        Self { rules: patch.reflex_rules().collect(), rows: patch.reflex_rows().map(owned).collect() }
    }

    /// The same on a skin that reads these factors more: `[place]`. A row takes loads for as much less as the mean of its
    /// places, or, without one, of all.
    #[must_use]
    pub fn with_gains(mut self, gains: &[f64]) -> Self {
        for row in &mut self.rows {
            let is_in =
                |place: &usize| row.places.get(place / 8).is_some_and(|bits| bits >> (place % 8) & 1 == 1);
            let own: Vec<f64> = (0..gains.len()).filter(is_in).map(|place| gains[place]).collect();
            let of = if own.is_empty() { gains } else { &own };
            let gain = of.iter().sum::<f64>() / of.len().max(1) as f64;
            row.weights.iter_mut().for_each(|weight| *weight = (f64::from(*weight) / gain) as f32);
        }
        self
    }

    /// The rows, for writing a patch.
    #[must_use]
    pub fn rows(&self) -> Vec<ReflexRow<&[f32]>> {
        let weights = self.rows.iter().map(|row| &row.weights[..]);
        let rows = self.rows.iter().zip(weights);
        rows.map(|(row, weights)| ReflexRow { area: row.area, places: row.places, weights }).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_takes_loads_for_as_much_less_as_its_places_read_more() {
        let row = |places: [u8; 2]| {
            let mut bits = [0; 32];
            bits[..2].copy_from_slice(&places);
            ReflexRow { area: 1e-4, places: bits, weights: vec![6.0, -3.0] }
        };
        let reflexes =
            Reflexes { rules: Vec::new(), rows: vec![row([0b101, 0]), row([0, 0b10]), row([0, 0])] };
        let gains = [1.0, 9.0, 2.0, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0, 3.0];
        let scaled = reflexes.with_gains(&gains);
        let weights: Vec<_> = scaled.rows.iter().map(|row| row.weights.clone()).collect();
        assert_eq!(weights[..2], [vec![4.0, -2.0], vec![2.0, -1.0]]);
        assert!((weights[2][0] - 6.0 / 6.9).abs() < 1e-6, "without places all count");
    }
}
