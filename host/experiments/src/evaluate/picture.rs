//! The picture of an evaluation: a map of each figure.

use super::{Evaluation, FoundBy, pairs::Direction, single::Single};
use dermatome_view::map::{Panel, Places, Sheet, map_sheet};

/// Maps in a row.
const COLUMNS: u32 = 4;
/// A figure is shown so far around its place, in spacings.
const REACH: f64 = 1.0;
/// Set of places of single targets; those of pairs follow.
const SINGLES: usize = 0;

/// Draws the maps as a PNG file; `title` is their first line.
pub fn picture(evaluation: &Evaluation, title: String) -> Result<Vec<u8>, png::EncodingError> {
    let around = |points, spacing: f64| Places { points, reach: REACH * spacing };
    let mut places =
        vec![around(evaluation.singles.iter().map(|single| single.position).collect(), evaluation.spacing)];
    let mut panels = panels_of_singles(evaluation);
    for (direction, way) in [(Direction::Radial, "one behind the other"), (Direction::Across, "side by side")]
    {
        let pairs = || evaluation.pairs.iter().filter(|pair| pair.direction == direction);
        let distances = pairs().map(|pair| pair.told_apart.map(|distance| distance * 1e3)).collect();
        panels.push(panel(["two contacts told apart", way], "mm", places.len(), distances, false));
        places.push(around(pairs().map(|pair| pair.middle).collect(), evaluation.pair_spacing));
    }
    let electrodes: Vec<_> = evaluation.electrodes.iter().map(|centre| [centre.x, centre.y]).collect();
    let note = "grey: no contact, or not told apart at any distance for which there is room; pale: not tried. \
                Behind > lie the largest 5 in 100.";
    let sheet = Sheet {
        title: vec![title, note.to_owned()],
        mesh: &evaluation.mesh,
        electrodes: &electrodes,
        places,
        columns: COLUMNS,
        panels,
    };
    map_sheet(&sheet).encode()
}

fn panels_of_singles(evaluation: &Evaluation) -> Vec<Panel> {
    let per_cent = 100.0 / evaluation.skin_diameter;
    let map = |title: [&str; 2], name, from_zero, value: &dyn Fn(&Single) -> Option<f64>| {
        panel(title, name, SINGLES, evaluation.singles.iter().map(value).collect(), from_zero)
    };
    let found_by = match evaluation.found_by {
        FoundBy::Voltages => "contact in the voltages",
        FoundBy::Image => "contact in the board's image",
        FoundBy::F64Image => "contact in the image",
    };
    vec![
        map(["position error", found_by], "% of diameter", true, &|single| {
            Some(single.position_error()? * per_cent)
        }),
        map(["thesis: PE along radius", "magnitude"], "% of diameter", true, &|single| {
            Some(single.thesis?.position_error.abs() * per_cent)
        }),
        map(["thesis: RES", "root of region's share"], "0 to 1", false, &|single| {
            Some(single.thesis?.resolution)
        }),
        map(["thesis: RNG", "outside the region"], "of the region's sum", true, &|single| {
            Some(single.thesis?.ringing)
        }),
        map(["GREIT: PE along radius", "magnitude"], "% of diameter", true, &|single| {
            Some(single.greit?.position_error.abs() * per_cent)
        }),
        map(["GREIT: RES", "root of set's share"], "0 to 1", false, &|single| Some(single.greit?.resolution)),
        map(["GREIT: RNG", "outside the circle"], "of the circle's sum", true, &|single| {
            single.greit?.ringing
        }),
        map(["GREIT: SD", "set outside the circle"], "share of the set", true, &|single| {
            Some(single.greit?.shape_deformation)
        }),
        map(["GREIT: AR", "image over target"], "1 is faithful", false, &|single| {
            Some(single.greit?.amplitude_response)
        }),
        map(["contacts found", "for one target"], "number", false, &|single| {
            Some(single.contacts.len() as f64)
        }),
        map(["strength", "of the strongest contact"], "change", false, &|single| {
            Some(single.contacts.first()?.strength)
        }),
        map(["d' of a target", "in the voltages of a frame"], "standard deviations", true, &|single| {
            Some(single.detectability?.significance)
        }),
        map(["smallest target detected", "by one frame"], "change, linear", true, &|single| {
            Some(single.detectability?.smallest)
        }),
        map(["deviation of its place", "at least, by one frame"], "% of diameter", true, &|single| {
            Some(single.detectability?.position_deviation * per_cent)
        }),
    ]
}

/// A map with mean and largest value in its caption.
fn panel(
    [title, subtitle]: [&str; 2],
    name: &'static str,
    set: usize,
    values: Vec<Option<f64>>,
    from_zero: bool,
) -> Panel {
    let known = || values.iter().flatten();
    let mean = known().sum::<f64>() / known().count().max(1) as f64;
    let largest = known().copied().fold(f64::NEG_INFINITY, f64::max);
    let summary = if known().next().is_some() {
        format!("mean {mean:.3}, max {largest:.3}")
    } else {
        "no values".to_owned()
    };
    Panel { caption: [title.to_owned(), subtitle.to_owned(), summary], name, set, values, from_zero }
}
