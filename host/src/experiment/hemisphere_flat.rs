//! Surface against planar image on the hemisphere (thesis 5.4.4, Fig. 5.11): the same frames through the surface's
//! model and through that of the skin without its third dimension.

use super::{
    ExperimentError,
    hemisphere::{DIAMETER, matched, played_words, skins},
    plot::{Chart, Series, Style},
    report::{Report, Wanted, mean_and_deviation, number},
};
use crate::{
    learn::judge::board_image,
    model::Model,
    quantize,
    scenes::{Options, Scene, play},
    simulate::{Press, TrueSkin},
    skin::{Skin, electrodes_in_plane},
    view::{
        layout::Layout,
        sheet::{Panel, Sheet, reconstruction_sheet},
    },
};
use dermatome_shared::{
    contact::{self, Contact},
    patch::PatchView,
    reference::DEFAULT_TARE_FRAMES,
};
use nalgebra::Point3;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use serde_json::json;

/// Scenes: a third each with one, two and three contacts.
const SCENES: usize = 150;
/// How much better the surface's model should be.
const BETTER: f64 = 2.0;
/// Contacts closer to the pole than this, degrees of the sphere, hardly differ: the sheet is level there.
const POLE: f64 = 20.0;
/// The pictures' fingers: direction seen from above, degrees.
const PICTURES: [&[f64]; 2] = [&[20.0, 200.0], &[90.0, 210.0, 330.0]];
/// How far down from the pole they are, degrees of the sphere.
const DOWN: f64 = 50.0;

pub(super) fn run() -> Result<Report, ExperimentError> {
    let mut report = Report::new(
        "hemisphere-flat",
        "Surface against planar image on a hemisphere (thesis 5.4.4, Fig. 5.11)",
    );
    let options = Options { scenes: SCENES, ..Options::default() };
    report.words(played_words(&options));
    report.words(
        "Each frame is imaged twice: with the surface's model, and with the model of a flat disc with the same rim and electrodes \
         as seen from above. What the flat model finds is laid back onto the hemisphere from above.",
    );
    let [skin, true_skin] = skins()?;
    let flat = skin.flattened().map_err(crate::model::ModelError::from)?;
    compare(&mut report, &play(&skin, &true_skin, &options)?)?;
    let truth = TrueSkin::new(&true_skin)?;
    let (surface, planar) = (Eye::new(&skin)?, Eye::new(&flat)?);
    let scenes: Vec<Shown> = (1..)
        .zip(PICTURES)
        .map(|(seed, at)| Shown::new(at, &truth, [&surface, &planar], seed, &options))
        .collect();
    let of = |eye: usize| scenes.iter().map(move |scene| (scene, &scene.seen[eye]));
    report
        .picture(surface.draw(of(0))?, "Two and three contacts through the surface's model, seen from above");
    report.picture(planar.draw(of(1))?, "The same frames through the planar model");
    tabulate(&mut report, &scenes);
    Ok(report)
}

/// How far from the pole, degrees of the sphere.
fn way_down(centre: &Point3<f64>) -> f64 {
    centre.x.hypot(centre.y).atan2(centre.z).to_degrees()
}

/// Errors of both models, contact by contact: way from the pole in degrees, surface and planar in mm. Contacts that
/// either does not find are left out, and counted.
fn errors(scenes: &[Scene]) -> (Vec<[f64; 3]>, [usize; 2]) {
    let (mut errors, mut missed) = (Vec::new(), [0; 2]);
    for scene in scenes {
        let of = [&scene.surface, &scene.flattened].map(|found| matched(&scene.truth, found));
        for (index, centre) in scene.truth.iter().enumerate() {
            let [surface, flat] = [0, 1].map(|eye| of[eye][index]);
            missed[0] += usize::from(surface.is_none());
            missed[1] += usize::from(flat.is_none());
            errors.extend(surface.zip(flat).map(|(a, b)| [way_down(centre), a * 1e3, b * 1e3]));
        }
    }
    (errors, missed)
}

