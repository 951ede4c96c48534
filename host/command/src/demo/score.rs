//! Scores what came over the link against what the fingers really did.

use dermatome_geometry::outline::Outline;
use dermatome_model::{
    metrics::{ImageFigures, image_figures, mean_and_max, position_error},
    model::Model,
    skin::Skin,
};
use dermatome_patch::layout::Layout;
use dermatome_shared::{contact::Contacts, protocol::FrameStamp, units::RelativeConductivity};
use dermatome_simulate::{Press, Script};
use nalgebra::Point2;
use serde::Serialize;

/// Knows the truth of a demo.
pub(crate) struct Scorer<'a> {
    /// The skin.
    pub skin: &'a Skin,
    /// Its rim.
    pub outline: &'a Outline,
    /// Its model.
    pub model: &'a Model,
    /// How its images are shown.
    pub layout: &'a Layout,
    /// What the fingers do.
    pub script: &'a Script,
}

/// One frame as it arrived, and what it is worth.
#[derive(Clone, Debug)]
pub(crate) struct FrameRecord {
    /// Frames since streaming started.
    pub index: u32,
    /// The board's number and time of the frame.
    pub at: FrameStamp,
    /// The fingers at that time.
    pub presses: Vec<Press>,
    /// Image as received: `[pixel]`.
    pub image: Vec<f64>,
    /// Contacts as received.
    pub contacts: Contacts,
    /// Resolution and ringing.
    pub figures: Option<ImageFigures>,
}

impl Scorer<'_> {
    /// Scores one frame, the first streamed one being `first_sequence`.
    #[must_use]
    pub(crate) fn record(
        &self,
        at: FrameStamp,
        first_sequence: u32,
        image: Vec<f64>,
        contacts: Contacts,
    ) -> FrameRecord {
        let index = at.sequence.wrapping_sub(first_sequence);
        let presses = self.presses(index);
        let fixed: Vec<_> = image.iter().map(|&value| RelativeConductivity::from_f64(value)).collect();
        FrameRecord {
            index,
            at,
            presses,
            figures: image_figures(&fixed, RelativeConductivity::from_f64(self.skin.contact_threshold)),
            image,
            contacts,
        }
    }

    /// The fingers in a frame since streaming started.
    #[must_use]
    pub(crate) fn presses(&self, index: u32) -> Vec<Press> {
        self.script.presses(f64::from(index) / self.skin.drive.frame_rate)
    }

    /// Sums up a whole demo.
    #[must_use]
    pub(crate) fn figures(&self, records: &[FrameRecord]) -> Figures {
        let diameter = self.outline.diameter();
        let single = || records.iter().filter_map(|record| Some((record, single_error(record, diameter)?)));
        let error_in = |unit: f64| {
            let (mean, max) = mean_and_max(single().map(|(_, error)| error / unit))?;
            Some(MeanMax { mean, max })
        };
        let of_figures = |pick: fn(&ImageFigures) -> f64| {
            let figures = single().filter_map(|(record, _)| record.figures.as_ref());
            mean_and_max(figures.map(pick)).map(|(mean, _)| mean)
        };
        Figures {
            position_error_mm: error_in(1e-3),
            position_error_percent: error_in(diameter / 100.0),
            position_error_by_radius: self.by_radius(records),
            single_press_frames: records.iter().filter(|record| record.presses.len() == 1).count(),
            single_press_frames_with_one_contact: frames_with_right_count(records, 1),
            two_press_frames: records.iter().filter(|record| record.presses.len() == 2).count(),
            two_press_frames_with_two_contacts: frames_with_right_count(records, 2),
            significance: self.significance(records),
            resolution_mean: of_figures(|figures| figures.resolution),
            ringing_mean: of_figures(|figures| figures.ringing),
        }
    }

    fn significance(&self, records: &[FrameRecord]) -> Option<Significance> {
        let contacts = records.iter().flat_map(|record| &record.contacts);
        let known = || contacts.clone().filter_map(|contact| Some(f64::from(contact.evidence?.significance)));
        let (mean, _) = mean_and_max(known())?;
        Some(Significance { mean, least: known().fold(f64::INFINITY, f64::min) })
    }

    fn by_radius(&self, records: &[FrameRecord]) -> Vec<RadiusBand> {
        const BANDS: usize = 4;
        let diameter = self.outline.diameter();
        let share =
            |record: &FrameRecord| Point2::from(record.presses[0].position).coords.norm() / (diameter / 2.0);
        let band = |i: usize| {
            let (from, to) = (i as f64 / 5.0, (i + 1) as f64 / 5.0);
            let errors = records
                .iter()
                .filter_map(|record| single_error(record, diameter).map(|error| (share(record), error)))
                .filter(|(share, _)| (from..to).contains(share) || i == BANDS - 1 && *share >= to);
            let per_cent = errors.clone().map(|(_, error)| 100.0 * error / diameter);
            let (mean_percent, max_percent) = mean_and_max(per_cent)?;
            Some(RadiusBand { from, to, frames: errors.count(), mean_percent, max_percent })
        };
        (0..BANDS).filter_map(band).collect()
    }
}

/// Position error of the strongest contact of a frame with one finger, m. A frame in which the
/// board saw no contact counts as `worst`.
fn single_error(record: &FrameRecord, worst: f64) -> Option<f64> {
    let [press] = record.presses.as_slice() else { return None };
    Some(record.contacts.first().map_or(worst, |contact| position_error(contact.position, press.position)))
}

fn frames_with_right_count(records: &[FrameRecord], count: usize) -> usize {
    records.iter().filter(|record| record.presses.len() == count && record.contacts.len() == count).count()
}

/// By how many standard deviations contacts stand out from the noise that the board measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Significance {
    /// Mean.
    pub mean: f64,
    /// Least.
    pub least: f64,
}

/// Mean and largest value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct MeanMax {
    /// Mean.
    pub mean: f64,
    /// Largest.
    pub max: f64,
}

/// Position error in a ring of the skin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct RadiusBand {
    /// Inner radius, share of the skin's radius.
    pub from: f64,
    /// Outer radius, share of the skin's radius.
    pub to: f64,
    /// Frames with the finger there.
    pub frames: usize,
    /// Mean error, per cent of the diameter.
    pub mean_percent: f64,
    /// Largest error, per cent of the diameter.
    pub max_percent: f64,
}

/// The demo's figures; keys are documented in docs/cli.md.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Figures {
    /// Centre of pressure against the finger, mm, while one finger travels.
    pub position_error_mm: Option<MeanMax>,
    /// The same, per cent of the diameter.
    pub position_error_percent: Option<MeanMax>,
    /// The same, by distance from the centre; rings without a frame are left out.
    pub position_error_by_radius: Vec<RadiusBand>,
    /// Frames with one finger.
    pub single_press_frames: usize,
    /// Those with exactly one contact reported.
    pub single_press_frames_with_one_contact: usize,
    /// Frames with two fingers.
    pub two_press_frames: usize,
    /// Those with exactly two contacts reported.
    pub two_press_frames_with_two_contacts: usize,
    /// How far contacts stand out from the noise.
    pub significance: Option<Significance>,
    /// Resolution RES (thesis equation 3.3), mean over the single-finger frames.
    pub resolution_mean: Option<f64>,
    /// Ringing RNG (thesis equation 3.5), the same.
    pub ringing_mean: Option<f64>,
}
