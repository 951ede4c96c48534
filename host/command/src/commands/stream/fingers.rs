//! Fingers: fitted to the voltages that a board streams.

use anyhow::{Context, bail};
use dermatome_link::Link;
use dermatome_model::{
    jacobian::{combine_voltages, step_counts},
    model::{Model, divisors},
    multi_contact::{FittedContact, MultiContactFit, Settings},
    skin::{
        Skin,
        quantity::{LENGTH, Quantity},
    },
};
use dermatome_shared::{
    protocol::{Reply, Request},
    units::AdcCode,
};
use std::time::{Duration, Instant};

/// The board's reference follows drift, so it is asked for so often.
const ASK_EVERY: Duration = Duration::from_secs(2);

/// Resolves fingers of one size on the skin of a board's patch.
pub(super) struct Fingers {
    model: Model,
    fit: MultiContactFit,
    /// The board's reference, in steps of its codes: `[measurement]`.
    reference: Vec<f64>,
    /// When it was asked for, unless the board may have another.
    asked: Option<Instant>,
    rests_until: Instant,
}

impl Fingers {
    /// Prepares the skin, which must be the board's; the board must have a reference.
    pub(super) fn new(skin: &Skin, radius: f64, link: &mut Link) -> anyhow::Result<Self> {
        let model = Model::build(skin, |_| ())?;
        let settings = Settings { radius, snr_db: skin.inverse.noise_db };
        let fit = MultiContactFit::new(skin, &model, settings)?;
        let reference = reference(link, &model)?;
        let now = Instant::now();
        Ok(Self { model, fit, reference, asked: Some(now), rests_until: now })
    }

    /// The board may have made a new reference.
    pub(super) fn forget_reference(&mut self) {
        self.asked = None;
    }

    /// The fingers in a frame, `[step]`, strongest first, in the skin's frame; `None` for a frame that passes
    /// while this rests. Each frame is followed by a rest of half its time: whoever is slower than the
    /// board lets frames pass, and does not fall behind.
    pub(super) fn of_frame(
        &mut self,
        codes: &[AdcCode],
        link: &mut Link,
    ) -> anyhow::Result<Option<Vec<FittedContact>>> {
        let begun = Instant::now();
        if begun < self.rests_until {
            return Ok(None);
        }
        if self.asked.is_none_or(|asked| asked.elapsed() > ASK_EVERY) {
            self.reference = reference(link, &self.model)?;
            self.asked = Some(Instant::now());
        }
        let fingers = self.fit.contacts(&self.difference(codes));
        self.rests_until = Instant::now() + begun.elapsed() / 2;
        Ok(Some(fingers))
    }

    /// Difference data of a frame, `[step]`: `[measurement]`.
    fn difference(&self, codes: &[AdcCode]) -> Vec<f64> {
        let voltages: Vec<f64> = codes.iter().map(|code| f64::from(code.0)).collect();
        let pressed = combine_voltages(&voltages, &self.model.combination);
        let divisors = divisors(self.model.difference, &self.reference);
        let change = |((v, r), d): ((&f64, &f64), &f64)| if *d == 0.0 { 0.0 } else { (v - r) / d };
        pressed.iter().zip(&self.reference).zip(&divisors).map(change).collect()
    }
}

/// The board's reference, a mean over its frames and over the steps of each measurement: `[measurement]`.
fn reference(link: &mut Link, model: &Model) -> anyhow::Result<Vec<f64>> {
    let Reply::Reference { frames, sums } = link.request(&Request::Reference)? else {
        bail!("`{}` answered a request for its reference with something else", link.port())
    };
    let counts = step_counts(&model.combination);
    if sums.len() != counts.len() {
        let (board, skin) = (sums.len(), counts.len());
        bail!("the board's reference has {board} measurements; the skin file's patch has {skin}");
    }
    let mean = |(sum, count): (&i64, &f64)| *sum as f64 / (f64::from(frames.max(1)) * count);
    Ok(sums.iter().zip(&counts).map(mean).collect())
}

/// The radius of a finger as somebody states it, m.
pub(in crate::commands) fn radius(text: &str) -> anyhow::Result<f64> {
    let quantity = text.trim().parse().map_or_else(|_| Quantity::Text(text.to_owned()), Quantity::Number);
    let read = LENGTH.read(&quantity).filter(|radius| *radius > 0.0 && radius.is_finite());
    read.with_context(|| {
        format!("`--fit` is {text:?}; allowed: a number above zero (m), or a number with {}", LENGTH.units())
    })
}
