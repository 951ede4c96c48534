//! Order: which wire goes to which electrode, as presses show it, and the skin file that says so.
//!
//! A patch takes wire k to go to electrode k. Where the wires go round the same electrodes from another one on, or the
//! other way round, wire k goes to electrode r + k or r - k, and a press beside that one is seen beside electrode k.

use anyhow::{Context, bail, ensure};
use dermatome_frames::recorded::order::{Arrangement, SenseOrder};
use dermatome_model::skin::Skin;
use nalgebra::{Point2, Point3};
use std::path::Path;
use toml_edit::{DocumentMut, Item, Table, value};

/// The second electrode that is pressed, a quarter of the way round: there a mirror shows.
pub(super) fn second(electrodes: u8) -> usize {
    usize::from(electrodes).div_ceil(4)
}

/// Where the wires go, if presses beside electrode 0 and [`second`] are seen beside these; none where no turn and no
/// mirror does that. Electrodes count from 0.
pub(super) fn of_presses(seen: [usize; 2], electrodes: u8) -> Option<Arrangement> {
    let n = usize::from(electrodes);
    let between = (seen[1] + n - seen[0]) % n;
    let mirrored = match between {
        forward if forward == second(electrodes) => false,
        backward if backward == n - second(electrodes) => true,
        _ => return None,
    };
    let rotation = if mirrored { seen[0] } else { (n - seen[0]) % n };
    Some(Arrangement { sense: SenseOrder::default(), rotation: u8::try_from(rotation).ok()?, mirrored })
}

/// The electrode that a wire goes to, both from 0.
fn electrode_of(wire: usize, order: &Arrangement, electrodes: usize) -> usize {
    let along = if order.mirrored { electrodes - wire % electrodes } else { wire };
    (along + usize::from(order.rotation)) % electrodes
}

/// The order in words, electrodes from 1.
pub(super) fn told(order: &Arrangement) -> String {
    let way = if order.mirrored { ", and the others go round the other way" } else { "" };
    format!("wire 1 goes to electrode {}{way}", order.rotation + 1)
}