fn compare(report: &mut Report, scenes: &[Scene]) -> Result<(), ExperimentError> {
    let single: Vec<Scene> = scenes.iter().filter(|scene| scene.truth.len() == 1).cloned().collect();
    let mut figures = Vec::new();
    for (what, scenes) in [("single contacts", &single[..]), ("all contacts", scenes)] {
        let (errors, missed) = errors(scenes);
        let away: Vec<_> = errors.iter().filter(|[down, ..]| *down > POLE).collect();
        let mean = |eye: usize| mean_and_deviation(&away.iter().map(|e| e[eye]).collect::<Vec<_>>())[0];
        let [surface, flat] = [mean(1), mean(2)];
        let wanted = (what == "single contacts").then_some(Wanted::AtLeast(BETTER));
        report.compare(format!("{what} away from the pole: surface, mean error"), "mm", None, surface, None);
        report.compare(format!("{what} away from the pole: planar, mean error"), "mm", None, flat, None);
        report.compare(
            format!("{what} away from the pole: planar over surface"),
            "",
            None,
            flat / surface,
            wanted,
        );
        figures.push(json!({
            "of": what, "contacts": errors.len(), "away_from_pole": away.len(), "not_found": { "surface": missed[0], "planar": missed[1] },
            "mean_error_mm": { "surface": surface, "planar": flat },
        }));
    }
    let (errors, missed) = errors(&single);
    report.words(format!(
        "Away from the pole: more than {POLE:.0} degrees of the sphere. Contacts that one of the models does not find are left out: of \
         the single ones {} and {}.",
        missed[0], missed[1]
    ));
    let series = |name, eye: usize| {
        Series::new(name, errors.iter().map(|error| [error[0], error[eye]]).collect(), Style::Marks)
    };
    report.plots(&[Chart {
        title: "Single contacts",
        x: "way from the pole, degrees",
        y: "position error, mm",
        series: vec![series("surface", 1), series("planar", 2)],
        ..Chart::default()
    }])?;
    report.figures = json!({ "scenes": scenes.len(), "pole_degrees": POLE, "errors": figures });
    Ok(())
}

/// A model with its patch.
struct Eye {
    skin: Skin,
    model: Model,
    patch: Vec<u8>,
}

/// What one model shows of a frame, by the board's arithmetic.
struct Seen {
    image: Vec<f64>,
    contacts: Vec<Contact>,
}

impl Eye {
    fn new(skin: &Skin) -> Result<Self, ExperimentError> {
        let model = Model::build(skin, |_| ())?;
        let patch = quantize::patch(skin, &model)?;
        Ok(Self { skin: skin.clone(), model, patch })
    }

    fn look(&self, frame: &[f64], tare: &[f64]) -> Seen {
        let patch = PatchView::open(&self.patch).expect("the patch was checked when it was built");
        let change: Vec<f64> = frame.iter().zip(tare).map(|(v, r)| v - r).collect();
        let image = board_image(&patch, &self.model.difference_data(&change, tare));
        let contacts = contact::find(&patch.surface(), &image, patch.header.contact_threshold).to_vec();
        Seen { image: image.iter().map(|value| value.to_f64()).collect(), contacts }
    }

    fn draw<'a>(
        &self,
        scenes: impl Iterator<Item = (&'a Shown, &'a Seen)>,
    ) -> Result<Vec<u8>, ExperimentError> {
        let failed = |error: &dyn std::fmt::Display| ExperimentError::Draw(error.to_string());
        let layout = &Layout::from(&self.model.surface().map_err(|error| failed(&error))?);
        let panels = scenes.map(|(scene, seen)| Panel {
            caption: vec![format!("{} pressed, {} found", scene.truth.len(), seen.contacts.len())],
            values: &seen.image,
            found: seen.contacts.iter().map(Contact::from_above).collect(),
            truth: scene.truth.iter().map(|centre| ([centre.x, centre.y], scene.radius)).collect(),
            maximum: None,
        });
        let rim = electrodes_in_plane(&self.skin.shape);
        let sheet = Sheet { title: "", layout, electrodes: &rim, columns: 2, panels: panels.collect() };
        reconstruction_sheet(&sheet).encode().map_err(|error| failed(&error))
    }
}

