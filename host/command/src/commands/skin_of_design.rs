//! The skin file of a design: the skin's own, with other electrodes and another pattern.

use anyhow::{Context, bail};
use dermatome_model::{model::design::Proposal, skin::Skin};
use nalgebra::Point3;
use toml_edit::{Array, DocumentMut, Item, Table, value};

/// Hyperparameter for plain difference data over that for normalised ones, about.
const PLAIN: f64 = 0.1;

/// Text of the skin file; what is not of electrodes and pattern stays as it was written.
pub(super) fn skin_file(text: &str, name: &str, skin: &Skin, proposal: &Proposal) -> anyhow::Result<String> {
    let mut file: DocumentMut = text.parse().context("the skin file is no TOML")?;
    set(file.as_table_mut(), "name", name);
    let flat = skin.shape.flat().is_ok();
    let electrodes = table(&mut file, "electrodes")?;
    for field in ["pitch", "first", "direction", "ground"] {
        electrodes.remove(field);
    }
    set(electrodes, "count", proposal.positions.len() as i64);
    set(electrodes, "placement", "points");
    set(electrodes, "positions", positions(&proposal.positions, flat));
    let width = skin.electrodes.model.width(0);
    if width > 0.0 && !electrodes.get("width").is_some_and(is_one_value) {
        set(electrodes, "width", format!("{:.3} mm", width * 1e3));
    }
    one_value(electrodes, "contact_impedance");
    let drive = table(&mut file, "drive")?;
    drive.remove("table");
    drive.remove("driven");
    set(drive, "pattern", pattern(proposal));
    let inverse = table(&mut file, "inverse")?;
    plain_difference(inverse);
    Ok(file.to_string())
}

/// Pairs may lie so that an untouched voltage is too small to divide by: changes are over the mean of all.
fn plain_difference(inverse: &mut Table) {
    if inverse.get("normalised").and_then(Item::as_bool) != Some(true) {
        return;
    }
    set(inverse, "normalised", false);
    inverse.remove("weights");
    let number = |item: &Item| item.as_float().or_else(|| item.as_integer().map(|whole| whole as f64));
    if let Some(lambda) = inverse.get("hyperparameter").and_then(number) {
        set(inverse, "hyperparameter", lambda * PLAIN);
    }
}

/// The pattern as skin files name it.
pub(super) fn pattern(proposal: &Proposal) -> String {
    match proposal.distance {
        1 => "adjacent".to_owned(),
        distance => format!("skip-{}", distance - 1),
    }
}

/// Whether a skin file lists a weight for each measurement, which other electrodes have others of.
pub(super) fn refuse_weights(text: &str) -> anyhow::Result<()> {
    let file: DocumentMut = text.parse().context("the skin file is no TOML")?;
    let weights = file.get("inverse").and_then(|inverse| inverse.get("weights"));
    let is_rule = |weights: &Item| matches!(weights.as_str(), Some("steps" | "reference-squared"));
    if weights.is_none_or(is_rule) {
        return Ok(());
    }
    bail!(
        "`inverse.weights` is of the measurements there are; allowed for a design: \"steps\" or \"reference-squared\""
    )
}

fn table<'a>(file: &'a mut DocumentMut, name: &str) -> anyhow::Result<&'a mut Table> {
    let table = file.get_mut(name).and_then(Item::as_table_mut);
    table.with_context(|| format!("`{name}` is no table of its own; allowed: one that begins with [{name}]"))
}

/// Sets a field; a comment behind it, which is of what was there, goes.
fn set(table: &mut Table, field: &str, new: impl Into<toml_edit::Value>) {
    table[field] = value(new);
}

fn is_one_value(item: &Item) -> bool {
    item.as_value().is_some_and(|value| !value.is_array())
}

/// Of a list for the electrodes there were, the first value.
fn one_value(table: &mut Table, field: &str) {
    let first = table.get(field).and_then(Item::as_array).and_then(|list| list.get(0)).cloned();
    if let Some(first) = first {
        set(table, field, first.decorated(" ", ""));
    }
}

/// One row each, in mm.
fn positions(points: &[Point3<f64>], flat: bool) -> Array {
    let axes = if flat { 2 } else { 3 };
    let row = |point: &Point3<f64>| -> Array {
        point.iter().take(axes).map(|metres| format!("{:.2} mm", metres * 1e3 + 0.0)).collect()
    };
    let mut rows: Array = points.iter().map(row).collect();
    rows.iter_mut().for_each(|row| row.decor_mut().set_prefix("\n    "));
    rows.set_trailing_comma(true);
    rows.set_trailing("\n");
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::patch::Difference;
    use std::path::Path;

    const SKIN: &str = include_str!("../../../../models/square-210mm/skin.toml");

    fn proposal() -> Proposal {
        let at = |x: f64, y: f64| Point3::new(x * 1e-3, y * 1e-3, 0.0);
        let positions = vec![
            at(0.0, 105.0),
            at(105.0, 0.0),
            at(30.0, 20.0),
            at(0.0, -105.0),
            at(-105.0, 0.0),
            at(-30.0, 10.0),
        ];
        Proposal { positions, on_rim: 4, distance: 2, judged: 1 }
    }

    #[test]
    fn all_but_electrodes_and_pattern_stays_and_the_skin_file_is_read() {
        let skin = Skin::parse(Path::new("skin.toml"), SKIN).unwrap().made().unwrap();
        let text = skin_file(SKIN, "other", &skin, &proposal()).unwrap();
        let made = Skin::parse(Path::new("skin.toml"), &text).unwrap().made().unwrap();
        let centres = made.shape.electrode_centres();
        for (centre, wanted) in centres.iter().zip(&proposal().positions) {
            assert!((centre - wanted).norm() < 1e-5, "{centre} {wanted}");
        }
        assert_eq!(made.name, "other");
        assert_eq!(made.material, skin.material);
        // Six pairs drive; three of the others touch no driven electrode.
        assert_eq!(made.steps().len(), 6 * 3);
        let after = |text: &str, table: &str| text.split_once(table).unwrap().1.to_owned();
        assert_eq!(after(&text, "[image]"), after(SKIN, "[image]"));
        assert_eq!(made.inverse.difference, Difference::Plain);
    }

    #[test]
    fn weights_of_each_measurement_are_refused() {
        refuse_weights(SKIN).unwrap();
        let listed = SKIN.replace("[inverse]", "[inverse]\nweights = [1, 2]");
        assert!(refuse_weights(&listed).unwrap_err().to_string().contains("`inverse.weights`"));
    }
}