/// The electrode whose centre is next to a point, from 0, and how far away it is, m.
pub(super) fn nearest(centres: &[Point3<f64>], point: Point2<f64>) -> Option<(usize, f64)> {
    let away = centres.iter().map(|centre| (centre.xy() - point).norm()).enumerate();
    away.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The skin file's text with its electrodes numbered as the wires are, `skin` being what the text says; `file` is for
/// messages.
pub(super) fn reordered(
    text: &str,
    file: &Path,
    skin: &Skin,
    order: &Arrangement,
) -> anyhow::Result<(String, Skin)> {
    let mut document: DocumentMut = text.parse().context("the skin file is no TOML")?;
    let electrodes = document.get_mut("electrodes").and_then(Item::as_table_mut);
    let electrodes = electrodes
        .context("`electrodes` is no table of its own; allowed: one that begins with [electrodes]")?;
    let n = usize::from(skin.electrodes.count);
    for field in ["positions", "width", "contact_impedance"] {
        reorder_list(electrodes, field, order, n);
    }
    match electrodes.get("placement").and_then(Item::as_str) {
        Some("points") => {}
        Some("rim" | "sides") => turn(electrodes, skin, order)?,
        other => bail!(
            "`electrodes.placement` is {}; allowed for another order: \"rim\", \"sides\" or \"points\"",
            other.unwrap_or("not given")
        ),
    }
    let text = document.to_string();
    let made = Skin::parse(file, &text)?.made()?;
    ensure!(
        is_reordered(skin, &made, order),
        "no `electrodes.first` and `electrodes.direction` put the electrodes of this skin into another order: exchange the wires"
    );
    Ok((text, made))
}

/// Puts the entries of a list of all electrodes into the order of the wires.
fn reorder_list(electrodes: &mut Table, field: &str, order: &Arrangement, n: usize) {
    let Some(list) = electrodes.get_mut(field).and_then(Item::as_array_mut).filter(|list| list.len() == n)
    else {
        return;
    };
    let old = list.clone();
    for wire in 0..n {
        if let Some(entry) = old.get(electrode_of(wire, order, n)) {
            list.replace_formatted(wire, entry.clone());
        }
    }
}

/// Begins the electrodes of a rim where wire 1 goes.
fn turn(electrodes: &mut Table, skin: &Skin, order: &Arrangement) -> anyhow::Result<()> {
    let centres = skin.shape.electrode_centres();
    let n = centres.len();
    let middle = skin.shape.from_above()?.middle();
    let direction = |at: usize| centres[at].xy() - middle;
    let first = direction(electrode_of(0, order, n));
    // Sides begin with the first electrode that is met: a hair before it.
    let before = direction(electrode_of(n - 1, order, n));
    let hair = if electrodes.get("placement").and_then(Item::as_str) == Some("sides") { 1e-3 } else { 0.0 };
    let start = first.normalize() * (1.0 - hair) + before.normalize() * hair;
    electrodes["first"] = value(format!("{:.4} deg", start.y.atan2(start.x).to_degrees()));
    if order.mirrored {
        let other = match electrodes.get("direction").and_then(Item::as_str) {
            Some("counter-clockwise") => "clockwise",
            _ => "counter-clockwise",
        };
        electrodes["direction"] = value(other);
    }
    Ok(())
}

/// Whether electrode k of `after` lies where wire k goes on `before`.
fn is_reordered(before: &Skin, after: &Skin, order: &Arrangement) -> bool {
    let [before, after] = [before, after].map(|skin| skin.shape.electrode_centres());
    let n = before.len();
    let Some(spacing) = (1..n).map(|at| (before[at] - before[0]).norm()).min_by(f64::total_cmp) else {
        return false;
    };
    let is_there = |wire: usize| (after[wire] - before[electrode_of(wire, order, n)]).norm() < 0.1 * spacing;
    after.len() == n && (0..n).all(is_there)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TINY: &str = include_str!("../../../../tests/data/tiny.toml");

    fn skin(text: &str) -> Skin {
        Skin::parse(Path::new("skin.toml"), text).unwrap().made().unwrap()
    }

    fn order(rotation: u8, mirrored: bool) -> Arrangement {
        Arrangement { rotation, mirrored, ..Arrangement::default() }
    }

    #[test]
    fn two_presses_tell_turn_and_mirror_whatever_they_are() {
        for n in [8_u8, 16] {
            for (rotation, mirrored) in (0..n).flat_map(|rotation| [(rotation, false), (rotation, true)]) {
                let order = order(rotation, mirrored);
                let wire_at = |electrode: usize| {
                    (0..n.into()).find(|&wire| electrode_of(wire, &order, n.into()) == electrode).unwrap()
                };
                assert_eq!(of_presses([wire_at(0), wire_at(second(n))], n), Some(order));
            }
        }
        assert_eq!(of_presses([0, 4], 16), Some(Arrangement::default()));
        assert_eq!(of_presses([0, 5], 16), None, "two wires are exchanged, or it was pressed elsewhere");
    }

    #[test]
    fn a_skin_file_says_any_turn_and_mirror_of_a_rim_of_sides_and_of_points() {
        let points = "placement = \"points\"\npositions = [[0.045, 0.0], [0.03, 0.03], [0.0, 0.045], [-0.03, 0.03], \
                      [-0.045, 0.0], [-0.03, -0.03], [0.0, -0.045], [0.03, -0.03]]";
        let disc = "kind = \"disc\"\ndiameter = \"100 mm\"";
        let square = "kind = \"rectangle\"\nwidth = \"100 mm\"\nheight = \"90 mm\"";
        let rim = "placement = \"rim\"";
        let sides = "placement = \"sides\"\npitch = \"30 mm\"";
        for (placement, shape) in [(rim, disc), (points, disc), (sides, square)] {
            let text = TINY.replace(rim, placement).replace(disc, shape);
            let skin = skin(&text);
            for (rotation, mirrored) in [(3, false), (0, true), (5, true)] {
                // It says itself whether electrodes are where they should be.
                let (new, made) =
                    reordered(&text, Path::new("skin.toml"), &skin, &order(rotation, mirrored)).unwrap();
                assert_ne!(new, text);
                assert_eq!(made.name, skin.name);
            }
        }
    }

    #[test]
    fn a_skin_file_that_cannot_be_changed_is_refused_with_what_is_allowed() {
        let skin = skin(TINY);
        let inline = "electrodes = { count = 8 }\n";
        let groups = TINY.replace("placement = \"rim\"", "placement = \"groups\"");
        for (text, allowed) in [(inline, "[electrodes]"), (&groups, "\"rim\", \"sides\" or \"points\"")] {
            let refused = reordered(text, Path::new("skin.toml"), &skin, &order(1, true));
            let words = refused.unwrap_err().to_string();
            assert!(words.contains(allowed), "{words}");
        }
    }
}
