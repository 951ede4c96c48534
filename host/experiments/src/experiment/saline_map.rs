//! Saline experiment 3 (thesis 4.1.2.3): a cube at 15 places, and the drift of the bath by itself.

use super::{
    ExperimentError,
    plot::{Chart, Series, Style},
    report::{Report, Wanted, largest, number},
    saline::{DRIVEN, bath, cube, dip, draw},
    sample_rig::{Artefacts, Shown},
};
use dermatome_model::metrics::thesis::Figures;
use dermatome_shared::contact::Contact;
use dermatome_simulate::material::{Material, Transducer};
use dermatome_view::sheet::Panel;
use serde_json::{Value, json};

/// Side of the cube, m.
const SIDE: f64 = 0.02;
/// Lines of places, m from the centre, and what the thesis calls them.
pub(super) const LINES: [(f64, &str); 3] = [(0.0, "centre"), (0.03, "off-centre"), (0.06, "edge")];
/// Places on a line, m.
pub(super) const PLACES: [f64; 5] = [0.06, 0.03, 0.0, -0.03, -0.06];

/// A load at one place and what came of it.
#[derive(Clone, Debug)]
pub(super) struct Spot {
    pub(super) at: [f64; 2],
    pub(super) shown: Shown,
    pub(super) figures: Option<Figures>,
    /// Distance of the board's contact from the place, share of the skin's side; the whole side where
    /// there is no contact.
    pub(super) error: f64,
}

pub(super) fn run() -> Result<Report, ExperimentError> {
    let mut report = Report::new("saline-map", "Saline experiment 3: a cube at 15 places (thesis 4.1.2.3)");
    let mut rig = bath(1)?;
    report.words(format!(
        "A cube of 20 mm stands under water at 15 places, 30 mm apart, on half of the bath. {DRIVEN} Artefacts: {}.",
        Artefacts::SALINE.words()
    ));
    let mut spots = Vec::new();
    for (x, _) in LINES {
        for y in PLACES {
            let shown = dip(&mut rig, &[cube([x, y], SIDE, SIDE)])?;
            spots.push(Spot::new(&rig, [x, y], shown));
        }
    }
    let side = rig.side();
    let percent = |spot: &Spot| 100.0 * spot.error;
    let mean = spots.iter().map(percent).sum::<f64>() / spots.len() as f64;
    let max = largest(spots.iter().map(percent));
    report.compare("position error, mean", "%", None, mean, Some(Wanted::AtMost(1.5)));
    report.compare("position error, largest", "%", Some(4.0), max, Some(Wanted::AtMost(4.0)));
    let shares: Vec<f64> =
        spots.iter().filter_map(|s| s.figures).map(|f| 100.0 * f.resolution.powi(2)).collect();
    let spread = largest(shares.iter().copied()) - shares.iter().copied().fold(f64::INFINITY, f64::min);
    report.compare(
        "spread of the region's share of the area (RES²)",
        "%",
        Some(10.0),
        spread,
        Some(Wanted::AtMost(10.0)),
    );
    let roots: Vec<f64> = spots.iter().filter_map(|s| s.figures).map(|f| 100.0 * f.resolution).collect();
    let root_spread = largest(roots.iter().copied()) - roots.iter().copied().fold(f64::INFINITY, f64::min);
    report.compare("spread of RES itself, times 100", "", None, root_spread, None);
    report.words(
        "Position error: distance of the board's contact from the cube; the thesis' PE counts radial distances only and is \
         shown below. The thesis' \"10 % of the total surface area\" is read as the region's share of the area, RES squared.",
    );
    let drift = drift()?;
    // The smallest cube of experiment 2: 5 cm^3.
    let smallest = dip(&mut rig, &[cube([0.0; 2], 0.0171, 0.0171)])?.voltage_change.abs();
    let largest_drift = largest(drift.iter().flatten().map(|point| point[1].abs()));
    report.compare(
        "drift in 120 s over the dV/V of 5 cm³ of water displaced",
        "",
        Some(0.1),
        largest_drift / smallest,
        None,
    );
    show_spots(&mut report, "Figures of the thesis at each place", &spots, side)?;
    let series = (1..).zip(drift.clone()).map(|(trial, points)| {
        Series::new(
            format!("trial {trial}"),
            points.iter().map(|&[t, v]| [t, 1e4 * v]).collect(),
            Style::MarkedLine,
        )
    });
    report.plots(&[Chart {
        title: "Drift of the bath without a cube (Fig. 4.7)",
        x: "time, s",
        y: "dV/V, 1e-4",
        series: series.collect(),
        square: None,
    }])?;
    report.words(
        "The drift is a random walk of the water's conductivity (models/materials/saline.toml: 0.01 % of the full change in a \
         minute, assumed) with the noise of the measurement; the worst of three trials counts. The thesis found it an order of \
         magnitude below any change of its volume experiments.",
    );
    let images: Vec<Vec<f64>> =
        spots.iter().map(|spot| spot.shown.image.iter().map(|value| -value).collect()).collect();
    let panels = spots.iter().zip(&images).map(|(spot, image)| panel(spot, image));
    report.picture(
        draw(&rig, "", 5, panels.collect())?,
        "What the board showed at the 15 places: lines from the centre to the edge, each from top to bottom. Circle: \
         contact; cross: where the cube stood.",
    );
    report.figures = json!({
        "position_error_percent": { "mean": mean, "max": max },
        "res_area_spread_percent": spread,
        "res_spread": root_spread / 100.0,
        "places": spots.iter().map(|spot| spot.json(side)).collect::<Vec<_>>(),
        "drift": drift,
    });
    Ok(report)
}

