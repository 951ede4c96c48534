//! `dermatome check --skin`: what a board measures on its untouched skin, against what the skin file says it should.

use super::interrupt;
use anyhow::{Context, ensure};
use dermatome_frames::recorded::{
    check::{
        Expected, check,
        findings::{About, Level},
        signal::noise,
    },
    fit::{Fit, FitError, fit},
    order::Arrangement,
    read::Frames,
    wording::{Advice, Wording},
};
use dermatome_link::{Link, LinkError, health::Finding};
use dermatome_model::skin::Skin;
use dermatome_shared::protocol::{PatchInfo, Selection};
use num_complex::Complex64;
use serde::Serialize;
use std::{
    f64::consts::PI,
    path::{Path, PathBuf},
    time::Duration,
};

/// A sheet that conducts so many times as well as the skin file says, or as badly, is worth a word.
const OFF: f64 = 1.2;
/// What the model leaves over of the voltages that is worth a word, %. On the shipped skins it is 0.2 to 5.3 % of their own
/// (electrodes inside a skin are hardest to model), and 23 % or more of another one's that is not of the same kind.
const MUCH_LEFT_PERCENT: f64 = 10.0;
/// A sheet that is off by more may be that of another skin.
const FAR_OFF: f64 = 4.0;

/// What came out; keys are documented in docs/cli.md.
#[derive(Serialize)]
pub(super) struct Compared {
    skin_file: PathBuf,
    /// Of log magnitudes, measured and modelled.
    correlation: f64,
    sheet_conductivity_s: Option<f64>,
    sheet_conductivity_of_file_s: f64,
    unexplained_percent: Option<f64>,
    /// Whether the model fits in no order that the board could have, or in another one.
    #[serde(skip)]
    pub(super) wires_are_wrong: bool,
    #[serde(skip)]
    pub(super) findings: Vec<Finding>,
    /// Where the wires are instead, if the skin's shape tells.
    #[serde(skip)]
    pub(super) order: Option<Arrangement>,
    /// Of the untouched voltages over their noise, root mean square, dB; none without noise.
    #[serde(skip)]
    pub(super) snr_db: Option<f64>,
}

/// A skin file, and what it says of an untouched skin.
pub(super) struct Model<'a> {
    file: &'a Path,
    skin: Skin,
    expected: Expected,
}

impl<'a> Model<'a> {
    pub(super) fn of(file: &'a Path) -> anyhow::Result<Self> {
        Self::of_skin(file, Skin::load(file)?.made()?)
    }

    /// The same of what the file says, or would say.
    pub(super) fn of_skin(file: &'a Path, skin: Skin) -> anyhow::Result<Self> {
        let expected = Expected::of(&skin).with_context(|| format!("skin file `{}`", file.display()))?;
        Ok(Self { file, skin, expected })
    }

    /// Refuses a board that measures otherwise.
    pub(super) fn check_steps(&self, link: &mut Link, patch: &PatchInfo) -> anyhow::Result<()> {
        ensure!(
            link.steps()? == self.expected.steps,
            "the board's patch, of `{}`, measures other steps than skin file `{}`; allowed: the skin file of that patch, or \
             `dermatome flash` first",
            patch.skin,
            self.file.display()
        );
        Ok(())
    }

    /// Compares it with voltages as [`frames`] gives them.
    pub(super) fn compare(&self, frames: &Frames, patch: &PatchInfo) -> anyhow::Result<Compared> {
        let in_file = || format!("skin file `{}`", self.file.display());
        let used = Arrangement::default();
        // In volts, with the skin file's current.
        let volts = frames.values.iter().map(|ohms| ohms * self.skin.drive.amplitude).collect();
        let frames = &Frames { values: volts, ..frames.clone() };
        let check = check(&self.expected, frames, used).with_context(in_file)?;
        let faults =
            check.findings.iter().filter(|finding| finding.level == Level::Fault && tells(finding.about));
        let mut findings: Vec<Finding> = faults
            .map(|fault| Finding { what: fault.found.clone(), advice: fault.advice.told(&Wires) })
            .collect();
        let wires_are_wrong = !findings.is_empty();
        let fit = if wires_are_wrong { None } else { self.fit(frames).with_context(in_file)? };
        findings.extend(self.of_another_skin(patch));
        findings.extend(fit.as_ref().and_then(|fit| left_over(fit).or_else(|| self.off(fit))));
        Ok(Compared {
            skin_file: self.file.to_owned(),
            correlation: check.sound_correlation,
            sheet_conductivity_s: fit.as_ref().map(|fit| fit.sheet_conductivity_s),
            sheet_conductivity_of_file_s: self.skin.material.sheet_conductivity,
            unexplained_percent: fit.as_ref().map(|fit| fit.residual_percent),
            order: check.findings.iter().find_map(|finding| order(&finding.advice)),
            snr_db: check.steadiness.and_then(|steadiness| steadiness.snr_db),
            wires_are_wrong,
            findings,
        })
    }

