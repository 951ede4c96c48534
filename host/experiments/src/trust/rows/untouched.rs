//! Frames of the untouched skin, and of one whose fingers were lifted.

use super::{
    WITHIN,
    count::{APART, RADIUS},
};
use crate::trust::{Bench, Figure, Options, Trial, TrustError, Voltages, figure::poisson_upper};

/// False contacts an hour that are allowed.
const ALLOWED: f64 = 1.0;
/// How long nothing presses behind fingers, s.
const REST: f64 = 2.0;

pub(super) fn run(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let mut trial = Trial::new(bench, options.first_snr_db(), options.seed)?;
    let mut figures = Vec::new();
    for &snr_db in &options.snr_db {
        trial.change_noise(snr_db, options.seed);
        let (mut with_contact, mut begun, mut before) = (0, 0, false);
        for _ in 0..options.frames {
            let now = !trial.see_untouched().contacts().is_empty();
            with_contact += usize::from(now);
            begun += usize::from(now && !before);
            before = now;
        }
        let hours = options.frames as f64 / bench.frame_rate() / 3600.0;
        figures.push(Figure::share("frames with a contact", snr_db, with_contact, options.frames));
        figures.push(an_hour(begun, hours, snr_db));
    }
    Ok(figures)
}

/// One, two and three fingers in turn, each time followed by a rest: what other rows, which press more often, do not see.
pub(super) fn rest(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let mut trial = Trial::new(bench, options.first_snr_db(), options.seed)?;
    let mut places = bench.places(options.seed);
    let scenes = (0..options.presses).map(|scene| {
        let fingers = places.draw(1 + scene % 3, &WITHIN, APART)?;
        Ok(bench.pressed(&fingers, RADIUS, 1.0))
    });
    let scenes = scenes.collect::<Result<Vec<_>, TrustError>>()?;
    let frames = (REST * bench.frame_rate()).ceil() as usize;
    let mut figures = Vec::new();
    for &snr_db in &options.snr_db {
        trial.change_noise(snr_db, options.seed);
        let is_left = |scene: &Voltages| {
            trial.press(scene);
            for _ in 1..frames {
                trial.see_untouched();
            }
            !trial.see_untouched().contacts().is_empty()
        };
        let left: Vec<bool> = scenes.iter().map(is_left).collect();
        let count = left.iter().filter(|is_left| **is_left).count();
        let longest = left.split(|is_left| !is_left).map(<[bool]>::len).max().unwrap_or(0);
        let words = format!("contact left {REST} s after");
        figures.push(Figure::share(words, snr_db, count, left.len()).at_most(0.0, true));
        figures.push(Figure::new("presses in a row that leave one, most", "", snr_db, longest as f64));
    }
    Ok(figures)
}

/// False contacts an hour: what they are no more than with 95 % confidence. Frames that are too few show nothing.
fn an_hour(begun: usize, hours: f64, snr_db: f64) -> Figure {
    let upper = poisson_upper(begun, 0.05) / hours;
    let figure =
        Figure::new("false contacts an hour, upper 95 % bound", "1/h", snr_db, upper).at_most(ALLOWED, true);
    let seen = format!("{begun} in {:.0} s", 3600.0 * hours);
    // Were the rate as large as allowed, would so many be seen?
    let is_too_few = poisson_upper(begun.saturating_sub(1), 0.95) / hours <= ALLOWED || begun == 0;
    if upper > ALLOWED && is_too_few {
        figure.open(format!("{seen}: too few frames"))
    } else {
        figure.note(seen)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trust::Verdict;

    #[test]
    fn few_frames_without_a_contact_show_nothing_and_a_contact_soon_is_too_many() {
        assert_eq!(an_hour(0, 0.1, 60.0).verdict(), Some(Verdict::Open));
        assert_eq!(an_hour(1, 0.01, 60.0).verdict(), Some(Verdict::NotMet));
        assert_eq!(an_hour(1, 2.0, 60.0).verdict(), Some(Verdict::Open));
        assert_eq!(an_hour(0, 3.1, 60.0).verdict(), Some(Verdict::Met));
        assert_eq!(an_hour(20, 3.1, 60.0).verdict(), Some(Verdict::NotMet));
    }
}
