//! Errors of the electrodes: the true skin's are not quite what the skin file says.

use super::EvaluateError;
use dermatome_geometry::sheet::{ElectrodeModel, Place, Sheet};
use dermatome_model::skin::{Shape, Skin};
use nalgebra::Vector2;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;

/// Mean distance of neighbouring electrodes along the rim, m; `None` where none lie there.
#[must_use]
pub(crate) fn spacing(skin: &Skin) -> Option<f64> {
    let Shape::Sheet(sheet) = &skin.shape else { return None };
    let count = sheet.on_rim().count();
    (count > 0).then(|| sheet.outline.perimeter() / count as f64)
}

/// A skin whose electrodes are shifted by random errors of standard deviation `shift`, m, and whose
/// contact impedances are off by the standard deviation `impedance`, a share.
///
/// Electrodes on the rim move along it, others in both directions. An impedance is multiplied by
/// exp(error), so that none becomes negative.
pub(crate) fn with_errors(skin: &Skin, shift: f64, impedance: f64, seed: u64) -> Result<Skin, EvaluateError> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut skin = skin.clone();
    if shift > 0.0 {
        move_electrodes(&mut skin, shift, &mut random)?;
    }
    if impedance > 0.0 {
        change_impedances(&mut skin.electrodes.model, impedance, &mut random)?;
    }
    Ok(skin)
}

fn normal(deviation: f64) -> Normal<f64> {
    Normal::new(0.0, deviation).expect("arguments are finite and not negative")
}

fn move_electrodes(skin: &mut Skin, shift: f64, random: &mut Pcg64Mcg) -> Result<(), EvaluateError> {
    let Shape::Sheet(sheet) = &mut skin.shape else {
        return Err(EvaluateError::Unsuited {
            option: "electrode_error",
            why: "the skin is an imported mesh, whose electrodes cannot move",
        });
    };
    let error = normal(shift);
    let before = sheet.clone();
    for place in &mut sheet.places {
        match place {
            Place::Rim(s) => *s += error.sample(random),
            Place::Inside(point) => *point += Vector2::from_fn(|_, _| error.sample(random)),
        }
    }
    match collision(&before, sheet, &skin.electrodes.model) {
        Some([a, b]) => Err(EvaluateError::Overlap { first: a + 1, second: b + 1 }),
        None => Ok(()),
    }
}

/// Neighbours on the rim that touch each other after their move, or have passed each other.
fn collision(before: &Sheet, after: &Sheet, model: &ElectrodeModel) -> Option<[usize; 2]> {
    let perimeter = before.outline.perimeter();
    let places = before.on_rim().zip(after.on_rim());
    // Electrode, place before, and how far it moved.
    let mut order: Vec<_> =
        places.map(|((e, from), (_, to))| (e, from.rem_euclid(perimeter), to - from)).collect();
    order.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut pairs = order.iter().zip(order.iter().cycle().skip(1)).filter(|(a, b)| a.0 != b.0);
    let collide = |((a, from_a, move_a), (b, from_b, move_b)): &(&(usize, f64, f64), &(usize, f64, f64))| {
        let between = (from_b - from_a).rem_euclid(perimeter) + move_b - move_a;
        between <= (model.width(*a) + model.width(*b)) / 2.0 + 1e-6 * perimeter
    };
    pairs.find(collide).map(|(a, b)| [a.0, b.0])
}

fn change_impedances(
    model: &mut ElectrodeModel,
    deviation: f64,
    random: &mut Pcg64Mcg,
) -> Result<(), EvaluateError> {
    let ElectrodeModel::Complete { contact_impedance, .. } = model else {
        return Err(EvaluateError::Unsuited {
            option: "impedance_error",
            why: "point electrodes have no contact impedance",
        });
    };
    let error = normal(deviation);
    contact_impedance.iter_mut().for_each(|impedance| *impedance *= error.sample(random).exp());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::tests::coarse_disc;

    fn moves(skin: &Skin, moved: &Skin) -> Vec<f64> {
        let [before, after] = [skin, moved].map(|skin| match &skin.shape {
            Shape::Sheet(sheet) => sheet.on_rim().map(|(_, s)| s).collect::<Vec<_>>(),
            Shape::Mesh { .. } => panic!("not a sheet"),
        });
        before.iter().zip(after).map(|(before, after)| after - before).collect()
    }

    #[test]
    fn electrodes_move_by_the_deviation_asked_for_and_alike_for_one_seed() {
        let skin = coarse_disc();
        assert_eq!(with_errors(&skin, 0.0, 0.0, 1).unwrap(), skin);
        let deviation = 1e-4;
        let squares: f64 = (0..200)
            .flat_map(|seed| moves(&skin, &with_errors(&skin, deviation, 0.0, seed).unwrap()))
            .map(|by| by * by)
            .sum();
        let count = 200.0 * f64::from(skin.electrodes.count);
        assert!(((squares / count).sqrt() / deviation - 1.0).abs() < 0.05);
        let twice = [7, 7].map(|seed| with_errors(&skin, deviation, 0.1, seed).unwrap());
        assert_eq!(twice[0], twice[1]);
        assert_ne!(twice[0], with_errors(&skin, deviation, 0.1, 8).unwrap());
    }

    #[test]
    fn electrodes_that_would_touch_are_refused_by_number() {
        let skin = coarse_disc();
        let wide = spacing(&skin).unwrap();
        let error = with_errors(&skin, wide, 0.0, 1).unwrap_err();
        assert!(matches!(error, EvaluateError::Overlap { first: 1.., second: 1.. }), "{error}");
    }

    #[test]
    fn impedances_change_by_the_share_asked_for_and_stay_positive() {
        let skin = coarse_disc();
        let logarithms = |deviation| -> Vec<f64> {
            let impedance = |model: &ElectrodeModel| match model {
                ElectrodeModel::Complete { contact_impedance, .. } => contact_impedance.clone(),
                ElectrodeModel::Point => panic!("no contact impedance"),
            };
            let before = impedance(&skin.electrodes.model);
            (0..200)
                .flat_map(|seed| {
                    impedance(&with_errors(&skin, 0.0, deviation, seed).unwrap().electrodes.model)
                })
                .zip(before.iter().cycle())
                .map(|(after, before)| (after / before).ln())
                .collect()
        };
        let values = logarithms(0.2);
        let mean_square = values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64;
        assert!((mean_square.sqrt() / 0.2 - 1.0).abs() < 0.05);
    }

    #[test]
    fn errors_that_a_skin_cannot_have_are_refused() {
        let mut skin = coarse_disc();
        skin.electrodes.model = ElectrodeModel::Point;
        let refused = with_errors(&skin, 0.0, 0.1, 1).unwrap_err();
        assert!(refused.to_string().contains("`impedance_error`"), "{refused}");
        let mesh =
            dermatome_model::model::mesh(&skin, 1.0, dermatome_geometry::mesh::Lattice::default()).unwrap();
        skin.shape = Shape::Mesh { mesh: Box::new(mesh), outline: None };
        assert_eq!(spacing(&skin), None);
        let refused = with_errors(&skin, 1e-3, 0.0, 1).unwrap_err();
        assert!(refused.to_string().contains("`electrode_error`"), "{refused}");
    }
}