/// One of the pictures' scenes, through both models.
struct Shown {
    truth: Vec<Point3<f64>>,
    radius: f64,
    /// Area of one finger on the hemisphere, m^2.
    area: f64,
    seen: [Seen; 2],
    /// Contacts of both, on the hemisphere.
    laid: [Vec<Point3<f64>>; 2],
}

impl Shown {
    fn new(directions: &[f64], true_skin: &TrueSkin, eyes: [&Eye; 2], seed: u64, options: &Options) -> Self {
        let radius = options.radius * DIAMETER;
        let away = DIAMETER / 2.0 * DOWN.to_radians().sin();
        let places = directions.iter().map(|direction| {
            let (sine, cosine) = direction.to_radians().sin_cos();
            [away * cosine, away * sine]
        });
        let presses: Vec<_> = places.clone().map(|at| Press::finger(at, radius, options.depth)).collect();
        let steps = &eyes[0].model.steps;
        let untouched = true_skin.voltages(&true_skin.conductivity(&[]), steps);
        let pressed = true_skin.voltages(&true_skin.conductivity(&presses), steps);
        let mean_square = untouched.iter().map(|v| v * v).sum::<f64>() / untouched.len() as f64;
        let deviation = mean_square.sqrt() * 10_f64.powf(-options.snr_db / 20.0);
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut noisy = |voltages: &[f64], deviation: f64| -> Vec<f64> {
            let mut noise = || -> f64 { StandardNormal.sample(&mut random) };
            voltages.iter().map(|voltage| voltage + deviation * noise()).collect()
        };
        let tare = noisy(&untouched, deviation / f64::from(DEFAULT_TARE_FRAMES).sqrt());
        let frame = noisy(&pressed, deviation);
        let seen = eyes.map(|eye| eye.look(&frame, &tare));
        let surface = seen[0].contacts.iter().map(|contact| Point3::from(contact.position.map(f64::from)));
        let flat = seen[1].contacts.iter().map(|contact| true_skin.lay(contact.from_above()));
        Self {
            truth: places.map(|at| true_skin.lay(at)).collect(),
            radius,
            area: std::f64::consts::PI * radius * radius / DOWN.to_radians().cos(),
            laid: [surface.collect(), flat.collect()],
            seen,
        }
    }
}

/// Position and size of the pictures' contacts.
fn tabulate(report: &mut Report, scenes: &[Shown]) {
    let mut rows = Vec::new();
    for scene in scenes {
        for (eye, name) in ["surface", "planar"].into_iter().enumerate() {
            let errors: Vec<f64> = matched(&scene.truth, &scene.laid[eye]).into_iter().flatten().collect();
            let contacts = &scene.seen[eye].contacts;
            let areas: Vec<f64> = contacts.iter().map(|contact| f64::from(contact.area) * 1e4).collect();
            rows.push(vec![
                format!("{} contacts, {name}", scene.truth.len()),
                contacts.len().to_string(),
                number(1e3 * mean_and_deviation(&errors)[0]),
                number(mean_and_deviation(&areas)[0]),
                number(1e4 * scene.area),
            ]);
        }
    }
    report.words(format!(
        "The pictures' fingers are {DOWN:.0} degrees of the sphere down from the pole. Crosses: where they truly are; rings: what the \
         board found. Areas of the planar model are areas of its disc."
    ));
    report.table(
        "The pictures' contacts",
        &["", "found", "position error, mean, mm", "region of interest, mean, cm²", "finger, cm²"],
        rows,
    );
}