    /// Sheet and contacts; none of a skin whose file or measurements do not tell them.
    fn fit(&self, frames: &Frames) -> Result<Option<Fit>, FitError> {
        match fit(&self.skin, &frames.mean(), &Arrangement::default()) {
            Ok(fit) => Ok(Some(fit)),
            Err(FitError::PointModel | FitError::TooFew { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }

    fn of_another_skin(&self, patch: &PatchInfo) -> Option<Finding> {
        let (name, file) = (&patch.skin, self.file.display());
        (name.as_str() != self.skin.name).then(|| Finding {
            what: format!("the board's patch is of `{name}`, skin file `{file}` is of `{}`", self.skin.name),
            advice: format!("build the patch of `{file}`, and `dermatome flash` it"),
        })
    }

    /// A sheet of another conductivity than the file says.
    fn off(&self, fit: &Fit) -> Option<Finding> {
        let (found, said) = (fit.sheet_conductivity_s, self.skin.material.sheet_conductivity);
        let ratio = found / said;
        let file = self.file.display();
        (!(1.0 / OFF..=OFF).contains(&ratio)).then(|| Finding {
            what: format!(
                "the sheet conducts {ratio:.2} times as well as `{file}` says: {:.3} mS per square, not {:.3}",
                1e3 * found,
                1e3 * said
            ),
            advice: format!(
                "{}set `material.sheet_conductivity` = \"{:.3} mS\" there, then build and flash the patch anew",
                if (1.0 / FAR_OFF..=FAR_OFF).contains(&ratio) { "" } else { "if it is the file of this skin, " },
                1e3 * found
            ),
        })
    }
}

impl Compared {
    /// How many ohms too little each electrode's test leaves for its contact, as the board takes the sheet for
    /// that of the patch, whose share it knows: `[electrode]`.
    pub(super) fn missing(&self, of_sheet: &[f32]) -> Vec<f32> {
        let ratio = self.sheet_conductivity_s.map_or(1.0, |found| found / self.sheet_conductivity_of_file_s);
        of_sheet.iter().map(|ohms| ohms * (1.0 - 1.0 / ratio) as f32).collect()
    }

    /// Whether the sheet's conductivity was found.
    pub(super) fn has_sheet(&self) -> bool {
        self.sheet_conductivity_s.is_some()
    }

    pub(super) fn rows(&self) -> Vec<(&'static str, String)> {
        let sheet = self.sheet_conductivity_s.map_or("not fitted".to_owned(), |found| {
            format!(
                "{:.3} mS per square (skin file {:.3})",
                1e3 * found,
                1e3 * self.sheet_conductivity_of_file_s
            )
        });
        let left = self.unexplained_percent.map(|percent| format!(", which leaves {percent:.2} % over"));
        vec![
            ("model", format!("correlation {:.4}{}", self.correlation, left.unwrap_or_default())),
            ("sheet", sheet),
        ]
    }
}

fn left_over(fit: &Fit) -> Option<Finding> {
    (fit.residual_percent > MUCH_LEFT_PERCENT).then(|| Finding {
        what: format!("the model leaves {:.0} % of the voltages over, whatever sheet and contacts are", fit.residual_percent),
        advice: "check that the skin file's shape and electrodes are those of the skin, and that nothing touches it".to_owned(),
    })
}

/// The order of the wires that is advised, if it is the only one that fits.
fn order(advice: &Advice) -> Option<Arrangement> {
    match advice {
        Advice::Rearrange(change) if !change.rotation_ambiguous => Some(change.best),
        _ => None,
    }
}

/// Whether such a fault says something of skin and wires that the electrodes' own tests do not.
fn tells(about: About) -> bool {
    matches!(about, About::Order | About::Resemblance | About::Exchange | About::Polarity | About::Electrode)
}

/// Streams so many frames of voltages over the current: in ohm.
pub(super) fn frames(
    link: &mut Link,
    count: usize,
    ohms_per_code: f64,
    timeout: Duration,
) -> Result<Option<Frames>, LinkError> {
    let go_on = || !interrupt::requested();
    let mut stream = link.subscribe(Selection { measurements: 1, ..Selection::default() })?;
    let mut values = Vec::new();
    let (mut frames, mut measurements) = (0, 0);
    while frames < count && go_on() {
        let Some(frame) = stream.next_while(timeout, go_on)? else { break };
        let Some(measured) = frame.measurements else { continue };
        values.extend(measured.codes.iter().map(|code| Complex64::from(f64::from(code.0) * ohms_per_code)));
        (frames, measurements) = (frames + 1, measured.codes.len());
    }
    stream.stop()?;
    Ok((frames > 0).then_some(Frames { values, frames, measurements, complex: false }))
}

/// By which part of them measurements, each the mean of a step and the one with drive and sense exchanged, differ between
/// the two on average where they differ by noise alone.
pub(super) fn difference_by_noise(frames: &Frames) -> f64 {
    let size: f64 = frames.mean().iter().map(|value| value.norm()).sum();
    // The difference has twice the noise of the mean, and the mean of what is so large is less.
    let mean_of_normal = (2.0 / PI).sqrt();
    if size > 0.0 { 2.0 * mean_of_normal * noise(frames).iter().sum::<f64>() / size } else { 0.0 }
}

/// Names wires in advice.
struct Wires;

impl Wording for Wires {
    fn arrangement(&self, arrangement: &Arrangement) -> String {
        if *arrangement == Arrangement::default() {
            return String::new();
        }
        let first = format!("the wire of electrode {} as the first", arrangement.rotation + 1);
        let order = if arrangement.mirrored { ", and the others in reverse order" } else { "" };
        format!("{first}{order} (or say so in the skin file: `electrodes.first`, `electrodes.direction`)")
    }

    fn offset(&self, value: f64) -> String {
        format!("look for what adds {value:.4} V")
    }
}