impl Spot {
    pub(super) fn new(rig: &super::sample_rig::SampleRig, at: [f64; 2], shown: Shown) -> Self {
        let figures = rig.figures(&shown, at);
        let error = shown.offset(at).map_or(1.0, |[x, y]| x.hypot(y) / rig.side());
        Self { at, shown, figures, error }
    }

    pub(super) fn json(&self, side: f64) -> Value {
        json!({
            "position_m": self.at,
            "position_error_percent": 100.0 * self.error,
            "thesis_pe_percent": self.figures.map(|figures| 100.0 * figures.position_error / side),
            "res": self.figures.map(|figures| figures.resolution),
            "rng": self.figures.map(|figures| figures.ringing),
            "contacts": self.shown.contacts.len(),
        })
    }
}

/// Table and diagrams of the thesis' figures, by line.
pub(super) fn show_spots(
    report: &mut Report,
    caption: &str,
    spots: &[Spot],
    side: f64,
) -> Result<(), ExperimentError> {
    let of = |spot: &Spot, pick: fn(&Figures) -> f64| spot.figures.as_ref().map_or(f64::NAN, pick);
    let row = |spot: &Spot| {
        let figures = [
            100.0 * spot.error,
            100.0 * of(spot, |f| f.position_error) / side,
            of(spot, |f| f.resolution),
            of(spot, |f| f.ringing),
        ];
        let place = format!("({:.1}, {:.1})", spot.at[0] * 100.0, spot.at[1] * 100.0);
        std::iter::once(place)
            .chain(figures.map(number))
            .chain([spot.shown.contacts.len().to_string()])
            .collect()
    };
    let columns = ["place, cm", "error, %", "PE (3.4), %", "RES", "RNG", "contacts"];
    report.table(caption, &columns, spots.iter().map(row).collect());
    let lines: Vec<&[Spot]> = spots.chunks(spots.len() / LINES.len()).collect();
    let chart = |title, y, value: &dyn Fn(&Spot) -> f64| {
        let series = lines.iter().zip(LINES).map(|(line, (_, name))| {
            let points = line.iter().map(|spot| [spot.at[1] * 100.0, value(spot)]).collect();
            Series::new(name, points, Style::MarkedLine)
        });
        Chart { title, x: "y, cm", y, series: series.collect(), square: None }
    };
    report.plots(&[
        chart("Position error", "error, % of the side", &|spot| 100.0 * spot.error),
        chart("Resolution", "RES", &|spot| of(spot, |f| f.resolution)),
        chart("Ringing", "RNG", &|spot| of(spot, |f| f.ringing)),
    ])
}

/// An image with its contact and its load.
pub(super) fn panel<'a>(spot: &Spot, image: &'a [f64]) -> Panel<'a> {
    Panel {
        caption: vec![format!("({:.1}, {:.1}) cm", spot.at[0] * 100.0, spot.at[1] * 100.0)],
        values: image,
        found: spot.shown.contacts.first().map(Contact::from_above).into_iter().collect(),
        truth: vec![(spot.at, 0.0)],
        maximum: None,
    }
}

/// dV/V of the bath by itself, at 0, 30 ... 120 s, in three trials: time and change.
fn drift() -> Result<Vec<Vec<[f64; 2]>>, ExperimentError> {
    let material = Material::named("saline")?;
    let trial = |seed: u64| {
        let mut rig = bath(seed)?;
        let mut water = Transducer::new(&material, seed);
        let mut points = Vec::new();
        for moment in 0..=4 {
            let seconds = if moment == 0 { 0.0 } else { 30.0 };
            let conductivity = 1.0 + water.respond(0.0, seconds);
            let shown = rig.show(&vec![conductivity; rig.elements()])?;
            points.push([30.0 * f64::from(moment), shown.voltage_change]);
        }
        Ok(points)
    };
    (1..=3).map(trial).collect()
}
